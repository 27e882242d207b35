"""How does the player ``foresight_rule`` choose? By a rule, from the view ``foresight``."""

import numpy as np

from snooker_env.planning import action_masks
from snooker_env.players import ChoicePlayer

from ..features.lookahead_features import PICKS, ForesightView, worth_by_rule


class ForesightRule(ChoicePlayer):
    """The observation of ``ppo_foresight``, scored by a rule: mean points plus the value of what is left."""

    name, training_shots = "foresight_rule", 0

    def _bind(self, options):
        super()._bind(options)
        self._view = ForesightView().at(options)

    def scores(self, at, seeds):
        """Expected points of the simulated choices; all others are worse."""
        masks = action_masks(at, cue=self.options.cue)
        # where none of the simulated choices is there, the first of the others
        scores = np.where(masks, -1e9, -np.inf)
        scores[:, PICKS] = np.maximum(worth_by_rule(self._view.ahead(at, masks[:, PICKS])), scores[:, PICKS])
        return scores
