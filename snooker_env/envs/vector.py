"""How do thousands of tables play side by side? The native vector environment of ``Snooker-v0``: steps as kernels, spread over threads.

gymnasium.make_vec("Snooker-v0", num_envs=1024, vectorization_mode="vector_entry_point", noise="club")
"""

import copy
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .._check import choice, integer, refuse, refuse_what
from .._processors import processors
from ..game.balls import BallOn
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.frame_table import MAX_STROKES
from ..tasks.states import checked
from ..tasks.visit import BALL_ON, COUNTS, NEVER, POINTS, REALS, Returned, Visits, Work
from .pictures import Pictures
from .snooker import SnookerEnv

CHUNK = 128
"""Most tables played in one go: few enough for a work space that stays in the cache, enough to make the calls from Python cheap."""
LEAST = 8
"""Fewest tables that are worth a thread or a chunk of their own."""

PICTURES = ("rgb_array", "ansi")
NOT_OF_A_TABLE = {
    "reset": 'reset(options={"reset_mask": ...})', "step": "step", "set_state": 'reset(options={"states": ...})', "render": "render",
    "close": "close", "last_shot": "simulate_batch, or SnookerEnv for one table", "spec": "the attribute spec",
    "unwrapped": "this environment", "get_wrapper_attr": "call", "set_wrapper_attr": "another environment",
}  # fmt: skip
"""What ``call`` does not do for single tables, and what there is instead: the tables play, end and begin together."""


