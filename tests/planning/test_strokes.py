"""Are choices, aims and directions the strokes that they say, seen by what they do on the table?"""

import numpy as np
import pytest
from positions import tables

import snooker_env as sn
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import (
    Planner,
    Position,
    Positions,
    action_masks,
    actions_of,
    as_actions,
    pot_aim,
    pots,
)
from snooker_env.tasks import choice_of

DISCRETE = {"action": "discrete"}


def test_choices_as_angles_are_the_same_shots():
    """Said as a float32 angle, a choice's aim is rounded by 2e-7 rad."""
    choices, angles = tables(40, layout="random:1", **DISCRETE), tables(40, layout="random:1", aim="absolute")
    masks = choices.action_masks()
    picks = np.where(masks[:, choice_of(0, 3, 2, 3)], choice_of(0, 3, 2, 3), 0)
    actions = as_actions(angles, np.arange(40), picks)
    assert np.abs(actions).max() <= 1.0
    _, first, _, _, _ = choices.step(picks)
    _, second, _, _, _ = angles.step(actions)
    assert np.mean(first == second) > 0.95 and first.sum() > 10
    apart = np.abs(Positions.of(choices).positions[:, 0] - Positions.of(angles).positions[:, 0]).max(axis=1)
    assert np.median(apart) < 1e-3


def test_the_masks_are_those_of_the_environment():
    env = tables(30, layout="random:4", **DISCRETE)
    assert np.array_equal(action_masks(env), env.action_masks())
    assert np.array_equal(action_masks(env.get_state()), env.action_masks())


def test_an_action_of_a_speed_and_a_direction_is_that_stroke():
    """A ball alone: where it goes and how far is what ``strike`` says."""
    at = Position(cue=(0.0, 0.0), black=(0.0, -1.0))
    for speed, aim, side, top in ((0.6, 0.3, 0.0, 0.0), (0.5, 2.9, 0.3, 0.1), (0.7, 3.1, -0.2, -0.3)):
        action = actions_of([speed], [aim], side, top)
        left = Planner({}).play(at, [0], action).afterstates.positions[0, 0]
        assert np.arctan2(left[1], left[0]) == pytest.approx(aim, abs=1e-6)
        v, w = sn.strike(speed, 0.0, abs(side), top)
        shot = sn.simulate([(0.0, 0.0)], [v[:2]], [w], None)
        assert np.hypot(*left) == pytest.approx(np.hypot(*shot.positions[0]), rel=1e-6)
    assert actions_of([0.2, 7.0], [np.pi, 7 * np.pi / 2]).tolist() == [[-1, 0, 0, 1], [1, 0, 0, -0.5]]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (([0.1], [0.0]), r"strokes\[0\], speed = 0.1: must be a finite number in"),
        (([7.1], [0.0]), r"strokes\[0\], speed = 7.1"),
        (([np.nan], [0.0]), r"speeds\[0\] = nan"),
        (([1.0], [np.inf]), r"aims\[0\] = inf"),
        (([1.0], [0.0], 0.6), r"strokes\[0\], side = 0.6"),
        (([1.0], [0.0], np.nan), r"strokes\[0\], side = nan"),
        (([[1.0]], [0.0]), "speeds = array of shape"),
    ],
)
def test_a_stroke_that_cannot_be_an_action_is_refused(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        actions_of(*arguments)


def test_a_solved_aim_pots_where_the_straight_line_misses():
    """Cuts with side, at which the ball is thrown."""
    env = tables(60, layout="pots:hard", aim="absolute")
    at, direct, n = Positions.of(env), pots(env, most=1), np.arange(60)
    targets = POCKET_AIMS[direct.pocket[:, 0], :2]
    planner, straight = Planner(env), np.arctan2(*(direct.ghost[:, 0] - at.positions[:, 0])[:, ::-1].T)
    spun = np.tile([2.9, 0.3, 0.0, 0.0, 0.0], (60, 1))
    solved = planner.pot_aim(at, n, direct.ball[:, 0], targets, spun)
    assert np.array_equal(solved, pot_aim(at, n, direct.ball[:, 0], targets, spun, ghosts=direct.ghost[:, 0]))
    played = [planner.play(at, n, actions_of(np.full(60, 2.9), aims, 0.3)) for aims in (solved, straight)]
    made = [(outcomes.points > 0).mean() for outcomes in played]
    assert made[0] > 0.8 and made[1] < 0.5


POT = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)])


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"rows": [1]}, r"rows\[0\] = 1"),
        ({"balls": [0]}, r"balls\[0\] = 0: must be an integer in \[1, 21\]"),
        ({"balls": [22]}, r"balls\[0\] = 22"),
        ({"balls": [2]}, r"balls\[0\] = 2: must be on the table"),
        ({"balls": [1.0]}, "balls = float64 array"),
        ({"targets": [0.8, 0.8]}, "targets = "),
        ({"strokes": -1.0}, r"strokes\[0\], speed = -1.0"),
        ({"strokes": [1.0, 2.0]}, "strokes = "),
        ({"strokes": [[2.3, 0.6, 0.0, 0.0, 0.0]]}, r"strokes\[0\], side = 0.6"),
        ({"strokes": [[2.3, 0.0, 0.0, 0.0, 2.0]]}, r"strokes\[0\], elevation = 2.0"),
        ({"ghosts": [[np.nan, 0.0]]}, r"ghosts\[0, 0\] = nan"),
        ({"physics": "moon"}, "physics"),
        ({"fidelity": "coarse"}, "fidelity = 'coarse'"),
    ],
)
def test_an_aim_that_cannot_be_solved_is_refused(changes, complaint):
    arguments = {"positions": POT, "rows": [0], "balls": [1], "targets": [(0.8, 0.8)], "strokes": 2.3}
    assert pot_aim(**arguments).shape == (1,)
    with pytest.raises(ValueError, match=complaint):
        pot_aim(**arguments | changes)


def test_choices_out_of_range_are_refused():
    with pytest.raises(ValueError, match=r"choices\[1\] = 540: must be an integer in \[0, 539\]"):
        as_actions(POT, [0, 0], [3, 540])
    with pytest.raises(ValueError, match=r"choices = int64 array of shape \(2,\): must be integers of shape"):
        as_actions(POT, [0], [3, 4])
