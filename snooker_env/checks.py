"""How does code outside the package report bad input? By the same checks.

>>> from snooker_env.checks import integer
>>> integer("visits", 0, 1, 100)
Traceback (most recent call last):
...
ValueError: visits = 0: must be an integer in [1, 100]
"""

from ._check import choice, integer, number, refuse, refuse_what, truth
from .physics.impact.contact import parse_fidelity

__all__ = ["choice", "integer", "number", "parse_fidelity", "refuse", "refuse_what", "truth"]
