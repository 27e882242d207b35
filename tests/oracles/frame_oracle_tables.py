"""From which tables does the oracle see what whole frames show seldom? Random tables with touching balls,
taken spots and level scores."""

from __future__ import annotations

import numpy as np

from . import frame_oracle_geometry as geometry

POCKETS = np.array([(a * 0.88, b * 1.775) for a in (-1, 1) for b in (-1, 1)] + [(0.885, 0.0), (-0.885, 0.0)])


def table(state: dict, rng: np.random.Generator) -> dict:
    """A state of ``get_state`` changed to a random table, in the middle of a frame."""
    reds, first = _balls(rng)
    on_table = np.zeros(22, bool)
    on_table[[0, *rng.choice(np.arange(1, 16), reds, replace=False), *range(first, 22)]] = True
    positions = np.array(state["positions"], float)
    placed: list[np.ndarray] = []
    crowd = POCKETS[rng.integers(6)] * 0.96 if rng.random() < 0.4 else None
    for i in rng.permutation(np.flatnonzero(on_table)):
        positions[i] = _place(int(i), placed, crowd, rng)
        placed.append(positions[i])
    in_hand = bool(rng.random() < 0.15)
    if in_hand:
        wish = rng.uniform([-0.14, geometry.BAULK - 0.25], [0.14, geometry.BAULK])
        positions[0] = geometry.nearest_in_d(wish, positions[np.flatnonzero(on_table)[1:]])
    ball_on = 1 if reds else first - 14
    if first == 16 and rng.random() < 0.3:
        ball_on = 0
    left = 8 * reds + sum(range(first - 14, 8))
    lead = int(rng.choice([0, 7, -7, left, -left, left - 7, 4 - left, rng.integers(-60, 61)]))
    low = int(rng.integers(0, 50))
    scores = [low + max(lead, 0), low + max(-lead, 0)]
    frame = dict(state["frame"])
    frame |= {
        "scores": scores,
        "striker": int(rng.integers(2)),
        "break_points": 1 if ball_on == 0 else 0,
        "ball_on": ball_on,
        "in_hand": in_hand,
        "free_ball": bool(ball_on != 0 and first < 21 and rng.random() < 0.3),
        "respotted_black": False,
        "on_table": int(sum(1 << int(i) for i in np.flatnonzero(on_table) if i)),
        "rack": 0x3FFFFE,
    }
    if ball_on == 0:
        frame["scores"][frame["striker"]] += 1
    return state | {"positions": positions.tolist(), "on_table": on_table.tolist(), "frame": frame}


def caged(state: dict, rng: np.random.Generator) -> dict:
    """Two reds, and the cue ball in a ring of colours, through which it often cannot get."""
    positions, on_table = np.array(state["positions"], float), np.zeros(22, bool)
    positions[0], on_table[0], many = rng.uniform((-0.7, -1.5), (0.7, 1.5)), True, int(rng.integers(4, 7))
    far, turn = rng.uniform(1.004 * geometry.D2, 1.43 * geometry.D2), rng.uniform(0, 2 * np.pi)
    for k in range(many):
        angle = turn + 2 * np.pi * k / many
        positions[16 + k] = positions[0] + far * np.array([np.cos(angle), np.sin(angle)])
        on_table[16 + k] = True
    for red in (1, 2):
        positions[red] = _place(red, list(positions[on_table]), None, rng)
        on_table[red] = True
    frame = {"on_table": int(sum(1 << int(i) for i in np.flatnonzero(on_table) if i)), "ball_on": 1}
    frame |= {"in_hand": False, "scores": [0, 0]}
    return state | {
        "positions": positions.tolist(),
        "on_table": on_table.tolist(),
        "frame": state["frame"] | frame,
    }


def with_free_ball(state: dict, rng: np.random.Generator) -> dict:
    """The colours with a free ball; two of them hang before one pocket: the ball on and another go down now
    and then, alone or together."""
    state = table(state, rng)
    positions, pocket = np.array(state["positions"], float), POCKETS[rng.integers(4)]
    on_table = np.zeros(22, bool)
    on_table[[0, *range(16, 22)]] = True
    while True:
        positions[16:] = list(geometry.SPOTS.values())
        positions[[16, 17]] = pocket * 0.975 + rng.normal(0, 0.03, (2, 2))
        positions[0] = pocket * 0.7 + rng.normal(0, 0.05, 2)
        here, inside = positions[on_table], np.abs(positions[on_table]) < (0.8627, 1.758)
        apart = np.hypot(*(here[:, None] - here).transpose(2, 0, 1)) + np.eye(len(here))
        if inside.all() and apart.min() > geometry.D2 + 1.5e-6:
            break
    frame = state["frame"] | {
        "ball_on": 2,
        "free_ball": True,
        "in_hand": False,
        "break_points": 0,
        "on_table": int(sum(1 << int(i) for i in np.flatnonzero(on_table) if i)),
    }
    return state | {"positions": positions.tolist(), "on_table": on_table.tolist(), "frame": frame}


def _balls(rng):
    """How many reds, and the lowest colour."""
    if rng.random() < 0.6:
        return int(rng.integers(1, 9)), 16
    return 0, int(rng.choice([16, 17, 18, 19, 20, 20, 21, 21]))


def _place(i, placed, crowd, rng):
    tries = 0
    while True:
        tries += 1
        kind = rng.random()
        if crowd is not None and (i == 0 or i > 15) and tries < 20:
            kind = 0.9
        if kind < 0.25:
            at = POCKETS[rng.integers(6)] * rng.uniform(0.93, 0.985)
        elif kind < 0.5:
            at = np.array(list(geometry.SPOTS.values())[rng.integers(6)]) + rng.normal(0, 0.02, 2)
        elif kind < 0.8 and placed:  # beside another ball, as near as balls come to rest, or in its shadow
            turn = rng.uniform(0, 2 * np.pi)
            gap = rng.choice([2e-6, 20e-6, 45e-6, 80e-6, 1e-3, 0.03])
            at = placed[rng.integers(len(placed))] + (geometry.D2 + gap) * np.array(
                [np.cos(turn), np.sin(turn)]
            )
        elif crowd is not None and tries < 20:  # many before one pocket: several go down in one stroke
            at = crowd * (0.75 if i == 0 else 1.0) + rng.normal(0, 0.05, 2)
        else:
            at = rng.uniform([-0.86, -1.75], [0.86, 1.75])
        inside = abs(at[0]) < 0.8627 and abs(at[1]) < 1.758
        if inside and all(np.hypot(*(at - other)) > geometry.D2 + 1.5e-6 for other in placed):
            return at
