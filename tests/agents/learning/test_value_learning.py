"""Are the value's targets those of the docstring, recomputed by hand, and does the network come to them?"""

import pickle
from itertools import combinations

import numpy as np
import pytest
import torch

from agents.learning.value_learning import LAMBDA, ValueLearning
from agents.learning.value_network import MEMBERS, POINTS, ValueNetwork, value_of
from snooker_env.planning import Positions, Search, VisitJudge
from snooker_env.planning.learned.value_features import LOGIT, SIZE, value_features
from snooker_env.tasks import LEVELS
from snooker_env.tasks.noise import Spread
from tests.positions import chances_by_width, tables

SPREAD, SAMPLES = 1e-3, 3


def learner(n, seed=0):
    torch.manual_seed(seed)
    return ValueLearning(ValueNetwork(), SPREAD, n, np.random.default_rng(seed))


def a_round(n, rng, scale=1.0):
    """Features, those of what is left, points, whether it went on, whether its first sample was followed."""
    goes_on = rng.random((n, SAMPLES)) < 0.6
    after = (rng.normal(0, scale, (n, SAMPLES, SIZE)) * goes_on[..., None]).astype(np.float16)
    points = np.where(goes_on, rng.integers(1, 8, (n, SAMPLES)), 0).astype(np.float64)
    follows = goes_on[:, 0] & (rng.random(n) < 0.7)  # not where the stroke was exploratory
    return rng.normal(0, scale, (n, SIZE)).astype(np.float32), after, points, goes_on, follows


def by_numpy(network, rows):
    """P and U of every member: (MEMBERS, n) each."""
    both = []
    for member in range(MEMBERS):
        x = rows.astype(np.float64)
        for k, (weight, bias) in enumerate(zip(network.weights, network.biases, strict=True)):
            x = x @ weight[member].detach().double().numpy() + bias[member].detach().double().numpy()
            x = np.maximum(x, 0.0) if k < 2 else x
        chance = 1.0 / (1.0 + np.exp(-(rows[:, LOGIT].astype(np.float64) + x[:, 0])))
        both.append((chance, 40.0 * np.log1p(np.exp(x[:, 1]))))
    return np.array(both).swapaxes(0, 1)


def worth(network, row):
    """The value of one row of features: the mean of the members."""
    return np.prod(by_numpy(network, row[None]), axis=0).mean()


def by_hand(network, rounds):
    """Targets (rounds, n): each round's backup, and 0.7 of how far the next target was from its value."""
    n = len(rounds[0][0])
    targets = np.zeros((len(rounds), n))
    for i in range(n):
        for t in reversed(range(len(rounds))):
            _, after, points, goes_on, follows = rounds[t]
            gains = [goes_on[i, j] * worth(network, after[i, j]) for j in range(SAMPLES)]
            targets[t, i] = (sum(gains) + points[i].sum()) / SAMPLES
            if follows[i] and t + 1 < len(rounds):
                value = worth(network, rounds[t + 1][0][i].astype(np.float16))
                targets[t, i] += 0.7 * (targets[t + 1, i] - value)
    return targets


def test_the_targets_recomputed():
    """Four rounds of nine tables: visits that go on, that end, or that an exploratory stroke cuts."""
    rng, learning = np.random.default_rng(3), learner(9)
    rounds = [a_round(9, rng) for _ in range(4)]
    for one in rounds:
        learning.add(*one)
    expected = by_hand(learning._network, rounds)
    assert learning._targets().reshape(4, 9) == pytest.approx(expected, rel=1e-3, abs=2e-3) and LAMBDA == 0.7
    follows = np.array([one[4] for one in rounds[:-1]])
    without = by_hand(learning._network, [(*one[:4], np.zeros(9, bool)) for one in rounds])
    moved = np.abs(expected - without)[:-1] > 1e-3
    # corrected where it was followed, and only there
    assert np.array_equal(moved, follows) and 5 < follows.sum() < 22
    later = [*rounds[:-1], (rounds[-1][0], rounds[-1][1], rounds[-1][2] + 30.0, *rounds[-1][3:])]
    reached = np.abs(by_hand(learning._network, later) - expected) > 1.0
    assert np.array_equal(reached[2], follows[2]) and np.array_equal(reached[1], follows[2] & follows[1])
    assert reached[1].any()  # a correction reaches two rounds back


