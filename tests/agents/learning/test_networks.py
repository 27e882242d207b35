"""Do the networks know what a table is: no order among balls or pots, and the same play in a mirror?"""

import numpy as np
import pytest
import torch
from gymnasium import spaces

from agents.learning import networks
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.planning.learned.stroke_policy import BALL_X, CUT, POT_ENTRIES, POT_X, SHOWN, with_pots
from snooker_env.tasks.discrete_actions import POTS, SIDES, SIZE, SPEEDS, STROKES, TOPS
from snooker_env.tasks.observations import SIZE as SEEN

N = 40


@pytest.fixture(scope="module")
def seen():
    """Tables met in play: (N, SHOWN)."""
    tables = SnookerVectorEnv(N, action="discrete", observation="flat", noise="none")
    observations, _ = tables.reset(seed=1)
    rng = np.random.default_rng(0)
    for _ in range(3):
        choices = [rng.choice(np.flatnonzero(mask)) for mask in tables.action_masks()]
        observations, *_ = tables.step(np.array(choices))
    return torch.as_tensor(with_pots(observations))


@pytest.fixture
def net():
    torch.manual_seed(0)
    reader, head, value = (
        networks.TableReader(spaces.Box(-1.0, 1.0, (SHOWN,), np.float32)),
        networks.StrokeHead(),
        networks.ValueHead(),
    )
    return lambda x: (head(reader(x)).detach(), value(reader(x)).detach(), reader)


def mirrored(seen):
    """As seen in a mirror that exchanges left and right."""
    turned = seen.clone()
    turned[:, np.arange(22) * 5 + BALL_X] *= -1
    for entry in (*POT_X, CUT):
        turned[:, SEEN + np.arange(POTS) * POT_ENTRIES + entry] *= -1
    return turned


def test_reds_have_no_order(net, seen):
    order = np.r_[0, 1 + np.random.default_rng(1).permutation(15), 16:22]
    other = seen.clone()
    other[:, :110] = seen[:, :110].reshape(N, 22, 5)[:, order].reshape(N, 110)
    scores, values, _ = net(seen)
    changed, changed_values, _ = net(other)
    assert torch.allclose(scores, changed, atol=1e-5) and torch.allclose(values, changed_values, atol=1e-5)
    # a red and the black exchanged
    other[:, :110] = seen[:, :110].reshape(N, 22, 5)[:, np.r_[0:15, 21, 16:21, 15]].reshape(N, 110)
    assert not torch.allclose(values, net(other)[1], atol=1e-3)


def test_balls_on_are_summed_apart(net, seen):
    """Read of that sum alone, a table changes with each ball that is on and with no other."""
    reader = net(seen)[2]
    with torch.no_grad():
        reader.context[0].weight[:, networks.BALL :] = 0.0
    before, met = net(seen)[1], 0
    for ball in range(1, 22):
        on = (seen[:, 5 * ball + 2] > 0) & (seen[:, 5 * ball + 4] > 0)
        other = seen.clone()
        other[:, 5 * ball + 1] += 0.3
        changed = (net(other)[1] != before)[:, 0]
        assert torch.equal(changed, on), ball
        met += bool(on.any())
    assert met > 19


def test_pots_have_no_order_but_their_own_scores(net, seen):
    order = [2, 0, 3, 1]
    other = seen.clone()
    other[:, SEEN:] = seen[:, SEEN:].reshape(N, POTS, POT_ENTRIES)[:, order].reshape(N, -1)
    scores, changed = (net(x)[0].reshape(N, POTS, STROKES) for x in (seen, other))
    assert torch.allclose(scores[:, order], changed, atol=1e-5)
    assert not torch.allclose(scores[:, 0], scores[:, 1], atol=1e-3)


def test_a_mirror_turns_the_side_spin(net, seen):
    """But for the one number that says which half it was, since yellow and green lie on different sides."""
    reader = net(seen)[2]
    with torch.no_grad():
        reader.context[0].weight[:, -1] = 0.0
    assert reader.context[0].in_features == 3 * networks.BALL + networks.POT + (SEEN - 110) + 3
    scores, values, _ = net(seen)
    turned, turned_values, _ = net(mirrored(seen))
    expected = scores.reshape(N, POTS, len(SPEEDS), len(SIDES), len(TOPS)).flip(3).reshape(N, SIZE)
    off_centre = seen[:, BALL_X] != 0.0
    assert off_centre.sum() > 30
    assert torch.allclose(expected[off_centre], turned[off_centre], atol=1e-5)
    assert torch.allclose(values[off_centre], turned_values[off_centre], atol=1e-5)
    assert not torch.allclose(scores, turned, atol=1e-3)
