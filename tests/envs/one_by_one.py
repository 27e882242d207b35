"""What must many tables give? Single ones played one after the other, arranged as Gymnasium arranges results."""

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array

from snooker_env import SnookerEnv

MODES = list(AutoresetMode)


def native(n, **options):
    return gymnasium.make_vec("Snooker-v0", n, vectorization_mode="vector_entry_point", **options)


class OneByOne(VectorEnv):
    """n single tables with the same options; ``max_episode_steps`` truncates. Counted here: importing RL Baselines3 Zoo
    replaces Gymnasium's ``TimeLimit`` by one that does not truncate an episode that terminates."""

    def __init__(self, n, mode=AutoresetMode.NEXT_STEP, max_episode_steps=None, **options):
        self.limit, self.num_envs, self.mode = max_episode_steps, n, AutoresetMode(mode)
        self.envs = singles = [SnookerEnv(**options) for _ in range(n)]
        self.steps = [0] * n
        self.single_observation_space = singles[0].observation_space
        self.single_action_space = singles[0].action_space
        self.observation_space = batch_space(self.single_observation_space, n)
        self.action_space = batch_space(self.single_action_space, n)
        self.seen, self.done = [None] * n, np.zeros(n, bool)

    def reset(self, *, seed=None, options=None):
        options, infos = dict(options or {}), {}
        seeds = (
            [None if seed is None else seed + k for k in range(self.num_envs)] if np.ndim(seed) == 0 else seed
        )
        for k in np.flatnonzero(options.pop("reset_mask", np.ones(self.num_envs, bool))):
            self.seen[k], info = self.envs[k].reset(seed=seeds[k], options=options)
            self.steps[k], self.done[k], infos = 0, False, self._add_info(infos, info, k)
        return self._stacked(), infos

    def step(self, actions):
        waiting, infos = self.done & (self.mode == AutoresetMode.NEXT_STEP), {}
        rewards, ended, cut = np.zeros(self.num_envs), *np.zeros((2, self.num_envs), bool)
        for k, env in enumerate(self.envs):
            if waiting[k]:
                self.seen[k], info, self.steps[k] = *env.reset(), 0
            else:
                self.seen[k], rewards[k], ended[k], cut[k], info = env.step(actions[k])
                self.steps[k] += 1
                cut[k] |= self.limit is not None and self.steps[k] >= self.limit
            if self.mode == AutoresetMode.SAME_STEP and (ended[k] or cut[k]):
                infos = self._add_info(infos, {"final_obs": self.seen[k], "final_info": info}, k)
                self.seen[k], info, self.steps[k] = *env.reset(), 0
            infos = self._add_info(infos, info, k)
        self.done = ended | cut
        return self._stacked(), rewards, ended, cut, infos

    def _stacked(self):
        space = self.single_observation_space
        return concatenate(space, self.seen, create_empty_array(space, self.num_envs))


def same(a, b):
    """Equal in every bit, type and key; arrays of objects element by element."""
    if isinstance(a, dict):
        return isinstance(b, dict) and set(a) == set(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, np.ndarray) and a.dtype == object:
        return b.dtype == object and all(
            (x is None) == (y is None) and (x is None or same(x, y)) for x, y in zip(a, b, strict=True)
        )
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(same, a, b))
    return data_equivalence(a, b, exact=True)
