"""How does a simulated shot become the data of a replay? By hand from its log, so that the browser is tested against the format itself."""

import base64

import numpy as np

from snooker_env.physics import cloth
from snooker_env.render.scene import scene_data

_F8 = [cloth.T0, cloth.X, cloth.Y, cloth.VX, cloth.VY, cloth.AX, cloth.AY]
_F4 = [cloth.WX, cloth.WY, cloth.WZ]
_U1 = [cloth.SEGMENT_BALL, cloth.SEGMENT_STATE]


def packed(values, kind):
    """Base64 of numbers, little-endian."""
    return base64.b64encode(np.ascontiguousarray(values, kind).tobytes()).decode()


def stroke_of(shot, start, on_table=None, **words):
    """One stroke of a replay: ``shot`` from the places ``start`` (n, 2)."""
    n = len(start)
    here = np.ones(n, bool) if on_table is None else np.asarray(on_table)
    rows = shot.segments
    still = (rows[:, cloth.T0] == 0.0) & (rows[:, cloth.SEGMENT_STATE] <= cloth.REST) & (rows[:, cloth.WZ] == 0.0)
    rows = rows[~still]
    said = {"cue": None, "player": None, "ball_on": None, "points": 0, "penalty": 0, "fouls": [], "words": "", "score": [], "break": 0}
    return said | {
        "n": n,
        "start": packed(start, "<f8"),
        "on_table": np.flatnonzero(here).tolist(),
        "paths": {"count": len(rows), "f8": packed(rows[:, _F8], "<f8"), "f4": packed(rows[:, _F4], "<f4"), "u1": packed(rows[:, _U1], "u1")},
        "events": [[float(t), int(kind), int(i), int(j)] for t, kind, i, j in shot.events.tolist()],
        "duration": shot.duration,
        "pots": np.flatnonzero(shot.potted >= 0).tolist(),
        "after": None,
    } | words  # fmt: skip


def replay_of(strokes, table="match", physics=None, players=(), title="test"):
    """A whole replay; ``physics``: the ``Physics`` of all its shots."""
    return {
        "format": "snooker-replay", "version": 1, "title": title, "players": list(players), "scene": scene_data(table),
        "R": physics.R, "spin_decel": physics.spin_decel, "strokes": strokes,
    }  # fmt: skip
