"""What does each fidelity cost, and how large is its error? Measures impacts, then whole pots; draws a picture and
recommends a fidelity for each use.

    python -m benchmarks.tradeoff [--impacts 2000] [--shots 1000] [--repeats 3] [--physics paper] [--seed 0]
    [--json FILE]
        [--out FOLDER]

``reference`` is the truth. Impacts: errors of direction and speed of the worse of the two balls, just after the
impact and once both balls roll (the direction that a player sees; it means little for a ball that its spin almost
stops). Shots: distance from the truth of the final places of cue ball and object ball, if they stay on the table,
and how often the pot's outcome changes. The scale is the effect of a professional's errors: the same intended
stroke, played twice by the truth with the execution errors of ``tasks.noise``.
"""

import numpy as np

import snooker_env as sn
from agents._lib import picture_style, provenance
from agents._lib.tables import text_table
from snooker_env.physics.engine import EventKind
from snooker_env.physics.impact import contact

from ._common import shot_sets
from ._common.command import Command, at_least, run, save_figures
from .speed.__main__ import impacts, median_impact, results
from .speed.clock import Way, time_ways

OWN = ("fast", "standard", "reference")
IMPACTS = (*OWN, *(f"euler:{n}" for n in (10, 30, 100, 200, 300, 1000, 3000, 10000)))
SHOTS = (*OWN, *(f"euler:{n}" for n in (100, 300, 1000, 3000, 10000)))
SETS = {"two-ball pots": shot_sets.two_ball, "full tables": shot_sets.full_table}
CONTACTS = ((1, 1), (2, 2), (3, 5), (6, 999))
ERRORS = "a professional's errors"
SHARE = 0.1
"""A fidelity is good enough for play if its effect on balls and pots is at most this share of the effect of a
professional's errors."""
STORED = 1e-3
"""It is good enough for results that are kept and compared if, in addition, it changes at most this share of pots."""
FILE = "tradeoff.png"


def spread(values):
    """Median, 99 % quantile and maximum."""
    return np.quantile(values, [0.5, 0.99, 1.0]).tolist() if len(values) else [float("nan")] * 3


def impact_errors(found, truth):
    """For each impact, the worse ball's error just after it and once both balls roll: direction [deg], speed [m/s];
    and that of the object ball alone."""
    errors, object_angle = [], np.zeros(0)
    for rolling in (False, True):
        angle, speed = np.zeros(len(truth)), np.zeros(len(truth))
        for ball in (0, 6):
            a, b = ((x[:, ball : ball + 2], x[:, ball + 3 : ball + 5]) for x in (found, truth))
            # after the slip: v - (2/7) u with u = v + R (-w_y, w_x)
            a, b = (
                (5 * v + 2 * np.column_stack([w[:, 1], -w[:, 0]])) / 7 if rolling else v for v, w in (a, b)
            )
            turn = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(1))
            object_angle = np.degrees(np.abs(turn))
            angle = np.maximum(angle, object_angle)
            speed = np.maximum(speed, np.abs(np.hypot(*a.T) - np.hypot(*b.T)))
        errors += [angle, speed]
    names = ("angle_deg", "speed_m_s", "rolling_angle_deg", "rolling_speed_m_s", "object_rolling_angle_deg")
    return dict(zip(names, map(spread, (*errors, object_angle)), strict=True))


def play_impacts(n, physics, seed):
    """Figures of every fidelity on the set of impacts."""
    (x, normals), physics = impacts(n, seed), sn.Physics.preset(physics)
    phys, rows = physics.packed_for((1, 0)), {}
    truth = results(x, normals, "reference", physics)
    for fidelity in IMPACTS:
        code, steps = contact.parse_fidelity(fidelity)
        guess = median_impact(x[:50], normals[:50], phys, code, steps, 2)
        errors = impact_errors(results(x, normals, fidelity, physics), truth)
        rows[fidelity] = {
            "us": median_impact(x, normals, phys, code, steps, max(2, int(30 / guess))),
            **errors,
        }
    return rows


def compare(end, truth, ball):
    """Compare shots that end in ``end`` with ``truth``: shifts of cue ball and object ball [mm], nan if off the
    table, and whether the pot's outcome changed."""
    rows = np.arange(len(ball))
    shifts = []
    for b in (0 * ball, ball):
        shift = 1e3 * np.hypot(*(end.positions - truth.positions)[rows, b].T)
        shifts.append(np.where(end.on_table[rows, b] & truth.on_table[rows, b], shift, np.nan))
    return *shifts, (end.potted[rows, ball] >= 0) != (truth.potted[rows, ball] >= 0)


