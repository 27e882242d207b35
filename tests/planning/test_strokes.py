"""Are choices, aims and directions the strokes that they say, seen by what they do on the table?"""

import numpy as np
import pytest
from positions import tables

import snooker_env as sn
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Planner, Position, Positions, Strokes, action_masks, pot_aim, pots
from snooker_env.planning.strokes import decode
from snooker_env.players import VISITS
from snooker_env.tasks import choice_of
from snooker_env.tasks.carry_out import sayings

DISCRETE = {"action": "discrete"}


def test_choices_as_angles_are_the_same_shots():
    """Said as a float32 angle, a choice's aim is rounded by 2e-7 rad."""
    choices, angles = tables(40, layout="random:1", **DISCRETE), tables(40, layout="random:1", aim="absolute")
    masks = choices.action_masks()
    picks = np.where(masks[:, choice_of(0, 3, 2, 3)], choice_of(0, 3, 2, 3), 0)
    strokes, _ = Planner(choices).strokes_of(choices, np.arange(40), picks)
    actions = Strokes(strokes).actions(angles.options, Positions.of(angles)).astype(np.float32)
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
        {"aim": "absolute"},
        {"aim": "absolute", "elevation": True, "layout": "break_off"},
        {"aim": "target", "placement": True, "elevation": True, "layout": "break_off"},
        {"aim": "target", "cue": "real", "layout": "random:6"},
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


def test_what_an_action_cannot_hold_is_refused():
    at = Positions.of(Position(cue=(0.0, -0.5), reds=[(0.3, 0.3)]))
    for stroke, options, complaint in (
        ([2.0, 0.0, 0.0, 0.3, 0.2], {}, r"elevation = 0\.2: must be left out"),
        ([2.0, 0.0, 0.0, 0.3, 0.0], DISCRETE, "options.action = 'discrete'"),
        (
            [2.0, 0.0, 0.0, 0.3, 0.0],
            {"aim": "target"},
            r"aim\[0\] = 0.3: must be within 3 degrees of the target",
        ),
    ):
        with pytest.raises(ValueError, match=f"^{complaint}"):
            Strokes([stroke]).actions(sn.Options(**options), at)
    with pytest.raises(ValueError, match=r"^positions = 2 positions: must be 1, one for each stroke"):
        Strokes([stroke]).actions(sn.Options(), at[[0, 0]])
    with pytest.raises(ValueError, match=r"^rows = 0: must be a slice, a mask or an array of rows"):
        Strokes([stroke])[0]


def test_a_solved_aim_pots_where_the_straight_line_misses():
    """Cuts with side, at which the ball is thrown."""
    env = tables(60, layout="pots:hard", aim="absolute")
    at, direct, n = Positions.of(env), pots(env, most=1), np.arange(60)
    targets = POCKET_AIMS[direct.pocket[:, 0], :2]
    planner, straight = Planner(env), np.arctan2(*(direct.ghost[:, 0] - at.positions[:, 0])[:, ::-1].T)
    spun = np.tile([2.9, 0.3, 0.0, 0.0, 0.0], (60, 1))
    solved = planner.pot_aim(at, n, direct.ball[:, 0], targets, spun)
    assert np.array_equal(solved, pot_aim(at, n, direct.ball[:, 0], targets, spun, ghosts=direct.ghost[:, 0]))
    made = []
    for spun[:, 3] in solved, straight:
        made.append((planner.play_strokes(at, n, spun).points > 0).mean())
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