class SnookerVectorEnv(VectorEnv):
    """Many visits side by side: the same shots, rewards and infos, bit for bit, as ``SyncVectorEnv`` of ``SnookerEnv`` with the same seeds.

    ``num_envs`` tables; ``autoreset_mode``: NEXT_STEP, SAME_STEP or DISABLED (of ``gymnasium.vector.AutoresetMode``, or its value);
    ``threads``: how many to use, None for one per core, results do not depend on it; ``max_episode_steps``: strokes after which a visit
    is truncated. All other arguments are those of ``SnookerEnv`` in a visit; a frame needs "sync" or "async". Pictures show the balls as
    they lie, without paths; a window ("human") shows one environment only.

    ``reset(seed=...)`` takes an int, a list or None as ``SyncVectorEnv`` does; options: "reset_mask" (bool array: only those tables),
    "state" (of ``SnookerEnv.get_state``, for all of them) or "states" (of ``get_state``: a list of one each). A state holds its random
    numbers, so that all tables given one state meet the same errors of ``noise``; with a seed too, table k draws them from seed + k.
    """

    metadata = SnookerEnv.metadata

    def __init__(
        self, num_envs=1, *, max_episode_steps=None, render_mode=None, autoreset_mode=AutoresetMode.NEXT_STEP, threads=None, task="visit",
        layout="default", action="box", aim="absolute", observation="flat", noise="none", reward="points", elevation=False, placement=False,
        physics="paper", table="match", fidelity="standard", opponent="none", miss="off", decision=False, max_strokes=MAX_STROKES,
        trust=False,
    ):  # fmt: skip
        if task == "frame":
            raise refuse("task", task, 'must be "visit" here; for frames gymnasium.make_vec has vectorization_mode="sync" and "async"')
        choice("task", task, ("visit",))
        self.num_envs = integer("num_envs", num_envs, 1, 2**24)
        self._threads = min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024)
        self.autoreset_mode = autoreset_mode if isinstance(autoreset_mode, AutoresetMode) else AutoresetMode(autoreset_mode)
        self.metadata = dict(self.metadata, autoreset_mode=self.autoreset_mode)
        if render_mode is not None:
            choice("render_mode", render_mode, PICTURES)
        self._one = SnookerEnv(
            task=task, layout=layout, action=action, aim=aim, observation=observation, noise=noise, reward=reward, elevation=elevation,
            placement=placement, physics=physics, table=table, fidelity=fidelity, render_mode=render_mode, opponent=opponent, miss=miss,
            decision=decision, max_strokes=max_strokes, trust=trust,
        )  # fmt: skip
        shooter = self._one.shooter
        limit = NEVER if max_episode_steps is None else integer("max_episode_steps", max_episode_steps, 1, NEVER)
        self.render_mode, self.observation, self.shooter = render_mode, observation, shooter
        self.single_action_space, self.single_observation_space = self._one.action_space, self._one.observation_space
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.visits = Visits(replace(self._one.visits.rules, limit=limit), self.num_envs)
        self._pictures = Pictures(shooter.table, render_mode)
        self._generators: list[Any] = [None] * self.num_envs
        self._generator_seeds = [-1] * self.num_envs
        self._keyed = np.zeros(self.num_envs, np.bool_)  # has the table's stream a key?
        self._begun = np.zeros(self.num_envs, np.bool_)
        self._done = np.zeros(self.num_envs, np.bool_)
        self._pool, self._pool_process, self._works = None, 0, []

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int | list[int | None] | None = None, options=None):
        """New visits on all tables, or on those of ``options["reset_mask"]``."""
        options = {} if options is None else options
        if not isinstance(options, dict):
            raise refuse("options", options, "must be None or a dict")
        for key in options:
            choice("options", key, ("reset_mask", "state", "states"))
        seeds, wanted = self._seeds(seed), self._mask(options)
        states = self._states(options)
        if not (wanted | self._begun).all():
            raise gymnasium.error.ResetNeeded(f"table {int(np.argmin(wanted | self._begun))} has no visit yet: reset all tables first")
        tables = np.flatnonzero(wanted).tolist()
        made = {k: seeding.np_random(seeds[k]) for k in tables if seeds[k] is not None or self._generators[k] is None}
        for k, own in made.items():
            self._generators[k], self._generator_seeds[k] = own
        for k in tables:
            if states is not None:
                self._set_state(k, states[k], seeded=seeds[k] is not None)
            if seeds[k] is not None or not self._keyed[k]:
                self.visits.seed(k, self._generators[k])
                self._keyed[k] = True
        fresh = wanted if states is None else np.zeros(self.num_envs, np.bool_)
        self._begun |= wanted
        self._done[wanted] = False
        out = Returned(self.num_envs)
        self.visits.begin(fresh, out, others=True)
        return observations.shaped(self.observation, out.observations), self._infos(out.reals, out.counts, wanted)

    def step(self, actions):
        """One stroke on each table. ValueError, before anything is played, if an action is not finite and within [-1, 1]."""
        a = self.shooter.actions.check_many(actions, self.num_envs)
        if not self._begun.all():
            raise gymnasium.error.ResetNeeded("call reset() before step()")
        mode = self.autoreset_mode
        if mode == AutoresetMode.DISABLED and self._done.any():
            k = int(np.argmax(self._done))
            raise gymnasium.error.ResetNeeded(f'the visit on table {k} is over: reset(options={{"reset_mask": ...}}) before step()')
        same_step = mode == AutoresetMode.SAME_STEP
        waiting = self._done if mode == AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, np.bool_)
        out = Returned(self.num_envs, last=same_step)
        try:
            self._play(a, waiting, out, same_step)
        except BaseException:
            self._begun[:] = False  # some tables have played and some not
            raise
        done = out.terminated | out.truncated
        infos = self._infos(out.reals, out.counts, np.ones(self.num_envs, np.bool_))
        if same_step:
            self._done = np.zeros(self.num_envs, np.bool_)
            if done.any():
                infos |= self._final(out, done)
        else:
            self._done = done
        return observations.shaped(self.observation, out.observations), out.rewards, out.terminated, out.truncated, infos

    def action_masks(self):
        """With ``action="discrete"``: which choices there are on each table, bool (num_envs, n)."""
        if not isinstance(self.shooter.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.visits.action_masks()

    def call(self, name, *args, **kwargs):
        """For each table what ``SnookerEnv`` calls ``name``, an attribute or a method (which gets the arguments): a tuple, as
        ``SyncVectorEnv.call`` gives it. ValueError for what does not belong to one table, AttributeError for what is not there."""
        if not isinstance(name, str) or name in NOT_OF_A_TABLE or name.startswith("_"):
            instead = NOT_OF_A_TABLE.get(name) if isinstance(name, str) else None
            raise refuse("name", name, "must be something public that a table has for itself" + (f"; use {instead}" if instead else ""))
        found = [getattr(self._table(k, generator), name) for k, generator in enumerate(self.np_random)]
        return tuple(each(*args, **kwargs) if callable(each) else each for each in found)

    def get_attr(self, name):
        """``call`` without arguments: an attribute of each table."""
        return self.call(name)

    def set_attr(self, name, values):
        """Not to be had."""
        raise AttributeError(f"{name} cannot be set: the tables share everything; make another environment")

    def _table(self, k, generator):
        """Table k as a ``SnookerEnv``; they share the table's state."""
        env, visits, here = copy.copy(self._one), copy.copy(self.visits), slice(k, k + 1)
        visits.positions, visits.on_table, visits.game = self.visits.positions[here], self.visits.on_table[here], self.visits.game[here]
        visits.n, visits.streams = 1, self.visits.streams[here]
        env.visits, env._np_random, env._np_random_seed = visits, generator, self._generator_seeds[k]
        return env

    def render(self):
        """A picture of each table: uint8 (H, W, 3) for "rgb_array", str for "ansi"."""
        shown = []
        for p, on, game in zip(self.visits.positions, self.visits.on_table, self.visits.game, strict=True):
            text = f"break {game[POINTS]}   on: {BallOn(game[BALL_ON]).name.lower().replace('_', ' ')}"
            shown.append(self._pictures.render(p, on, None, text))
        return tuple(shown)

    def close_extras(self, **kwargs):
        """End the threads."""
        if self._pool is not None and self._pool_process == os.getpid():
            self._pool.shutdown()
        self._pool = None

    @property
    def threads(self):
        """How many threads play the tables, fixed when the environment is made."""
        return self._threads

    @property
    def np_random(self):
        """The numpy generator of each table; each is asked once, for the key of its table's stream."""
        for k in range(self.num_envs):
            if self._generators[k] is None:
                self._seed_generator(k, None)
        return tuple(self._generators)

    @property
    def np_random_seed(self):
        """The seed of each table's generator; -1 where it came with a state."""
        return self.np_random and tuple(self._generator_seeds)

    def _seed_generator(self, k, seed):
        self._generators[k], self._generator_seeds[k] = seeding.np_random(seed)

    # states ----------------------------------------------------------------------------------------------------------------

    def get_state(self):
        """The state of each table, as ``SnookerEnv.get_state`` gives it; strokes towards ``max_episode_steps`` are not part of it."""
        return [self.visits.get_state(k) | {"rng": g.bit_generator.state} for k, g in enumerate(self.np_random)]

    def _set_state(self, k, state, *, seeded):
        if not seeded:
            self._generators[k].bit_generator.state, self._generator_seeds[k] = state.rng, -1
        self.visits.set_state(k, state)
        self._keyed[k] = True

    def __getstate__(self):
        return self.__dict__ | {"_pool": None, "_works": []}  # threads belong to one process

    # parts of reset and step -----------------------------------------------------------------------------------------------

    def _seeds(self, seed):
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, (int, np.integer)):
            return [int(seed) + k for k in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise refuse_what("seed", f"{len(seed)} seeds", f"must be an int, None, or {self.num_envs} of them")
        return list(seed)

    def _mask(self, options):
        if "reset_mask" not in options:
            return np.ones(self.num_envs, np.bool_)
        mask = options["reset_mask"]
        if not isinstance(mask, np.ndarray) or mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise refuse('options["reset_mask"]', mask, f"must be a bool array of shape ({self.num_envs},), not all False")
        return mask.copy()

    def _states(self, options):
        """The ``State`` of each table, checked, or None."""
        if "state" in options:
            states, each = [options["state"]], self.num_envs
        elif "states" in options:
            states, each = options["states"], 1
            if not isinstance(states, list | tuple) or len(states) != self.num_envs:
                found = f"{type(states).__name__} of {len(states)}" if isinstance(states, list | tuple) else type(states).__name__
                raise refuse_what('options["states"]', found, f"must be a list of {self.num_envs} states")
        else:
            return None
        generator = self.np_random[0]
        return [checked(state, self.shooter.table, self.shooter.physics.R, generator, to_play=True) for state in states] * each

    def _play(self, actions, waiting, out, same_step):
        """Share the tables out among the threads, a chunk at a time."""
        threads = max(1, min(self.threads, self.num_envs // LEAST))
        even = self.num_envs if threads == 1 else max(LEAST, -(-self.num_envs // (4 * threads)))  # shots differ in length
        size = min(CHUNK, even)
        while len(self._works) < threads:
            self._works.append(Work(size))
        starts = iter(range(0, self.num_envs, size))

        def play(work):
            for start in starts:  # a range's iterator gives each start once, whichever thread asks
                here = slice(start, start + size)
                self.visits.play(actions[here], waiting[here], out, work, start, same_step=same_step)

        if threads == 1:
            play(self._works[0])
            return
        if self._pool is None or self._pool_process != os.getpid():  # a forked process has none of its parent's threads
            self._pool, self._pool_process = ThreadPoolExecutor(threads - 1, "snooker"), os.getpid()
        others = [self._pool.submit(play, work) for work in self._works[1:threads]]
        try:
            play(self._works[0])
        finally:
            for other in others:
                other.exception()  # wait for all of them, whatever happened
        for other in others:
            other.result()

    def _infos(self, reals, counts, there):
        """Infos as Gymnasium's vector environments give them: an array a key, and a mask of the tables that it is about."""
        columns = [*zip(REALS, reals.T, strict=True), *zip(COUNTS, counts.T, strict=True)]
        infos: dict[str, Any] = {name: column * there for name, column in columns}
        infos["foul"] = infos["fouls"] != 0
        return infos | {f"_{name}": there.copy() for name in infos}

    def _final(self, out, done):
        """What SAME_STEP adds: how the visits ended that ended in this step."""
        rows = observations.shaped(self.observation, out.last_observations)
        each = rows if self.observation == "flat" else ({name: rows[name][k] for name in rows} for k in range(self.num_envs))
        final = np.fromiter(each, object, self.num_envs)
        final[~done] = None
        info = self._infos(out.last_reals, out.last_counts, done)
        return {"final_obs": final, "_final_obs": done.copy(), "final_info": info, "_final_info": done.copy()}
