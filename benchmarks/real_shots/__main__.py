"""How close does the engine come to the paths of real balls? This compares tracked three-cushion shots, fitting only the strike.

    python -m benchmarks.real_shots FILE [--physics carom] [--fit MINUTES] [--json FILE] [--out FOLDER]

FILE holds shots in metres and seconds (``tracks.py`` describes the format). The shots behind the kept figures were
digitised at 50 Hz from one match (December 2022). github tailuge/billiards (dist/fit/trajectories.json) and
erdo100/3cushiontool publish them under the GPL; this project contains only the results.

For each shot, the speed, direction, side, top and elevation of the cue are fitted, and the time of the strike between two
samples. All shots share one set of constants, the preset "carom" (``--physics``). It was fitted to the half of the shots
with even ids (``--fit`` repeats this with the even ids of FILE); the other half is held out.

The error of a path is the distance between measured and simulated ball at each sample; for a shot, the root mean square
over its samples (and the mean). Samples that no ball can have reached are omitted (their number is printed). Contacts are
those of the cue ball with cushions, and the first with each ball. The order is right if the first four contacts are the
same in the same order; two within 0.03 s may swap.
"""

import dataclasses
from pathlib import Path

import numpy as np

from agents._lib import provenance
from agents._lib.tables import text_table
from snooker_env.physics.parameters import PRESETS, Physics

from .._common.command import Command, run, save_figures
from . import constants, tracks, verdict
from .paths import Judge
from .picture import draw
from .strikes import fit

FILE = "real_shots.png"
USED, HELD_OUT = "used for the constants", "held out"


def part(number):
    """The half that a shot belongs to. The preset's constants come from the even ids of a file without the ids 2, 5, 8, ..."""
    return USED if number % 2 == 0 and number % 3 != 2 else HELD_OUT


def main(argv=None):
    """Command line."""
    parser = Command("real_shots", __doc__, pictures=(FILE,), seed=0)
    parser.add_argument("file", type=Path, metavar="FILE", help="JSON file of tracked shots")
    parser.add_argument(
        "--physics", default="carom", choices=sorted(PRESETS), help="constants of all shots [carom]"
    )
    parser.add_argument(
        "--fit", type=float, metavar="MINUTES", help="first fit the constants for this many minutes"
    )
    options = parser.options(argv)
    try:
        shots = tracks.read(options.file)
    except ValueError as error:
        parser.error(str(error))
    save_figures(options, measure(options, shots))


def constants_of(options):
    """The shared constants: those of the preset, with this table's ball and without tables to compile."""
    ball = {"R": tracks.R, "M": 0.2125}
    return dataclasses.replace(Physics.preset(options.physics), **ball, tables=False)


def measure(options, shots):
    """Measure and print everything. Returns the figures."""
    print(provenance.line(options.made))
    physics = constants_of(options)
    if options.fit:
        used = [s for s in shots if part(s.id) == USED]
        physics, _ = constants.fit_real_shots(physics, used, options.fit, options.seed)
        print(
            f"\nfitted on {len(used)} shots: "
            + ", ".join(f"{k} {getattr(physics, k):.4g}" for k in constants.SEARCHED)
        )
    print(
        f"{len(shots)} shots of {options.file.name}, physics {'newly fitted' if options.fit else repr(options.physics)}"
    )
    found, judges, strikes = [], [], []
    for shot in shots:
        judges.append(judge := Judge(shot, physics))
        strikes.append(strike := fit(judge, options.seed)[0])
        found.append({"part": part(shot.id)} | verdict.judge_shot(judge, strike))
    figures = {
        "physics": options.physics,
        "constants": {k: getattr(physics, k) for k in ("R", *constants.SEARCHED)},
        "shots": found,
        "medians": {name: verdict.medians(rows) for name, rows in parts(found).items()},
    }
    say(figures)
    if options.pictures:
        draw(options.made | figures, judges, strikes, options.folder / FILE)
    return figures


def parts(found):
    """The shots of each half, and all shots."""
    halves = {name: [s for s in found if s["part"] == name] for name in (USED, HELD_OUT)}
    return {"all": found} | {name: rows for name, rows in halves.items() if rows}


def say(figures):
    """Print the medians, the order of contacts, and the runs across the table."""
    head = ["shots", "", "whole shot", "90 %", "mean", "first 3 s", "other balls", "order of contacts"]
    rows = []
    for name, m in figures["medians"].items():
        cells = [
            f"{100 * m[k]:.1f}" for k in ("cue_rms", "cue_rms_90", "cue_mean", "cue_rms_3s", "balls_rms")
        ]
        rows.append([name, str(m["shots"]), *cells, f"{m['order']:.0%}"])
    print(
        "\nError of the cue ball's path [cm], medians over shots (rms over a shot's samples; mean: of the distances)"
    )
    print("\n".join(text_table(head, rows)))
    wild = sum(sum(s["wild"]) for s in figures["shots"])
    print(
        f"wild samples left out: {wild}; published for all 182 shots (tailuge's billiards, rms, same samples): 22.3, 90 % 43"
    )
    runs = [run for s in figures["shots"] for run in s["across"]]
    for n, word in ((2, "twice"), (3, "three times or more")):
        errors = [run[3] for run in runs if (run[2] == 2 if n == 2 else run[2] >= 3)]
        if errors:
            print(
                f"{len(errors)} runs {word} across (from a cushion to the opposite one and back, nothing between): while it lasts the cue"
                f" ball is {100 * np.median(errors):.1f} cm off (median)"
            )


if __name__ == "__main__":
    run(main)