@pytest.mark.slow
def test_the_network_learns_a_known_value():
    """Strokes that end the visit: one feature says if they bring 7 points or 1, a second how many score.

    Then the loss falls, V comes to the mean, and P to the share of samples that score."""
    rng, n, learning = np.random.default_rng(0), 64, learner(64)
    nothing = np.zeros((n, 8, SIZE), np.float16)

    def play():
        seen = np.zeros((n, SIZE), np.float32)
        seen[:, :3] = rng.integers(0, 2, (n, 3))
        made = rng.random((n, 8)) < np.where(seen[:, 1] > 0, 0.9, 0.3)[:, None]
        seen[:, LOGIT] = 0.5
        points = made * np.where(seen[:, 0] > 0, 7.0, 1.0)[:, None]
        return seen, nothing, points, np.zeros((n, 8), bool), np.zeros(n, bool)

    for _ in range(30):
        learning.add(*play())
    began = []
    for step in range(80):
        learning.fit(1.0 - step / 160)
        began = began or [np.mean(list(learning.losses)[:5])]
    assert np.mean(list(learning.losses)[-20:]) < 0.8 * began[0] and np.isfinite(learning.losses).all()
    seen, _, _, _, _ = play()
    expected = np.where(seen[:, 1] > 0, 0.9, 0.3) * np.where(seen[:, 0] > 0, 7.0, 1.0)
    assert np.abs(learning.value().of(seen) - expected).mean() < 0.6
    with torch.no_grad():
        p = torch.sigmoid(learning._network(torch.from_numpy(seen))[0]).numpy()
    assert np.abs(p - np.where(seen[:, 1] > 0, 0.9, 0.3)).mean() < 0.08
    assert learning.mean_target == pytest.approx(learning._fitted[1][-n:].mean())
    assert 1.0 < learning.mean_target < 4.0


def test_each_member_learns_from_batches_of_its_own():
    """Members that start alike are apart after a fit, each as far from it as a network that learns alone."""
    rng, learning = np.random.default_rng(4), learner(16)
    alone = ValueLearning(ValueNetwork(members=1), SPREAD, 16, np.random.default_rng(0))
    with torch.no_grad():
        for all_members, own in zip(learning._network.parameters(), alone._network.parameters(), strict=True):
            all_members.copy_(all_members[:1].expand_as(all_members))
            own.copy_(all_members[:1])
    before = [p.detach().clone() for p in alone._network.parameters()]
    rounds = [a_round(16, rng) for _ in range(4)]
    for one in (learning, alone):
        for given in rounds:
            one.add(*given)
        one.fit(1.0)

    def moved(one):
        """How far each member came."""
        pairs = zip(one._network.parameters(), before, strict=True)
        return torch.stack([(p - start).flatten(1).norm(dim=1) for p, start in pairs]).norm(dim=0).tolist()

    for p in learning._network.weights:
        assert not any(torch.equal(p[a], p[b]) for a, b in combinations(range(4), 2))
    assert moved(learning) == pytest.approx(moved(alone) * 4, rel=0.15)


def test_no_gradient_is_left_behind():
    """Whoever learns next clips the gradients of the whole policy: these must not count there."""
    learning = learner(5)
    learning.add(*a_round(5, np.random.default_rng(0)))
    learning.fit(1.0)
    assert torch.nn.utils.clip_grad_norm_(learning._network.parameters(), 1.0) == 0.0


@pytest.mark.slow
def test_learning_goes_on_from_a_saved_state_bit_for_bit():
    """Saved at every step of a cycle of refreshes; the state is a copy as soon as it is a file."""
    rng = np.random.default_rng(5)
    rounds = [a_round(8, rng) for _ in range(12)]

    def go_on(learning, some):
        for one in some:
            learning.add(*one)
            learning.fit(0.7)

    whole = learner(8, seed=9)
    go_on(whole, rounds)
    assert learner(8).mean_target is None
    for stop in (0, 1, 5, 8, 11):
        first = learner(8, seed=9)
        go_on(first, rounds[:stop])
        saved = pickle.dumps((first.get_state(), first._network.state_dict(), first._rng.bit_generator.state))
        go_on(first, rounds[stop:])  # what comes later does not reach the file
        state, weights, generator = pickle.loads(saved)
        second = learner(8, seed=10)
        second._network.load_state_dict(weights)
        second._rng.bit_generator.state = generator
        second.set_state(state)
        go_on(second, rounds[stop:])
        for one in (first, second):
            assert all(map(torch.equal, whole._network.parameters(), one._network.parameters()))
            assert list(one.losses) == list(whole.losses) and one.mean_target == whole.mean_target


