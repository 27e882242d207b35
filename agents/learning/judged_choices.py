"""How does a policy learn the values of choices from a judge? As in ``imitation``, on others' positions."""

import uuid
from collections import deque

import numpy as np
import torch

from snooker_env.planning import action_masks
from snooker_env.planning.learned.pot_view import with_pots

from ..cluster.job import Here
from .imitation import fit_values, to_try
from .self_play import judged

KEPT = 50_000
"""Positions that gradient steps are drawn from."""
BATCH, EACH, RATE = 512, 32, 2e-3
"""Positions in the batch of a gradient step, new positions for each step, and the first learning rate."""
_PARTS = 4
"""Rounds that a batch is drawn from."""


class JudgedChoices:
    """Fits ``policy`` to values of choices in rounds of n positions; ``where`` simulates each choice once.

    ``shots``: simulated so far."""

    def __init__(self, policy, options, threads, n, rng, where=None):
        self._policy, self._rng, self._n, self._where = policy, rng, n, where or Here(threads)
        self._sent, self._cue = {"run": uuid.uuid4().hex, "options": options}, options.get("cue", "free")
        learned = [p for name, p in policy.named_parameters() if not name.startswith("position_value.")]
        self._optimizer, self._rounds = torch.optim.Adam(learned, RATE), []
        self.losses, self.shots = deque(maxlen=100), 0

    def round(self, at, value, remaining):
        """Try choices in ``Positions``, judge what they leave by ``value``, learn; ``remaining``: share."""
        seen, masks = with_pots(at.observations()), action_masks(at, cue=self._cue)
        with torch.no_grad():
            scores = self._policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.numpy()
        picks, valid = to_try(scores, masks, self._rng)
        row, column = np.nonzero(valid)
        keys = self._rng.integers(0, 2**63, len(row), dtype=np.uint64)
        worths = np.zeros(picks.shape, np.float32)
        sent = self._sent | {"value": value}
        worths[row, column], shots = judged(self._where, sent, at, row, picks[row, column], keys)
        self.shots += shots
        kept = seen, np.packbits(masks, axis=1), picks.astype(np.int16), valid, worths
        # sums depend on the layout, and a saved array comes back in this one
        self._rounds.append(tuple(map(np.ascontiguousarray, kept)))
        del self._rounds[: -max(1, KEPT // self._n)]
        for group in self._optimizer.param_groups:
            group["lr"] = RATE * max(0.02, remaining)
        for _ in range(max(1, self._n // EACH)):
            self.losses.append(fit_values(self._policy, self._optimizer, *self._batch(masks.shape[1])))

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
        """Go on from a state of ``get_state``."""
        self._rounds, self.shots = list(state["rounds"]), state["shots"]
        self.losses.extend(state["losses"])
        self._optimizer.load_state_dict(state["optimizer"])
