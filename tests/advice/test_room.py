"""Does advice say how the cue finds room, and what is in its way?"""

from dataclasses import replace
from math import degrees, pi
from typing import Any

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.advice.practice import room_for
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.geometry import HALF_WIDTH
from snooker_env.planning import Positions

FROZEN = sn.Position(cue=(HALF_WIDTH - R, 0.6), reds=[(0.0, 0.6), (-0.4, 1.2)], black=(0.0, 1.4605))
"""On the right cushion; the first red lies square across the table."""
BEHIND = sn.Position(cue=(0.0, 0.0), reds=[(-0.5, 0.0)], black=(0.0, 1.4605), blue=(2.2 * R, 0.0))
"""The blue is behind the cue ball when it is played to the red."""
ACROSS = CueStroke(speed=2.0, aim=pi)
REAL = sn.Options(cue="real").rules


def room(position, rules=REAL, **change: Any):
    return room_for(replace(ACROSS, **change).numbers(), Positions.of(position), rules)


def test_what_is_in_the_way_is_named():
    rail, ball, open_ = room(FROZEN), room(BEHIND), room(sn.Position(cue=(-0.65, 0.0), black=(0.0, 1.4605)))
    assert (rail.over, rail.raised, rail.moved, rail.unplayable) == ("rail", True, False, False)
    assert rail.behind == pytest.approx(R) and 30 < degrees(rail.elevation) < 36
    assert rail.words == f"cue raised to {degrees(rail.elevation):.0f} degrees over the rail"
    assert ball.over == "blue" and ball.behind == pytest.approx(2.2 * R) and "over the blue" in ball.words
    assert (open_.over, open_.raised, open_.words) == (None, False, "")
    assert room(FROZEN, sn.Options().rules) == replace(
        rail, elevation=0.0, raised=False, over=None, behind=0.0
    )


def test_a_tip_that_the_cue_does_not_reach_is_moved_and_a_stroke_without_room_is_said():
    screw = room(FROZEN, top=-0.4)
    assert (
        screw.moved and screw.raised and not screw.unplayable and -0.4 < screw.top < 0.0 and screw.side == 0.0
    )
    assert degrees(screw.elevation) == pytest.approx(45.0, abs=1e-6)
    assert f"tip moved to {-screw.top:.2f} below the middle" in screw.words and "over the rail" in screw.words
    jaws = Positions.of(FROZEN)
    jaws.positions[0, 0] = 0.885, 1.7712  # the rail of the right cushion runs on behind the pocket
    none = room_for(replace(ACROSS, aim=1.583).numbers(), jaws, REAL)
    assert none.unplayable and degrees(none.elevation) > 80
    assert none.words == "no room for the cue over the rail: nobody can play it, raised to 86 degrees"


def test_the_room_said_is_the_room_played():
    """Of the environment, for strokes with side too, whose cue points aside."""
    rng, env = (
        np.random.default_rng(0),
        sn.SnookerEnv(cue="real", elevation=True, aim="absolute", noise="none"),
    )
    env.keep_history, seen = True, 0
    for _ in range(40):
        numbers = {
            "side": rng.uniform(-0.35, 0.35),
            "top": rng.uniform(-0.35, 0.35),
            "aim": rng.uniform(-pi, pi),
        }
        stroke = CueStroke(speed=1.0, **numbers)
        env.reset(seed=1, options={"position": FROZEN})
        env.step(stroke.strokes().actions(env.options, Positions.of(env))[0])
        cue, said = env.history[-1].cue, room(FROZEN, **numbers)
        assert (said.elevation, said.side, said.top) == pytest.approx(
            (cue["elevation"], cue["side"], cue["top"]), abs=1e-5
        )
        assert env.history[-1].room == tuple(n for n in ("raised", "moved", "unplayable") if getattr(said, n))
        seen += said.raised
    assert seen > 10
