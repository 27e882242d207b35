"""From which commit do figures come?"""

import subprocess
from pathlib import Path


def commit():
    """The checkout's commit, with "-dirty" if files are changed; None where there is no git."""
    git = ["git", "-C", str(Path(__file__).resolve().parent), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        return subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
