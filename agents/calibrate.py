"""How large are a professional's errors, judged by whole frames? Two copies of the ``tactician`` play frames under
errors of several sizes, and the command compares these frames with those of professionals.

    python -m agents.calibrate FILE [--scales 0.9 1.0 1.1] [--frames 400] [--picture FILE] [--json FILE]

FILE holds one line per frame of professionals: VISITS/VISITS/MINUTES:SECONDS. VISITS lists the points of a player's
scoring visits, with F4 for 4 points from the opponent's foul. A line M A B before the frames of a match gives the seconds
per stroke of both players, 0 if unknown; lines with # are comments. A scale multiplies the errors of
``noise="professional"`` (``agents._lib.noise_option``). A visit (one turn at the table) scores if it pots a ball; its points
are its break. Players concede lost frames, as in matches. Standard errors are over frames. The command also compares the
chance to win that the ``tactician`` sees before each stroke with the actual winners.
"""

import re
import shlex
import sys
from pathlib import Path

from agents._lib.lifecycle import command, needs, parser_of

with needs("agents.calibrate"):
    import numpy as np

    import snooker_env
    from agents._lib import picture_style
    from agents._lib.files import writable, write_json
    from agents._lib.provenance import provenance
    from agents._lib.tables import TextTable, show
    from snooker_env.checks import integer, number, refuse
    from snooker_env.planning import FrameJudge
    from snooker_env.planning.learned.dense_layers import Layers
    from snooker_env.planning.learned.frame_features import HIDDEN, LIKELY, read_errors
    from snooker_env.planning.learned.learned_worth import worth_of
    from snooker_env.players.weights import learned_worth
    from snooker_env.tasks import LEVELS

    from .learning.frame_self_play import FRAME, TABLES, frames
    from .learning.frame_worth import by_stage, by_tenth, calibration

FIRST_SEED = 900_000_000  # frames that no training plays
FIGURES = {
    "visits": "scoring visits a frame",
    "strokes": "strokes a frame",
    "fouls": "fouls a frame",
    "break": "mean break of a scoring visit",
    "breaks_50": "breaks of 50 and more, %",
    "breaks_100": "breaks of 100 and more, %",
    "frames_50": "frames with a 50, %",
    "frames_100": "frames with a century, %",
    "winner": "points of the winner",
    "loser": "points of the loser",
}


def frames_of(text):
    """Read the frames of a file: one dict each, with "breaks" (of both players), "fouls", "points" (2,), "strokes"."""
    frames, shot = [], 0.0
    for line in text.splitlines():
        if not line or line.startswith("#"):
            continue
        if re.fullmatch(r"M( \d+(\.\d+)?){2}\s*", line):
            times = [float(part) for part in line.split()[1:]]
            shot = float(np.mean(times)) if all(times) else 0.0
            continue
        parts = line.split("/")
        if not re.fullmatch(r"[F\d ]*/[F\d ]*/\d+:\d\d\s*", line):
            raise refuse("file", line, "must hold lines VISITS/VISITS/MINUTES:SECONDS")
        breaks, fouls, points = [], 0, np.zeros(2)
        for side, visits in enumerate(parts[:2]):
            for visit in visits.split():
                if visit.startswith("F"):
                    fouls += 1
                    points[side] += int(visit[1:])
                else:
                    breaks.append(int(visit))
                    points[side] += int(visit)
        minutes, seconds = map(int, parts[2].split(":"))
        strokes = (60 * minutes + seconds) / shot if shot else np.nan
        frames.append({"breaks": breaks, "fouls": fouls, "points": points, "strokes": strokes})
    if len(frames) < 2 or not any(one["breaks"] for one in frames):
        raise refuse("file", f"{len(frames)} frames", "must hold at least two frames and one scoring visit")
    return frames


def group_frames(rows):
    """The same for simulated frames, from the rows of ``frame_self_play.frames``."""
    frames = []
    for k in np.unique(rows["frame"]).tolist():
        which = np.flatnonzero(rows["frame"] == k)
        breaks, points, running, at = [], np.zeros(2), 0.0, -1
        for swing, striker in zip(rows["swing"][which], rows["striker"][which], strict=True):
            points[striker if swing > 0 else 1 - striker] += abs(swing)
            if striker != at or swing <= 0:
                breaks.append(running)
                running = 0.0
            running, at = running + max(0.0, swing), striker
        breaks = [one for one in [*breaks, running] if one > 0]
        fouls = int((rows["swing"][which] < 0).sum())
        frames.append({"breaks": breaks, "fouls": fouls, "points": points, "strokes": float(len(which))})
    return frames


