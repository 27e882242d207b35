"""What does ``python -m benchmarks.scene`` run? The command in ``command.py``."""

from .._common.command import run
from .command import main

run(main)
