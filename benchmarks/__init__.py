"""Commands that measure snooker_env, a file or a folder each: ``python -m benchmarks.NAME --help``.
``_common`` holds what they share."""

import sys

if sys.argv[0] == "-m":  # Python is about to load a command: what fails in that is said in one line as well
    from agents._lib.lifecycle import in_one_line

    sys.excepthook = in_one_line
