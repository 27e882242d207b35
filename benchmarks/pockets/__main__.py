"""How wide is each pocket's window, and how large are its openings?

    python -m benchmarks.pockets [--json FILE] [--out FOLDER]

One ball, physics "match". The window is the full width of the paths into the pocket, 0.3 m away and at an angle off its
axis, that drop; * where it is in pieces: a firm ball that just touches a jaw may rattle out between paths that drop.
"rolling": the ball rolls at the start; "struck": it starts without spin, as an object ball leaves an impact. Speeds are
those at the start. A ball that comes out again has missed. ``game/pots.py`` offers pots by these windows.
"""

from typing import Literal

import numpy as np

import snooker_env as sn
from agents._lib.tables import text_table

from .._common.command import Command, run, save_figures
from . import openings
from .windows import CORNER, MIDDLE, Paths, alone, windows

SPEEDS, DISTANCE = (0.5, 1.0, 2.0, 4.0, 6.0, 9.0), 0.3
PLACES: dict[tuple[Literal["match", "tight"], str], tuple[int, tuple[int, ...]]] = {
    ("match", "corner"): (CORNER, (0, 20, 40)),
    ("match", "middle"): (MIDDLE, (0, 30, 45, 60)),
    ("tight", "corner"): (CORNER, (0, 20, 40)),
}
"""Table and pocket -> its index and the angles [degrees]; the middle pockets of both tables are the same."""
WIDTHS = {
    "mouth": "mouth",
    "across the fall's middle": "at the fall",
    "where the fall meets the jaws": "fall to jaw",
    "throat": "throat",
}


def print_openings(physics):
    """The openings [mm] of each pocket; the figures."""
    found = {}
    for (table, pocket), (index, _) in PLACES.items():
        here = alone(sn.Table.preset(table), index)
        sizes = {name: 1e3 * width for name, width in openings.openings(here).items()}
        found[f"{table} {pocket}"] = sizes | {
            "untouched to either side": 1e3 * openings.clean(here, physics.R)
        }
    print("Openings [mm]; untouched: offsets from the axis, along it, at which a ball meets no jaw")
    columns = {**WIDTHS, "untouched": "untouched to either side"}
    cells = lambda sizes: ["-" if np.isnan(sizes[key]) else f"{sizes[key]:.2f}" for key in columns.values()]  # noqa: E731
    print("\n".join(text_table(["", *columns], [[name, *cells(sizes)] for name, sizes in found.items()])))
    print(f"  {openings.PUBLISHED}")
    return found


def print_windows(physics):
    """The windows [mm] of each pocket; the figures."""
    found = []
    for (table, pocket), (index, angles) in PLACES.items():
        rows = []
        for ball, rolling in (("rolling", True), ("struck", False)):
            paths = Paths(np.radians(angles)[:, None], DISTANCE, np.array(SPEEDS), rolling, False)
            each = windows(alone(sn.Table.preset(table), index), paths, physics)
            for angle, width, pieces in zip(angles, 1e3 * each.width, each.pieces, strict=True):
                cells = [f"{w:.1f}{'*' * int(n > 1)}" for w, n in zip(width, pieces, strict=True)]
                rows.append([ball, f"{angle} deg", *cells])
                where = {"table": table, "pocket": pocket, "ball": ball, "angle": angle}
                found.append(where | {"widths": width.tolist(), "pieces": pieces.tolist()})
        print(f"\n{pocket} pocket, table {table!r}: window [mm]")
        print("\n".join(text_table(["ball", "off the axis", *(f"{v:g} m/s" for v in SPEEDS)], rows, 2)))
    return found


def main():
    """Command line."""
    options = Command("pockets", __doc__).options()
    physics = sn.Physics.preset("match")
    found = {"openings": print_openings(physics), "speeds": SPEEDS, "windows": print_windows(physics)}
    save_figures(options, found)


if __name__ == "__main__":
    run(main)
