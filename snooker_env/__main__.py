"""Which commands does the package have? ``python -m snooker_env NAME ...`` hands on to the ``main`` of each."""

import sys
from collections.abc import Sequence
from importlib import import_module

from ._lib.command import exit_code

COMMANDS = {
    "play": ("play.__main__", "play in the browser, against yourself or an agent, with an advisor"),
    "watch": ("watch", "watch a player's visit or frame, as a page or a film"),
    "advice": ("advice.__main__", "learn what recorded strokes say of a player"),
    "benchmark": ("benchmark.__main__", "judge an agent on named tasks"),
    "warmup": ("benchmark.warmup", "compile everything once, ahead"),
    "mcp": ("mcp.__main__", "let a language model play, by the Model Context Protocol"),
}
"""Name -> the module of its ``main``, and what one does with it."""


def _print_help() -> int:
    lines = [f"  {name:<10} {what}" for name, (_, what) in COMMANDS.items()]
    print("\n".join(["usage: python -m snooker_env NAME ...", "", *lines, "", "NAME --help says more."]))
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command that the first word names. Exit code 2: none has that name."""
    name, *words = (sys.argv[1:] if argv is None else argv) or ["--help"]
    if name in ("-h", "--help"):
        return exit_code("error", _print_help)
    if name not in COMMANDS:
        print(f"error: NAME = {name!r}: must be one of {', '.join(COMMANDS)}", file=sys.stderr)
        return 2
    return import_module(f".{COMMANDS[name][0]}", __package__).main(words)


if __name__ == "__main__":
    raise SystemExit(main())