TACTICS = {
    "easy": "visits ended by a stroke that leaves the opponent a pot with a chance over 0.9, %",
    "easy_no_pot": "the same if no direct pot was possible, %",
    "break_off": "points of the opponent's visit after a break-off",
    "escapes": "fouls by snookered strikers, %",
}


def tactics_of(parts):
    """Mean, standard error and number for each of ``TACTICS``, from the rows of all parts of a scale."""
    found = {name: [] for name in TACTICS}
    for rows in parts:
        after, likely, hidden = rows["next"], rows["seen"][:, LIKELY], rows["seen"][:, HIDDEN] > 0.5
        fouls = rows["swing"] < 0
        ends = (after >= 0) & (rows["same"] < 0) & ~fouls
        easy = likely[after] > 0.9
        found["easy"].append(easy[ends])
        found["easy_no_pot"].append(easy[ends & (likely < 0.01)])
        found["escapes"].append(fouls[hidden])
        first = np.unique(rows["frame"], return_index=True)[1]
        found["break_off"].append([_next_visit(rows, k) for k in first.tolist()])
    out = {}
    for name, values in found.items():
        every = np.concatenate(values).astype(float) * (1.0 if name == "break_off" else 100.0)
        many = len(every)
        out[name] = [float(every.mean()), float(every.std() / np.sqrt(many)), many] if many else None
    return out


def _next_visit(rows, k):
    """Points of the visit that begins after stroke k, if it is the opponent's."""
    at, points, other = rows["next"][k], 0.0, 1 - rows["striker"][k]
    while at >= 0 and rows["striker"][at] == other and rows["swing"][at] > 0:
        points += rows["swing"][at]
        at = rows["next"][at]
    return points


def figures_of(frames):
    """Mean and standard error for each of ``FIGURES``."""
    breaks = [np.array(one["breaks"]) for one in frames]
    many = np.array([len(one) for one in breaks], float)
    best = np.array([one.max(initial=0) for one in breaks])
    points = np.array([sorted(one["points"]) for one in frames])
    every = {
        "visits": many,
        "strokes": np.array([one["strokes"] for one in frames]),
        "fouls": np.array([one["fouls"] for one in frames], float),
        "frames_50": 100.0 * (best >= 50),
        "frames_100": 100.0 * (best >= 100),
        "winner": points[:, 1],
        "loser": points[:, 0],
    }
    out = {}
    for name, values in every.items():
        values = values[np.isfinite(values)]
        out[name] = (
            [float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))]
            if len(values) > 1
            else None
        )
    ratios = {
        "break": np.array([one.sum() for one in breaks]),
        "breaks_50": np.array([100.0 * (one >= 50).sum() for one in breaks]),
        "breaks_100": np.array([100.0 * (one >= 100).sum() for one in breaks]),
    }
    for name, sums in ratios.items():
        mean = sums.sum() / many.sum()
        out[name] = [float(mean), float(np.sqrt(((sums - mean * many) ** 2).sum()) / many.sum())]
    return {name: out[name] for name in FIGURES}


def play_frames(laws, many, budget):
    """Let two copies of the ``tactician`` play under each ``Noise``. Returns one list of rows per noise, one entry per part."""
    layers, chance = learned_worth()
    options = FRAME | {"says": ["decision", "concede"]}
    shared = {"options": options, "layers": layers, "chance": chance}
    shared |= {"budget": budget, "explore": 0.0, "replies": False}
    return [
        [
            frames(
                shared,
                {"noise": noise, "seed": FIRST_SEED + k, "many": min(TABLES, many - k), "other": None},
                None,
            )
            for k in range(0, many, TABLES)
        ]
        for noise in laws
    ]


def chances_of(parts):
    """Compare the striker's chance to win with the results, over the rows of all parts. Returns chance and share won, (10, 2), of
    groups of strokes sorted by chance; the mean absolute difference; the rows of ``by_stage``, and those of ``by_tenth``.
    None if no frame was won."""
    layers, chance = learned_worth()
    names = "seen", "lead", "left", "last", "won", "decided", "frame"
    rows = {name: np.concatenate([part[name] for part in parts]) for name in names}
    rows["frame"] += TABLES * np.repeat(np.arange(len(parts)), [len(part["frame"]) for part in parts])
    rows = {name: part[rows["decided"]] for name, part in rows.items()}
    if not len(rows["won"]):
        return None
    worth = worth_of(None if layers is None else Layers(layers, "relu"), rows["seen"]).astype(np.float64)
    stand = rows["lead"], rows["left"], rows["last"]
    said = chance(stand[0], worth, *stand[1:], read_errors(rows["seen"]))
    seen = by_stage(said, rows["won"], *stand, rows["frame"]), by_tenth(said, rows["won"], rows["frame"])
    return *calibration(said, rows["won"]), *seen


