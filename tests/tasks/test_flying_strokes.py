"""What does the referee say of balls that fly? Jump shots and balls forced off the table, by strokes that are played."""

import math
from typing import Any

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.game.balls import SPOTS, VALUES
from snooker_env.game.fouls import Foul
from snooker_env.physics.flight import OVER
from snooker_env.tasks.box_actions import MAX_SPEED, MIN_SPEED

FLYING = {"preset": "match", "flight": True}
R = sn.Physics().R


def environment(**options):
    return kept(**{"aim": "absolute", "physics": FLYING, "elevation": 70, **options})


def kept(**options):
    """An environment that keeps its strokes."""
    env: Any = gymnasium.make("Snooker-v0", **options).unwrapped
    env.keep_history = True
    return env


def action(speed, aim, elevation, side=0.0, top=0.0):
    """A stroke; aim [rad], elevation [deg]."""
    turn = math.remainder(aim / math.pi, 2.0)
    share = 2 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1
    return np.array([share, 2 * side, 2 * top, turn, elevation / 35 - 1], np.float32)


def played(env, position, stroke):
    """The stroke as it was played, and the fouls."""
    env.reset(seed=0, options={"position": position})
    _, _, _, _, info = env.step(stroke)
    return env.history[-1], Foul(int(info["fouls"])), info


def judged_jump(shot):
    """Whether a stroke is a jump shot by the words of the rule, from places at many times."""
    met = shot.events[(shot.events["kind"] == EventKind.BALL_BALL) & (shot.events["i"] == 0)]
    until = float(met["time"][0]) if len(met) else shot.duration
    first = int(met["j"][0]) if len(met) else -1
    others = [k for k in range(1, len(shot.positions)) if shot.on_table[k] | (shot.potted[k] != -1)]
    own = shot.events[((shot.events["i"] == 0) | (shot.events["j"] == 0))]
    # the flight in which it meets a ball may begin over that one
    last = float(own["time"][own["time"] < until].max(initial=0.0))
    times = np.append(np.arange(0.0, until, 1e-4), until)
    places = shot.at(times)[0]
    cue, rest = places[:, 0], places[0, others, :2]
    flat = np.hypot(*(cue[:, None, :2] - rest).transpose(2, 0, 1))
    flying = cue[:, 2] > 0.0
    counts = (times < last)[:, None] | (np.array(others) != first)
    if (flying[:, None] & counts & (flat < 2 * R - OVER)).any():
        return True
    if first < 0:
        return False
    r, before = shot.at(until)[0], shot.at(until - 1e-9)[1][0, :2]
    if r[0, 2] <= 0.0 or np.hypot(*(r[0] - r[first])[:2]) >= 2 * R - OVER:
        return False
    own = shot.events[((shot.events["i"] == 0) | (shot.events["j"] == 0)) & (shot.events["time"] > until)]
    down = shot.at(float(own["time"][0]))[0]
    return bool((down[0] - down[first])[:2] @ before > 0.0)


def test_jump_shots_are_those_of_the_rule():
    env, rng, found = environment(noise="none"), np.random.default_rng(2), {True: 0, False: 0}
    for _ in range(60):
        reds = [(rng.uniform(-0.02, 0.02), 0.3), (rng.uniform(-0.05, 0.05), rng.uniform(0.5, 0.9))]
        position = sn.Position(cue=(0.0, -0.1), reds=reds, black=(0.5, 1.3), on="red")
        stroke = action(rng.uniform(2, 6.5), math.pi / 2 + rng.normal(0, 0.03), rng.uniform(5, 65))
        one, fouls, _ = played(env, position, stroke)
        says = judged_jump(one.shot)
        assert bool(fouls & Foul.JUMP) == says, (reds, stroke)
        found[says] += 1
    assert min(found.values()) > 10


def test_the_cue_ball_forced_off_the_table_is_a_foul_and_in_hand():
    env = environment(noise="none", task="frame", opponent="ghost_ball", miss="off")
    position = sn.Position(cue=(0, 1.2), reds=[(0.4, 0.0)], black=(-0.4, -0.3), on="red")
    env.reset(seed=0, options={"position": position})
    env.step(action(7.0, math.pi / 2, 30))
    one = env.history[0]
    assert one.shot.potted[0] == -2 and Foul(one.fouls) & Foul.CUE_OFF and one.penalty == 4
    assert EventKind.OFF in one.shot.events["kind"]
    # it stands in the D for the other
    assert not one.on_table[0] or np.hypot(*(one.positions[0] - SPOTS[0])) < 0.3


@pytest.mark.parametrize(("ball", "returns"), [("red", False), ("black", True)])
def test_an_object_ball_forced_off_the_table_is_a_foul_and_only_colours_return(ball, returns):
    """Back spin throws the object ball up as it throws the cue ball down; dirty balls rub enough for the rail."""
    dirty = FLYING | {"mu_bb": 0.15}
    env, number = environment(noise="none", physics=dirty), 1 if ball == "red" else 21
    place = (0.3, 1.2)
    others = {"reds": [(0.5, 0.0)], "black": place} if returns else {"reds": [place], "black": (0.5, 0.0)}
    position = sn.Position(cue=(0.3, 0.9), on="red", **others)
    one, fouls, info = played(env, position, action(6.0, math.pi / 2, 0.0, top=-0.45))
    assert one.shot.potted[number] == -2
    assert fouls & Foul.BALL_OFF and info["penalty"] == max(4, VALUES[number])
    assert one.on_table[number] == returns
    if returns:
        np.testing.assert_allclose(one.positions[21], SPOTS[21])


def test_how_far_a_cue_may_be_raised_is_an_option():
    for steep, raised in ((True, 30.0), (50, 50.0), (70.0, 70.0)):
        env = kept(elevation=steep, noise="none")
        env.reset(seed=0)
        env.step(np.array([0.0, 0.0, 0.0, 0.0, 1.0], np.float32))
        assert math.degrees(env.history[-1].cue["elevation"]) == pytest.approx(raised)
