"""Do the fused passes compute the network's own values, probabilities and gradients, and draw by them?

The bounds: results of both are float32, sums over at most 540 terms in another order. Values and logarithms
of probabilities are at most about 10, so they may differ by some 10 * 540 ** 0.5 * 6e-8 = 1.4e-5; a gradient,
relative to its largest entry, by about 1e-4, as terms of the entropy's gradient cancel. A forgotten term,
factor or mirror changes them by more than 1e-2."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import torch
from gymnasium import spaces

from agents.learning import fused
from agents.learning.fused import Loss, Rollout
from agents.learning.networks import JudgedPolicy, TablePolicy
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.planning.learned import stroke_policy
from snooker_env.planning.learned.stroke_policy import BALL_X, SHOWN, with_pots
from snooker_env.tasks import CHOICES, OBSERVATION_SIZE

N = fused.BLOCK + 45
LOSS = CLIP, ENTROPY, VALUE = Loss(0.2, 0.01, 0.05)


@pytest.fixture(scope="module")
def met():
    """Tables met in play (N, SHOWN), some without a pot, one bare; and masks, some with choices left out."""
    tables = SnookerVectorEnv(N, action="discrete", observation="flat", layout="random:6", threads=1)
    observations, _ = tables.reset(seed=3)
    rng = np.random.default_rng(0)
    for _ in range(2):
        choices = [rng.choice(np.flatnonzero(mask)) for mask in tables.action_masks()]
        observations, *_ = tables.step(np.array(choices))
    seen, masks = with_pots(observations), tables.action_masks()
    masks[::3] &= rng.random((len(masks[::3]), CHOICES)) < 0.5
    masks[:, 7] = True
    seen[5, :110].reshape(22, 5)[1:, :3] = 0.0  # the cue ball alone
    seen[5, OBSERVATION_SIZE:] = 0.0
    assert (seen[:, BALL_X] < 0).sum() > 50 < (seen[:, BALL_X] > 0).sum()
    assert (seen[:, OBSERVATION_SIZE] == 0).sum() > 3
    return seen, masks


@pytest.fixture(params=[TablePolicy, JudgedPolicy])
def policy(request):
    torch.manual_seed(0)
    actions = SnookerVectorEnv(1, action="discrete").single_action_space
    made = request.param(spaces.Box(-1.0, 1.0, (SHOWN,), np.float32), actions, lambda _: 1e-3)
    with torch.no_grad():
        made.action_net.score.weight.mul_(10.0)  # so that choices differ as in a trained network
    return made


def plain(policy, seen, masks, choices):
    """Values, logarithms of probabilities and entropies by PyTorch."""
    values, logs, entropy = policy.evaluate_actions(*map(torch.as_tensor, (seen, choices, masks)))
    return values[:, 0], logs, entropy


def scored(policy, seen, masks):
    """Logarithms of all choices' probabilities by PyTorch, whose gradients keep the quick passes out."""
    return policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.detach().numpy()


def test_scores_are_those_of_the_network(policy, met):
    """Also through the distribution, from which a model plays; on tables read mirrored and not."""
    seen, masks = met
    expected, found = scored(policy, seen, masks), policy.fused.scores(seen, masks)
    assert np.array_equal(found == stroke_policy.NEVER, ~masks) and found.shape == (N, CHOICES)
    shifted = np.where(masks, found - expected, np.nan)
    apart = np.abs(shifted - np.nanmean(shifted, axis=1, keepdims=True))
    assert np.nanmax(apart) < 1.4e-5 < np.where(masks, found, 0.0).std()
    with torch.no_grad():
        quick = scored(policy, seen, masks)
    assert np.abs(np.where(masks, quick - expected, 0.0)).max() < 1.4e-5
    assert not np.array_equal(quick, expected)
    for rows in (slice(0, 1), slice(0, N, 2)):
        actions = policy.predict(seen[rows], action_masks=masks[rows], deterministic=True)[0]
        assert np.array_equal(actions, found[rows].argmax(axis=1))


def test_a_tables_scores_do_not_depend_on_the_tables_beside_it(policy, met):
    """Bit for bit: alone, in any order, in blocks, and by several threads at once."""
    seen, masks = met
    together = policy.fused.scores(seen, masks)
    for k in range(0, N, 7):
        one = slice(k, k + 1)
        assert np.array_equal(policy.fused.scores(seen[one], masks[one]), together[one])
    order = np.random.default_rng(6).permutation(N)
    assert np.array_equal(policy.fused.scores(seen[order], masks[order]), together[order])
    parts = [np.sort(part) for part in np.array_split(order, 8)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda rows: policy.fused.scores(seen[rows], masks[rows]), parts * 5))
    assert all(np.array_equal(one, together[rows]) for one, rows in zip(found, parts * 5, strict=True))