def draw(tenths, frames, file):
    """Draw the result of ``by_tenth``."""
    strokes, _, said, won, error = np.array(tenths).T
    said, won, error = 100.0 * said, 100.0 * won, 100.0 * error
    clear = said - won > 2.0 * error  # where it says more than comes true
    words = "In no tenth does it say more than comes true, beyond two standard errors."
    if clear.any():
        low, high = 10 * int(said[clear].min() // 10), 10 * int(said[clear].max() // 10) + 10
        words = f"Overconfident by {np.average((said - won)[clear], weights=strokes[clear]):.0f} points where it says {low} to {high} %."
    note = (
        f"Before each of {int(strokes.sum()):,} strokes in {frames} frames of two tacticians: how likely the player at the table wins.\n"
        f"Points: strokes in steps of 10 %; bars: two standard errors. {words}"
    )
    with picture_style.drawing() as plt:
        figure, axes = picture_style.page(plt, 5.4, "The chance to win, and who won", note, columns=1)
        axes.plot([0, 100], [0, 100], color=picture_style.GREY, linewidth=1)
        axes.errorbar(said, won, 2.0 * error, fmt="o-", color=picture_style.BLUE)
        axes.annotate(
            "as often as it says",
            (30, 30),
            (-6, 4),
            textcoords="offset points",
            ha="right",
            size=picture_style.SMALL,
        )
        axes.set(
            xlabel="chance to win that the tactician says [%]",
            ylabel="won [%]",
            xlim=(-2, 102),
            ylim=(-2, 104),
        )
        picture_style.save(figure, file)


def _table(title, words, columns):
    """Write figures as a table: one row for each of ``words``, one column for each of ``columns``."""
    cell = lambda one: f"{one[0]:.2f} ± {one[1]:.2f}" if one else "-"  # noqa: E731
    rows = [[text, *(cell(one[name]) for one in columns.values())] for name, text in words.items()]
    return TextTable(title, ["", *columns], rows, 1, 1)


@command("agents.calibrate")
def main(argv=None):
    """Play, compare. Exit code 0."""
    p = parser_of("python -m agents.calibrate", __doc__)
    p.add_argument("file", type=Path, help="frames of professionals")
    p.add_argument("--scales", type=float, nargs="+", default=[0.9, 1.0, 1.1], help="[0.9 1.0 1.1]")
    p.add_argument("--frames", type=int, default=400, help="frames per scale [400]")
    p.add_argument("--budget", type=int, default=120, help="average simulated shots per decision [120]")
    p.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw the chances to win and the winners here"
    )
    p.add_argument("--json", type=Path, metavar="FILE", help="write every figure here")
    argv = sys.argv[1:] if argv is None else argv
    args = p.parse_args(argv)
    try:
        integer("frames", args.frames, 2, 10**6)
        integer("budget", args.budget, FrameJudge.least, 10**6)
        for scale in args.scales:
            number("scales", scale, 0.01, 10.0)
        for name in ("picture", "json"):
            writable(name, getattr(args, name))
        real = frames_of(args.file.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        p.error(str(error))
    made = provenance(shlex.join(["python", "-m", "agents.calibrate", *argv]), FIRST_SEED)
    snooker_env.warmup()
    base = LEVELS["professional"]
    played = play_frames([base.scale(scale) for scale in args.scales], args.frames, args.budget)
    names = [f"scale {scale:g}" for scale in args.scales]
    columns = {"professionals": figures_of(real)}
    for name, parts in zip(names, played, strict=True):
        columns[name] = figures_of([one for rows in parts for one in group_frames(rows)])
    tactics = dict(zip(names, map(tactics_of, played), strict=True))
    title = f"{len(real)} frames of professionals, {args.frames} simulated frames per scale"
    parts, chances = [_table(title, FIGURES, columns), _table("Tactics", TACTICS, tactics)], None
    if won := chances_of([rows for each in played for rows in each]):
        table, error, stages, tenths = won
        chances = {"groups": table.tolist(), "error": error, "stages": stages, "tenths": tenths}
        rows = [
            [words, str(strokes), str(frames), f"{100.0 * a:.1f}", f"{100.0 * b:.1f} ± {100.0 * c:.1f}"]
            for words, strokes, frames, a, b, c in stages
        ]
        said = f"Chance to win of the leader before each stroke; over groups of strokes it differs from the result by {100.0 * error:.1f} %"
        parts.append(TextTable(said, ["", "strokes", "frames", "chance, %", "won, %"], rows, 1, 1))
        if args.picture:
            draw(tenths, args.frames * len(args.scales), args.picture)
    show(parts)
    if args.json:
        report = {"figures": columns, "tactics": tactics, "chances": chances, "frames": args.frames}
        write_json(args.json, report | made)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
