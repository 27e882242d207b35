"""How does a policy learn the values of choices? It is fitted to some choices in each position, simulated once and judged.

A choice is worth its points and, if the visit continues, the value of the position it leaves. State value + TEMPERATURE *
(log-probability - its mean) is fitted to this worth by least squares. The policy thus becomes the softmax of the values of
its choices, and the critic their mean under it. Half of the choices tried are its own best ones (DAgger, Ross et al. 2011).
"""

from collections import deque

import numpy as np
import torch

from snooker_env import Options
from snooker_env.benchmark import count_shots
from snooker_env.planning import Planner, action_masks
from snooker_env.planning.learned.stroke_policy import with_pots

TRIES = 48
"""Trials in each position: half the learner's best choices, half random; each twice if there are few."""
TEMPERATURE = 1.0
"""The difference in points that makes a choice e times as likely."""
KEPT = 50_000
"""Positions that gradient steps are drawn from."""
BATCH, EACH, RATE = 512, 32, 2e-3
"""Positions per batch, new positions per gradient step, and the first learning rate."""
_PARTS = 4
"""Rounds that a batch is drawn from."""


class JudgedChoices:
    """Fits ``policy`` to values of choices in rounds of n positions. ``shots`` counts those simulated so far."""

    def __init__(self, policy, options, threads, n, rng):
        self._policy, self._rng, self._n = policy, rng, n
        self._planner = Planner(Options(action="discrete", **options), threads=threads)
        learned = [p for name, p in policy.named_parameters() if not name.startswith("position_value.")]
        self._optimizer, self._rounds = torch.optim.Adam(learned, RATE), []
        self.losses, self.shots = deque(maxlen=100), 0

    def round(self, at, value, remaining):
        """Try choices in ``Positions``, judge the resulting positions by ``value``, and learn. ``remaining``: share of training left."""
        seen, masks = with_pots(at.observations()), action_masks(at, rails=self._planner.rules.rails)
        with torch.no_grad():
            scores = self._policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.numpy()
        picks, valid = to_try(scores, masks, self._rng)
        row, column = np.nonzero(valid)
        keys = self._rng.integers(0, 2**63, len(row), dtype=np.uint64)
        worths = np.zeros(picks.shape, np.float32)
        worths[row, column] = self._gains(at, value, row, picks[row, column], keys)
        kept = seen, np.packbits(masks, axis=1), picks.astype(np.int16), valid, worths
        # sums depend on the memory layout, and a saved array returns in this one
        self._rounds.append(tuple(map(np.ascontiguousarray, kept)))
        del self._rounds[: -max(1, KEPT // self._n)]
        for group in self._optimizer.param_groups:
            group["lr"] = RATE * max(0.02, remaining)
        for _ in range(max(1, self._n // EACH)):
            self.losses.append(fit_values(self._policy, self._optimizer, *self._batch(masks.shape[1])))

    def _gains(self, at, value, rows, picks, keys):
        """Points of choices (k,) plus the value of the positions they leave, each simulated once."""
        before = count_shots()
        played = self._planner.play(at, rows, picks, keys)
        gains, on = played.points.astype(np.float32), np.flatnonzero(played.goes_on)
        gains[on] += value(played.afterstates[on])
        self.shots += count_shots() - before
        return gains

    def _batch(self, choices):
        """Positions of several rounds: seen, masks, picks, valid, worths."""
        size = min(self._n, BATCH // _PARTS)
        which = self._rng.integers(len(self._rounds), size=_PARTS)
        parts = [(self._rounds[k], self._rng.choice(self._n, size, replace=False)) for k in which]
        columns = (np.concatenate([one[c][rows] for one, rows in parts]) for c in range(5))
        seen, masks, picks, valid, worths = columns
        masks = np.unpackbits(masks, axis=1, count=choices).astype(bool)
        return seen, masks, picks.astype(np.int64), valid, worths

    def get_state(self):
        """Everything but the policy."""
        state = {"rounds": self._rounds, "losses": list(self.losses), "shots": self.shots}
        return state | {"optimizer": self._optimizer.state_dict()}

    def set_state(self, state):
        """Continue from a state of ``get_state``."""
        self._rounds, self.shots = list(state["rounds"]), state["shots"]
        self.losses.extend(state["losses"])
        self._optimizer.load_state_dict(state["optimizer"])


def to_try(scores, masks, rng):
    """Pick ``TRIES`` choices for each row of masks (n, SIZE), half the best, half random. Also returns which are valid.

    A choice can be in both halves. If fewer choices than half of ``TRIES`` are valid, all are in both halves.
    """
    half = TRIES // 2
    best = np.argpartition(np.where(masks, -scores, np.inf), half, axis=1)[:, :half]
    lots, rest = np.where(masks, rng.random(masks.shape), np.inf), TRIES - half
    picks = np.concatenate([best, np.argpartition(lots, rest, axis=1)[:, :rest]], axis=1)
    return picks, np.take_along_axis(masks, picks, axis=1)


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
