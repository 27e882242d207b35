"""How is an agent made? By its hyper-parameters (``hyperparams/NAME.yml``, as RL Baselines3 Zoo writes them), with Stable-Baselines3.

To the Zoo's keys come ``algo`` (a file's name says which agent it is, not which algorithm), ``view`` (what it sees: pots or foresight),
``imitation`` (positions in which it imitates the search first) and ``first_aim_std`` (exploration of the aim at the start).
``learning_rate: lin_X`` falls linearly from X to nearly 0.
"""

import ast
import math
from dataclasses import dataclass
from pathlib import Path

import yaml

from snooker_env.checks import choice, integer, number, refuse

FOLDER = Path(__file__).parents[1] / "hyperparams"
ENV_ID = "Snooker-v0"
ACTION_OPTIONS = {"action": "box", "aim": "absolute", "elevation": False, "placement": False}
"""Options of the environment that say how actions are read, with its defaults: they belong to the agent."""
SHOT_OPTIONS = ("noise", "physics", "table", "fidelity")
"""Those that say how a shot goes: the same in training and at the end."""
TRAINING_OPTIONS = ("layout", "reward")
"""Those of training alone."""
BY_OPTION = ("n_timesteps", "n_envs", "imitation")
"""Keys with an option of train.py of their own: --steps, --envs, --imitate."""


def rate(field, value, low, high):
    """A learning rate: a number, or lin_X."""
    try:
        number(field, value_of(value[4:]) if isinstance(value, str) and value.startswith("lin_") else value, low, high)
    except ValueError:
        raise refuse(field, value, f"must be a number in [{low}, {high}], or lin_X with such a number X") from None
    return value


MOST = 10**9
KINDS = {
    "n_timesteps": (integer, 1, 10**12), "n_envs": (integer, 1, 2**24), "imitation": (integer, 0, MOST), "n_steps": (integer, 2, MOST),
    "batch_size": (integer, 2, MOST), "n_epochs": (integer, 1, MOST), "buffer_size": (integer, 1, MOST),
    "learning_starts": (integer, 0, MOST), "train_freq": (integer, 1, MOST), "gradient_steps": (integer, 1, MOST),
    "gamma": (number, 0, 1), "gae_lambda": (number, 0, 1), "ent_coef": (number, 0, 1), "vf_coef": (number, 0, 10),
    "learning_rate": (rate, 0, 1), "first_aim_std": (number, 1e-6, 10),
}  # fmt: skip
"""What the hyper-parameters may be: kind, least, most. Advantages are normalised, so a batch has two shots at least."""


def names():
    """The agents that there are recipes for."""
    return sorted(file.stem for file in FOLDER.glob("*.yml"))


@dataclass
class Recipe:
    """What makes an agent: ``settings`` are its hyper-parameters, the algorithm's own and those named here."""

    name: str
    algo: str
    policy: str
    n_timesteps: int
    n_envs: int
    env_kwargs: dict
    first_aim_std: float | None
    view: str
    imitation: int
    settings: dict

    @classmethod
    def of(cls, name, changes=(), env_kwargs=None, **given):
        """The recipe of that name with some "key=value" changed, then options of the environment and other keys. Raises ValueError.

        Algorithm, policy, its network, view and action fit each other: to change them is to write another recipe.
        """
        found = yaml.safe_load((FOLDER / f"{choice('agent', name, names())}.yml").read_text())[ENV_ID]
        found = {"view": "pots", "imitation": 0, "first_aim_std": None} | found
        changed = _changes(changes, [key for key, value in found.items() if key == "env_kwargs" or (key in KINDS and value is not None)])
        usual = found["env_kwargs"]
        found |= changed | given
        for key, (check, low, high) in KINDS.items():
            if found.get(key) is not None:
                found[key] = check(key, found[key], low, high)
        found["env_kwargs"] = _options(found["env_kwargs"], env_kwargs or {}, usual, found["policy"])
        own = ("algo", "policy", "n_timesteps", "n_envs", "env_kwargs", "first_aim_std", "view", "imitation")
        return cls(name, **{key: found.pop(key) for key in own}, settings=found)

    def new_model(self, tables, seed):
        """The untrained agent on these tables."""
        from stable_baselines3.common.utils import LinearSchedule

        settings = dict(self.settings)
        rate = settings["learning_rate"]
        if isinstance(rate, str) and rate.startswith("lin_"):
            settings["learning_rate"] = LinearSchedule(float(rate[4:]), 1e-5, 1.0)
        if "n_steps" in settings:  # few tables make small rollouts
            settings["batch_size"] = min(settings["batch_size"], settings["n_steps"] * tables.num_envs)
        model = algorithm_class(self.algo)(policy(self.policy), tables, seed=seed, device="cpu", stats_window_size=1000, **settings)
        if self.first_aim_std is not None:
            model.policy.log_std.data[3] = math.log(self.first_aim_std)
        # SB3 saves and restores what it does not know, too
        model.recipe, model.env_options, model.view = self.name, dict(self.env_kwargs), self.view
        model.start, model.imitated = None, 0  # where its weights came from: see ``models.load_weights``; positions it imitated in
        return model

    def new_network(self, observation_space, action_space):
        """The untrained network (an SB3 policy) of ``new_model`` alone, for weights that are there already."""
        network = policy(self.policy)
        if isinstance(network, str):
            network = algorithm_class(self.algo).policy_aliases[network]
        return network(observation_space, action_space, lambda _: 0.0, **self.settings.get("policy_kwargs", {}))


def value_of(text):
    """What a text on the command line means: a Python literal, or itself."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return text


def _changes(changes, keys):
    """What the "key=value" of ``changes`` say, each key at most once."""
    free, found = [key for key in keys if key not in BY_OPTION], {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals or key not in free:
            own = f" ({', '.join(BY_OPTION)} have options of their own)"
            raise refuse("set", change, f"must be KEY=VALUE with KEY one of {', '.join(free)}{own}")
        if key in found:
            raise refuse("set", change, f"must give {key} only once")
        found[key] = value_of(value)
    return found


def _options(options, more, usual, policy):
    """The environment's options and ``more`` of them; where ``policy`` needs it, actions must be read as ``usual``. Their values are
    checked by the environment itself."""
    known = (*ACTION_OPTIONS, *SHOT_OPTIONS, *TRAINING_OPTIONS)
    if not isinstance(options, dict):
        raise refuse("env_kwargs", options, f"must be a dict with keys of {', '.join(known)}")
    for key in options:
        choice("key of env_kwargs", key, known)
    options = options | more
    for key in ("action",) if policy == "MlpPolicy" else ACTION_OPTIONS:
        if options.get(key, ACTION_OPTIONS[key]) != usual.get(key, ACTION_OPTIONS[key]):
            raise refuse(key, options.get(key, ACTION_OPTIONS[key]), f"must be {usual.get(key, ACTION_OPTIONS[key])!r} for this agent")
    if options.get("layout") == "held_out":
        raise refuse("layout", "held_out", "must be another for training: the held-out tables are kept for evaluation")
    return options


def algorithm_class(name):
    """The SB3 class of that name."""
    import sb3_contrib
    import stable_baselines3

    classes = {"ppo": stable_baselines3.PPO, "ppo_mask": sb3_contrib.MaskablePPO, "sac": stable_baselines3.SAC, "tqc": sb3_contrib.TQC}
    return classes[choice("algo", name, classes)]


def policy(name):
    """A policy class of ``networks`` or ``mixture_policy``, or a name that SB3 knows."""
    from . import mixture_policy, networks

    return getattr(mixture_policy, name, getattr(networks, name, name))
