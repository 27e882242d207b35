"""What does ``python -m benchmarks.real_shots`` run? The command in ``command.py``."""

from .._common.command import run
from .command import main

run(main)
