"""Against whom does a person play? Five opponents with a style and errors of their own, weakest first."""

from typing import NamedTuple

from .._lib.types import NoiseName


class Level(NamedTuple):
    """An opponent: the agent that plays as it, with whose errors, how it plays in a line, and its measured strength."""

    name: str
    agent: str
    noise: NoiseName
    style: str
    elo: int  # docs/play/page.md says how it was measured; the first has 1000


LEVELS = (
    Level("Pip", "ghost_ball", "beginner", "quick: plays the easiest pot at once, and often misses it", 1000),
    Level("Walter", "tactician_500", "club", "safe: leaves you little, and waits for your mistakes", 1921),
    Level("Rosa", "search_2000", "amateur", "bold: goes for every pot, and for the break", 2148),
    Level("Mia", "tactician_30", "professional", "quick: considers few strokes, but hits them well", 2587),
    Level("Vera", "tactician_500", "professional", "safe: weighs pots and safeties, and seldom errs", 2693),
)
BY_NAME = {level.name: level for level in LEVELS}
USUAL = "Walter"  # who plays against a person unless someone is named