def play_shots(make, n, repeats, physics, seed):
    """Figures of every fidelity, and of the execution errors, on one set of shots."""
    physics = sn.Physics.preset(physics)
    shots = make(n, physics, seed)
    v, w = shots.struck(seed=seed + 1)

    def play(state, fidelity, events=False):
        return sn.simulate_batch(shots.positions, *state, physics=physics, fidelity=fidelity, events=events)

    truth = play((v, w), "reference", events=True)
    assert truth.events is not None
    hits = np.array([(log["kind"] == EventKind.BALL_BALL).sum() for log in truth.events])
    ways = {name: Way(physics, contact.parse_fidelity(name)) for name in SHOTS}
    times = time_ways(ways, (shots.positions, v, w), repeats)
    rows = {}
    for name in (*SHOTS, ERRORS):
        errors = name == ERRORS
        end = play(shots.struck(seed=seed + 2), "reference") if errors else play((v, w), name)
        cue, ball, changed = compare(end, truth, shots.ball)
        groups = [(c, (hits >= c[0]) & (hits <= c[1]) & ~np.isnan(cue)) for c in CONTACTS]
        rows[name] = {
            "us": None if errors else float(times[name].min(0).mean()),
            "cue_mm": spread(cue[~np.isnan(cue)]),
            "ball_mm": spread(ball[~np.isnan(ball)]),
            "changed": float(changed.mean()),
            "by_contacts": [
                {"contacts": c, "shots": int(g.sum()), "cue_mm": spread(cue[g])} for c, g in groups
            ],
        }
    potted = float((truth.potted[np.arange(n), shots.ball] >= 0).mean())
    return {"potted": potted, "contacts": float(hits.mean()), "rows": rows}


def find_dominated(rows, name, error):
    """The fidelities that are both faster and more accurate than ``name``."""
    others = [f for f in rows if f not in (name, ERRORS, "reference")]
    return [f for f in others if rows[f]["us"] < rows[name]["us"] and error(rows[f]) < error(rows[name])]


def recommendation(impact_rows, sets):
    """Recommend fidelities in sentences; every choice follows from the figures."""

    def cheapest(good):
        fit = [f for f in SHOTS if all(good(s["rows"][f], s["rows"][ERRORS]) for s in sets.values())]
        return min(fit, key=lambda f: sum(s["rows"][f]["us"] for s in sets.values())) if fit else None

    def figures(fidelity):
        parts = []
        for name, s in sets.items():
            row, errors = s["rows"][fidelity], s["rows"][ERRORS]
            parts.append(
                f"{name}: {row['us']:.1f} us a shot, {100 * row['changed']:.2g} % of pots change (a professional's errors:"
                f" {100 * errors['changed']:.2g} %), the cue ball's median error is {row['cue_mm'][0]:.2g} mm"
                f" ({errors['cue_mm'][0]:.3g} mm)"
            )
        return "; ".join(parts)

    def shares(row, errors):
        pots = row["changed"] / errors["changed"] if errors["changed"] else float(row["changed"] > 0)
        return {"pots changed": pots, "the cue ball's median error": row["cue_mm"][0] / errors["cue_mm"][0]}

    def for_play(row, errors):
        return max(shares(row, errors).values()) <= SHARE

    says = []
    play, kept = (
        cheapest(for_play),
        cheapest(lambda row, errors: for_play(row, errors) and row["changed"] <= STORED),
    )
    rule = f"Learning, search, play: at most {SHARE:.0%} of the effect of a professional's errors, in pots changed and cue ball's place."
    says.append(
        f"{rule} Cheapest fidelity that meets this: {play}. {figures(play)}."
        if play
        else f"{rule} No fidelity meets this."
    )
    rule = f"Results that are kept and compared: in addition, at most {STORED:.1%} of pots changed."
    says.append(
        f"{rule} No fidelity meets this."
        if kept is None
        else f"{rule} Again: {kept}."
        if kept == play
        else f"{rule} Cheapest fidelity that meets this: {kept}. {figures(kept)}."
    )
    saved = [1 - s["rows"]["fast"]["us"] / s["rows"]["standard"]["us"] for s in sets.values()]
    over = [
        f"{what} on {name} {share:.1%} of the errors'"
        for name, s in sets.items()
        for what, share in shares(s["rows"]["fast"], s["rows"][ERRORS]).items()
        if share > SHARE
    ]
    fit = f"breaks the rule for play ({'; '.join(over)})" if over else "meets the rule for play"
    says.append(
        f"fast {fit} and saves {min(saved):.0%} to {max(saved):.0%} of the time of standard. {figures('fast')}. In one impact, it errs"
        f" by at most {impact_rows['fast']['angle_deg'][2]:.2g} deg for the worse ball and by at most"
        f" {impact_rows['fast']['object_rolling_angle_deg'][2]:.2g} deg for the object ball's final path."
    )
    ratio = [s["rows"]["reference"]["us"] / s["rows"]["standard"]["us"] for s in sets.values()]
    says.append(
        f"reference is the truth here and takes {min(ratio):.1f} to {max(ratio):.1f} times as long as standard. Use it to check the others,"
        f" and if a shot with many contacts must be exact to the millimetre (standard on full tables: 99 % within"
        f" {sets['full tables']['rows']['standard']['cue_mm'][1]:.2g} mm)."
    )
    euler = [f for f in IMPACTS if f.startswith("euler")]
    beaten = {f: find_dominated(impact_rows, f, lambda r: r["angle_deg"][1]) for f in euler}
    free = [f for f in euler if not beaten[f]]
    steps = np.array([float(f[6:]) for f in euler])
    order = -np.polyfit(np.log(steps), np.log([impact_rows[f]["angle_deg"][0] for f in euler]), 1)[0]
    says.append(
        f"euler:N, the paper's scheme, approaches the truth as N^-{order:.2f} (median angle), an independent check of reference. "
        + (
            "Use it to reproduce the paper: for every N here, another fidelity is both faster and more accurate (99 % of angles)"
            if not free
            else f"Of these N, only {', '.join(free)} are not beaten by a fidelity both faster and more accurate (99 % of angles)"
        )
        + f"; euler:10000 errs by {impact_rows['euler:10000']['angle_deg'][1]:.1g} deg and takes"
        f" {impact_rows['euler:10000']['us'] / impact_rows['standard']['us']:.0f} times as long as standard, which errs by"
        f" {impact_rows['standard']['angle_deg'][1]:.1g} deg."
    )
    return says


