"""How is an agent defined? By ``hyperparams/NAME.yml``, in the format of RL Baselines3 Zoo.

Additional keys: ``algo`` (the algorithm), ``expert`` (true: expert iteration comes first), ``imitation`` (its positions)
and ``first_aim_std`` (initial deviation of the aim). If they stand under ``agent`` instead, the Zoo itself can train with
the same file, provided that the policy is one of SB3's own. ``learning_rate: lin_X`` decreases linearly from X to
nearly 0.
"""

import ast
import math
from dataclasses import dataclass, fields
from pathlib import Path

import yaml

from snooker_env import Options
from snooker_env.checks import choice, integer, number, refuse

FOLDER = Path(__file__).parents[1] / "hyperparams"
ENV_ID = "Snooker-v0"
ACTION_OPTIONS = Options.group("action", "visit")
"""Options that determine how actions are read, with their defaults: they belong to the agent."""
SHOT_OPTIONS = tuple(Options.group("shot"))
"""Options that determine the outcome of a shot: equal in training and evaluation."""
SEEN_OPTIONS = ("observation", "observe_conditions")
"""Options that determine what the agent observes (``features.observed``): they belong to the agent."""
TRAINING_OPTIONS = ("layout", "reward")
"""Options of training only."""
ENV_OPTIONS = (*ACTION_OPTIONS, *SHOT_OPTIONS, *SEEN_OPTIONS, *TRAINING_OPTIONS)
"""The options allowed in ``env_kwargs``."""
BY_OPTION = ("n_timesteps", "n_envs", "imitation")
"""Keys with their own options of train.py: --steps, --envs, --imitate."""


def rate(field, value, low, high):
    """A learning rate: a number, or lin_X."""
    falls = isinstance(value, str) and value.startswith("lin_")
    try:
        number(field, value_of(value[4:]) if falls else value, low, high)
    except ValueError:
        wanted = f"must be a number X in [{low}, {high}], or lin_X"
        raise refuse(field, value, wanted) from None
    return value


MOST = 10**9
KINDS = {
    "n_timesteps": (integer, 1, 10**12),
    "n_envs": (integer, 1, 2**24),
    "imitation": (integer, 0, MOST),
    **dict.fromkeys(("n_steps", "batch_size"), (integer, 2, MOST)),
    "n_epochs": (integer, 1, MOST),
    **dict.fromkeys(("gamma", "gae_lambda", "ent_coef"), (number, 0, 1)),
    "vf_coef": (number, 0, 10),
    "learning_rate": (rate, 0, 1),
    "first_aim_std": (number, 1e-6, 10),
}
"""Kind, smallest and largest value of each key; advantages are normalised, so a batch has at least two shots."""


def names():
    """The agents with a recipe."""
    return sorted(file.stem for file in FOLDER.glob("*.yml"))


