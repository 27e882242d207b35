"""How does a trained agent play? A model of Stable-Baselines3 as a player: one of ``train.py`` or, with consent, any other.

What ``train.py`` and ``agents.publish`` write is read by ``model_files``, which unpickles nothing. Any other model of Stable-Baselines3 or
sb3-contrib is a file whose pickles run when it is loaded: ``load_other``, with consent.
"""

import inspect

import numpy as np
from gymnasium import spaces

from snooker_env import SnookerVectorEnv
from snooker_env.checks import integer, number
from snooker_env.tasks import OBSERVATIONS
from snooker_env.tasks.saved_models import SavedModel, outline

from ..features.pot_features import PlainView
from ..features.views import view_of
from ..learning.hyperparameters import ACTION_OPTIONS
from ..learning.model_files import Trained, read
from ..learning.models import file_of, load_trained

UNKNOWN = dict.fromkeys(("layout", "noise", "fidelity", "physics"), "unknown")
"""What is known of the training of a model that ``train.py`` did not make."""


class ModelPlayer:
    """A trained agent (``Trained``, or a model of Stable-Baselines3) that sees the tables by a ``view``; it plays what it rates highest.

    ``foreign``: it sees no more than the environment shows, and train.py did not make it.
    """

    def __init__(self, model, options, view):
        self.model, self.options, self._view = model, options, view
        self.foreign = isinstance(view, PlainView)
        self._masked = "action_masks" in inspect.signature(model.policy.predict).parameters

    def act(self, tables, observations, going):
        """The model's own choice for the tables going."""
        seen = self._view(tables, observations[going], going)
        masks = {"action_masks": self._view.masks(tables)[going]} if self._masked else {}
        actions = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        actions[going] = self.model.policy.predict(seen, deterministic=True, **masks)[0]
        return actions

    def rank(self, tables, observations, going):
        """The choices of a masked policy, the likeliest first, with their probabilities; of any other its own action, without a score."""
        if not self._masked or not isinstance(tables.single_action_space, spaces.Discrete):
            return [(action[None], None) for action in self.act(tables, observations, going)[going]]
        import torch  # here: whoever plays no model waits for none

        policy, masks = self.model.policy, self._view.masks(tables)[going]
        seen, _ = policy.obs_to_tensor(self._view(tables, observations[going], going))
        with torch.no_grad():
            shares = policy.get_distribution(seen, action_masks=masks).distribution.probs.cpu().numpy()
        orders = np.argsort(np.where(masks, -shares, np.inf), axis=1, kind="stable")
        counts = masks.sum(axis=1).tolist()
        return [(order[:many], share[order[:many]]) for order, share, many in zip(orders, shares, counts, strict=True)]


def player_options(env_options):
    """Of the options an agent was trained with, those that say how its actions are read."""
    return {key: env_options[key] for key in ACTION_OPTIONS if key in env_options}


def load_player(path, field="agent"):
    """A ``ModelPlayer`` of ``train.py`` from its .zip or the run's folder. Raises ValueError, naming ``field``."""
    return _player(load_trained(path, field))


def _player(trained):
    return ModelPlayer(trained, player_options(trained.env_options), view_of(trained.view))


def load_any(path, trust, options):
    """The same of ``train.py`` or, with ``trust``, any other model of Stable-Baselines3 or sb3-contrib, see ``load_other``."""
    file = file_of(path, "agent")
    trained = read(file, "agent")
    return load_other(file, trust, options) if trained is None else _player(trained)


def load_other(file, trust, options):
    """A ``ModelPlayer`` that train.py did not make, trained on a visit by what the environment shows; ``options``: of ``ACTION_OPTIONS``.

    Raises ValueError: before any code in the file runs, if by what it says it does not fit, or without ``trust``.
    """
    saved = SavedModel.of(file, "agent")
    options = ({"action": "discrete"} if saved.action[0] == "Discrete" else {}) | options
    actions, views = SnookerVectorEnv(1, **options).single_action_space, [PlainView(kind) for kind in OBSERVATIONS]
    fitting = [view for view in views if outline(view.space) == saved.observation]
    other_view = saved.refused("must be a model that sees the observation of a visit, flat or balls, and nothing else")
    other_actions = saved.refused(f"must be a model whose actions are {actions}: --options says how they were read, as placement=True")
    if not fitting:
        raise other_view
    if outline(actions) != saved.action:
        raise other_actions
    try:
        seed = saved.data.get("seed")
        known = {
            "num_timesteps": integer("num_timesteps", saved.data.get("num_timesteps"), 0, 10**18),
            "gamma": number("gamma", saved.data.get("gamma"), 0, 1), "seed": seed if seed is None else integer("seed", seed, 0, 2**64),
        }  # fmt: skip
    except ValueError as error:
        raise saved.refused(f"must be a model saved by Stable-Baselines3 ({error})") from None
    network = saved.network(trust, "--trust")
    if network.observation_space != fitting[0].space:  # a file may say one thing and hold another
        raise other_view
    if network.action_space != actions:
        raise other_actions
    trained = Trained(network, saved.algorithm[1], "plain", UNKNOWN | options, imitated=None, start=None, **known)
    return ModelPlayer(trained, options, fitting[0])
