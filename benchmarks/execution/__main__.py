"""What does ``python -m benchmarks.execution`` run? The command in ``command.py``."""

from .._common.command import run
from .command import main

run(main)
