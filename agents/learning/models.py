"""How are trained agents kept and played? Models of Stable-Baselines3, saved whole or not at all, as players.

What ``train.py`` and ``agents.publish`` write is read by ``kept``, which unpickles nothing. Any other model of Stable-Baselines3 or
sb3-contrib is a file whose pickles run when it is loaded: ``load_other``, with consent.
"""

import inspect
import io
from pathlib import Path

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.checks import integer, number, refuse
from snooker_env.tasks import OBSERVATIONS
from snooker_env.tasks.saved_models import Saved, outline

from ..features.pot_features import Plain
from ..features.views import view_of
from .hyperparameters import READ
from .model_files import Trained, read

PRETRAINED = Path(__file__).parents[1] / "pretrained"
CHECKPOINT = "checkpoint.pkl"
"""What a run's folder holds until, and after, its model is there."""
UNKNOWN = dict.fromkeys(("layout", "noise", "fidelity", "physics"), "unknown")
"""What is known of the training of a model that ``train.py`` did not make."""


def pretrained():
    """The names of the pre-trained models that there are."""
    return sorted(file.stem for file in PRETRAINED.glob("*.zip"))


class Model:
    """A trained agent (``Trained``, or a model of Stable-Baselines3) that sees the tables by ``look``; it plays what it thinks best.

    ``foreign``: it sees no more than the environment shows, and train.py did not make it.
    """

    def __init__(self, model, options, look):
        self.model, self.options, self._look = model, options, look
        self.foreign = isinstance(look, Plain)
        self._masked = "action_masks" in inspect.signature(model.policy.predict).parameters

    def act(self, tables, observations, going):
        """The model's own choice for the tables going."""
        seen = self._look(tables, observations[going], going)
        masks = {"action_masks": self._look.masks(tables)[going]} if self._masked else {}
        actions = np.zeros(tables.action_space.shape, tables.action_space.dtype)
        actions[going] = self.model.policy.predict(seen, deterministic=True, **masks)[0]
        return actions


def player_options(env_options):
    """Of the options an agent was trained with, those that say how its actions are read."""
    return {key: env_options[key] for key in READ if key in env_options}


def file_of(path, field):
    """The model's file that a path means. Raises ValueError, naming ``field``."""
    file = path / "model.zip" if path.is_dir() else path
    if not file.is_file():
        unfinished = (path / CHECKPOINT).is_file()
        ends = f"; this run has not ended, it goes on with: python train.py --resume --out {path}" if unfinished else ""
        raise refuse(field, str(path), f"must be a model's .zip or a folder that holds model.zip{ends}")
    return file


def load_trained(path, field):
    """The ``Trained`` of a model's .zip or a run's folder. Raises ValueError, naming ``field``, if train.py did not make it."""
    file = file_of(path, field)
    trained = read(file, field)
    if trained is None:
        raise refuse(field, str(file), "must be a model that train.py saved")
    return trained


def load_player(path, field="agent"):
    """A ``Model`` of ``train.py`` from its .zip or the run's folder. Raises ValueError, naming ``field``."""
    return _player(load_trained(path, field))


def _player(trained):
    return Model(trained, player_options(trained.env_options), view_of(trained.view))


def load_any(path, trust, options):
    """The same of ``train.py`` or, with ``trust``, any other model of Stable-Baselines3 or sb3-contrib, see ``load_other``."""
    file = file_of(path, "agent")
    trained = read(file, "agent")
    return load_other(file, trust, options) if trained is None else _player(trained)


def load_other(file, trust, options):
    """A ``Model`` that train.py did not make, trained on a visit with the ``options`` (of ``READ``) by what the environment itself shows.

    Raises ValueError: before any code in the file runs, if by what it says it does not fit, or without ``trust``.
    """
    saved = Saved.of(file, "agent")
    options = ({"action": "discrete"} if saved.action[0] == "Discrete" else {}) | options
    actions, looks = SnookerVectorEnv(1, **options).single_action_space, [Plain(kind) for kind in OBSERVATIONS]
    fitting = [look for look in looks if outline(look.space) == saved.observation]
    other_view = saved.refused("must be a model that sees the observation of a visit, flat or balls, and nothing else")
    other_actions = saved.refused(f"must be a model whose actions are {actions}: --options says how they were read, as placement=True")
    if not fitting:
        raise other_view
    if outline(actions) != saved.action:
        raise other_actions
    try:
        seed = saved.data.get("seed")
        told = {
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
    trained = Trained(network, saved.algorithm[1], "plain", UNKNOWN | options, imitated=None, start=None, **told)
    return Model(trained, options, fitting[0])


def load_weights(model, path):
    """Give a model the weights of another of the same agent; ``model.start`` tells of it. Raises ValueError."""
    other = load_trained(path, "start")
    if other.recipe != model.recipe:
        raise refuse("start", str(path), f"must be a model of {model.recipe}, not of {other.recipe}")
    if other.action_space != model.action_space:
        raise refuse("start", str(path), f"must be a model with actions {model.action_space}, not {other.action_space}")
    model.policy.load_state_dict(other.policy.state_dict())
    model.start = {"model": str(path), "shots": other.num_timesteps, "imitated": other.imitated, "start": other.start}


def zipped(model):
    """An SB3 model as the bytes of its zip file."""
    file = io.BytesIO()
    model.save(file)
    return file.getvalue()
