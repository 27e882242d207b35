"""Which shots and replays do the tests of the browser show?"""

import base64

import numpy as np

import snooker_env as sn
from snooker_env.game import layout
from snooker_env.replays.encode import pack

MATCH = sn.Physics.preset("match")


def hit(r, here, speed, aim, side=0.0, top=0.0, elevation=0.0, table="match", physics=MATCH):
    """The shot of a cue that strikes ball 0."""
    v, w = sn.strike(speed, aim, side, top, elevation, physics)
    velocities, spins = np.zeros((len(r), 2)), np.zeros((len(r), 3))
    velocities[0], spins[0] = v[:2], w
    return sn.simulate(r, velocities, spins, table, physics, on_table=here)


def break_off():
    """A hard break-off: all reds move."""
    r, here = layout("break_off", np.random.default_rng(3))
    r[0] = 0.2, -1.2
    return hit(r, here, 8.0, np.arctan2(0.885 + 1.2, -0.21), 0.0, 0.1)


def visit():
    """A replay of three strokes by two players, the black re-spotted after the second."""
    shots = [break_off()]
    for aim in (2.0, -1.0):
        shots.append(hit(shots[-1].positions, shots[-1].on_table, 3.0, aim, 0.2, -0.3, 0.1))
    data = sn.replay(shots, title="A visit of tests").to_dict()
    places, on = shots[1].positions.copy(), shots[1].on_table.copy()
    places[[0, 21]], on[[0, 21]] = [(0.1, -1.2), (0.0, 1.4605)], True
    rows = [(0, 1, [2], "red", [1, 0], 1), (0, 7, [21], "black", [8, 0], 8), (1, 0, [], "red", [8, 0], 0)]
    for k, (player, points, pots, on_words, score, run) in enumerate(rows):
        aim, speed = (1.67, 2.0, -1.0)[k], 8.0 if k == 0 else 3.0
        cue = {"speed": speed, "side": 0.2, "top": -0.3, "aim": aim, "elevation": 0.2}
        judged = {"player": player, "points": points, "pots": pots, "ball_on": on_words, "score": score}
        words = f"The referee's words after stroke {k + 1}."
        data["strokes"][k] |= judged | {"break": run, "words": words, "cue": cue}
    data["strokes"][1]["after"] = {"places": pack(places, "f8"), "on_table": np.flatnonzero(on).tolist()}
    long = "Someone with a name that is much too long for its place in the bar"
    data["players"] = ["Ada <b>Lovelace</b>", long]
    return data, shots, places


def page_of(data):
    """The page of a replay that is given as data."""
    film = sn.replay(break_off(), title=data["title"])
    film.to_dict = lambda: data
    return film.html()


def doubles(text):
    """The numbers in base64."""
    return np.frombuffer(base64.b64decode(text), "<f8")
