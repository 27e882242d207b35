"""Does a policy propose the strokes that it likes, near its choices and within the limits of a stroke?"""

import numpy as np
import pytest

from agents.learning.models import PRETRAINED, load_trained
from snooker_env.benchmark import count_shots
from snooker_env.planning import Planner, Positions, Search, VisitJudge, action_masks, pots
from snooker_env.planning.learned.stroke_policy import TEMPERATURE, PolicyProposals
from snooker_env.planning.proposals import AIM, RIM, SIDE, SPEED, TOP
from snooker_env.tasks import CHOICES, SIDES, SPEEDS, TOPS, choice_of
from tests.positions import chances_by_width, tables

JUDGE = VisitJudge({"noise": "professional", "fidelity": "fast"}, threads=1)


def spread_at(speed):
    """The player's law of direction in a stroke at that speed."""
    return JUDGE.spread._replace(core=np.radians(JUDGE.noise.direction_deg(speed=speed)))


class Preferring:
    """A policy with given scores of all choices, the same in every position."""

    def __init__(self, scores):
        self._scores = np.asarray(scores, np.float32)

    def scores(self, seen, masks):
        return np.where(masks, self._scores, np.float32(-1e8))


def preferring(**worths):
    scores = np.full(CHOICES, -1e3)
    for name, worth in worths.items():
        scores[choice_of(*map(int, name.strip("_").split("_")))] = worth
    return PolicyProposals(Preferring(scores))


def some(n=6):
    """Positions with four pots or more."""
    at = Positions.of(tables(60, layout="random:9", seed=3))
    at = at[np.flatnonzero(action_masks(at).all(axis=1))[:n]]
    assert len(at) == n
    return at


@pytest.fixture(scope="module")
def learned():
    return PolicyProposals(load_trained(PRETRAINED / "ppo_value.zip", "agent").policy.fused)


def test_a_policy_that_likes_one_choice_gets_strokes_within_its_cell():
    """The second pot at 2.9 m/s, left side, below the middle."""
    at, m = some(), 64
    strokes, chances = preferring(_1_4_0_1=5.0)(JUDGE, at, m, np.arange(6))
    assert strokes.shape == (6, m, 5) and chances.shape == (6, m)
    step = np.gradient(np.log(SPEEDS))[4]
    off = np.log(strokes[..., SPEED] / SPEEDS[4]) / step
    assert np.abs(off).max() <= 0.5 + 1e-9 and off.min() < -0.45 and off.max() > 0.45
    assert np.abs(off.mean(axis=1)).max() < 0.05
    side, top = (strokes[..., SIDE] - SIDES[0]) / 0.3, (strokes[..., TOP] - TOPS[1]) / 0.2
    inside = np.hypot(strokes[..., SIDE], strokes[..., TOP]) < RIM - 1e-9  # a tip beyond the rim was drawn in
    for off in (side[inside], top[inside]):
        assert np.abs(off).max() <= 0.5 + 1e-9 and off.min() < -0.4 and off.max() > 0.4
    for k, i in zip(np.arange(m) % 6, np.arange(m), strict=True):
        expected = chances_by_width(at[[k]], spread_at(strokes[k, i, SPEED]))[0, 1]
        assert chances[k, i] == pytest.approx(expected, rel=1e-9)
    choices = np.full(6, choice_of(1, 4, 0, 1))
    middle = Planner({"action": "discrete"}).strokes_of(at, np.arange(6), choices)[0][:, AIM]
    apart = (strokes[..., AIM] - middle[:, None] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(apart).max() < 0.05  # throw depends on the stroke within the cell


def test_half_of_the_plain_strokes_have_no_side_at_all():
    strokes = preferring(_0_4_1_2=5.0)(JUDGE, some(), 400, np.arange(6)).strokes
    assert (strokes[..., SIDE] == 0.0).mean(axis=1) == pytest.approx(np.full(6, 0.5), abs=0.03)
    assert np.abs(strokes[..., SIDE]).max() <= 0.15 + 1e-9 and strokes[..., SIDE].max() > 0.1
    assert strokes[..., SIDE].min() < -0.1
    sided = preferring(_0_4_2_2=5.0)(JUDGE, some(), 400, np.arange(6)).strokes
    assert (sided[..., SIDE] > 0.14).all()


def test_shares_are_the_softmax_at_its_temperature():
    """Three choices of distinct speed: each gets its share of the strokes, to one stroke."""
    scores = {"_0_0_1_2": 2.0, "_0_4_1_2": 0.0, "_2_8_1_2": 3.0}
    m = 100
    strokes = preferring(**scores)(JUDGE, some(), m, np.arange(6)).strokes
    weights = np.exp(np.array(list(scores.values())) / TEMPERATURE)
    nearest = np.abs(np.log(strokes[..., SPEED, None] / np.array(SPEEDS)[[0, 4, 8]])).argmin(axis=2)
    for column, share in enumerate(weights / weights.sum()):
        assert np.abs((nearest == column).sum(axis=1) - m * share).max() <= 1.0


@pytest.mark.parametrize("layout", ["opened", "break_off"])
def test_a_trained_policys_strokes_can_be_played(learned, layout):
    at = Positions.of(tables(5, layout=layout, seed=1))
    strokes, chances = learned(JUDGE, at, 40, np.arange(5))
    present = pots(at).ball[:, 0] >= 0
    assert np.isfinite(strokes).all() and (strokes[present][..., SPEED] >= 0.748).all()
    assert (strokes[..., SPEED] <= 6.88).all()  # half a cell beyond the grid
    assert (np.hypot(strokes[present][..., SIDE], strokes[present][..., TOP]) <= RIM + 1e-12).all()
    assert ((chances > 0) == present[:, None]).all() and (chances <= 1).all()
    before = count_shots()
    ranked = Search(JUDGE, 30, learned).rank(at, np.arange(5))
    assert [len(one.strokes) for one in ranked] == [16] * 5 and count_shots() - before <= 5 * 30


def test_each_position_is_proposed_for_by_itself(learned):
    at, seeds, order = some(8), np.arange(8), np.array([6, 1, 3])
    whole, part = learned(JUDGE, at, 50, seeds), learned(JUDGE, at[order], 50, seeds[order])
    assert all(np.array_equal(one, every[order]) for one, every in zip(part, whole, strict=True))
    other = learned(JUDGE, at, 50, seeds + 90)
    assert all(not np.array_equal(other.strokes[k], whole.strokes[k]) for k in range(8))
