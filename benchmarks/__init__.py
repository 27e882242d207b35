"""Which commands measure snooker_env? Each is a file or folder: ``python -m benchmarks.NAME --help``. ``_common`` holds
shared code."""

import sys

if sys.argv[0] == "-m":  # Python is about to load a command; this reports its errors in one line as well
    from agents._lib.lifecycle import in_one_line

    sys.excepthook = in_one_line
