"""How is an agent made? By its hyper-parameters (``hyperparams/NAME.yml``, as RL Baselines3 Zoo writes them), with Stable-Baselines3.

To the Zoo's keys come ``algo`` (a file's name says which agent it is, not which algorithm), ``view`` (what it sees: pots or foresight),
``imitation`` (positions on which it is taught by the search first) and
``first_aim_std`` (exploration of the aim at the start). ``learning_rate: lin_X`` falls linearly from X to nearly 0.
"""

import ast
from dataclasses import dataclass
from pathlib import Path

import yaml

from snooker_env._check import choice, refuse

FOLDER = Path(__file__).parent / "hyperparams"
ENV_ID = "Snooker-v0"


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
    def of(cls, name, changes=()):
        """The recipe of that name with some "key=value" changed. Raises ValueError."""
        found = yaml.safe_load((FOLDER / f"{choice('agent', name, names())}.yml").read_text())[ENV_ID]
        for change in changes:
            key, equals, value = change.partition("=")
            if not equals or key not in found:
                raise refuse("set", change, f"must be KEY=VALUE with a key of {', '.join(found)}")
            found[key] = _value(value)
        own = {key: found.pop(key, None) for key in ("algo", "policy", "n_timesteps", "n_envs", "env_kwargs", "first_aim_std")}
        own |= {"view": found.pop("view", "pots"), "imitation": int(found.pop("imitation", 0))}
        own["n_timesteps"] = int(float(own["n_timesteps"]))
        return cls(name, settings=found, **own)

    def new_model(self, tables, seed, tensorboard_log=None):
        """The untrained agent on these tables."""
        from stable_baselines3.common.utils import LinearSchedule

        settings = dict(self.settings)
        rate = settings["learning_rate"]
        if isinstance(rate, str) and rate.startswith("lin_"):
            settings["learning_rate"] = LinearSchedule(float(rate[4:]), 1e-5, 1.0)
        if "n_steps" in settings:  # few tables make small rollouts
            settings["batch_size"] = min(settings["batch_size"], settings["n_steps"] * tables.num_envs)
        model = algorithm(self.algo)(
            policy(self.policy), tables, seed=seed, tensorboard_log=tensorboard_log, device="cpu", stats_window_size=1000, **settings
        )
        if self.first_aim_std is not None:
            import math

            model.policy.log_std.data[3] = math.log(self.first_aim_std)
        # SB3 saves and restores what it does not know, too
        model.recipe, model.env_options, model.view = self.name, dict(self.env_kwargs), self.view
        return model


def _value(text):
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


def algorithm(name):
    """The SB3 class of that name."""
    import sb3_contrib
    import stable_baselines3

    classes = {"ppo": stable_baselines3.PPO, "ppo_mask": sb3_contrib.MaskablePPO, "sac": stable_baselines3.SAC, "tqc": sb3_contrib.TQC}
    return classes[choice("algo", name, classes)]


def policy(name):
    """A policy class of ``networks`` or ``absolute``, or a name that SB3 knows."""
    from . import absolute, networks

    return getattr(absolute, name, getattr(networks, name, name))
