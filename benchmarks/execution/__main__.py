"""How well do the levels of ``noise`` play? Pot rates by distance and cut, direction errors, placement, play,
beside what is published.

    python -m benchmarks.execution [--levels professional robot ...] [--strokes 4000] [--visits 100] [--seed 0]
        [--json FILE] [--out FOLDER]

Every pot is aimed at the middle of all the aims that pot it without errors, and struck many times with the
errors of a level: made is what goes into its pocket, with the cue ball on the table. Speeds are as played,
and once more 4.5 m/s. Intervals are 95 % (Wilson). Direction: standard deviations of the cue ball's path
[deg], by cause. Placement: how far from where it would stop without errors the cue ball comes to rest after a
pot, root mean square, along its way from the impact and across. In play: visits from held-out tables by a
player who takes the pot, of all at several speeds, that goes in most often when tried on copies of the table.
Layouts: the widest pot of tables dealt by ``"pots:easy"`` and so on, along its solved line at 2.3 m/s.

The levels of people are set by whole frames (``python -m agents.calibrate``), not by what is published of pots,
which takes about half of their errors; the robot's is set by it.

Published: professionals pot 88 to 95 % of what they choose and 50 to 65 % of long pots. Aim errors of 0.02 to
0.03 deg for professionals, 0.05 for good amateurs, 0.08 to 0.12 in clubs were derived as total errors of
direction, for a corner pocket with an effective half window of 22 mm; the pot rates "derived" are computed
so, by geometry. A robot, built by the authors of the physics, potted 90 % and left the cue ball 100 to 200 mm
from its target (doi 10.1109/TMECH.2015.2461547; neither its shots nor its other errors are in its abstract).
"""

import numpy as np

from agents._lib.tables import text_table
from snooker_env.game.layouts import POT_WINDOWS
from snooker_env.physics.parameters import Physics
from snooker_env.tasks.noise import LEVELS, Noise

from .._common.command import Command, at_least, run, save_figures
from . import published
from .in_play import first_pots, in_play
from .pot_shots import DERIVED, FIRM, LONG, MODERATE, POTS, aimed, directions, rolls, wilson

SKILLS = tuple(name for name in LEVELS if name != "none")


def measure_level(level, shots, strokes, seed, physics, table):
    """Figures of a level at every pot, as played and firm."""
    rows = []
    for k, shot in enumerate(shots):
        found = rolls(shot, level, strokes, seed + 1000 + k, physics, table)
        rows.append(
            {
                "pot": shot.pot.name,
                "speed": float(shot.stroke[0]),
                "half_window_deg": float(np.degrees(shot.half)),
                "rate": found.rate,
                "interval": wilson(found.rate, strokes),
                "published": published.of_pot(shot.pot, level),
                "placement_mm": [1e3 * x for x in found.placement] if found.made.any() else None,
            }
        )
    return rows


def against(level, rows, made, expected):
    """(what, ours, lowest, highest published) of a level."""
    as_played = {row["pot"]: row for row in rows if row["speed"] != FIRM}
    found = []

    def mean(pots, value):
        return float(np.mean([value(as_played[pot.name]) for pot in pots]))

    if level == "professional":
        likely = made[expected >= published.LIKELY]
        found.append(("long pots", mean(LONG, _rate), *published.LONG_POTS))
        found.append(("in play, all that it tries", float(made.mean()), *published.CHOSEN))
        if len(likely):
            found.append(
                ("in play, where the chance is half or more", float(likely.mean()), *published.CHOSEN)
            )
    if level in published.AIM:
        found.append(
            ("black, red, blue, long 2.4 m (derived)", mean(DERIVED, _rate), *published.by_derivation(level))
        )
    if level == "robot":
        found.append(
            ("pots of moderate difficulty", mean(MODERATE, _rate), published.ROBOT_POTS, published.ROBOT_POTS)
        )
        found.append(
            (
                "placement after them [m]",
                mean(MODERATE, lambda row: row["placement_mm"][0] / 1e3),
                *published.ROBOT_PLACES,
            )
        )
    return found


def _rate(row):
    return row["rate"]


