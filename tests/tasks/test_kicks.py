"""Is a kick a bad contact of the cue ball, as often as asked, and nothing else?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import BALL_RADIUS
from snooker_env.physics.columns import CONSTANTS
from snooker_env.tasks.noise import Noise, kick_of
from tests.kernels import from_python
from tests.tables import begun

_kick_of = from_python(kick_of)

CUT = {"position": sn.Position(cue=(0.0, 0.0), black=(0.03, 0.6))}
ACTION = np.array([-0.4, 0.0, -0.4, 0.5])  # a stun shot up the table: the black at a cut of 35 degrees
ROLLING = ACTION * [1, 1, -2, 1]  # at 0.4 R above the middle the ball rolls from the start
FRICTION = 0.2  # docs/physics/limits.md


def throw(noise, physics="paper", across=0.03, fidelity="reference", action=ACTION):
    """The direction of the black after the contact [rad], and the shot; ``across`` of its line [m]."""
    env = sn.SnookerEnv(aim="absolute", noise=noise, physics=physics, fidelity=fidelity)
    env.keep_history = True
    env.reset(seed=1, options={"position": sn.Position(cue=(0.0, 0.0), black=(across, 0.6))})
    env.step(action)
    shot = env.last_shot
    t = float(shot.events["time"][shot.events["kind"] == sn.EventKind.BALL_BALL][0])
    moved = shot.at(t + 1e-4)[0][21] - shot.at(t)[0][21]
    return np.arctan2(moved[1], moved[0]), shot


@pytest.mark.parametrize(
    ("preset", "cut", "fidelity", "action"),
    [
        ("paper", 35, "reference", ACTION),
        ("match", 60, "standard", ACTION),
        ("paper", 60, "standard", ROLLING),
    ],
)
def test_a_kick_is_a_larger_friction_of_the_first_contact(preset, cut, fidelity, action):
    """At 35 degrees a stun shot's contact sticks, at 60 it slips: there the friction shows in the throw."""
    across = 2 * BALL_RADIUS * np.sin(np.radians(cut))
    shots = ("none", preset), ({"kick": 1.0}, preset)
    usual, kicked = (throw(*shot, across, fidelity, action)[0] for shot in shots)
    rough = {"preset": preset, "mu_bb": FRICTION, "tables": False}
    assert abs(kicked - throw("none", rough, across, fidelity, action)[0]) < 1e-9
    assert np.degrees(kicked - usual) > 1.0


@pytest.mark.parametrize(("share", "n"), [(0.01, 200_000), (0.3, 40_000), (0.9, 40_000)])
def test_kicks_are_as_frequent_as_asked(share, n):
    noise, stream = Noise(kick=share).pack(BALL_RADIUS), np.array([3, 0], np.uint64)
    frictions = np.array([_kick_of(noise, stream) for _ in range(n)])
    assert set(frictions) == {0.0, FRICTION} and stream.tolist() == [3, n]  # one block each
    assert (frictions > 0).mean() == pytest.approx(share, abs=4 * np.sqrt(share * (1 - share) / n))
    packed = (Noise(kick=p).pack(1.0) for p in (1.0, 0.0))
    (always,), (never,) = ({_kick_of(noise, stream) for _ in range(100)} for noise in packed)
    assert (always, never) == (FRICTION, 0.0)


def test_without_kicks_nothing_is_drawn_for_them():
    assert (throw("none")[1].positions == throw({"kick": 0.0})[1].positions).all()
    for kick, blocks in ((0.0, 0), (1e-9, 4)):  # errors have three, the kick one, in every stroke
        env = begun(sn.SnookerEnv(aim="absolute", noise={"kick": kick}))
        state = env.get_state()
        for _ in range(2):
            env.set_state(state)
            env.step(np.zeros(4))
            key, counter = state["stream"]
            state |= {"stream": [key, counter + blocks]}
            assert env.get_state()["stream"] == state["stream"]


def test_kicks_are_independent_of_the_errors_and_of_each_other():
    """The same strokes with and without kicks have the same errors: where a shot differs, it had a kick."""
    n, share = 3000, 0.3
    errors = {"aim_deg": 0.05, "speed_rel": 0.02, "offset_mm": 0.1, "elevation_deg": 0.1}
    drawn, kicked = [], []
    noises = (errors | {"kick": p} for p in (0.0, share))
    envs = [sn.SnookerVectorEnv(n, aim="absolute", noise=noise, threads=1) for noise in noises]
    for seed in (1, 10_001):  # the second time in the same work space
        ends = []
        for env in envs:
            env.reset(seed=seed, options=CUT)
            streams = env.tables.streams.copy()
            ends.append(env.step(np.tile(ACTION, (n, 1)))[0])
        drawn.append(Noise(**errors).errors_of(streams))
        kicked.append((ends[0] != ends[1]).any(axis=1))
        assert kicked[-1].mean() == pytest.approx(share, abs=4 * np.sqrt(share * (1 - share) / n))
    drawn, both = np.concatenate(drawn), np.concatenate(kicked).astype(float)
    for sizes in (drawn, np.abs(drawn)):
        together = np.corrcoef(sizes.T, both)[-1, :-1]
        assert np.abs(together).max() < 4 / np.sqrt(2 * n)
    assert abs(np.corrcoef(*kicked)[0, 1]) < 4 / np.sqrt(n)


def test_a_kick_copies_all_constants():
    """Its work space is ``CONSTANTS`` long: a shorter one would be written past its end."""
    assert len(sn.Physics().pack()) == CONSTANTS
