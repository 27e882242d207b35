"""Does ``snooker_env`` judge whole frames as the rules say? Plays frames of each kind and checks every stroke
against an oracle.

    python -m tests.oracles.frame_oracle [--frames 2000] [--kind NAME ...] [--seed 0] [--out FILE] [--mutants]
    python -m tests.oracles.frame_oracle --table FILE

Prints, for each kind, the strokes, the disagreements (there must be none), the decisions that rounding
decides, and how often each rule was met, so that one sees what was left untested. ``--mutants`` puts errors
into the rules one at a time and prints after how many strokes each is seen. ``--out`` adds a line of JSON for
each kind to a file; ``--table`` sums such a file up as a table in Markdown. The oracle is
``frame_oracle_rules`` and ``frame_oracle_geometry``: written from the rules, not from ``snooker_env.game``.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

from .frame_oracle_kinds import KINDS
from .frame_oracle_mutants import mutants, strokes_to_see
from .frame_oracle_opponent import OpponentChecker
from .frame_oracle_play import Case, Checker
from .frame_oracle_tables import with_free_ball


def check(name: str, frames: int, seed: int) -> Checker:
    """Play and check frames of one kind."""
    kind = KINDS[name]
    checker = (OpponentChecker if "opponent" in kind.options else Checker)(kind)
    for k in range(frames):
        checker.frame(seed + k)
    return checker


def report(name: str, checker: Checker, seconds: float) -> None:
    """Print what was compared and exercised."""
    tally = checker.tally
    print(
        f"{name}: {tally.frames} frames, {tally.strokes} strokes, {len(tally.disagreements)} disagreements, {seconds:.0f} s"
    )
    print(f"  rounding decides: {dict(tally.undecidable) or 'nothing'}")
    print("  " + ", ".join(f"{what} {many}" for what, many in sorted(tally.seen.items())))
    kinds = Counter((what, *names) for what, names, *_ in tally.disagreements)
    for names, many in kinds.most_common():
        print(f"  DISAGREE {many} times: {', '.join(names)}")
    sys.stdout.flush()


def line(name: str, checker: Checker, seconds: float, seed: int) -> dict:
    """The figures of one run."""
    tally = checker.tally
    return {
        "kind": name,
        "seed": seed,
        "frames": tally.frames,
        "strokes": tally.strokes,
        "seconds": round(seconds, 1),
        "rounding": dict(tally.undecidable),
        "exercised": dict(sorted(tally.seen.items())),
        "disagreements": [
            [what, *names, f"seed {data[0]}"] for what, names, _, _, data in tally.disagreements
        ],
    }


COLUMNS = {
    "fouls": lambda what: what.startswith("foul: "),
    "free balls": lambda what: what == "free ball given",
    "misses": lambda what: what in ("miss", "miss, part of a ball visible"),
    "replaced": lambda what: what == "replaced",
    "third misses": lambda what: what == "third miss",
    "re-spotted blacks": lambda what: what == "black re-spotted",
    "from the D": lambda what: what == "stroke from the D",
}
"""Columns of the table, each the sum of some of what was exercised."""


def table(lines: list[dict]) -> str:
    """The runs of a file in one table, the runs of a kind added up."""
    heads = ["kind", "frames", "strokes", "disagreements", "rounding decides", *COLUMNS]
    rows = ["| " + " | ".join(heads) + " |", "|" + "|".join(["---", *["--:"] * (len(heads) - 1)]) + "|"]
    for kind in dict.fromkeys(one["kind"] for one in lines):
        mine = [one for one in lines if one["kind"] == kind]
        seen: Counter = Counter()
        for one in mine:
            seen.update(one["exercised"])
        sums = [sum(one[name] for one in mine) for name in ("frames", "strokes")]
        sums += [
            sum(len(one["disagreements"]) for one in mine),
            sum(sum(one["rounding"].values()) for one in mine),
        ]
        sums += [sum(many for what, many in seen.items() if counts(what)) for counts in COLUMNS.values()]
        rows.append(f"| {kind} | " + " | ".join(f"{many:,}" for many in sums) + " |")
    return "\n".join(rows)


def recorded(frames: int, tables: int, seed: int = 0) -> list[Case]:
    """Strokes of whole frames and of random tables, to look for errors in."""
    cases = []
    for name, many in (("clear_path", frames), ("tables", tables), ("tables_nominate", tables)):
        checker = Checker(KINDS[name], record=True)
        for k in range(many):
            checker.frame(seed + k)
        cases += checker.cases
    checker = Checker(KINDS["tables_nominate"], record=True)
    for k in range(tables):
        checker.frame(seed + k, begin=with_free_ball)
    return cases + checker.cases


def main(arguments: list[str] | None = None) -> int:
    """Run the command; the number of disagreements, at most 1, is its exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=2000, help="of each kind")
    parser.add_argument("--kind", action="append", choices=[*KINDS], help="one or more; default all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="file to which the figures are added")
    parser.add_argument("--table", type=Path, help="sum up such a file, and play nothing")
    parser.add_argument("--mutants", action="store_true", help="are errors in the rules seen?")
    given = parser.parse_args(arguments)
    if given.table:
        print(table([json.loads(text) for text in given.table.read_text(encoding="utf-8").splitlines()]))
        return 0
    if given.mutants:
        cases = recorded(given.frames, 15 * given.frames, given.seed)
        seen = {name: strokes_to_see(name, cases) for name in mutants()}
        for name, many in seen.items():
            print(f"{name}: " + ("NOT SEEN" if many is None else f"seen after {many} strokes"))
        return int(None in seen.values())
    wrong = 0
    for name in given.kind or KINDS:
        start = time.perf_counter()
        checker = check(name, given.frames, given.seed)
        seconds = time.perf_counter() - start
        report(name, checker, seconds)
        if given.out:
            with given.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line(name, checker, seconds, given.seed)) + "\n")
        wrong += len(checker.tally.disagreements)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