def draw(figures, out):
    """Draw time against error: impacts (angle, speed), then the cue ball's final place in each set of shots."""
    impact_rows = figures["impacts"]
    panels = [
        (
            impact_rows,
            "angle_deg",
            "One impact: direction of the worse ball",
            "error [degrees]",
            "time of an impact [µs]",
        ),
        (
            impact_rows,
            "speed_m_s",
            "One impact: speed of the worse ball",
            "error [m/s]",
            "time of an impact [µs]",
        ),
    ]
    for name, s in figures["shots"].items():
        title = f"{name[0].upper()}{name[1:]}: where the cue ball stops"
        panels.append((s["rows"], "cue_mm", title, "distance from reference [mm]", "time of a shot [µs]"))
    with picture_style.drawing() as plt:
        note = (
            "Error against reference, of each fidelity and of the paper's scheme with N steps (euler:N): median, 99 % and worst.\n"
            "Lower left is better. Horizontal bar: effect of a professional's errors on the same shots, median to 99 %."
        )
        foot = f"python -m benchmarks.tradeoff, physics {figures['physics']!r}; {provenance.line(figures)}"
        fig, axes = picture_style.page(
            plt,
            8.6,
            "What each fidelity costs, and how large its error is",
            note,
            foot=foot,
            rows=2,
            columns=2,
        )
        labels = [label for ax, panel in zip(axes.flat, panels, strict=True) for label in _panel(ax, *panel)]
        _legend(axes[0, 1])
        picture_style.label_points(fig, labels)
        picture_style.save(fig, out)


def _panel(ax, rows, key, title, error, cost):
    """Draw time against one error, one column of marks per fidelity. Returns the labels to place."""
    labels = []
    for fidelity, row in rows.items():
        middle, high, worst = row[key]
        if fidelity == ERRORS:
            ax.axhspan(middle, high, color=picture_style.GREEN, alpha=0.14, lw=0)
            ax.axhline(middle, color=picture_style.GREEN, lw=1.2)
            continue
        if fidelity == "reference":
            ax.axvline(row["us"], color=picture_style.QUIET, ls=(0, (2, 2)), lw=1.1)
            ax.annotate(
                "reference",
                (row["us"], 0.11),
                xycoords=("data", "axes fraction"),
                xytext=(4, 0),
                textcoords="offset points",
                size=picture_style.SMALL,
                color=picture_style.QUIET,
            )
            continue
        own = fidelity in OWN
        colour = picture_style.BLUE if own else picture_style.ORANGE
        ax.plot([row["us"]] * 2, [middle, worst], color=colour, lw=1.2, alpha=0.55)
        ax.plot(row["us"], middle, "o", color=colour, ms=6)
        ax.plot(row["us"], high, "_", color=colour, ms=10, mew=2.2)
        ax.plot(row["us"], worst, "^", color=colour, ms=5, mfc="white")
        if own or fidelity in ("euler:10", "euler:100", "euler:1000", "euler:10000"):
            text = fidelity if own else f"{int(fidelity[6:]):,}"
            style = {"color": colour, "weight": "bold" if own else "normal"}
            # below the mark, because the line of reference would cross it
            if 1 < rows["reference"]["us"] / row["us"] < 1.8:
                ax.annotate(
                    text,
                    (row["us"], middle),
                    xytext=(-7, 0),
                    textcoords="offset points",
                    ha="right",
                    va="center",
                    size=picture_style.SMALL,
                    **style,
                )
            else:
                labels.append((ax, (row["us"], middle), text, style))
    picture_style.log_axis(ax.xaxis)
    picture_style.log_axis(ax.yaxis, decades=2)
    ax.set(title=title, xlabel=cost, ylabel=error)
    ax.margins(0.1, 0.13)
    ax.set_xlim(left=0.33 * min(row["us"] for fidelity, row in rows.items() if fidelity != ERRORS))
    return labels


