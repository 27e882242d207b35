"""Is the value that is played the network that is trained, and does it begin where the geometry stands?"""

import numpy as np
import pytest
import torch
from positions import chances_by_width, tables

from agents.learning.value_network import MEMBERS, POINTS, WIDTHS, ValueNetwork, value_of
from snooker_env.planning import Positions, StrokeSearch, spread_of
from snooker_env.planning.learned.value_features import LOGIT, SIZE, value_features
from snooker_env.tasks import LEVELS

SPREAD = spread_of(LEVELS["professional"])


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
    value = value_of(made, SPREAD)
    for seen in (
        value_features(some(), SPREAD),
        np.random.default_rng(0).normal(0, 1.5, (300, SIZE)).astype(np.float32),
    ):
        p, u = by_torch(made, seen)
        assert value.of(seen) == pytest.approx((p * u).mean(axis=0), rel=1e-4, abs=1e-4)
        assert value.of(seen).shape == (len(seen),)
        assert np.isfinite(value.of(seen)).all() and (value.of(seen) >= 0.0).all()


def test_the_network_has_the_layers_that_the_file_says():
    sizes = [(SIZE, WIDTHS[0]), (WIDTHS[0], WIDTHS[1]), (WIDTHS[1], 2)]
    assert [tuple(w.shape) for w in network().weights] == [(MEMBERS, *size) for size in sizes]
    assert MEMBERS == 4
    assert [tuple(b.shape) for b in network().biases] == [(MEMBERS, 1, b) for _, b in sizes]
    made, seen = network(2), np.random.default_rng(1).normal(0, 1, (50, SIZE)).astype(np.float32)
    p, u = by_torch(made, seen)
    for member in range(MEMBERS):
        x = seen.astype(np.float64)
        for k, (weight, bias) in enumerate(zip(made.weights, made.biases, strict=True)):
            x = x @ weight[member].detach().double().numpy() + bias[member].detach().double().numpy()
            x = np.maximum(x, 0.0) if k < 2 else x
        assert p[member] == pytest.approx(1 / (1 + np.exp(-(seen[:, LOGIT] + x[:, 0]))), abs=1e-5)
        assert u[member] == pytest.approx(POINTS * np.log1p(np.exp(x[:, 1])), rel=1e-4)


def test_the_members_start_apart_and_each_reads_its_own_rows():
    made = network()
    assert all(not torch.equal(w[a], w[b]) for w in made.weights for a in range(MEMBERS) for b in range(a))
    seen = torch.from_numpy(np.random.default_rng(0).normal(0, 1, (MEMBERS, 30, SIZE)).astype(np.float32))
    together = [one.detach() for one in made(seen)]
    for member in range(MEMBERS):  # each reads its own rows
        alone = [one[member].detach() for one in made(seen[member])]
        assert all(
            torch.allclose(one[member], own, atol=1e-4) for one, own in zip(together, alone, strict=True)
        )
    made(seen)[1][2].sum().backward()
    reached = [(w.grad != 0).flatten(1).any(1).tolist() for w in made.weights]
    assert reached == [[False, False, True, False]] * 3


def test_at_first_the_chance_is_the_likeliest_pots_and_what_follows_hardly_differs():
    at = some()
    likeliest = chances_by_width(at, SPREAD).max(axis=1)
    for seed in range(4):
        p, u = by_torch(network(seed), value_features(at, SPREAD))
        assert np.abs(p - likeliest).max() < 0.03
        assert all(np.corrcoef(one, likeliest)[0, 1] > 0.999 for one in p)
        assert (u.std(axis=1) < 0.05 * u.mean(axis=1)).all() and 0.4 * POINTS < u.mean() < POINTS


def test_a_value_keeps_the_weights_that_it_was_made_of():
    made, seen = network(), value_features(some(20), SPREAD)
    value = value_of(made, SPREAD)
    before = value.of(seen)
    with torch.no_grad():
        for p in made.parameters():
            p.add_(0.1)
    assert np.array_equal(value.of(seen), before) and not np.allclose(value_of(made, SPREAD).of(seen), before)


def test_the_value_of_a_position_is_that_of_its_features_on_any_number_of_threads_beside_any_others():
    made, at = network(), some(300)
    seen = value_features(at, SPREAD)
    kept = seen.copy()
    value = value_of(made, SPREAD)
    assert np.array_equal(value(at), value.of(seen))
    assert np.array_equal(value(at), value_of(made, SPREAD, threads=2)(at))
    assert np.array_equal(seen, kept) and value(at).dtype == np.float32
    alone = [value(at[k : k + 1])[0] for k in range(0, 300, 11)]
    assert np.array_equal(alone, value(at)[::11]) and np.array_equal(value(at[::-1]), value(at)[::-1])
    assert not np.allclose(value_of(made, 4e-3)(at), value(at), rtol=0.05)  # larger errors, a lower value
    assert value_of(made, 4e-3)(at).mean() < value(at).mean()


def test_a_search_takes_it_as_its_value():
    made, at = network(1, 2.0), some(3)
    options = {"noise": "professional", "fidelity": "fast"}
    value = value_of(made, SPREAD)
    ranked = StrokeSearch(options, 30, value=value, threads=1).rank(at, [1, 2, 3])
    usual = StrokeSearch(options, 30, threads=1).rank(at, [1, 2, 3])
    assert np.isfinite(ranked.scores).all() and not np.allclose(ranked.scores, usual.scores)
