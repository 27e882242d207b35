"""Is ``mixture_policy`` the density it says it is, and do its aims follow the pots' lines of the environment?"""

from copy import copy
from math import atan2, cos, pi, sin
from typing import Any

import numpy as np
import pytest
import torch
from scipy.special import logsumexp
from scipy.stats import norm
from stable_baselines3 import PPO

from agents.features.views import training_tables
from agents.learning import hyperparameters, mixture_policy
from agents.learning.mixture_policy import LINE, OFFERED, THROW_UNIT, TOLERANCE, AbsolutePolicy, nearest_image
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import N_BALLS, mask_of
from snooker_env.game.pots import pots
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Positions
from snooker_env.planning.learned import pot_view
from snooker_env.tasks.box_actions import line
from snooker_env.tasks.discrete_actions import POTS
from snooker_env.tasks.observations import SIZE

R = 0.02625


def tables(layout, n):
    """n environments at the start of a visit."""
    envs = [SnookerEnv(action="box", aim="absolute", layout=layout) for _ in range(n)]
    for seed, env in enumerate(envs):
        env.reset(seed=seed)
    return envs


def seen(envs):
    """What a policy sees of them, a tensor."""
    observations = [Positions.of(env).observations() for env in envs]
    return torch.as_tensor(pot_view.with_pots(np.concatenate(observations)))


def one_red(cue, red):
    """A table that holds just these: positions, on_table."""
    positions, on_table = np.zeros((N_BALLS, 2)), np.arange(N_BALLS) < 2
    positions[0], positions[1] = cue, red
    return positions, on_table


def shown(positions, on_table):
    """What a policy sees of a table with a red on."""
    at = Positions(positions[None], on_table[None], [[1, 0, 0, 0, 0]])
    return torch.as_tensor(pot_view.with_pots(at.observations()))


@pytest.fixture(scope="module")
def model():
    """PPO with the recipe's policy, which has learned something: every number that starts at 0 is drawn."""
    table = training_tables(2, threads=1, action="box", aim="absolute")
    made = PPO(AbsolutePolicy, table, n_steps=8, batch_size=8, seed=3, device="cpu")
    with torch.no_grad():
        head: Any = made.policy.action_net
        head.pot.weight.mul_(10.0)
        for p in (head.pot.bias, head.no_pot.bias, head.throw.last.weight):
            p.normal_(0.0, 0.3)
        made.policy.log_std.copy_(torch.tensor([0.2, 0.3, 0.25, 0.6]).log())
    return made


@pytest.fixture(scope="module")
def opened():
    return seen(tables("opened", 6))


@pytest.fixture(scope="module")
def without_pots():
    """Tables of one red without a direct pot."""
    found = [env for env in tables("random:1", 60) if not len(pots(env.positions, env.on_table, env.on))]
    assert len(found) > 3
    return found


def density(model, table, n=1):
    """The mixture at a table, or n times at the same one: a copy of the policy's own, which it sets anew."""
    read = model.policy.extract_features(table)
    return copy(model.policy._get_action_dist_from_latent(read.repeat(n, 1)))


def parameters(model, table):
    """Of the mixture at one table, numpy: weights, means, stds, aim stds; and the distribution."""
    dist = density(model, table)
    found = (dist.log_weights[0].exp(), dist.means[0], dist.stds, dist.aim_stds[0])
    return *(p.detach().double().numpy() for p in found), dist


def mixture(model, table, action):
    """Logarithm of an action's density, by the formula of the module; an aim counts at all its images."""
    weights, means, stds, aim_stds, dist = parameters(model, table)
    strokes = torch.as_tensor(action[:3], dtype=torch.float32).expand(1, POTS, 3)
    aims = dist.aims_of(strokes)[0].detach().double().numpy()
    parts, images_of = [], action[3] + np.array([-4.0, -2.0, 0.0, 2.0, 4.0])
    for k in np.flatnonzero(weights > 0):
        images = logsumexp(norm.logpdf(images_of, aims[k], aim_stds[k]))
        parts.append(np.log(weights[k]) + norm.logpdf(action[:3], means[k], stds).sum() + images)
    return logsumexp(parts)


@torch.no_grad()
def test_log_prob_is_that_of_the_mixture(model, opened):
    rng = np.random.default_rng(0)
    for k in range(len(opened)):
        table = opened[k : k + 1]
        weights, means, stds, aim_stds, dist = parameters(model, table)
        assert weights.sum() == pytest.approx(1.0, abs=1e-6)
        for c in range(POTS):
            stroke = means[c] + stds * rng.normal(size=3)
            aims = dist.aims_of(torch.as_tensor(stroke, dtype=torch.float32).expand(1, POTS, 3))[0]
            action = np.array([*stroke, aims[c].item() + 2.0 * aim_stds[c] * rng.normal()], np.float32)
            got = dist.log_prob(torch.as_tensor(action)[None]).item()
            # float32 aims in units of narrow deviations
    assert got == pytest.approx(mixture(model, table, action.astype(float)), abs=5e-3, rel=1e-6)


