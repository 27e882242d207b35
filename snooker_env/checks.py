"""How does code outside the package report bad input? By the same checks."""

from ._lib.check import choice, integer, number, refuse, refuse_what
from .physics.impact.contact import parse_fidelity

__all__ = ["choice", "integer", "number", "parse_fidelity", "refuse", "refuse_what"]
