"""Is the PPO of one file right, and does it learn? Its advantages, masks and file, and a short run."""

import gymnasium
import numpy as np
import pytest
import torch

from agents.evaluation.visit_figures import summary
from agents.players.trained import load_player
from examples import ppo_single_file as example
from snooker_env.benchmark import play_visits


def test_advantages_are_those_of_the_definition():
    """Sums of discounted errors up to the end of the visit, with nothing from beyond it."""
    torch.manual_seed(0)
    rewards, values, last = torch.rand(7, 3), torch.rand(7, 3), torch.rand(3)
    ends = torch.zeros(7, 3)
    ends[2, 0] = ends[6, 1] = ends[0, 2] = ends[1, 2] = 1.0
    advantages = example.advantages_of(rewards, values, ends, last)
    after = torch.cat([values[1:], last[None]])
    for k in range(3):
        for t in range(7):
            want, weight = 0.0, 1.0
            for s in range(t, 7):
                going = 1.0 - ends[s, k].item()
                want += weight * (rewards[s, k] + example.GAMMA * going * after[s, k] - values[s, k]).item()
                weight *= example.GAMMA * example.LAMBDA
                if not going:
                    break
            assert advantages[t, k].item() == pytest.approx(want, abs=1e-5)


def test_masked_choices_are_never_drawn_and_cost_nothing():
    torch.manual_seed(0)
    agent = example.Agent(121, 540)
    masks = torch.rand(64, 540) < 0.02
    masks[:, 7] = True
    masks[0] = torch.arange(540) == 7
    rows = torch.rand(64, 121, requires_grad=True)
    policy = agent.policy(rows, masks)
    drawn = policy.sample((50,))
    assert masks.expand(50, 64, 540).gather(2, drawn[..., None]).all()
    assert policy.probs[~masks].max() == 0.0 and torch.isfinite(policy.entropy()).all()
    assert policy.entropy()[0] == 0.0
    (policy.entropy().sum() + policy.log_prob(drawn[0]).sum()).backward()
    assert torch.isfinite(rows.grad).all()
    assert all(torch.isfinite(p.grad).all() for p in agent.actor.parameters())
    none = agent.policy(rows, torch.zeros(64, 540, dtype=torch.bool))
    assert torch.isfinite(none.entropy()).all() and torch.isfinite(none.log_prob(none.sample())).all()


def trained(steps, folder):
    """What the command returns, points a visit at its end, and the player of its file."""
    before = torch.random.get_rng_state(), torch.get_num_threads()
    points = example.main(["--steps", str(steps), "--seed", "1", "--out", str(folder / "p.npz")])
    torch.random.set_rng_state(before[0]), torch.set_num_threads(before[1])
    return points, load_player(folder / "p.npz")


@pytest.mark.slow
def test_it_learns(tmp_path, capsys):
    points, player = trained(57_344, tmp_path)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 7 and points > 1.7 * float(lines[0].partition(" shots, ")[2].partition(" ")[0])
    assert summary(play_visits(player, 200))["points_a_visit"] > 3.3  # after 8,192 shots: 2.4


@pytest.fixture
def played(monkeypatch):
    """Rewards and ends of all steps of tables that are made now."""
    made, make_vec = [], gymnasium.make_vec

    def watched(*args, **options):
        envs = make_vec(*args, **options)
        step = envs.step

        def kept(actions):
            given = step(actions)
            made.append((given[1].copy(), given[2] | given[3]))
            return given

        envs.step = kept
        return envs

    monkeypatch.setattr(gymnasium, "make_vec", watched)
    before = torch.random.get_rng_state(), torch.get_num_threads()
    yield made
    torch.random.set_rng_state(before[0]), torch.set_num_threads(before[1])


def returns_of(played):
    """What each visit that ended brought, counted table by table."""
    returns = []
    for k in range(len(played[0][0])):
        begun = 0
        for t, (_, ends) in enumerate(played):
            if ends[k]:
                returns.append(sum(rewards[k] for rewards, _ in played[begun : t + 1]))
                begun = t + 1
    return returns


def test_the_returns_that_it_prints_are_those_of_whole_visits(tmp_path, capsys, monkeypatch, played):
    """Every reward of a visit counts, the first one too."""
    monkeypatch.setattr(example, "STEPS", 16)
    points, _ = trained(1024, tmp_path)
    returns = returns_of(played)
    assert len(played) == 16 and 300 < len(returns) < 1000
    assert points == pytest.approx(np.mean(returns))
    assert f", {np.mean(returns):.2f} points a visit" in capsys.readouterr().out
