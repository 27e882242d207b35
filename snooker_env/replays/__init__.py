"""Replays: what was played, exact at every time, as a page for any browser, as data, and as a film.

>>> import snooker_env as sn
>>> shot = sn.simulate([(0.0, -1.0), (0.0, 0.5)], [(0.0, 3.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
>>> film = sn.replay(shot, title="full ball")
>>> film.to_dict()["strokes"][0]["n"]
2
"""

from .document import Replay, replay
from .wrapper import RecordReplay

__all__ = ["RecordReplay", "Replay", "replay"]
