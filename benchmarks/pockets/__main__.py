"""How wide is each pocket's window? Against speed, angle and distance; down the rails; with other jaws and
edges; beside pool's.

    python -m benchmarks.pockets [--quick] [--json FILE] [--out FOLDER]

One ball, physics "match". The window is the whole range of paths into the pocket aimed at, as an angle of the
path (turned about the start) and as its shift sideways; * where it is in pieces: a firm ball that just
touches a jaw may rattle out between paths that drop. "rolling": the ball rolls at the start; "struck": it
starts without spin, as an object ball leaves an impact, and rolls only if it is soft or comes from far.
Speeds are those at the start, distances those to the aim point (where the fall meets the pocket's axis). A
ball that comes out again has missed. "before": the ball drops at once where its centre crosses the edge, as
it did up to version 0.1; the first run compiles a copy of the package for that (``_common/variants.py``).
"""

from typing import Literal

import numpy as np

import snooker_env as sn
from commands.tables import text_table

from .._common import variants
from .._common.command import Command, run, save_json
from . import openings, picture, pool_tables, rail_paths
from .windows import CORNER, MIDDLE, Engine, Paths, alone, windows

SPEEDS, DISTANCES = (0.5, 1.0, 2.0, 4.0, 6.0, 9.0), (0.3, 1.0, 1.7)
"""1.7 m: the farthest that a path straight into a middle pocket has room for."""
QUICK_SPEEDS, QUICK_DISTANCES = (0.5, 1.0, 6.0), (0.3, 1.0)
ANGLES = {"corner": (0, 20, 40), "middle": (0, 30, 45, 60)}
INDEX = {"corner": CORNER, "middle": MIDDLE}
PLACES: tuple[tuple[Literal["match", "tight"], str], ...] = (
    ("match", "corner"),
    ("match", "middle"),
    ("tight", "corner"),
)
"""The middle pockets of both tables are the same."""
BALLS, MEASURES = ("rolling", "struck"), {"mm": 1e3, "deg": float(np.degrees(1.0))}
CLEAN_SPEEDS = (0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0)
FILE = "pockets.png"


def shown(x):
    """A number of a cell; "-" where no ball arrives."""
    return "-" if np.isnan(x) else f"{x:.2f}" if x < 10 else f"{x:.1f}"


def all_windows(physics, engines, speeds, distances):
    """Rows of windows in the order of printing; arrays over speeds."""
    rows = []
    for table, pocket in PLACES:
        here = alone(sn.Table.preset(table), INDEX[pocket])
        angles = ANGLES[pocket]
        a, d, v, rolling, turned = np.meshgrid(
            np.radians(angles), distances, speeds, (True, False), (False, True), indexing="ij"
        )
        found = {
            rule: windows(here, Paths(a, d, v, rolling, turned), physics, engine)
            for rule, engine in engines.items()
        }
        for m, (measure, scale) in enumerate(MEASURES.items()):
            for i, angle in enumerate(angles):
                for j, distance in enumerate(distances):
                    for b, ball in enumerate(BALLS):
                        at = (i, j, slice(None), b, m)
                        row = {
                            "table": table,
                            "pocket": pocket,
                            "measure": measure,
                            "angle": angle,
                            "distance": distance,
                            "ball": ball,
                        }
                        for rule, w in found.items():
                            row[rule] = scale * w.width[at]
                            row[f"centre {rule}"], row[f"pieces {rule}"] = scale * w.centre[at], w.pieces[at]
                            row[f"held {rule}"] = w.held[at]
                        rows.append(row)
    return rows


