"""How is a stroke encoded for a browser? As the closed forms of its phases of motion (docs/play/replay.md).

Motion has 64 bits, so that the browser computes the places of ``Shot.at``; spins, which are only displayed, 32."""

import base64
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._lib.check import refuse_what
from ..game.balls import N_BALLS
from ..physics import cloth
from ..physics.parameters import PRESETS, Physics
from ..physics.table import Table
from ..simulation import Shot
from ..tasks.noise import LEVELS, Noise
from ..tasks.played import Played
from .chances import frame_before, start_of
from .referee_words import foul_words, on_words, pots_of, sentence

_PLACES = [cloth.T0, cloth.X, cloth.Y, cloth.VX, cloth.VY, cloth.AX, cloth.AY]
_HEIGHTS = [cloth.Z, cloth.UZ]
_SPINS = [cloth.WX, cloth.WY, cloth.WZ]
_EVENT = ["time", "kind", "i", "j"]
_WHICH = [cloth.SEGMENT_BALL, cloth.SEGMENT_STATE]


def pack(values: ArrayLike, kind: str) -> str:
    """Numbers as base64 of little-endian ``kind``: "f8", "f4" or "u1", row after row."""
    little = np.ascontiguousarray(values, np.dtype(kind).newbyteorder("<"))
    return base64.b64encode(little.tobytes()).decode("ascii")


def encode_shot(shot: Shot) -> dict[str, Any]:
    """The motion of a shot, up to "pots". ValueError if it has no path, or more balls than snooker."""
    n = len(shot.positions)
    if n > N_BALLS:
        raise refuse_what("shot", f"{n} balls", f"must have at most {N_BALLS}: their colours are snooker's")
    if not len(shot.segments):
        allowed = "must be of sn.simulate, or of an environment with keep_history = True"
        raise refuse_what("shot", "a Shot without its path", allowed)
    (places, here), states = start_of(shot), shot.segments[:, cloth.SEGMENT_STATE]
    idle = (states == cloth.REST) | (states == cloth.GONE)
    # at rest from the start: its place is in ``start``
    waits = (np.arange(len(states)) < n) & idle & (shot.segments[:, cloth.WZ] == 0.0)
    moves = shot.segments[~waits]
    flies = bool((states == cloth.AIR).any())
    heights = {"height": pack(moves[:, _HEIGHTS], "f8"), "g": shot.physics.g} if flies else {}
    return {
        "n": n,
        "start": pack(places, "f8"),
        "on_table": np.flatnonzero(here).tolist(),
        "paths": {
            "count": len(moves),
            "f8": pack(moves[:, _PLACES], "f8"),
            "f4": pack(moves[:, _SPINS], "f4"),
            "u1": pack(moves[:, _WHICH], "u1"),
            **heights,
        },
        "events": [[round(float(t), 9), *map(int, what)] for t, *what in shot.events[_EVENT].tolist()],
        "duration": shot.duration,
        "pots": pots_of(shot),
    }


def encode_stroke(item: Shot | Played, players: tuple[str, ...]) -> dict[str, Any]:
    """One stroke of a replay. For a bare ``Shot``, the parts that come from the referee are empty."""
    if isinstance(item, Shot):
        nothing = ("cue", "cue_kind", "noise", "player", "ball_on", "after", "frames", "meant")
        empty = dict.fromkeys(nothing)
        none = {"points": 0, "penalty": 0, "fouls": [], "words": "", "score": [], "break": 0}
        return encode_shot(item) | empty | none
    same = {name: getattr(item, name) for name in ("cue", "cue_kind", "player", "points", "penalty")}
    here, after = item.on_table, None  # the table before the next stroke, where it is another than at rest
    rest = item.shot.positions[here], item.shot.on_table
    if not all(map(np.array_equal, (item.positions[here], here), rest)):
        after = {"places": pack(item.positions, "f8"), "on_table": np.flatnonzero(here).tolist()}
    return encode_shot(item.shot) | {
        **same,
        "noise": noise_data(item.noise),
        "ball_on": "free ball" if item.free_ball else on_words(item.ball_on),
        "fouls": foul_words(item.fouls),
        "words": sentence(item, players),
        "score": list(item.scores),
        "break": item.break_points,
        "after": after,
        "frames": item.frame and [frame_before(item, item.frame).to_dict(), item.frame.to_dict()],
        "meant": item.meant,
    }


def noise_data(noise: Noise) -> str | dict[str, float]:
    """Execution errors as JSON types, which ``Noise.of`` reads: the name of a level, or the fields that are not the defaults."""
    level = next((name for name, one in LEVELS.items() if one == noise), None)
    return level or {name: value for name, value in asdict(noise).items() if value != getattr(Noise(), name)}


def physics_data(physics: Physics) -> str | dict[str, Any]:
    """Constants as JSON types, which ``Physics.of`` reads: the name of a preset, or the nearest one and what differs."""
    own, changes = asdict(physics), {}
    for name in PRESETS:
        usual = asdict(Physics(**PRESETS[name]))
        changes[name] = {key: value for key, value in own.items() if value != usual[key]}
    nearest = min(changes, key=lambda name: len(changes[name]))
    return {"preset": nearest, **changes[nearest]} if changes[nearest] else nearest


def table_data(table: Table) -> str | dict[str, Any]:
    """A table as JSON types, which ``table_from`` reads: the name of a preset, or its parts."""
    if table.is_preset:
        return table.name
    parts: dict[str, Any] = {name: getattr(table, name).tolist() for name in ("noses", "jaws", "falls")}
    return {"name": table.name, **parts, "ball_radius": table.ball_radius, "pockets": list(table.pockets)}


def table_from(data: str | Mapping[str, Any]) -> Table:
    if isinstance(data, str):
        return Table.preset(data)  # type: ignore[arg-type]
    columns = {"noses": 5, "jaws": 6, "falls": 3}
    parts = {name: np.array(data[name], np.float64).reshape(-1, n) for name, n in columns.items()}
    return Table(data["name"], **parts, ball_radius=data["ball_radius"], pockets=tuple(data["pockets"]))