def _legend(ax):
    """The meaning of marks and colours."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    dark = picture_style.QUIET
    handles = [
        Line2D([], [], marker=m, ls="", color=dark, mfc=f, ms=s, mew=2.2 if m == "_" else 1, label=t)
        for m, f, s, t in (("^", "white", 5, "worst"), ("_", dark, 10, "99 %"), ("o", dark, 6, "median"))
    ]
    colours = ((picture_style.BLUE, "fidelity"), (picture_style.ORANGE, "euler:N, with N"))
    handles += [Patch(color=c, label=t) for c, t in colours]
    ax.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 0.05))


def main():
    """Command line."""
    parser = Command("tradeoff", __doc__, pictures=(FILE,), seed=0, redraws=True)
    parser.add_argument("--impacts", type=at_least(2), default=2000, help="impacts in the set")
    parser.add_argument("--shots", type=at_least(2), default=1000, help="shots in each set")
    parser.add_argument(
        "--repeats", type=at_least(1), default=3, help="timed runs of every shot, of which the best counts"
    )
    parser.add_argument(
        "--physics", default="paper", help="physics of impacts and shots: paper or match [paper]"
    )
    options = parser.options()
    if options.figures is None:
        options.figures = measure(options)
    if options.pictures:
        draw(options.figures, options.folder / FILE)
        print(f"\n{options.folder / FILE}")


def measure(options):
    """Measure and print everything. Returns the figures."""
    print(provenance.line(options.made))
    impact_rows = play_impacts(options.impacts, options.physics, options.seed)
    print(
        f"\n{options.impacts} impacts: median us; then median, 99 %, worst of: direction [deg], speed [m/s]; once both roll: the same"
    )
    for fidelity, row in impact_rows.items():
        errors = "   ".join(" ".join(f"{e:7.1e}" for e in row[k]) for k in list(row)[1:5])
        print(f"  {fidelity:12s} {row['us']:8.3f}   {errors}")
    sets = {}
    for name, make in SETS.items():
        s = sets[name] = play_shots(make, options.shots, options.repeats, options.physics, options.seed)
        print(
            f'\n{options.shots} {name}, physics "{options.physics}": {s["potted"]:.0%} potted, {s["contacts"]:.1f} ball-ball hits a shot'
        )
        print(
            "                          us a shot   pots changed   cue ball off by [mm]: median, 99 %, worst   object ball: the same"
        )
        for fidelity, row in s["rows"].items():
            us = "        -" if row["us"] is None else f"{row['us']:9.1f}"
            mm = "      ".join(
                " ".join(f"{e:9.2g}" if e < 100 else f"{e:9.0f}" for e in row[k])
                for k in ("cue_mm", "ball_mm")
            )
            print(f"  {fidelity:22s}  {us}      {row['changed']:7.2%}      {mm}")
    print(
        "\nfull tables, cue ball off by [mm] (median, 99 %, worst), by the number of ball-ball contacts in the shot"
    )
    heads = [f"{a} or more" if b == 999 else f"{a}" if a == b else f"{a} to {b}" for a, b in CONTACTS]
    groups = sets["full tables"]["rows"]
    counts = [g["shots"] for g in groups["standard"]["by_contacts"]]
    rows = [
        [
            fidelity,
            *(
                " ".join(f"{e:7.2g}" if e < 100 else f"{e:7.0f}" for e in g["cue_mm"])
                for g in row["by_contacts"]
            ),
        ]
        for fidelity, row in groups.items()
    ]
    print(
        "\n".join(text_table(["", *(f"{h} ({c} shots)" for h, c in zip(heads, counts, strict=True))], rows))
    )
    says = recommendation(impact_rows, sets)
    print("\nWhich fidelity for which use")
    for sentence in says:
        print(f"* {sentence}")
    figures = {
        "physics": options.physics,
        "impacts": impact_rows,
        "shots": sets,
        "recommendation": says,
    }
    return save_figures(options, figures)


if __name__ == "__main__":
    run(main)
