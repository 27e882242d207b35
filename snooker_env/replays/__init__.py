"""Replays: what was played, exact at every time, as a page for any browser, as data, and as a film."""

from .document import Replay, replay
from .wrapper import RecordReplay

__all__ = ["RecordReplay", "Replay", "replay"]
