"""Is the first stroke of every player, of one's own too, the one that it would play on tables?"""

from typing import ClassVar

import numpy as np
import pytest
from cases import ALL, IN_HAND, OPEN, state_of, stroke_of

import snooker_env as sn
from snooker_env.planning import Positions
from snooker_env.tasks import choice_of


class Soft:
    """Sees observations: always the first pot, softly."""

    options: ClassVar = {"action": "discrete"}

    def act(self, observations, masks, seeds):
        assert observations.shape == (1, 61) and masks.shape == (1, 540)
        return np.array([choice_of(0, 0, 1, 2)])


class Aiming:
    """A stroke with side, aimed away from +x, and placed where it says."""

    options: ClassVar = {"aim": "absolute", "placement": True}

    def act(self, observations, masks, seeds):
        return np.array([[0.0, 0.6, -0.2, 0.5, 0.5, -1.0]], np.float32)


class OfFrames:
    """Sees frames: its score, which is 0 in a visit, and the balls."""

    options: ClassVar = {"task": "frame", "aim": "absolute", "says": ["decision"]}
    seen: ClassVar = []

    def act(self, observations, masks, seeds):
        self.seen.append(np.array(observations[0]))
        return np.array([[-0.5, 0.0, 0.0, 0.5, -1.0]], np.float32)


def test_a_players_stroke_is_read_as_the_environment_reads_it():
    """Squirt and all: the same stroke from the same place ends where the player's own action does."""
    for player, position in ((Soft(), OPEN), (Aiming(), OPEN), (Aiming(), IN_HAND)):
        tables = sn.SnookerVectorEnv(1, noise="none", **player.options)
        observations, _ = tables.reset(seed=0, options={"state": state_of(position)})
        tables.step(player.act(observations, np.ones((1, 540), bool), [0]))
        stroke = stroke_of(player, position)
        other = sn.SnookerVectorEnv(1, aim="absolute", placement=True)
        other.reset(seed=0, options={"state": state_of(position)})
        other.step(stroke.strokes().actions(other.options, Positions.of(other)))
        (one,), (same,) = tables.get_state(), other.get_state()
        assert one["on_table"] == same["on_table"]
        assert np.allclose(one["positions"], same["positions"], atol=2e-3)  # float32, magnified by impacts
    assert stroke_of(Aiming(), IN_HAND).place == pytest.approx((0.146, -1.0475))
    assert stroke_of(Aiming(), OPEN).side == pytest.approx(0.3)


def test_a_player_of_frames_sees_the_frame_and_a_visit_as_one():
    env = sn.SnookerEnv(task="frame", opponent="ghost_ball")
    env.reset(seed=2, options={"breaker": 0})
    OfFrames.seen.clear()
    stroke_of(OfFrames(), env)
    assert np.array_equal(OfFrames.seen[0], env.tables.observe(np.arange(1))[0])
    visits = [stroke_of(OfFrames(), position) for position in ALL.values()]
    assert len(OfFrames.seen) == 1 + len(ALL)
    assert len({seen.tobytes() for seen in OfFrames.seen}) == 1 + len(ALL)
    assert {round(stroke.aim, 6) for stroke in visits} == {round(np.pi / 2, 6)}