def print_windows(rows, speeds):
    """One table for each pocket and measure."""
    last = None
    for row in rows:
        head = row["table"], row["pocket"], row["measure"]
        if head != last:
            print(
                f"\n{row['pocket']} pocket, table {row['table']!r}: window [{row['measure']}], in brackets before"
            )
            print("  angle  from     ball   " + "".join(f"{s:9g} m/s   " for s in speeds))
            last = head
        cells = ""
        for k in range(len(speeds)):
            mark = "*" if row["pieces after"][k] > 1 else "h" if row["held after"][k] else " "
            before = f"({shown(row['before'][k])})"
            cells += f"{shown(row['after'][k]):>7s}{mark}{before:<8s}"
        print(f"  {row['angle']:4d}   {row['distance']:3.1f} m  {row['ball']:8s}{cells}")
    after, before = (
        sum(int((row[f"pieces {rule}"] > 1).sum()) for row in rows) for rule in ("after", "before")
    )
    print(
        f"\n  *: in pieces ({after} of {sum(len(r['after']) for r in rows)} windows, before {before}); the width is that of all pieces."
    )
    print("  -: the ball stops short.  h: the window ends where the ball would start in the cushion.")


def rail(physics, engines, quick):
    """Down the rail: marks and ranges of angles."""
    offs, runs = rail_paths.OFF, rail_paths.RUNS[:1] if quick else rail_paths.RUNS
    speeds = (1.0, 6.0) if quick else rail_paths.SPEEDS
    marks = []
    for table in ("match", "tight"):
        preset = sn.Table.preset(table)
        found = {
            rule: rail_paths.down_the_rail(preset, physics, e, offs, runs, speeds)
            for rule, e in engines.items()
        }
        for b, ball in enumerate(BALLS):
            for r, length in enumerate(runs):
                for o, off in enumerate(offs):
                    at, f = (o, r, slice(None), b), found["after"]
                    marks.append(
                        {
                            "table": table,
                            "ball": ball,
                            "run": length,
                            "off": off,
                            "arrives": f["arrives"][at],
                            "after": f["potted"][at],
                            "before": found["before"]["potted"][at],
                            "low": np.degrees(f["low"][at]),
                            "high": np.degrees(f["high"][at]),
                            "low before": np.degrees(found["before"]["low"][at]),
                            "high before": np.degrees(found["before"]["high"][at]),
                        }
                    )
    return {"offs": offs, "runs": runs, "speeds": speeds, "marks": marks}


def print_rail(found):
    """The marks, then the ranges of the rolling ball."""
    print("\nDown the rail, parallel to it: o drops, x does not, - stops short; in brackets before")
    head, drops, widest = (
        ["table", "ball", "from", "off the cushion", *(f"{s:g} m/s" for s in found["speeds"])],
        [],
        [],
    )
    for m in found["marks"]:
        where = [
            m["table"],
            m["ball"],
            f"{m['run']:.1f} m",
            "frozen" if m["off"] == 0 else f"{1e3 * m['off']:.0f} mm",
        ]
        each = zip(m["after"], m["before"], m["arrives"], strict=True)
        drops.append(
            [*where, *(f"{'xo'[int(a)]} ({'xo'[int(b)]})" if arrives else "-" for a, b, arrives in each)]
        )
        if m["ball"] == "rolling":
            ranges = zip(m["low"], m["high"], strict=True)
            widest.append([*where, *(f"{a:+.2f}..{b:+.2f}" if a == a else "-" for a, b in ranges)])
    print("\n".join(text_table(head, drops, 2)))
    print("widest range of angles that drops [deg], + towards the rail; rolling")
    print("\n".join(text_table(head, widest, 2)))


def sizes(physics, engines, quick):
    """Openings and what passes them untouched."""
    found, speeds = {}, CLEAN_SPEEDS[::3] if quick else CLEAN_SPEEDS
    for table, pocket in PLACES:
        here = alone(sn.Table.preset(table), INDEX[pocket])
        entry: dict[str, object] = {name: 1e3 * x for name, x in openings.openings(here).items()}
        entry["clean"] = 1e3 * openings.clean(here, physics.R)
        for rule, engine in engines.items():
            entry[f"untouched {rule}"] = 1e3 * openings.untouched(here, speeds, True, physics, engine)
            entry[f"all drop {rule}"] = openings.all_clean_drop(here, speeds, physics, engine)
        found[f"{table} {pocket}"] = entry
    return {"speeds": speeds, "pockets": found}


