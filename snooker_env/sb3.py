"""How does Stable-Baselines3 train on many tables at once? ``SnookerVecEnv``: its ``VecEnv`` on the native vector environment.

from snooker_env.sb3 import SnookerVecEnv
PPO("MlpPolicy", SnookerVecEnv(64, aim="target")).learn(100_000)
"""

import time

import numpy as np
from gymnasium.vector import AutoresetMode

try:
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import VecEnv
except ModuleNotFoundError as error:
    if (error.name or "").split(".")[0] != "stable_baselines3":
        raise
    wanted = 'snooker_env.sb3 needs Stable-Baselines3; install it, in a clone of snooker_env, with: pip install -e ".[train]"'
    raise ImportError(wanted) from error

from collections.abc import Sequence
from typing import Any

from ._check import choice, integer, refuse
from ._types import Bools, Observation, Singles
from .envs.vector import SnookerVectorEnv

__all__ = ["SnookerVecEnv"]


class SnookerVecEnv(VecEnv):
    """Many tables as Stable-Baselines3 takes them.

    A step that ends a visit starts the next one. Its info holds ``terminal_observation``, ``TimeLimit.truncated`` and, as a ``Monitor``
    around each table would give it, ``episode`` with the reward "r", the length "l" and the time "t" [s]. Other infos are left out, ten
    entries for each table at each step being slow, but for those named in ``info_keys``.

    Parameters
    ----------
    num_envs : int
        How many tables.
    seed : int, optional
        Table k begins with seed + k, as after ``seed(seed)``.
    info_keys : sequence of str
        Keys of the environment's infos to hand on.
    **kwargs
        All other arguments of ``SnookerVectorEnv``, but for ``autoreset_mode``.

    Raises
    ------
    ValueError
        For a bad argument.
    ImportError
        Without Stable-Baselines3, when this module is imported.
    """

    tables: SnookerVectorEnv
    info_keys: tuple[str, ...]
    reset_infos: list[dict[str, Any]]

    def __init__(self, num_envs: int, *, seed: int | None = None, info_keys: Sequence[str] = (), **kwargs: Any):
        if seed is not None:
            seed = integer("seed", seed, 0, 2**63 - 1)
        if "autoreset_mode" in kwargs:
            raise refuse("autoreset_mode", kwargs["autoreset_mode"], "must be left out: Stable-Baselines3 needs SAME_STEP")
        self.tables = SnookerVectorEnv(num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **kwargs)
        known = (*self.tables.tables.REALS, *self.tables.tables.COUNTS, "foul")
        self.info_keys = tuple(choice("info_keys", key, known) for key in info_keys)
        super().__init__(num_envs, self.tables.single_observation_space, self.tables.single_action_space)
        self._actions = None
        self.episode_returns, self.episode_lengths = np.zeros(num_envs), np.zeros(num_envs, np.int64)
        """Rewards and steps so far of the episodes going on: (n,) each. No state of a table holds them: save them with its state."""
        self._start = time.time()
        if seed is not None:
            self.seed(seed)

    def reset(self) -> Observation:
        """New visits on all tables, with the seeds and options set before: ``set_options([{"state": ...}, ...])`` starts from states,
        ``set_options([{"position": ...}, ...])`` from positions.

        States hold their random numbers; with ``seed`` called too, those of the seeds take their place.

        Returns
        -------
        float32 (num_envs, k) or dict of arrays
        """
        options = None
        if any(self._options):
            key = "position" if "position" in self._options[0] else "state"
            for k, own in enumerate(self._options):
                if set(own) != {key}:
                    wanted = '"state" alone or "position" alone, the same for each table, or nothing for all'
                    raise refuse(f"keys of options[{k}]", list(own), f"must be {wanted}")
            options = {f"{key}s": [own[key] for own in self._options]}
        observation, info = self.tables.reset(seed=self._seeds, options=options)
        self.reset_infos = [{key: info[key][k] for key in self.info_keys} for k in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        self.episode_returns[:], self.episode_lengths[:] = 0.0, 0
        return observation

    def step_async(self, actions: Any) -> None:
        """Note the actions that ``step_wait`` plays.

        Parameters
        ----------
        actions : array_like, float (num_envs, k) or int (num_envs,)
        """
        self._actions = actions

    def step_wait(self) -> tuple[Observation, Singles, Bools, list[dict[str, Any]]]:
        """Play the actions.

        Returns
        -------
        observations : float32 (num_envs, k) or dict of arrays
        rewards : float32 (num_envs,)
        dones : bool (num_envs,)
        infos : list of dict
        """
        observation, rewards, terminated, truncated, info = self.tables.step(self._actions)
        done = terminated | truncated
        self.episode_returns += rewards
        self.episode_lengths += 1
        infos = [{} for _ in range(self.num_envs)]
        for key in self.info_keys:
            values = np.where(done, info["final_info"][key], info[key]) if "final_info" in info else info[key]
            for own, value in zip(infos, values.tolist(), strict=True):
                own[key] = value
        now = round(time.time() - self._start, 6)
        for k in np.flatnonzero(done).tolist():
            episode = {"r": round(float(self.episode_returns[k]), 6), "l": int(self.episode_lengths[k]), "t": now}
            infos[k]["episode"], infos[k]["terminal_observation"] = episode, info["final_obs"][k]
            infos[k]["TimeLimit.truncated"] = bool(truncated[k] and not terminated[k])
        self.episode_returns[done], self.episode_lengths[done] = 0.0, 0
        return observation, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """End the threads."""
        self.tables.close()

    def get_images(self) -> Sequence[Any]:
        """A picture of each table.

        Returns
        -------
        sequence of uint8 (H, W, 3)
            With ``render_mode="rgb_array"``.
        """
        return self.tables.render()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of the tables asked for: what all share, or of each its own, as ``points``.

        Parameters
        ----------
        attr_name : str
        indices : int, sequence of int, optional
            Which tables; None: all.

        Returns
        -------
        list

        Raises
        ------
        AttributeError
            For what no table has.
        """
        if attr_name in ("observation_space", "action_space"):  # of one table
            return [getattr(self.tables, f"single_{attr_name}") for _ in self._get_indices(indices)]
        if hasattr(self.tables, attr_name) and attr_name not in ("np_random", "np_random_seed"):
            return [getattr(self.tables, attr_name) for _ in self._get_indices(indices)]
        try:
            each = self.tables.get_attr(attr_name)
        except ValueError as error:  # a name that is not of one table: SB3's ``has_attr`` expects this error
            raise AttributeError(str(error)) from None
        return [each[k] for k in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Not to be had: the tables share everything.

        Parameters
        ----------
        attr_name, value, indices
            Anything.

        Raises
        ------
        AttributeError
            Always.
        """
        raise AttributeError(f"{attr_name} cannot be set: the tables share everything; make another SnookerVecEnv")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """What ``get_state`` or ``action_masks`` gives of the tables asked for; no other method belongs to one table.

        Parameters
        ----------
        method_name : {"get_state", "action_masks"}
        *method_args, **method_kwargs
            Not read: these methods take none.
        indices : int, sequence of int, optional
            Which tables; None: all.

        Returns
        -------
        list
        """
        choice("method_name", method_name, ("get_state", "action_masks"))
        states = getattr(self.tables, method_name)()
        return [states[k] for k in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Whether tables are wrapped. None is, but each reports its episodes as a ``Monitor`` would.

        Parameters
        ----------
        wrapper_class : type
        indices : int, sequence of int, optional
            Which tables; None: all.

        Returns
        -------
        list of bool
            True for ``Monitor``.
        """
        return [issubclass(wrapper_class, Monitor) for _ in self._get_indices(indices)]
