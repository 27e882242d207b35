"""How is it said in one line that a command was stopped, also while it is still being loaded?

Only the standard library is imported here: what fails while other libraries are loaded is said as well.
"""

import os
import sys
import traceback

from commands.lifecycle import what_is_missing

STOPPED = 130
"""Exit code after Ctrl-C, as shells have it."""
WRITTEN = []
"""The files that have been written so far."""


def in_one_line(kind, error, trace):
    """``sys.excepthook`` while a command is loaded."""
    if isinstance(error, KeyboardInterrupt | ImportError):
        code = explained(error)
        sys.stderr.flush()
        os._exit(code)  # Python itself would end an interrupted process by a signal
    traceback.print_exception(kind, error, trace)


def explained(error):
    """Say in one line what stopped the command; its exit code."""
    if isinstance(error, KeyboardInterrupt):
        so_far = f"written: {', '.join(map(str, WRITTEN))}" if WRITTEN else "no file was written"
        print(
            f"\nstopped by Ctrl-C: what is printed so far stands, the rest was not measured; {so_far}",
            file=sys.stderr,
        )
        return STOPPED
    try:
        print(what_is_missing(error), file=sys.stderr)
    except ImportError:  # a mistake in a module of this repository
        traceback.print_exception(error)
    return 1