@torch.no_grad()
def test_aim_wraps_at_the_seam(model):
    table = shown(*one_red((0.5, 0.0), (-0.4, 0.0)))  # the left middle pocket lies straight ahead: at +-1
    weights, means, _, aim_stds, dist = parameters(model, table)
    at = mixture_policy.lines_of(table)[0, :, LINE]
    c = int(np.argmax(1.0 - np.abs(np.abs(at.numpy()) - 1.0)))
    assert abs(abs(at[c].item()) - 1.0) < 1e-6 and weights[c] > 0
    aim = dist.aims_of(dist.means)[0, c].item()
    for off in (-2.0, -0.5, 0.5, 2.0):
        inside = float(nearest_image(torch.tensor(aim + off * aim_stds[c], dtype=torch.float64)))
        expected = mixture(model, table, np.array([*means[c], inside]))
        for turn in (-2.0, 0.0, 2.0):
            action = torch.tensor([[*means[c], inside + turn]], dtype=torch.float32)
            assert dist.log_prob(action).item() == pytest.approx(expected, abs=5e-3)
    torch.manual_seed(0)
    dist = density(model, table, 4000)
    aims = dist.sample()[:, 3].numpy()
    near = np.abs(np.abs(aims) - 1.0) < 0.05
    assert np.abs(aims).max() <= 1.0 and (aims[near] > 0).any() and (aims[near] < 0).any()
    assert near.mean() > 0.5 * weights[c]


@torch.no_grad()
def test_density_integrates_to_one(model, opened):
    """Over the whole circle of aims: what is left must be the mixture of the strokes alone, a Gaussian."""
    table = opened[:1]
    weights, means, stds, aim_stds, _ = parameters(model, table)
    n = int(2.0 / (0.5 * aim_stds.min()))  # equal steps of half a deviation sum a Gaussian to many digits
    aims = torch.linspace(-1.0, 1.0, n + 1, dtype=torch.float64)[:-1].float()
    dist = density(model, table, n)
    for stroke in (means[0], means[1] + stds, np.zeros(3)):
        actions = torch.cat([torch.as_tensor(stroke, dtype=torch.float32).expand(n, 3), aims[:, None]], 1)
        found = dist.log_prob(actions).exp().double().sum().item() * 2.0 / n
        assert found == pytest.approx((weights * norm.pdf(stroke, means, stds).prod(1)).sum(), rel=1e-3)


@torch.no_grad()
def test_samples_follow_the_density(model, opened):
    n = 8000
    torch.manual_seed(1)
    weights, means, stds, aim_stds, _ = parameters(model, opened[:1])
    dist = density(model, opened[:1], n)
    actions = dist.sample()
    aims = dist.aims_of(actions[:, None, :3].expand(n, POTS, 3))
    aside = nearest_image(actions[:, None, 3] - aims).numpy() / aim_stds
    of = np.abs(aside).argmin(1)  # the pots' lines lie many deviations apart
    assert np.sort(np.abs(aside), 1)[:, 1].min() > 8.0
    assert np.bincount(of, minlength=POTS) / n == pytest.approx(weights, abs=2.0 / np.sqrt(n))
    z = np.column_stack([(actions[:, :3].numpy() - means[of]) / stds, aside[np.arange(n), of]])
    assert z.mean(0) == pytest.approx(np.zeros(4), abs=4.0 / np.sqrt(n))
    assert np.cov(z.T) == pytest.approx(np.eye(4), abs=4.0 * np.sqrt(2.0 / n))
    surprise = -dist.log_prob(actions).numpy()
    assert dist.entropy()[0].item() == pytest.approx(surprise.mean(), abs=4.0 * surprise.std() / np.sqrt(n))


