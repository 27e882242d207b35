"""How is a policy pre-trained by imitation? It is fitted to the search's one-shot values; then PPO goes on.

``train.py`` does this for the recipes with ``imitation``, or with ``--imitate POSITIONS``.

The expert: some choices in positions of played visits are simulated under execution noise, once each. A choice
is worth its points plus, if the visit goes on, what it leaves by the search's rule of thumb (``prospects_of``).

The learner: state value + TEMPERATURE * (log-probability - its mean) is fitted to these values by least
squares. The policy becomes the softmax of the values of its choices, and the critic their mean under it. The
visits are played by the learner, so that it is trained on the states that it will meet (DAgger, Ross et al.
2011); half of the trials are its own best choices.
"""

import time
import uuid
from collections import deque

import numpy as np
import torch

from snooker_env.benchmark import simulated
from snooker_env.planning import Positions, spread_of

from ..cluster.job import Here
from .hyperparameters import SHOT_OPTIONS
from .self_play import judged

TRIES = 48
"""Trials in each position: half the learner's best choices, half random; if they are few, each twice."""
TEMPERATURE = 1.0
"""The difference in points that makes a choice e times as likely."""
KEPT = 50_000
"""Size of the buffer of positions that gradient steps are drawn from."""
BATCH, PER_UPDATE = 512, 8
"""Positions in the batch of a gradient step, and new positions for each step."""
RATE = 3e-3
USED = ("action", "aim", "elevation", "placement", *SHOT_OPTIONS)
"""Options of the tables that decide what a choice is worth."""


class Expert:
    """Evaluates choices on a ``SnookerVectorEnv``; ``ahead``: and what they leave; ``where``: who plays."""

    def __init__(self, tables, threads, rng, ahead=True, where=None):
        self._tables, self._rng, self._where = tables, rng, where or Here(threads)
        rules, options = tables.options.rules, {name: getattr(tables.options, name) for name in USED}
        self._sent = {"run": uuid.uuid4().hex, "options": options, "ahead": ahead}
        self._sent["spread"] = spread_of(rules.noise, rules.physics)
        self.shots = 0
        """Simulated so far."""

    def worth(self, picks, valid):
        """Values [points] of the ``valid`` choices among ``picks`` (n, k), each simulated once; else 0."""
        row, column = np.nonzero(valid)
        keys = self._rng.integers(0, 2**63, len(row), dtype=np.uint64)
        worth, at = np.zeros(picks.shape, np.float32), Positions.of(self._tables)
        chosen = row, picks[row, column], keys
        worth[row, column], shots = judged(self._where, self._sent, at, *chosen, task="trials", of="worth")
        self.shots += shots
        return worth


def to_try(scores, masks, rng):
    """``TRIES`` choices of each row of masks (n, SIZE), half the best, half random; which are valid.

    A choice can be in both halves; of fewer valid choices than half of ``TRIES``, all are in both.
    """
    half = TRIES // 2
    best = np.argpartition(np.where(masks, -scores, np.inf), half, axis=1)[:, :half]
    lots, rest = np.where(masks, rng.random(masks.shape), np.inf), TRIES - half
    picks = np.concatenate([best, np.argpartition(lots, rest, axis=1)[:, :rest]], axis=1)
    return picks, np.take_along_axis(masks, picks, axis=1)


