"""Is the chance of each pot that is advised its share in the environment, played again and again?"""

from typing import NamedTuple

import gymnasium
import numpy as np
import pytest
from cases import ENDGAME, IN_HAND, OPEN

import snooker_env as sn
from snooker_env.planning import Position

TRIES = 2000
APART = 0.04
"""How far the two shares may be apart: 2.5 standard errors of their difference where each pot is as likely as not."""
END, SIDE = 1.7582, 0.8627  # frozen to a cushion
BEHIND = {"brown": (-0.03, -0.27), "blue": (0.035, -0.265)}  # in the way of the cue, from (0, -0.2)


class Case(NamedTuple):
    """Where advice is asked, with whose errors, which cue, with ``scores`` in a frame; ``words``: what some pots are said
    to be."""

    position: Position
    noise: str
    cue: str = "free"
    scores: tuple[int, int] | None = None
    words: str = ""


def at(cue, *reds, **others):
    return Position(cue=cue, reds=reds, black=(0.0, 1.4605), on="red", **others)


CASES = {
    "open": Case(OPEN, "professional"),
    "endgame": Case(ENDGAME, "amateur"),
    "in_hand": Case(IN_HAND, "club"),
    "long": Case(at((-0.3, -1.2), (0.35, 1.1), (-0.5, 0.9)), "professional", "real"),
    "middle": Case(at((-0.45, -0.5), (0.5, 0.1)), "amateur"),
    "thin": Case(at((-0.1, 0.9), (0.6, 1.2)), "club"),
    "near": Case(at((0.5, 1.2), (0.72, 1.55)), "beginner"),
    "plant": Case(at((0.1, 0.6), (0.62, 1.44), (0.584, 1.4)), "professional", words="by a plant"),
    "over_the_rail": Case(
        at((-0.2, -END), (-0.4, -1.0), (0.3, -0.9)), "amateur", "real", words="over the rail"
    ),
    "over_a_ball": Case(
        at((0.0, -0.2), (0.2, 0.35), (-0.3, 0.4), **BEHIND), "club", "real", words="over the brown"
    ),
    "frame": Case(OPEN, "club", "real", (20, 24)),
    "frame_near": Case(at((0.45, 1.1), (0.7, 1.5), (-0.4, 0.6)), "beginner", "real", (50, 40)),
    "frame_side": Case(
        at((SIDE, 0.9), (0.75, 1.5), (-0.4, 0.6)), "amateur", "real", (8, 16), "over the rail"
    ),
    "frame_in_hand": Case(IN_HAND, "professional", "real", (0, 4)),
}


def share_of(case, one, seed):
    """The share of fair strokes of the environment that put the ball of a suggestion into its pocket."""
    task = {} if case.scores is None else {"task": "frame", "opponent": "random"}
    how = {"aim": "absolute", "elevation": True, "placement": True, "noise": case.noise, "cue": case.cue}
    env = gymnasium.make("Snooker-v0", **how, **task, disable_env_checker=True).unwrapped
    env.keep_history, made = True, 0
    env.reset(seed=seed)
    for _ in range(TRIES):
        env.reset(options={"position": case.position})
        (action,) = one.stroke.strokes().actions(env.options, sn.Positions.of(env))
        env.step(action.astype(np.float32))
        played = env.history[0]
        made += played.shot.potted[one.ball] == one.pocket and not played.fouls
    return made / TRIES


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_chance_of_each_pot_is_its_share_in_the_environment(name):
    case, seed = CASES[name], 100 * list(CASES).index(name)
    how = {"noise": case.noise, "options": {"cue": case.cue}, "scores": case.scores}
    advice = sn.advise(case.position, n=3, samples=TRIES, visits=0, seed=seed, **how)
    pots = [one for one in advice if one.kind == "pot"]
    assert any(case.words in one.words for one in pots)
    for k, one in enumerate(pots):
        share = share_of(case, one, seed + k + 1)
        assert abs(share - one.chance) <= APART, (one.words, share)
