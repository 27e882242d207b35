"""On which positions do the tests of advice ask?"""

import numpy as np

import snooker_env as sn
from snooker_env.advice.practice import one_position, practice_of
from snooker_env.players import Ranked, Strokes
from snooker_env.players.cue_stroke import cue_strokes

REDS = [(0.3, 0.5), (-0.3, 0.7), (0.1, 1.0)]
OPEN = sn.Position(cue=(0.25, -0.4), reds=REDS, blue=(0.0, 0.0), pink=(0.2, 0.1), black=(0.0, 1.4605))
"""Reds to pot."""
ENDGAME = sn.Position(cue=(0.0, 0.3), blue=(0.3, -0.2), pink=(0.4, 0.9), black=(0.0, 1.4605), on="blue")
BAULK = {"yellow": (0.292, -1.0475), "brown": (0.0, -1.0475)}
IN_HAND = sn.Position(in_hand=True, reds=[(0.0, 0.3), (0.5, 1.0)], **BAULK, black=(0.0, 1.4605))
RESPOTTED = sn.Position(in_hand=True, black=(0.0, 1.4605))
WALL = {"green": (0.0, -1.4), "brown": (0.06, -1.42), "yellow": (-0.06, -1.42)}
SNOOKERED = sn.Position(cue=(0.0, -1.6), reds=[(0.0, 1.6)], **WALL, black=(0.1, 1.2))
"""No straight path to the red."""
HIDDEN = sn.Position(cue=(0.3, -0.5), reds=[(0.0, 1.74), (0.06, 1.74)], pink=(0.0, 0.89), black=(0.0, 1.4605))
"""Reds that straight lines reach, and none of them can be potted."""
ALL = {"open": OPEN, "endgame": ENDGAME, "in_hand": IN_HAND, "respotted": RESPOTTED}
ALL |= {"snookered": SNOOKERED, "hidden": HIDDEN}


def stroke_of(player, position, *, noise="professional", seed=0):
    """The one stroke that a player would play in a position."""
    at = one_position(position)
    practice = practice_of(noise, None, position, of_frames=at.of_frames)
    return cue_strokes(sn.player(player).at(practice.options).play(at, [seed]), at)[0]


class Given:
    """A player who ranks these strokes, in this order."""

    name = "given"

    def __init__(self, *strokes):
        self.strokes = strokes

    def at(self, rules):
        return self

    def rank(self, positions, seeds):
        places = [(np.nan, np.nan) if stroke.place is None else stroke.place for stroke in self.strokes]
        values = np.stack([stroke.numbers() for stroke in self.strokes])
        return [Ranked(Strokes(values, np.array(places)), None)]

    def play(self, positions, seeds):
        return self.rank(positions, seeds)[0].strokes[:1]


def state_of(position, **options):
    """A state of ``SnookerEnv`` with the balls of a position."""
    env = sn.SnookerEnv(**options)
    env.reset(seed=1)
    places, on_table, game = position.arrays()
    state = env.get_state() | {"positions": places.tolist(), "on_table": on_table.tolist()}
    return state | {"ball_on": int(game[0]), "in_hand": bool(game[1]), "points": 0, "over": False}


def played(position, stroke, tables, **options):
    """A stroke on so many tables of the environment, each with errors of its own."""
    env = sn.SnookerVectorEnv(tables, aim="absolute", elevation=True, placement=True, **options)
    env.reset(seed=99, options={"state": state_of(position, aim="absolute", elevation=True, placement=True)})
    actions = stroke.strokes().actions(env.options, sn.Positions.of(env)[:1])
    _, _, _, _, info = env.step(np.repeat(actions, tables, 0))
    return info["points"], info["foul"], env.get_state()