class Imitation:
    """Imitation in ``states`` positions of visits that ``model.policy`` plays; for gamma = 0 only points count.

    ``before``: of ``get_state``, model and tables restored: the result is an uninterrupted run's, bit for bit.
    """

    def __init__(self, model, venv, states, seed, threads, before=None, where=None):
        self._model, self._venv, self.states, self._rng = model, venv, states, np.random.default_rng(seed)
        self._expert = Expert(venv.unwrapped.tables, threads, self._rng, model.gamma > 0, where)
        self._optimizer = torch.optim.Adam(model.policy.parameters(), RATE)
        self.done, self.curve, self._kept, self._losses, self._seconds = 0, [], [], deque(maxlen=200), 0.0
        self._points = deque(maxlen=1000)
        if before is None:
            venv.seed(seed)
        else:
            self._rng.bit_generator.state = before["rng"]
            self._optimizer.load_state_dict(before["optimizer"])
            self.done, self.curve = before["done"], before["curve"]
            self._kept, self._seconds = before["kept"], before["seconds"]
            self._losses.extend(before["losses"])
            self._expert.shots = before["shots"]
        self._seen = venv.reset()
        self._began = time.perf_counter()

    @property
    def seconds(self):
        """Duration of the imitation so far [s]."""
        return self._seconds + time.perf_counter() - self._began

    def get_state(self):
        """The state beside model, tables and random generators; most of it is the buffer of positions."""
        made = {name: getattr(self, name) for name in ("done", "curve", "seconds")}
        made |= {"kept": self._kept, "losses": list(self._losses), "rng": self._rng.bit_generator.state}
        return made | {"optimizer": self._optimizer.state_dict(), "shots": self._expert.shots}

    @property
    def figures(self):
        """Round, mean loss of the last gradient steps and points of the last visits, in words."""
        words = [round_of(self.done, self.states, self._venv.num_envs)]
        words += [f"loss {np.mean(self._losses):.1f}"] if self._losses else []
        words += [f"{np.mean(self._points):.2f} points a visit"] if self._points else []
        return ", ".join(words)

    def round(self):
        """Learn from every table's position and play on; each twentieth of all is an entry of ``curve``."""
        policy, n = self._model.policy, self._venv.num_envs
        for group in self._optimizer.param_groups:
            group["lr"] = RATE * (1.0 - self.done / self.states) + 1e-5
        masks = np.array(self._venv.env_method("action_masks"))
        with torch.no_grad():
            scores = policy.get_distribution(torch.as_tensor(self._seen), masks).distribution.logits.numpy()
        picks, valid = to_try(scores, masks, self._rng)
        self._kept.append((self._seen, masks, picks, valid, self._expert.worth(picks, valid)))
        del self._kept[: -max(1, KEPT // n)]
        for _ in range(max(1, n // PER_UPDATE)):
            rounds = self._rng.integers(len(self._kept), size=max(1, BATCH // n))
            batch = (np.concatenate(column) for column in zip(*(self._kept[i] for i in rounds), strict=True))
            self._losses.append(fit_values(policy, self._optimizer, *batch))
        before = simulated()
        self._seen, _, _, infos = self._venv.step(np.where(masks, scores, -np.inf).argmax(1))
        self._expert.shots += simulated() - before
        self._points.extend(info["episode"]["r"] for info in infos if "episode" in info)
        self.done += n
        if self.done * 20 // self.states > len(self.curve):
            loss = round(float(np.mean(self._losses)), 3)
            so_far = {"states": self.done, "simulated_shots": self._expert.shots}
            self.curve.append({**so_far, "seconds": round(self.seconds, 1), "loss": loss})


def round_of(done, total, n):
    """The round in progress in words: n positions a round."""
    return f"round {-(-done // n):,} of {-(-total // n):,}"


def fit_values(policy, optimizer, seen, masks, picks, valid, worths):
    """One gradient step towards the values ``worths`` of choices (n, k); the mean square error [points^2]."""
    features = policy.extract_features(torch.as_tensor(seen))
    distribution = policy._get_action_dist_from_latent(features)
    distribution.apply_masking(masks)
    logits = distribution.distribution.logits
    mean = (logits.exp() * logits.clamp(min=-1e3)).sum(1, keepdim=True)
    fitted = policy.value_net(features) + TEMPERATURE * (logits.gather(1, torch.as_tensor(picks)) - mean)
    weight = torch.as_tensor(valid).float()
    loss = ((fitted - torch.as_tensor(worths)).square() * weight).sum() / weight.sum()
    optimizer.zero_grad()
    loss.backward()
    torch.nn.utils.clip_grad_norm_([p for group in optimizer.param_groups for p in group["params"]], 10.0)
    optimizer.step()
    return loss.item()
