"""Commands that measure snooker_env: ``python -m benchmarks.NAME --help``. Files whose names begin with ``_`` are parts of them."""

import sys

if sys.argv[0] == "-m":  # Python is about to load a command: what fails in that is said in one line as well
    from ._common.command import in_one_line

    sys.excepthook = in_one_line