def print_sizes(found):
    """Beside what is published."""
    print("\nOpenings [mm] from the tables' arrays")
    columns = {
        "mouth": "mouth",
        "across the fall's middle": "at the fall",
        "where the fall meets the jaws": "fall to jaw",
        "throat": "throat",
    }
    rows = [
        [name, *("-" if np.isnan(p[key]) else f"{p[key]:.2f}" for key in columns.values())]
        for name, p in found["pockets"].items()
    ]
    print("\n".join(text_table(["", *columns], rows)))
    print(f"  {openings.PUBLISHED}")
    print("\nClean opening: offsets from the axis, along it, at which no jaw is touched")
    for name, p in found["pockets"].items():
        low, high = p["untouched after"].min(), p["untouched after"].max()
        yes = "all drop" if p["all drop after"] else "NOT ALL DROP"
        before = p["untouched before"].min()
        print(
            f"  {name:14s}  throat less ball: +-{p['clean']:.2f} mm, {yes} at {found['speeds'][0]:g} to {found['speeds'][-1]:g} m/s;"
            f" no jaw in the log up to +-{low:.2f} (firm) .. {high:.2f} (soft), before +-{before:.2f}"
        )


def variants_of(physics):
    """Variants of jaws and slate: name -> how it is played, (physics, table's changes)."""
    fixed = {"the preset": (physics, {})}
    for e in (0.85, 0.72):  # the second is a rail's at 6 m/s
        fixed[f"jaws e_j {e}"] = (sn.Physics.preset("match", e_j=e), {})
    for way, what in ((0.005, "out"), (-0.005, "in")):
        fixed[f"slate's edge 5 mm further {what}"] = (physics, {"fall": way})
    for way, what in ((0.002, "wider"), (-0.002, "narrower")):
        fixed[f"throat 2 mm {what}"] = (physics, {"throat": way})
    return fixed


def sensitivity(physics, engine):
    """Lateral windows [mm] of a rolling ball from 0.3 m, at 1 and 6 m/s, by variant and pocket."""
    found = {}
    for name, (constants, change) in variants_of(physics).items():
        table = openings.moved(sn.Table.preset("match"), **change)
        found[name] = {}
        for pocket, index in INDEX.items():
            angles = np.radians(ANGLES[pocket])[:, None]
            w = windows(
                alone(table, index), Paths(angles, 0.3, np.array([1.0, 6.0]), True, False), constants, engine
            )
            found[name] |= {f"{pocket} {a}": 1e3 * w.width[k] for k, a in enumerate(ANGLES[pocket])}
    return found


def print_sensitivity(found):
    """One line a variant."""
    print("\nOther jaws, another edge (table 'match'): window [mm], rolling, at 1 / 6 m/s from 0.3 m")
    rows = [[name, *(f"{a:.1f} / {b:.1f}" for a, b in row.values())] for name, row in found.items()]
    print("\n".join(text_table(["", *found["the preset"]], rows)))


def print_pool(found):
    """Target sizes beside Alciatore's, and where they differ."""
    print(
        "\nPool: effective target size [in], in brackets [mm]; the last rows: physics 'match', rolling ball"
    )
    for kind, targets in found.items():
        rows = []
        for name, sizes in targets.items():
            speed = pool_tables.SPEEDS.get(name.split()[0])
            rows.append(
                [
                    name if speed is None else f"{name}, {speed:g} m/s",
                    *(f"{s:.3f} ({25.4 * s:.1f})" for s in sizes),
                ]
            )
        print(
            "\n".join(
                text_table(
                    [f"{kind} pocket, off the axis", *(f"{a} deg" for a in pool_tables.ANGLES[kind])], rows
                )
            )
        )


