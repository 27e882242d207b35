"""Does ``snooker_env`` judge whole frames as the rules say? Plays frames of each kind and checks every stroke against an oracle.

    python -m tests.oracles.frame_oracle [--frames 2000] [--kind NAME ...] [--seed 0] [--mutants]

Prints, for each kind, the strokes, the disagreements (there must be none), the decisions that rounding decides, and how often each
rule was met, so that one sees what was left untested. ``--mutants`` puts errors into the rules one at a time and prints after how many
strokes each is
seen. The oracle is ``frame_oracle_rules`` and ``frame_oracle_geometry``: written from the rules, not from ``snooker_env.game``.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from .frame_oracle_kinds import KINDS
from .frame_oracle_mutants import mutants, strokes_to_see
from .frame_oracle_opponent import OpponentChecker
from .frame_oracle_play import Case, Checker


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
    print(f"{name}: {tally.frames} frames, {tally.strokes} strokes, {len(tally.disagreements)} disagreements, {seconds:.0f} s")
    print(f"  rounding decides: {dict(tally.undecidable) or 'nothing'}")
    print("  " + ", ".join(f"{what} {many}" for what, many in sorted(tally.seen.items())))
    kinds = Counter((what, *names) for what, names, *_ in tally.disagreements)
    for names, many in kinds.most_common():
        print(f"  DISAGREE {many} times: {', '.join(names)}")
    sys.stdout.flush()


def recorded(frames: int, tables: int, seed: int = 0) -> list[Case]:
    """Strokes of whole frames and of random tables, to look for errors in."""
    cases = []
    for name, many in (("clear_path", frames), ("tables", tables), ("tables_nominate", tables)):
        checker = Checker(KINDS[name], record=True)
        for k in range(many):
            checker.frame(seed + k)
        cases += checker.cases
    return cases


def main(arguments: list[str] | None = None) -> int:
    """Run the command; the number of disagreements, at most 1, is its exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=2000, help="of each kind")
    parser.add_argument("--kind", action="append", choices=[*KINDS], help="one or more; default all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--mutants", action="store_true", help="are errors in the rules seen?")
    given = parser.parse_args(arguments)
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
        report(name, checker, time.perf_counter() - start)
        wrong += len(checker.tally.disagreements)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
