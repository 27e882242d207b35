"""Who says so when Ray ends this process? It does that when its node dies, without a word: a small process beside it has the word."""

import subprocess
import sys

_CODE = """
import sys
sys.stdin.buffer.read() or print(sys.argv[1], file=sys.stderr, flush=True)
"""


class Witness:
    """A process that prints a line on stderr if this one ends before ``done`` was called.

    Parameters
    ----------
    line : str
        What it prints.
    """

    def __init__(self, line):
        command = [sys.executable, "-S", "-E", "-c", _CODE, line]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)

    def done(self):
        """All is well: it ends without a word."""
        if self._process.stdin is not None and not self._process.stdin.closed:
            try:
                self._process.communicate(b"done", timeout=10)
            except (OSError, subprocess.TimeoutExpired):
                self._process.kill()
                self._process.wait()