@dataclass
class Recipe:
    """The definition of an agent: the keys named here, and the algorithm's own hyperparameters in ``settings``.

    ``fidelity_given``: whether the fidelity of ``env_kwargs`` was requested; otherwise the recipe's saves training time.
    """

    name: str
    algo: str
    policy: str
    n_timesteps: int
    n_envs: int
    env_kwargs: dict
    first_aim_std: float | None
    imitation: int
    expert: bool
    settings: dict
    fidelity_given: bool = False

    @classmethod
    def of(cls, name, changes=(), env_kwargs=None, **more):
        """Read the recipe of this name and apply "key=value" changes, then environment options, then other keys. ValueError.

        Algorithm, policy, network and action belong together; changing them requires another recipe.
        """
        file = FOLDER / f"{choice('agent', name, names())}.yml"
        written = yaml.safe_load(file.read_text(encoding="utf-8"))
        keys = {"imitation": 0, "expert": False, "first_aim_std": None}
        keys |= written[ENV_ID] | written.get("agent", {})
        usual, env_kwargs = keys["env_kwargs"], env_kwargs or {}
        unset = [key for key in KINDS if keys.get(key) is None]
        known = [key for key in keys if key == "env_kwargs" or (key in KINDS and key not in unset)]
        changed = changes_of(changes, known)
        keys |= changed | more
        for key, (check, low, high) in KINDS.items():
            if keys.get(key) is not None:
                keys[key] = check(key, keys[key], low, high)
        keys["env_kwargs"] = _options(keys["env_kwargs"], env_kwargs, usual, keys["policy"])
        if keys["env_kwargs"].get("observe_conditions") and keys["algo"] == "ppo_mask":
            why = "its networks do not read the table's constants"
            raise refuse("observe_conditions", True, f"must be left out for {name}: {why}")
        asked = "fidelity" in env_kwargs or "fidelity" in changed.get("env_kwargs", {})
        mine = {f.name: keys.pop(f.name) for f in fields(cls) if f.name in keys}
        return cls(name, **mine, settings=keys, fidelity_given=asked)

    @property
    def method(self):
        """The name of the algorithm, as PPO."""
        return self.algo.partition("_")[0].upper()

    def new_model(self, tables, seed):
        """The untrained agent on these tables."""
        from stable_baselines3.common.utils import LinearSchedule

        from .fast_ppo import BoolMasks

        settings = dict(self.settings)
        rate = settings["learning_rate"]
        if isinstance(rate, str) and rate.startswith("lin_"):
            settings["learning_rate"] = LinearSchedule(float(rate[4:]), 1e-5, 1.0)
        # few tables give small rollouts
        settings["batch_size"] = min(settings["batch_size"], settings["n_steps"] * tables.num_envs)
        if self.algo == "ppo_mask":
            settings["rollout_buffer_class"] = BoolMasks
        settings |= {"seed": seed, "device": "cpu", "stats_window_size": 1000}
        model = algorithm_class(self.algo)(policy(self.policy), tables, **settings)
        if self.first_aim_std is not None:
            model.policy.log_std.data[3] = math.log(self.first_aim_std)
        # SB3 also saves and restores additional attributes
        model.recipe, model.env_options = self.name, dict(self.env_kwargs)
        model.imitated = 0  # positions of expert iteration
        return model

    def new_network(self, observation_space, action_space):
        """The untrained network (an SB3 policy) of ``new_model``, to be filled with given weights."""
        network = policy(self.policy)
        if isinstance(network, str):
            network = algorithm_class(self.algo).policy_aliases[network]
        kwargs = self.settings.get("policy_kwargs", {})
        return network(observation_space, action_space, lambda _: 0.0, **kwargs)


def value_of(text):
    """The value of text on the command line: a Python literal, or the text itself."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return text


def changes_of(changes, keys):
    """The values of "key=value" in ``changes``, with each key at most once."""
    free, changed = [key for key in keys if key not in BY_OPTION], {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals or key not in free:
            others = f" ({', '.join(BY_OPTION)} have their own options)"
            raise refuse("set", change, f"must be KEY=VALUE with KEY one of {', '.join(free)}{others}")
        if key in changed:
            raise refuse("set", change, f"must give {key} only once")
        changed[key] = value_of(value)
    return changed


def _options(options, more, usual, policy):
    """Merge ``more`` into environment options; if ``policy`` needs it, actions must be read as ``usual``."""
    if not isinstance(options, dict):
        raise refuse("env_kwargs", options, f"must be a dict with keys of {', '.join(ENV_OPTIONS)}")
    for key in options:
        choice("key of env_kwargs", key, ENV_OPTIONS)
    options = options | more
    for key in ("action", "observation") if policy == "MlpPolicy" else (*ACTION_OPTIONS, "observation"):
        value, wanted = (some.get(key, ACTION_OPTIONS.get(key)) for some in (options, usual))
        if value != wanted:
            raise refuse(
                key,
                value,
                f"must be {wanted!r} for this agent" if wanted else "must be left out for this agent",
            )
    not_held_out(options.get("layout"))
    return options


def not_held_out(layout):
    """Raise ValueError for the layout that is reserved for evaluation."""
    if layout == "held_out":
        why = "the held-out tables are reserved for evaluation"
        raise refuse("layout", layout, f"must differ in training: {why}")


def algorithm_class(name):
    """The SB3 class with this name."""
    from stable_baselines3 import PPO

    from .fast_ppo import FastPPO

    classes = {"ppo": PPO, "ppo_mask": FastPPO}
    return classes[choice("algo", name, classes)]


def policy(name):
    """A policy class of ``networks`` or ``snooker_env.sb3``, or the name of one of SB3's own."""
    from snooker_env import sb3

    from . import networks

    return getattr(networks, name, getattr(sb3, name, name))
