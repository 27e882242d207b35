"""How does a command of this project start and stop? It writes to any terminal and reports an outside cause that
stops it in one line.

This module imports only the standard library, so that it can report missing packages before they are needed.
"""

import argparse
import contextlib
import functools
import io
import os
import shutil
import sys
import threading
import traceback
from pathlib import Path

INTERRUPTED = 130
"""The exit code after Ctrl-C, as in shells."""
EXTRAS = {"scipy": "test", "pygame": "render", "ray": "cluster"}
"""Package that is not in [train] -> the extra of pyproject.toml that installs it."""
OUR_OWN = ("agents", "snooker_env", "train", "benchmarks")


def installs(extra):
    """The line that installs an extra in a clone, where the commands of this repository run."""
    return f'pip install -c constraints.txt -e ".[{extra}]"'


def python():
    """How a command to paste starts this interpreter: "python" if possible, otherwise its shortest path."""
    mine, usual = Path(sys.executable or "python"), shutil.which("python")
    if usual and mine.parent.resolve() == Path(usual).parent.resolve() and mine.samefile(usual):
        return "python"
    return str(mine.relative_to(Path.cwd()) if mine.is_relative_to(Path.cwd()) else mine)


def what_is_missing(error):
    """Describe an ``ImportError``. Raises it again if a module of this repository lacks a name."""
    if not error.name:  # its text names the missing package
        return str(error)
    package = error.name.partition(".")[0]
    if package in OUR_OWN:
        raise error
    return f"{package} is missing; in a clone of the repository:  {installs(EXTRAS.get(package, 'train'))}"


class needs:  # noqa: N801 - reads as a word: with needs("train.py"): import torch
    """Guard the imports of the command ``name``: one line for a missing package, no traceback after Ctrl-C."""

    def __init__(self, name):
        self._name = name

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace) -> None:
        if isinstance(error, ImportError):
            raise SystemExit(f"{self._name}: {what_is_missing(error)}") from None
        if isinstance(error, KeyboardInterrupt):
            raise SystemExit(INTERRUPTED) from None


def parser_of(name, doc):
    """The parser of the command ``name``, which shows its module's docstring unchanged."""
    return argparse.ArgumentParser(
        name, description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )


def any_terminal():
    """Print "?" for characters that the terminal cannot encode, instead of raising UnicodeEncodeError."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="replace")


def _of_thread(uncaught):
    """Hide a disk error of TensorBoard's writer thread; the main thread raises the same error."""
    if not isinstance(uncaught.exc_value, OSError):
        threading.__excepthook__(uncaught)


def command(name):
    """Decorate ``main(argv)`` of the command ``name``, which then ends according to ``snooker_env._lib.command.exit_code``."""

    def import_and_run(main):
        @functools.wraps(main)
        def run(argv=None):
            any_terminal()
            before, threading.excepthook = threading.excepthook, _of_thread
            try:
                from snooker_env._lib.command import exit_code  # here: its packages may be missing

                return exit_code(name, lambda: main(argv), what_is_missing)
            except ImportError as error:
                raise SystemExit(f"{name}: {what_is_missing(error)}") from None
            finally:
                threading.excepthook = before

        return run

    return import_and_run


def in_one_line(kind, error, trace):
    """``sys.excepthook`` while a command is loaded: reports Ctrl-C and a missing library in one line."""
    if isinstance(error, KeyboardInterrupt):
        print("interrupted", file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)  # Python itself would end an interrupted process with a signal
    if isinstance(error, ImportError):
        with contextlib.suppress(
            ImportError
        ):  # a mistake in a module of this repository, not a missing library
            print(what_is_missing(error), file=sys.stderr)
            return
    traceback.print_exception(kind, error, trace)
