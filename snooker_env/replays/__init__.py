"""Replays: what was played, exact at every time, as a page for any browser, as data, and as a film."""

from .document import Replay, replay

__all__ = ["Replay", "replay"]
