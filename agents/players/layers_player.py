"""How does the policy of another trainer play? The available choice with the highest score of its layers (``learning.policy_files``)."""

import numpy as np

from snooker_env.tasks import OBSERVATION_SIZE


class LayersPlayer:
    """A policy of plain layers as a player: its greedy (deterministic) choices.

    Parameters
    ----------
    model : Trained
        From ``learning.policy_files.read_policy``.
    """

    foreign = False
    """Its file says everything that is needed, and holds no code."""

    def __init__(self, model):
        self.model, self.options = model, {"action": "discrete"}

    def act(self, tables, observations, going):
        """A choice for each running table: int (n,)."""
        choices = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        choices[going] = self._scores(tables, observations, going).argmax(axis=1)
        return choices

    def rank(self, tables, observations, going):
        """The available choices by probability, highest first: (choices, probabilities) of each running table."""
        found = []
        for scores in self._scores(tables, observations, going):
            order = np.argsort(-scores, kind="stable")[: int(np.isfinite(scores).sum())]
            shares = np.exp(scores[order] - scores[order[0]])
            found.append((order, shares / shares.sum()))
        return found

    def _scores(self, tables, observations, going):
        masks = tables.action_masks()[going]  # in a frame its own entries follow those of a visit
        return np.where(masks, self.model.policy(observations[going, :OBSERVATION_SIZE]), -np.inf)
