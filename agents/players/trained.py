"""How does a trained model become a player? ``ModelPlayer``: for a model of ``train.py`` or, with ``trust``, any other SB3 model.

Files of ``train.py`` and ``agents.publish`` are read by ``model_files``, which unpickles nothing. Any other model of Stable-Baselines3 or
sb3-contrib holds pickled code, which runs when it is loaded: ``load_other`` needs ``trust``.
"""

import inspect

import numpy as np
from gymnasium import spaces

from snooker_env.benchmark import FittingModel
from snooker_env.checks import integer, number
from snooker_env.tasks.saved_models import one_thread

from ..features.views import PlainView, view_of
from ..learning.hyperparameters import ACTION_OPTIONS
from ..learning.model_files import Trained, read
from ..learning.models import file_of, load_trained
from ..learning.policy_files import read_policy
from .layers_player import LayersPlayer

UNKNOWN = dict.fromkeys(("layout", "noise", "fidelity", "physics"), "unknown")
"""The training record of a model that ``train.py`` did not make."""


class ModelPlayer:
    """A trained model as a player: its greedy (deterministic) actions.

    Parameters
    ----------
    model : Trained or stable_baselines3 model
        Whatever has a ``policy`` of Stable-Baselines3.
    options : dict
        How its actions are read: arguments of ``SnookerEnv``, such as ``{"action": "discrete"}``.
    view : view
        What it observes, see ``features.views``.

    Attributes
    ----------
    foreign : bool
        Whether it observes the environment's own observation: a model that ``train.py`` did not make.
    """

    def __init__(self, model, options, view):
        self.model, self.options, self._view = model, options, view
        self.foreign = isinstance(view, PlainView)
        self._masked = "action_masks" in inspect.signature(model.policy.predict).parameters

    def act(self, tables, observations, going):
        """The model's greedy actions for the running tables: float32 (n, k) or int (n,)."""
        seen = self._view(tables, observations[going], going)
        masks = {"action_masks": self._view.masks(tables)[going]} if self._masked else {}
        actions = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        with one_thread():
            actions[going] = self.model.policy.predict(seen, deterministic=True, **masks)[0]
        return actions

    def rank(self, tables, observations, going):
        """The choices of a masked policy by probability, highest first; of any other policy its one action, without a score."""
        if not self._masked or not isinstance(tables.single_action_space, spaces.Discrete):
            return [(action[None], None) for action in self.act(tables, observations, going)[going]]
        import torch  # here: players without a model need no torch

        policy, masks = self.model.policy, self._view.masks(tables)[going]
        seen, _ = policy.obs_to_tensor(self._view(tables, observations[going], going))
        with one_thread(), torch.no_grad():
            shares = policy.get_distribution(seen, action_masks=masks).distribution.probs.cpu().numpy()
        orders = np.argsort(np.where(masks, -shares, np.inf), axis=1, kind="stable")
        counts = masks.sum(axis=1).tolist()
        return [(order[:many], share[order[:many]]) for order, share, many in zip(orders, shares, counts, strict=True)]


def player_options(env_options):
    """The options that say how actions are read, from those that an agent was trained with."""
    return {key: env_options[key] for key in ACTION_OPTIONS if key in env_options}


def load_player(path, field="agent"):
    """The player of a model of ``train.py``, its .zip or the run's folder, or of another trainer's policy. ValueError, naming ``field``."""
    file = file_of(path, field)
    return LayersPlayer(read_policy(file, field)) if file.suffix == ".npz" else _player(load_trained(path, field))


def _player(trained):
    return ModelPlayer(trained, player_options(trained.env_options), view_of(trained.view))


def load_any(path, trust, options):
    """As ``load_player`` or, with ``trust``, of any other model of Stable-Baselines3 or sb3-contrib, see ``load_other``."""
    file = file_of(path, "agent")
    if file.suffix == ".npz":
        return load_player(file)
    trained = read(file, "agent")
    return load_other(file, trust, options) if trained is None else _player(trained)


def load_other(file, trust, options):
    """A ``ModelPlayer`` that train.py did not make, trained with the environment's own observation. ``options``: ``ACTION_OPTIONS``.

    Raises ValueError without ``trust``, or if the spaces described in the file do not fit; both before any code in the file runs.
    """
    fitting = FittingModel.of(file, options)
    saved = fitting.saved
    try:
        seed = saved.data.get("seed")
        known = {
            "num_timesteps": integer("num_timesteps", saved.data.get("num_timesteps"), 0, 10**18),
            "gamma": number("gamma", saved.data.get("gamma"), 0, 1), "seed": seed if seed is None else integer("seed", seed, 0, 2**64),
        }  # fmt: skip
    except ValueError as error:
        raise saved.refused(f"must be a model saved by Stable-Baselines3 ({error})") from None
    network = fitting.network(trust)
    trained = Trained(network, saved.algorithm[1], "plain", UNKNOWN | fitting.options, imitated=None, start=None, **known)
    return ModelPlayer(trained, fitting.options, PlainView(fitting.observation))