def says(figures):
    """What follows."""
    at, speeds = figures["sizes"]["pockets"], list(figures["speeds"])
    lines = [
        f"Between the noses at the fall a corner of 'match' is {at['match corner']['at the fall']:.1f} mm wide (published: 3 1/2 in,"
        f" 88.9), one of 'tight' {at['tight corner']['at the fall']:.1f}; a middle pocket {at['match middle']['fall to jaw']:.1f} where its"
        " fall meets the jaws."
    ]
    soft, firm = speeds.index(1.0), speeds.index(6.0)
    for table, pocket in PLACES:
        rows = [
            r
            for r in figures["windows"]
            if (r["table"], r["pocket"], r["ball"], r["measure"]) == (table, pocket, "rolling", "mm")
        ]
        rows = [r for r in rows if r["distance"] == 0.3]
        parts = [
            f"{r['angle']} deg {r['after'][soft]:.1f} -> {r['after'][firm]:.1f} mm ({r['before'][soft]:.1f} -> {r['before'][firm]:.1f})"
            for r in rows
        ]
        lines.append(
            f"From 1 to 6 m/s the window of the {pocket} pocket of {table!r} goes (before in brackets): {', '.join(parts)}."
        )
    frozen = [
        m for m in figures["rail"]["marks"] if m["off"] == 0 and m["ball"] == "rolling" and m["run"] == 0.5
    ]
    for m in frozen:
        drops = [f"{v:g}" for v, yes in zip(figures["rail"]["speeds"], m["after"], strict=True) if yes]
        before = [f"{v:g}" for v, yes in zip(figures["rail"]["speeds"], m["before"], strict=True) if yes]
        lines.append(
            f"Frozen to the rail of {m['table']!r}, 0.5 m away, a rolling ball drops at {', '.join(drops) or 'no'} m/s (before:"
            f" {', '.join(before) or 'no'})."
        )
    return lines + pool_tables.says(figures["pool"])


def main():
    """Command line."""
    parser = Command("pockets", __doc__, pictures=(FILE,), redraws=True)
    parser.add_argument("--quick", action="store_true", help="fewer speeds and distances, for a test")
    options = parser.options()
    figures = measure(options) if options.figures is None else options.figures
    if options.pictures:
        picture.draw(figures, options.folder / FILE)
        print(f"\n{options.folder / FILE}")


def measure(options):
    """Measure and print everything; the figures."""
    physics = sn.Physics.preset("match")
    engines = {"before": Engine(variants.load()._run, variants.AT_ONCE), "after": Engine()}
    speeds, distances = (QUICK_SPEEDS, QUICK_DISTANCES) if options.quick else (SPEEDS, DISTANCES)
    figures = {"speeds": speeds, "sizes": sizes(physics, engines, options.quick)}
    print_sizes(figures["sizes"])
    figures["windows"] = all_windows(physics, engines, speeds, distances)
    print_windows(figures["windows"], speeds)
    figures["rail"] = rail(physics, engines, options.quick)
    print_rail(figures["rail"])
    figures["sensitivity"] = sensitivity(physics, engines["after"])
    print_sensitivity(figures["sensitivity"])
    pool = {kind: pool_tables.sizes(kind, engines) for kind in pool_tables.ANGLES}
    figures["pool"] = {
        kind: {name: s / pool_tables.INCH for name, s in rows.items()} for kind, rows in pool.items()
    }
    print_pool(figures["pool"])
    lines = says(figures)
    print("\nWhat follows")
    for line in lines:
        print(f"* {line}")
    figures = plain(figures | {"says": lines})
    save_json(options.json, figures)
    return figures


def plain(x):
    """For JSON: arrays as lists, None for what is not a number."""
    if isinstance(x, dict):
        return {k: plain(v) for k, v in x.items()}
    if isinstance(x, np.ndarray | list | tuple):
        return [plain(v) for v in x]
    x = x.item() if isinstance(x, np.generic) else x
    return None if isinstance(x, float) and np.isnan(x) else x


if __name__ == "__main__":
    run(main)
