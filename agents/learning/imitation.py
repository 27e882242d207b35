"""Can an agent start from what the search knows? A masked policy imitates what the search finds one shot deep; PPO goes on from there.

``train.py`` does it for the recipes that say so (``imitation``), or with ``--imitate POSITIONS``.

The expert: in positions of real visits some of the choices are played on copies of the table under execution noise, once each. A choice is
worth its points and, if the visit goes on, the value, by the rule of thumb, of the position it leaves (``prospects_of``), the search's own
measure. The learner: state value + TEMPERATURE * (log-probability - its mean) is fitted to these worths by least squares, all tries of a
position at once. So the policy becomes the softmax of what its choices are worth, and the critic their mean under it. The visits are
played by the learner, so it learns where it will be (DAgger, Ross et al. 2011), and half of the tries are its own best.
"""

import time
from collections import deque

import numpy as np
import torch

from snooker_env.planning import Planner, prospects_of, spread_of

TRIES = 48
"""Choices tried in each position: half of them the learner's best, half at random. Where there are no more than half of them, each is tried
twice."""
TEMPERATURE = 1.0
"""Points that make a choice e times as likely."""
KEPT = 50_000
"""Positions that are learned from again and again."""
BATCH, PER_UPDATE = 512, 8
"""Positions in the batch of a gradient step, and new positions for each step."""
RATE = 3e-3


class Expert:
    """Says what choices are worth on the tables of a ``SnookerVectorEnv``; ``ahead``: with the value of the position left."""

    def __init__(self, tables, threads, rng, ahead=True):
        self._tables, self._rng, self._ahead, self._planner = tables, rng, ahead, Planner(tables, threads=threads)
        self._spread = spread_of(self._planner.noise, self._planner.physics)

    def worth(self, picks, there):
        """Points that the choices ``picks`` (n, k) that are ``there`` (n, k) brought, one try of each, with the value of what they left.

        float32 (n, k), 0 where there is none.
        """
        row, column = np.nonzero(there)
        keys = self._rng.integers(0, 2**63, len(row), dtype=np.uint64)
        points, goes_on, left, _ = self._planner.play(self._tables, row, picks[row, column], keys)
        worth = np.zeros(picks.shape, np.float32)
        worth[row, column] = points + self._ahead * goes_on * prospects_of(left, self._spread, threads=self._planner.threads)[0]
        return worth


def to_try(scores, masks, rng):
    """``TRIES`` choices of each row of masks (n, SIZE), half with the highest scores, half at random; and which of them are there.

    A choice can be in both halves; where there are fewer choices than a half holds, all of them are in both.
    """
    half = TRIES // 2
    best = np.argpartition(np.where(masks, -scores, np.inf), half, axis=1)[:, :half]
    any_of = np.argpartition(np.where(masks, rng.random(masks.shape), np.inf), TRIES - half, axis=1)[:, : TRIES - half]
    picks = np.concatenate([best, any_of], axis=1)
    return picks, np.take_along_axis(masks, picks, axis=1)


class Imitation:
    """The imitation in that many ``states``, positions of visits that ``model.policy`` plays itself; with gamma 0 only points count.

    ``before``: of ``get_state``, when the model and its tables are as they were then: it goes on bit for bit as if it had not stopped.
    """

    def __init__(self, model, venv, states, seed, threads, before=None):
        self._model, self._venv, self.states, self._rng = model, venv, states, np.random.default_rng(seed)
        self._expert = Expert(venv.unwrapped.tables, threads, self._rng, ahead=model.gamma > 0)
        self._optimizer = torch.optim.Adam(model.policy.parameters(), RATE)
        self.done, self.curve, self._kept, self._losses, self._seconds = 0, [], [], deque(maxlen=200), 0.0
        if before is None:
            venv.seed(seed)
        else:
            self._rng.bit_generator.state = before["rng"]
            self._optimizer.load_state_dict(before["optimizer"])
            self.done, self.curve, self._kept, self._seconds = (before[name] for name in ("done", "curve", "kept", "seconds"))
            self._losses.extend(before["losses"])
        self._seen = venv.reset()
        self._began = time.perf_counter()

    @property
    def seconds(self):
        """Time of imitation so far."""
        return self._seconds + time.perf_counter() - self._began

    def get_state(self):
        """What the rest depends on, beside the model, its tables and its random generators; the positions kept are most of it."""
        return {
            "done": self.done, "curve": self.curve, "kept": self._kept, "losses": list(self._losses), "seconds": self.seconds,
            "rng": self._rng.bit_generator.state, "optimizer": self._optimizer.state_dict(),
        }  # fmt: skip

    def round(self):
        """The present position of every table; a twentieth of all makes an entry of ``curve``."""
        policy, n = self._model.policy, self._venv.num_envs
        for group in self._optimizer.param_groups:
            group["lr"] = RATE * (1.0 - self.done / self.states) + 1e-5
        masks = np.array(self._venv.env_method("action_masks"))
        with torch.no_grad():
            scores = policy.get_distribution(torch.as_tensor(self._seen), masks).distribution.logits.numpy()
        picks, there = to_try(scores, masks, self._rng)
        self._kept.append((self._seen, masks, picks, there, self._expert.worth(picks, there)))
        del self._kept[: -max(1, KEPT // n)]
        for _ in range(max(1, n // PER_UPDATE)):
            rounds = self._rng.integers(len(self._kept), size=max(1, BATCH // n))
            self._losses.append(_fit(policy, self._optimizer, [self._kept[i] for i in rounds]))
        self._seen, _, _, _ = self._venv.step(np.where(masks, scores, -np.inf).argmax(1))
        self.done += n
        if self.done * 20 // self.states > len(self.curve):
            loss = float(np.mean(self._losses))
            self.curve.append({"states": self.done, "seconds": round(self.seconds, 1), "loss": round(loss, 3)})


def _fit(policy, optimizer, rounds):
    """One gradient step; the mean square error [points^2]."""
    seen, masks, picks, there, worths = (np.concatenate(column) for column in zip(*rounds, strict=True))
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
