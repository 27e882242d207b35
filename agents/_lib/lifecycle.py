"""How does a command of this project start and stop? It writes to any terminal, and an outside cause that
stops it is reported in one line.

Only the standard library is imported here: missing packages are reported before they are needed.
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
"""The exit code after Ctrl-C, as shells have it."""
EXTRAS = {"matplotlib": "test", "scipy": "test", "pygame": "render", "ray": "cluster"}
"""The extra of pyproject.toml that brings a package which is not in [train]."""
OUR_OWN = ("agents", "snooker_env", "train", "benchmarks")


def installs(extra):
    """The line that installs an extra: a command of this repository runs in a clone."""
    return f'pip install -e ".[{extra}]"'


def python():
    """How a command to paste starts this interpreter: "python" if that is it, else its path, as short as may be."""
    mine, usual = Path(sys.executable or "python"), shutil.which("python")
    if usual and mine.parent.resolve() == Path(usual).parent.resolve() and mine.samefile(usual):
        return "python"
    return str(mine.relative_to(Path.cwd()) if mine.is_relative_to(Path.cwd()) else mine)


def what_is_missing(error):
    """An ``ImportError`` in words. Raised again if a module of this repository lacks a name."""
    if not error.name:  # its text names what is missing
        return str(error)
    package = error.name.partition(".")[0]
    if package in OUR_OWN:
        raise error
    return f"{package} is missing; in a clone of the repository:  {installs(EXTRAS.get(package, 'train'))}"


class needs:  # noqa: N801 - reads as a word: with needs("train.py"): import torch
    """Around the imports of the command ``name``: one line if a package is missing, no traceback after
    Ctrl-C."""

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
    """The parser of the command ``name``, with its module's docstring as it stands."""
    return argparse.ArgumentParser(
        name, description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )


def any_terminal():
    """Print characters that the terminal cannot encode as "?" in place of a UnicodeEncodeError."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="replace")


def _of_thread(uncaught):
    """Hide a disk error of TensorBoard's writer thread: the main thread raises the same error again."""
    if not isinstance(uncaught.exc_value, OSError):
        threading.__excepthook__(uncaught)


def command(name):
    """A decorator for ``main(argv)`` of the command ``name``: it ends as ``snooker_env._lib.command.exit_code`` says."""

    def import_and_run(main):
        @functools.wraps(main)
        def run(argv=None):
            any_terminal()
            before, threading.excepthook = threading.excepthook, _of_thread
            try:
                from snooker_env._lib.command import exit_code  # here: what it needs may be missing

                return exit_code(name, lambda: main(argv), what_is_missing)
            except ImportError as error:
                raise SystemExit(f"{name}: {what_is_missing(error)}") from None
            finally:
                threading.excepthook = before

        return run

    return import_and_run


def in_one_line(kind, error, trace):
    """``sys.excepthook`` while a command is loaded: Ctrl-C and a missing library are one line."""
    if isinstance(error, KeyboardInterrupt):
        print("interrupted", file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)  # Python itself would end an interrupted process by a signal
    if isinstance(error, ImportError):
        with contextlib.suppress(
            ImportError
        ):  # a mistake in a module of this repository: no library is missing
            print(what_is_missing(error), file=sys.stderr)
            return
    traceback.print_exception(kind, error, trace)
