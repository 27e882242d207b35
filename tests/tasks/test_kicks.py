"""Is a kick a bad contact of the cue ball, as often as asked, and nothing else?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.physics.columns import CONSTANTS
from snooker_env.planning import Planner
from snooker_env.tasks.noise import KICK
from tests.tables import begun

CUT = {"position": sn.Position(cue=(0.0, 0.0), black=(0.03, 0.6))}
ACTION = np.array(
    [-0.4, 0.0, -0.4, 0.5]
)  # a stun shot straight up the table: the black at a cut of 35 degrees


def throw(noise, physics="paper", seed=1):
    """The direction of the black after the contact [rad], and the shot."""
    env = sn.SnookerEnv(noise=noise, physics=physics, fidelity="reference")
    env.keep_history = True
    env.reset(seed=seed, options=CUT)
    env.step(ACTION)
    shot = env.last_shot
    t = float(shot.events["time"][shot.events["kind"] == sn.EventKind.BALL_BALL][0])
    moved = shot.at(t + 1e-4)[0][21] - shot.at(t)[0][21]
    return np.arctan2(moved[1], moved[0]), shot


def test_a_kick_is_a_larger_friction_of_the_first_contact():
    usual, kicked = throw("none")[0], throw({"kick": 1.0})[0]
    rough = throw("none", {"mu_bb": KICK})[0]
    assert abs(kicked - rough) < 1e-9 and np.degrees(kicked - usual) > 1.5


def test_without_kicks_nothing_is_drawn_and_with_few_it_depends_on_the_seed():
    assert (throw("none")[1].positions == throw({"kick": 0.0})[1].positions).all()
    env = begun(sn.SnookerEnv(noise={"kick": 0.0}))
    before = env.get_state()["stream"]
    env.step(np.zeros(4))
    assert env.get_state()["stream"] == before
    many = sn.SnookerVectorEnv(400, noise={"kick": 0.1}, threads=1)
    many.reset(seed=1, options=CUT)
    where = many.step(np.tile(ACTION, (400, 1)))[0][:, 105]
    usual = sn.SnookerEnv()
    usual.reset(seed=1, options=CUT)
    share = (where != usual.step(ACTION)[0][105]).mean()
    assert 0.05 < share < 0.15  # 0.1 with a standard error of 0.015


def test_only_the_first_contact_is_bad():
    # the black goes on to meet the pink: friction of that impact stays
    position = sn.Position(cue=(0.0, 0.0), black=(0.03, 0.6), pink=(0.144, 0.764), on="pink")
    ends = []
    for noise, physics in (({"kick": 1.0}, {"mu_bb": 0.05}), ("none", {"mu_bb": KICK})):
        env = sn.SnookerEnv(noise=noise, physics=physics)
        env.reset(seed=1, options={"position": position})
        env.step(ACTION)
        ends.append(env.last_shot)
    kinds = [shot.events[shot.events["kind"] == sn.EventKind.BALL_BALL] for shot in ends]
    assert len(kinds[0]) > 1 and kinds[0]["time"][0] == kinds[1]["time"][0]
    assert np.abs(ends[0].positions - ends[1].positions).max() > 1e-4


def test_planners_meet_the_kicks_of_the_environment():
    options = sn.Options(noise={"kick": 0.5, "aim_deg": 0.05}, elevation=True)
    planner, strokes = Planner(options, threads=1), np.array([[2.24, 0.0, -0.2, np.pi / 2, 0.0]])
    action, ends = planner.actions_of(strokes)[0], set()
    for seed in range(6):
        env = sn.SnookerEnv(options)
        env.reset(seed=seed, options=CUT)
        key = np.array([env.get_state()["stream"]], np.uint64)
        by_strokes = planner.stops(env, [0], strokes=strokes, keys=key).places[0]
        by_actions = planner.stops(env, [0], action[None], keys=key).places[0]
        env.step(action)
        assert np.allclose(by_strokes, env.last_shot.positions, atol=1e-7)
        assert np.allclose(by_actions, env.last_shot.positions, atol=1e-12)
        ends.add(by_strokes[21, 0].round(3))
    assert len(ends) > 1
    env.reset(seed=1, options=CUT)
    silent = planner.stops(env, [0], strokes=strokes, errors=np.zeros((1, 5))).places[0]
    plain = Planner(options.but(noise="none"), threads=1).stops(env, [0], strokes=strokes).places[0]
    assert (silent == plain).all()


@pytest.mark.parametrize("kick", [-0.1, 1.1, "often", np.nan])
def test_a_bad_probability_is_refused(kick):
    with pytest.raises(ValueError, match=r"^noise\.kick = "):
        sn.Options(noise={"kick": kick})


def test_a_kick_copies_all_constants():
    """Its work space is ``CONSTANTS`` long: a shorter one would be written past its end."""
    assert len(sn.Physics().pack()) == CONSTANTS
