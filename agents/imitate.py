"""Can an agent start from what the search knows? Teach a masked policy what the search finds one shot deep; PPO goes on from there.

    python -m agents.imitate --agent ppo_foresight --out runs/imitated
    python train.py --agent ppo_foresight --start runs/imitated

The teacher: in positions of real visits some of the choices are played on copies of the table under execution noise, once each. A choice
is worth its points and, if the visit goes on, the value by hand of the position it leaves (``lookahead.prospects``), the search's own
measure. The pupil: state value + TEMPERATURE * (log-probability - its mean) is fitted to these worths by least squares, all tries of a
position at once. So the policy becomes the softmax of what its choices are worth, and the critic their mean under it. The visits are
played by the pupil, so it is taught where it will be (DAgger, Ross et al. 2011), and half of the tries are its own best.
"""

import argparse
import json
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from snooker_env._check import refuse
from snooker_env.envs.choices import POTS

from .lookahead import BY_HAND, Copies, Position, prospects, spread_of
from .recipes import Recipe
from .view import training_tables

TABLES = 128
TRIES = 64
"""Choices tried in each position."""
TEMPERATURE = 1.0
"""Points that make a choice e times as likely."""
KEPT = 400
"""Rounds of positions that are learned from again and again: some 50,000 positions."""
UPDATES, BATCH = 4, 8
"""Gradient steps a round, and rounds in the batch of each."""
EXPLORE = 0.1
"""Share of random strokes in the visits."""
RATE = 1e-3


class Teacher:
    """Says what choices are worth on the tables of a ``SnookerVecEnv``."""

    def __init__(self, tables, threads, rng):
        self._tables, self._rng, rules = tables, rng, tables.visits.rules
        self._copies = [Copies(rules, rules.shooter.noise) for _ in range(threads)]
        self._spread = spread_of(rules.shooter.noise, rules.shooter.physics)
        self._pool = ThreadPoolExecutor(threads)

    def worth(self, picks):
        """Points that the choices ``picks`` (n, k) brought, one try of each, with the value of what they left: float32 (n, k)."""
        v, (n, k) = self._tables.visits, picks.shape
        at = Position(v.positions, v.on_table, v.game)
        rows, keys = np.repeat(np.arange(n), k), self._rng.integers(0, 2**63, n * k, dtype=np.uint64)
        parts = np.array_split(np.arange(n * k), len(self._copies))
        worths = self._pool.map(lambda c, p: self._worth(c, at, rows[p], picks.ravel()[p], keys[p]), self._copies, parts)
        return np.concatenate(list(worths)).reshape(n, k)

    def _worth(self, copies, at, rows, picks, keys):
        points, goes_on, left, _ = copies.play(at, rows, picks, keys)
        values, chances = np.empty(len(rows)), np.empty((len(rows), POTS))
        prospects(left.positions, left.on_table, left.game, self._spread, BY_HAND, values, chances)
        return (points + goes_on * values).astype(np.float32)


def to_try(scores, masks, rng):
    """``TRIES`` choices of each row of masks (n, SIZE), half with the highest scores, half at random; and which of them are there."""
    half = TRIES // 2
    best = np.argpartition(np.where(masks, -scores, np.inf), half, axis=1)[:, :half]
    any_of = np.argpartition(np.where(masks, rng.random(masks.shape), np.inf), TRIES - half, axis=1)[:, : TRIES - half]
    picks = np.concatenate([best, any_of], axis=1)
    return picks, np.take_along_axis(masks, picks, axis=1)


def teach(model, venv, states, seed, threads, say=lambda *_: None):
    """Teach ``model.policy`` on that many positions; returns the curve, a dict for each twentieth of them."""
    import torch

    rng, tables, policy = np.random.default_rng(seed), venv.unwrapped.tables, model.policy
    teacher, optimizer = Teacher(tables, threads, rng), torch.optim.Adam(policy.parameters(), RATE)
    venv.seed(seed)
    seen, kept, curve, done, losses, began = venv.reset(), [], [], 0, [], time.perf_counter()
    while done < states:
        for group in optimizer.param_groups:
            group["lr"] = RATE * (1.0 - done / states) + 1e-5
        masks = np.array(venv.env_method("action_masks"))
        with torch.no_grad():
            scores = policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.numpy()
        picks, there = to_try(scores, masks, rng)
        kept.append((seen, masks, picks, there, teacher.worth(picks)))
        del kept[:-KEPT]
        for _ in range(UPDATES if len(kept) >= BATCH else 0):
            losses.append(_fit(model, optimizer, [kept[i] for i in rng.integers(len(kept), size=BATCH)]))
        own = np.where(masks, scores, -np.inf).argmax(1)
        strange = rng.random(len(own)) < EXPLORE
        own[strange] = picks[:, -1][strange]
        own = np.where(masks[np.arange(len(own)), own], own, masks.argmax(1))
        seen, _, _, _ = venv.step(own)
        done += len(own)
        if done * 20 // states > len(curve) and losses:
            seconds = time.perf_counter() - began
            curve.append({"states": done, "seconds": round(seconds, 1), "loss": round(float(np.mean(losses[-200:])), 3)})
            say(curve[-1])
    return curve


def _fit(model, optimizer, rounds):
    """One gradient step; the mean square error [points^2]."""
    import torch

    seen, masks, picks, there, worths = (np.concatenate(column) for column in zip(*rounds, strict=True))
    policy = model.policy
    features = policy.extract_features(torch.as_tensor(seen))
    distribution = policy._get_action_dist_from_latent(features)
    distribution.apply_masking(masks)
    logits = distribution.distribution.logits
    mean = (logits.exp() * logits.clamp(min=-1e3)).sum(1, keepdim=True)
    fitted = policy.value_net(features) + TEMPERATURE * (logits.gather(1, torch.as_tensor(picks)) - mean)
    weight = torch.as_tensor(there).float()
    loss = ((fitted - torch.as_tensor(worths)).square() * weight).sum() / weight.sum()
    optimizer.zero_grad()
    loss.backward()
    torch.nn.utils.clip_grad_norm_(policy.parameters(), 10.0)
    optimizer.step()
    return loss.item()


def main():
    """Command line."""
    import torch

    from .recipes import write_model

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--agent", default="ppo_foresight", help="a recipe with masks: ppo_mask or ppo_foresight")
    parser.add_argument("--states", type=int, default=30_000, help="positions to teach")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2, help="for the simulation")
    parser.add_argument("--out", type=Path, required=True, help="folder for model.zip and imitation.json")
    options = parser.parse_args()
    recipe = Recipe.of(options.agent)
    if recipe.algo != "ppo_mask":
        raise refuse("agent", options.agent, "must have masks: ppo_mask or ppo_foresight")
    torch.set_num_threads(1)
    torch.distributions.Distribution.set_default_validate_args(False)
    venv = training_tables(TABLES, threads=options.threads, view=recipe.view, **recipe.env_kwargs)
    model = recipe.new_model(venv, options.seed)
    curve = teach(model, venv, options.states, options.seed, options.threads, lambda row: print(json.dumps(row), flush=True))
    options.out.mkdir(parents=True, exist_ok=True)
    write_model(model, options.out / "model.zip")
    told = {"agent": options.agent, "states": options.states, "tries": TRIES, "seed": options.seed, "curve": curve}
    (options.out / "imitation.json").write_text(json.dumps(told, indent=1) + "\n")


if __name__ == "__main__":
    main()
