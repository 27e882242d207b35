"""Are choices, aims and directions the strokes that they say, seen by what they do on the table?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Planner, Position, Positions, Strokes, action_masks, pots
from snooker_env.planning.strokes import decode
from snooker_env.players import VISITS
from snooker_env.tasks.frames import sayings
from tests.positions import tables

DISCRETE = {"action": "discrete"}


def test_the_masks_are_those_of_the_environment():
    env = tables(30, layout="random:4", **DISCRETE)
    assert np.array_equal(action_masks(env), env.action_masks())
    assert np.array_equal(action_masks(env.get_state()), env.action_masks())


def test_a_stroke_of_a_speed_and_a_direction_is_what_it_says():
    """A ball alone: where it goes and how far is what ``strike`` says."""
    at = Position(cue=(0.0, 0.0), black=(0.0, -1.0))
    for speed, aim, side, top in ((0.6, 0.3, 0.0, 0.0), (0.5, 2.9, 0.3, 0.1), (0.7, 3.1, -0.2, -0.3)):
        left = Planner({}).play_strokes(at, [0], [[speed, side, top, aim, 0.0]]).afterstates.positions[0, 0]
        assert np.arctan2(left[1], left[0]) == pytest.approx(aim, abs=1e-6)
        v, w = sn.strike(speed, 0.0, abs(side), top)
        shot = sn.simulate([(0.0, 0.0)], [v[:2]], [w], None)
        assert np.hypot(*left) == pytest.approx(np.hypot(*shot.positions[0]), rel=1e-6)


@pytest.mark.parametrize(
    "options",
    [
        VISITS,
        {"aim": "absolute", "elevation": True, "layout": "break_off"},
        {"aim": "target", "placement": True, "elevation": True, "layout": "break_off"},
        {"aim": "target", "cue": "real", "layout": "random:6"},
        {"cue": "real", "layout": "random:6"},
        {"placement": True, "elevation": True, "layout": "break_off"},
        {"task": "frame", "says": ["nominate", "decision"]},
        {"aim": "target", "task": "frame", "placement": True, "says": ["decision"]},
    ],
)
def test_strokes_become_actions_that_mean_them(options):
    """The encoder and the decoder: from random actions to strokes, and back twice."""
    env = tables(40, **options)
    at, rng, rows = Positions.of(env), np.random.default_rng(2), np.arange(40)
    planner = Planner(env)
    values, start = planner.strokes_of(at, rows, rng.uniform(-0.6, 0.6, (40, *env.single_action_space.shape)))
    strokes = Strokes(values, np.where(at.in_hand[:, None], start.positions[:, 0], np.nan))
    again, placed = planner.strokes_of(at, rows, strokes.actions(env.options, at))
    assert np.allclose(again[:, [0, 1, 2, 4]], values[:, [0, 1, 2, 4]], rtol=0, atol=1e-12)
    assert np.allclose(np.exp(1j * again[:, 3]), np.exp(1j * values[:, 3]), rtol=0, atol=1e-9)
    assert np.allclose(placed.positions[:, 0], start.positions[:, 0], rtol=0, atol=1e-9)
    ends = Strokes([[0.2, 0.0, 0.0, np.pi, 0.0], [7.0, 0.0, 0.0, 3.5 * np.pi, 0.0]])
    if env.options.aim == "absolute":
        told = ends.actions(env.options, at[:2])
        assert told[:, 0].tolist() == [-1.0, 1.0] and told[:, 3].tolist() == [1.0, -0.5]


def test_an_aim_from_a_target_line_is_that_of_the_nominated_ball():
    options = sn.Options(task="frame", aim="target", says=["nominate"])
    env, rng = sn.SnookerEnv(options), np.random.default_rng(3)
    colours = {"yellow": (0.3, 0.4), "blue": (0.0, 0.0), "pink": (-0.4, 0.7), "black": (0.5, 1.2)}
    position = Position(cue=(0.1, -0.6), reds=[(-0.6, -0.2)], on="any_colour", **colours)
    env.reset(seed=1, options={"position": position})
    at = Positions.of(env)[np.zeros(20, int)]
    actions = rng.uniform(-0.9, 0.9, (20, 5))
    nominated, *_ = sayings(options.rules, actions, at.game)
    assert len(set(nominated.tolist())) == 4
    values, _ = decode(options.rules, at, np.arange(20), actions, nominated)
    back = Strokes(values, nominate=nominated).actions(options, at)
    assert np.allclose(back[:, :4], actions[:, :4], rtol=0, atol=1e-9)
    assert np.array_equal(sayings(options.rules, back, at.game)[0], nominated)


def test_a_solved_aim_pots_where_the_straight_line_misses():
    """Cuts with side, at which the ball is thrown."""
    env = tables(60, layout="pots:hard", aim="absolute")
    at, direct, n = Positions.of(env), pots(env, most=1), np.arange(60)
    targets = POCKET_AIMS[direct.pocket[:, 0], :2]
    planner, straight = Planner(env), np.arctan2(*(direct.ghost[:, 0] - at.positions[:, 0])[:, ::-1].T)
    spun = np.tile([2.9, 0.3, 0.0, 0.0, 0.0], (60, 1))
    solved = planner.pot_aim(at, n, direct.ball[:, 0], targets, spun)
    assert np.array_equal(
        solved, planner.pot_aim(at, n, direct.ball[:, 0], targets, spun, ghosts=direct.ghost[:, 0])
    )
    made = []
    for spun[:, 3] in solved, straight:
        made.append((planner.play_strokes(at, n, spun).points > 0).mean())
    assert made[0] > 0.8 and made[1] < 0.5