def test_choices_are_drawn_by_their_probabilities(policy, met):
    """By inversion: of m evenly spaced numbers each choice gets its share, to within one."""
    m = 2000
    for k in (np.flatnonzero(met[0][:, BALL_X] < 0)[0], np.flatnonzero(met[0][:, BALL_X] > 0)[0]):
        seen, masks = np.repeat(met[0][k : k + 1], m, 0), np.repeat(met[1][k : k + 1], m, 0)
        choices, _, _ = policy.fused.act(seen, masks, (np.arange(m) + 0.5) / m)
        shares = np.exp(scored(policy, seen[:1], masks[:1]))[0]
        assert np.abs(np.bincount(choices, minlength=CHOICES) - m * shares).max() < 1.01
        assert shares.max() > 3 / m


def test_a_rollout_draws_by_the_fused_pass(policy, met):
    seen, masks = met
    torch.manual_seed(4)
    with torch.no_grad():
        choices, values, logs = policy(torch.as_tensor(seen), action_masks=masks)
    torch.manual_seed(4)
    expected = policy.fused.act(seen, masks, torch.rand(N).numpy())
    assert choices.shape == logs.shape == (N,) and values.shape == (N, 1)
    for a, b in zip((choices, values[:, 0], logs), expected, strict=True):
        assert np.array_equal(a.numpy(), b)


def test_the_gradient_is_pytorchs_own(policy, met):
    """On more rows than a block, in any order; of everything that PPO learns and nothing else."""
    seen, masks = met
    rng = np.random.default_rng(2)
    choices, values, logs = policy.fused.act(seen, masks, rng.random(N))
    advantages = rng.normal(size=N).astype(np.float32)
    returns = (values + rng.normal(size=N)).astype(np.float32)
    before = (logs + 0.3 * rng.normal(size=N)).astype(np.float32)
    rows = rng.permutation(N)[: N - 7]
    policy.zero_grad()
    policy.fused.zero_grad()
    rollout = Rollout(seen, masks, choices, before, advantages, returns)
    figures = policy.fused.ppo_gradient(rows, rollout, LOSS)
    own = {name: p.grad.clone() for name, p in policy.named_parameters() if p.grad is not None}
    learned = {name for name, _ in policy.named_parameters() if not name.startswith("position_value.")}
    assert own.keys() == learned and policy.fused.gradient.numel() == sum(g.numel() for g in own.values())

    policy.zero_grad()
    values, logs, entropy = plain(policy, seen[rows], masks[rows], choices[rows])
    advantage, change = torch.as_tensor(advantages[rows]), logs - torch.as_tensor(before[rows])
    ratio = change.exp()
    policy_loss = -torch.min(advantage * ratio, advantage * ratio.clamp(1 - CLIP, 1 + CLIP)).mean()
    value_loss = (values - torch.as_tensor(returns[rows])).square().mean()
    (policy_loss - ENTROPY * entropy.mean() + VALUE * value_loss).backward()
    for name, p in policy.named_parameters():
        if name in own:
            assert (own[name] - p.grad).abs().max() < 1e-4 * p.grad.abs().max(), name
    clipped = ((ratio - 1.0).abs() > CLIP).float().mean()
    expected = [policy_loss, value_loss, entropy.mean(), clipped, (ratio - 1.0 - change).mean()]
    assert np.allclose(figures, [x.item() for x in expected], rtol=1e-4, atol=1e-6) and 0.2 < clipped < 0.9


def test_copies_and_new_weights_have_passes_of_their_own(policy, met):
    """After passes were made: a copy, a pickle, and weights that were put in place of others."""
    seen, masks = met
    draws = np.random.default_rng(1).random(N).astype(np.float32)
    want = policy.fused.act(seen, masks, draws)[1]
    for other in (copy.deepcopy(policy), pickle.loads(pickle.dumps(policy))):
        assert np.array_equal(other.fused.act(seen, masks, draws)[1], want)
    for assign in (False, True):
        other = copy.deepcopy(policy)
        other.fused.act(seen, masks, draws)
        halves = {name: 0.5 * part for name, part in policy.state_dict().items()}
        other.load_state_dict(halves, assign=assign)
        with torch.no_grad():
            values = other.predict_values(torch.as_tensor(seen)).numpy()[:, 0]
        assert np.abs(other.fused.act(seen, masks, draws)[1] - values).max() < 1.4e-5
        assert np.abs(values - want).max() > 1e-2