@torch.no_grad()
def test_aims_follow_the_lines_of_the_environment(model):
    """Without throw every line leads to the pot's ghost ball, and what the environment plays leaves along it."""
    throw = model.policy.action_net.throw
    learned = throw.last.weight.clone()
    throw.start()
    try:
        for env in tables("opened", 8):
            dist = density(model, seen([env]))
            aims = dist.aims_of(dist.means)[0].double().numpy() * pi
            found = pots(env.positions, env.on_table, env.on, most=POTS)
            ghosts = (found[:, 2:4] - env.positions[0]) @ [1.0, 1j]
            assert len(found) > 1
            assert np.exp(1j * aims[: len(found)]) == pytest.approx(ghosts / np.abs(ghosts), abs=2e-6)
            dist.log_weights = torch.arange(POTS, 0, -1.0)[None]  # the widest pot
            action = dist.mode()[0].clamp(-1.0, 1.0).tolist()
            actions = env.tables.rules.actions
            # without squirt
            shot = actions.shot([*action[:1], 0.0, *action[2:]], env.positions, env.on_table, env.on)
            left = shot[3] - line(env.positions, env.on_table, env.on)
            assert abs(sin(left)) < 1e-6 and cos(left) > 0.0
    finally:
        throw.last.weight.copy_(learned)


@torch.no_grad()
def test_throw_turns_the_ghost_ball_round_the_object_ball(model):
    """In the frame of the table, for a turn of the line of centres in proportion to the cut's sine."""

    class Known(torch.nn.Module):
        def forward(self, known):
            return 0.2 * known[..., :1]

    cue, red = np.array((0.1, -0.3)), np.array((0.0, 0.4))
    table = one_red(cue, red)
    found = pots(*table, mask_of([1]), most=POTS)
    throw = mixture_policy.Throw()
    throw.net = Known()
    lines = mixture_policy.lines_of(shown(*table))
    turns = throw(lines, torch.zeros(1, POTS, 3))[0].double().numpy() * pi
    cuts = set()
    for k, (_, pocket, gx, gy, *_) in enumerate(found):
        to_pocket, path = POCKET_AIMS[int(pocket), :2] - red, np.array((gx, gy)) - cue
        d, p = to_pocket / np.hypot(*to_pocket), path / np.hypot(*path)
        sine = p[0] * d[1] - p[1] * d[0]
        turn = THROW_UNIT * 2 * 0.2 * sine
        turned = (cos(turn) * d[0] - sin(turn) * d[1], sin(turn) * d[0] + cos(turn) * d[1])
        ghost = red - 2 * R * np.array(turned) - cue
        expected = atan2(ghost[1], ghost[0]) - atan2(path[1], path[0])
        assert turns[k] == pytest.approx(expected, rel=1e-3, abs=1e-7)
        cuts.add(sine > 0)
    assert len(cuts) == 2 and np.abs(turns).max() > 1e-4 and not turns[len(found) :].any()


@torch.no_grad()
def test_throw_sees_the_stroke_as_it_is_played(model, opened):
    dist = density(model, opened)

    def aims(*stroke):
        return dist.aims_of(torch.tensor(stroke).expand(len(opened), POTS, 3))

    assert torch.equal(aims(3.0, 0.0, 0.0), aims(1.0, 0.0, 0.0))
    assert not torch.equal(aims(0.5, 0.0, 0.0), aims(1.0, 0.0, 0.0))
    assert torch.allclose(aims(0.0, 0.9, 0.9), aims(0.0, 0.5**0.5, 0.5**0.5), atol=1e-7)
    assert not torch.allclose(aims(0.0, 0.5, 0.0), aims(0.0, -0.5, 0.0), atol=1e-5)


@torch.no_grad()
def test_a_mirrored_table_gives_the_mirrored_action(model, opened):
    mirrored = opened[:, :SIZE].clone()
    mirrored[:, : 5 * N_BALLS : 5] *= -1.0
    mirrored = torch.as_tensor(pot_view.with_pots(mirrored.numpy()))
    # the reader also says which half it read, for the spots of yellow and green
    first = model.policy.features_extractor.context[0].weight
    kept = first.clone()
    first[:, -1] = 0.0
    try:
        here, there = density(model, opened), density(model, mirrored)
        assert torch.allclose(here.log_weights, there.log_weights, atol=1e-3)
        turned = here.means * torch.tensor([1.0, -1.0, 1.0])
        assert torch.allclose(turned, there.means, atol=1e-3) and here.means[:, :, 1].abs().max() > 0.05
        aims = nearest_image(1.0 - here.aims_of(here.means) - there.aims_of(turned))
        assert aims[here.log_weights > -20.0].abs().max() < 1e-5
        turns = nearest_image(here.aims_of(here.means) - mixture_policy.lines_of(opened)[:, :, LINE])
        assert turns.abs().max() > 1e-4
        mode = here.mode() * torch.tensor([1.0, -1.0, 1.0, -1.0]) + torch.tensor([0.0, 0.0, 0.0, 1.0])
        assert torch.allclose(mode[:, :3], there.mode()[:, :3], atol=1e-3)
        assert nearest_image(mode[:, 3] - there.mode()[:, 3]).abs().max() < 1e-4
    finally:
        first.copy_(kept)