def show_pots(rows, levels):
    """Pot rates and placements at every pot."""
    rates, places = [], []
    for k, first in enumerate(rows[levels[0]]):
        where = [first["pot"], f"{first['speed']:.1f}"]
        rates.append(
            [*where, f"{first['half_window_deg']:.3f}", *(_rate_in_words(rows[level][k]) for level in levels)]
        )
        at = [rows[level][k]["placement_mm"] for level in levels]
        places.append(
            [
                *where,
                *(
                    "none potted" if place is None else "{:.0f} ({:.0f}, {:.0f})".format(*place)
                    for place in at
                ),
            ]
        )
    print(
        "\n".join(text_table(["pot rate [%], 95 % (published; long: mean)", "m/s", "window", *levels], rates))
    )
    print("window: half the width of the aims that pot without errors [deg]\n")
    print("\n".join(text_table(["placement [mm]: distance (along, across)", "m/s", *levels], places)))


def _rate_in_words(row):
    words = "{:.0f} [{:.0f}, {:.0f}]".format(*(100 * x for x in (row["rate"], *row["interval"])))
    return (
        words
        if row["published"] is None
        else words + " ({:.0f}-{:.0f})".format(*(100 * x for x in row["published"]))
    )


def share(made):
    """The share that scored, in words."""
    if len(made) == 0:
        return "none"
    low, high = wilson(made.mean(), len(made))
    return f"{made.sum()} of {len(made)}: {made.mean():.1%} [{low:.1%}, {high:.1%}]"


def main():
    """Command line."""
    parser = Command("execution", __doc__, seed=0)
    parser.add_argument(
        "--levels", nargs="+", choices=SKILLS, default=list(SKILLS), help="levels of noise [all]"
    )
    parser.add_argument("--strokes", type=at_least(10), default=4000, help="strokes at each pot [4000]")
    parser.add_argument("--visits", type=at_least(1), default=100, help="visits of each level in play [100]")
    parser.add_argument("--physics", choices=("paper", "match"), default="paper", help="[paper]")
    parser.add_argument("--table", choices=("match", "tight"), default="match", help="[match]")
    options = parser.options()
    physics, table = Physics.preset(options.physics), options.table
    shots = [aimed(pot, physics, table, speed) for pot in POTS for speed in (None, FIRM)]
    rows = {
        level: measure_level(level, shots, options.strokes, options.seed, physics, table)
        for level in options.levels
    }
    show_pots(rows, options.levels)
    print(
        "\ndirection [deg], standard deviations: of aim, squirt, swerve, all; closed form of aim and squirt"
    )
    turned = {}
    for level in options.levels:
        turned[level] = directions(level, options.strokes, options.seed + 7, physics) | {
            "closed": Noise.of(level).direction_deg(physics)
        }
        print(f"{level:14s}" + "".join(f"{value:9.4f}" for value in turned[level].values()))
    print(f"\n{'in play, scored':14s}{'of all strokes':>40s}{'where the chance was half or more':>40s}")
    plays = {}
    for level in options.levels:
        made, expected = in_play(
            level, options.visits, options.seed + 3, physics=options.physics, table=table
        )
        print(f"{level:15s}" + f"{share(made):>40s}{share(made[expected >= published.LIKELY]):>40s}")
        compared = against(level, rows[level], made, expected)
        plays[level] = {
            "made": int(made.sum()),
            "strokes": len(made),
            "expected": float(expected.mean()),
            "against": compared,
        }
    print(f"\n{'layouts':15s}" + "".join(f"{f'pots:{name}':>40s}" for name in POT_WINDOWS))
    for level in options.levels:
        dealt = {
            name: first_pots(level, f"pots:{name}", options.strokes, physics=options.physics, table=table)
            for name in POT_WINDOWS
        }
        plays[level]["layouts"] = {name: float(made.mean()) for name, made in dealt.items()}
        print(f"{level:15s}" + "".join(f"{share(made):>40s}" for made in dealt.values()))
    beside = [
        [level, what, f"{ours:.3f}", f"{low:.3f} to {high:.3f}", f"{ours - min(max(ours, low), high):+.3f}"]
        for level in options.levels
        for what, ours, low, high in plays[level]["against"]
    ]
    print(
        "\n"
        + "\n".join(
            text_table(["level", "beside what is published", "ours", "published", "outside by"], beside, 2)
        )
    )
    save_figures(options, {"pots": rows, "direction_deg": turned, "in_play": plays})


if __name__ == "__main__":
    run(main)
