"""How does a trained model of this repository play? It takes its greedy choices or actions from its observations."""

from pathlib import Path

import numpy as np

from snooker_env.planning import action_masks
from snooker_env.planning.learned.dense_layers import Layers
from snooker_env.players import ChoicePlayer, SeenPlayer
from snooker_env.players.choices import shares
from snooker_env.players.saved_models import by_train, entries, one_thread
from snooker_env.players.weights import learned_of

from ..features.observed import seen_of, shown
from ..learning.hyperparameters import ACTION_OPTIONS, SEEN_OPTIONS
from ..learning.models import file_of, load_trained
from ..learning.policy_files import read_policy


class PolicyPlayer(ChoicePlayer):
    """A player that takes the choice preferred by the policy of a ``Trained`` model."""

    def __init__(self, model):
        self.model, self.name = model, model.recipe

    @property
    def learned(self):
        """Policy and value of a planner; None if the model has no value of positions."""
        from ..learning.networks import arrays_of  # this loads PyTorch

        policy = self.model.policy
        return learned_of(arrays_of(policy)) if hasattr(policy, "position_value") else None

    def scores(self, at, seeds):
        """The policy's logits, whose softmax are its probabilities."""
        policy, seen = self.model.policy, at.observations()
        masks = action_masks(at, rails=self.options.rules.rails)
        plain = isinstance(policy, Layers)
        return np.where(masks, policy(seen) if plain else policy.fused.scores(seen_of(seen), masks), -np.inf)

    def figures(self, scores):
        """The probabilities."""
        return shares(scores)


class ActingModel:
    """A model of box actions or of the menu as a ``Seen``: its deterministic actions, one table at a time."""

    def __init__(self, model):
        self.model, belong = model, (*ACTION_OPTIONS, *SEEN_OPTIONS)
        own = {key: model.env_options[key] for key in belong if key in model.env_options}
        observation, self._see = shown(own)
        self.options = own | {"observation": observation}

    def act(self, observations, masks, seeds):
        """The actions (n, k), or choices (n,)."""
        seen = self._see(observations)
        with one_thread():
            actions = [self.model.policy.predict(row, deterministic=True)[0] for row in seen]
        return np.array(actions).reshape(len(seen), *self.model.policy.action_space.shape)


class ActingPlayer(SeenPlayer):
    """The player of an ``ActingModel``."""

    learned = None

    def __init__(self, model):
        super().__init__(ActingModel(model), name=model.recipe)
        self.model = model


def player_of_model(trained):
    """The player of a ``Trained`` model or policy."""
    discrete = isinstance(trained.policy, Layers) or trained.env_options.get("action") == "discrete"
    return PolicyPlayer(trained) if discrete else ActingPlayer(trained)


def load_player(path, field="agent"):
    """The player of a .zip, an .npz or a run. If train.py did not make it, the ValueError names ``field``."""
    file = file_of(Path(path), field)
    return player_of_model(read_policy(file, field) if file.suffix == ".npz" else load_trained(file, field))


def read_model(path, field="player"):
    """Like ``load_player``, with ``field`` in errors; None for a file not made by train.py."""
    path = Path(path)
    file = file_of(path, field) if path.is_dir() else path
    if file.suffix != ".npz":
        try:
            ours = by_train(entries(file))
        except Exception:  # no zip, or another kind of zip: other loaders report its fault
            return None
        if not ours:
            return None
    return load_player(file, field)