ERRORS = LEVELS["professional"].spread()


def network(seed=0, scale=1.0):
    torch.manual_seed(seed)
    made = ValueNetwork()
    with torch.no_grad():
        for p in made.parameters():
            p.mul_(scale)
    return made


def by_torch(made, seen):
    """P and U of every member: (MEMBERS, n) each."""
    with torch.no_grad():
        logit, follows = made(torch.from_numpy(seen))
        return torch.sigmoid(logit).numpy(), follows.numpy()


def some(n=200, layout="random:5"):
    return Positions.of(tables(n, layout=layout, seed=1))


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_the_value_is_that_of_the_network(scale):
    """On real positions and on random features, also with weights that saturate both outputs."""
    made = network(3, scale)
    value = value_of(made, ERRORS)
    for seen in (
        value_features(some(), ERRORS),
        np.random.default_rng(0).normal(0, 1.5, (300, SIZE)).astype(np.float32),
    ):
        p, u = by_torch(made, seen)
        assert value.of(seen) == pytest.approx((p * u).mean(axis=0), rel=1e-4, abs=1e-4)
        assert value.of(seen).shape == (len(seen),)
        assert np.isfinite(value.of(seen)).all() and (value.of(seen) >= 0.0).all()


def test_the_members_start_apart_and_each_reads_its_own_rows():
    made = network()
    assert all(not torch.equal(w[a], w[b]) for w in made.weights for a in range(MEMBERS) for b in range(a))
    seen = torch.from_numpy(np.random.default_rng(0).normal(0, 1, (MEMBERS, 30, SIZE)).astype(np.float32))
    together = [one.detach() for one in made(seen)]
    for member in range(MEMBERS):  # each reads its own rows
        alone = [one[member].detach() for one in made(seen[member])]
        for one, own in zip(together, alone, strict=True):
            assert torch.allclose(one[member], own, atol=1e-4)
    made(seen)[1][2].sum().backward()
    reached = [(w.grad != 0).flatten(1).any(1).tolist() for w in made.weights]
    assert reached == [[False, False, True, False]] * 3


def test_at_first_the_chance_is_the_likeliest_pots_and_what_follows_hardly_differs():
    at = some()
    likeliest = chances_by_width(at, ERRORS).max(axis=1)
    for seed in range(4):
        p, u = by_torch(network(seed), value_features(at, ERRORS))
        assert np.abs(p - likeliest).max() < 0.03
        assert all(np.corrcoef(one, likeliest)[0, 1] > 0.999 for one in p)
        assert (u.std(axis=1) < 0.05 * u.mean(axis=1)).all() and 0.4 * POINTS < u.mean() < POINTS


def test_the_value_of_a_position_is_that_of_its_features_on_any_number_of_threads_beside_any_others():
    made, at = network(), some(300)
    seen = value_features(at, ERRORS)
    kept = seen.copy()
    value = value_of(made, ERRORS)
    assert np.array_equal(value(at), value.of(seen))
    assert np.array_equal(value(at), value_of(made, ERRORS, threads=2)(at))
    assert np.array_equal(seen, kept) and value(at).dtype == np.float32
    alone = [value(at[k : k + 1])[0] for k in range(0, 300, 11)]
    assert np.array_equal(alone, value(at)[::11]) and np.array_equal(value(at[::-1]), value(at)[::-1])
    assert not np.allclose(
        value_of(made, Spread(4e-3))(at), value(at), rtol=0.05
    )  # larger errors, a lower value
    assert value_of(made, Spread(4e-3))(at).mean() < value(at).mean()


def test_a_search_takes_it_as_its_value():
    made, at = network(1, 2.0), some(3)
    options = {"noise": "professional", "fidelity": "fast"}
    value = value_of(made, ERRORS)
    ranked = Search(VisitJudge(options, value, threads=1), 30).rank(at, [1, 2, 3])
    usual = Search(VisitJudge(options, threads=1), 30).rank(at, [1, 2, 3])
    for one, other in zip(ranked, usual, strict=True):
        assert np.isfinite(one.scores).all() and not np.allclose(one.scores, other.scores)