def to_nearest(positions, on_table, on):
    """Direction from the cue ball to the nearest ball on [rad]."""
    to = positions - positions[0]
    far = np.where(on_table & ((on >> np.arange(N_BALLS)) & 1 == 1), np.hypot(*to.T), np.inf)
    return np.arctan2(*to[far.argmin(), ::-1])


def test_without_a_pot_the_nearest_ball_on_is_struck(model, without_pots):
    table = seen(without_pots)
    dist = density(model, table)
    with torch.no_grad():
        action = dist.sample()
    total = dist.log_prob(action).sum() + dist.entropy().sum() + model.policy.predict_values(table).sum()
    model.policy.zero_grad()
    total.backward()
    assert all(torch.isfinite(p.grad).all() for p in model.policy.parameters() if p.grad is not None)
    assert torch.isfinite(total) and torch.isfinite(action).all()
    assert model.policy.action_net.no_pot.weight.grad.abs().max() > 0.0
    assert model.policy.action_net.pot.weight.grad.abs().max() == 0.0
    for env, aim in zip(without_pots, dist.mode()[:, 3].tolist(), strict=True):
        off = pi * aim - to_nearest(env.positions, env.on_table, env.on)
        assert abs(sin(off)) < 1e-6 and cos(off) > 0.0
    for k in range(3):
        expected = mixture(model, table[k : k + 1], action[k].detach().numpy().astype(float))
        assert dist.log_prob(action)[k].item() == pytest.approx(expected, abs=5e-3)


@torch.no_grad()
def test_the_nearest_ball_that_is_on_is_meant(model):
    """Two reds are on, the second the nearer one, and a nearer blue is not; neither red can be potted."""
    rng, seen_ones, on_table = np.random.default_rng(0), 0, np.isin(np.arange(N_BALLS), (0, 1, 2, 19))
    while seen_ones < 5:
        positions = np.zeros((N_BALLS, 2))
        positions[on_table] = rng.uniform((-0.85, -1.75), (0.85, 1.75), (4, 2))
        far = np.hypot(*(positions - positions[0]).T)
        if not far[19] < far[2] < far[1] or len(pots(positions, on_table, mask_of([1, 2]))):
            continue
        aim = density(model, shown(positions, on_table)).mode()[0, 3].item()
        off = pi * aim - to_nearest(positions, on_table, mask_of([1, 2]))
        assert abs(sin(off)) < 1e-5 and cos(off) > 0.0
        seen_ones += 1


def test_pots_that_are_not_there_are_never_played(model):
    table = shown(*one_red((0.5, 0.0), (-0.4, 0.0)))
    there = mixture_policy.lines_of(table)[0, :, OFFERED] > 0.0
    assert 0 < there.sum() < POTS
    weights = parameters(model, table)[0]
    assert (weights[there.numpy()] > 0.0).all() and not weights[~there.numpy()].any()
    assert torch.isfinite(mixture_policy.lines_of(table)).all()
    assert mixture_policy.lines_of(table)[0, :, TOLERANCE].min() > 0.0


def test_learn_save_load_predict(model, opened, tmp_path):
    fresh = hyperparameters.Recipe.of("ppo_absolute", ["n_steps=8", "batch_size=8"])
    learner = fresh.new_model(training_tables(2, threads=1, **fresh.env_kwargs), seed=0)
    assert type(learner.policy) is AbsolutePolicy
    assert learner.policy.log_std[3].exp().item() == pytest.approx(fresh.first_aim_std)
    before = {name: p.detach().clone() for name, p in learner.policy.named_parameters()}
    learner.learn(16)
    moved = {name for name, p in learner.policy.named_parameters() if not torch.equal(p, before[name])}
    parts = {name.split(".")[0] for name in moved}
    assert parts == {"features_extractor", "action_net", "value_net", "log_std"}
    assert "action_net.throw.last.weight" in moved
    assert all(torch.isfinite(p).all() for p in learner.policy.parameters())
    for made in (learner, model):
        made.save(tmp_path / "model.zip")
        loaded = PPO.load(tmp_path / "model.zip", device="cpu")
        actions, _ = made.predict(opened.numpy(), deterministic=True)
        assert np.array_equal(loaded.predict(opened.numpy(), deterministic=True)[0], actions)
        assert all(made.action_space.contains(a) for a in actions)
        one, _ = made.predict(opened[0].numpy(), deterministic=True)
        assert one == pytest.approx(actions[0], abs=1e-4)
