"""How do thousands of tables play side by side? As kernels, on several threads."""

import copy
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike

from .._lib.check import integer
from .._lib.types import Bools, Floats, Observation
from ..tasks import observations
from ..tasks.options import NEVER, Options
from ..tasks.played import Played
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Tables
from ..tasks.threads import Threads, processors
from .arguments import (
    MANY,
    begin_at,
    breakers_of,
    game_of,
    known_options,
    mask_of,
    seeds_of,
    starts_of,
    tables_of,
)
from .pictures import SIZE, Picture, Pictures
from .snooker import SnookerEnv

PICTURES = ("rgb_array", "ansi")
_GENERATOR = np.random.default_rng(0)  # of the kind whose states a reset takes; no number is drawn from it


class SnookerVectorEnv(VectorEnv[Any, Any, Any]):
    """Many tables side by side, bit for bit as ``SyncVectorEnv`` of ``SnookerEnv`` with the same seeds.

    ``SnookerEnv`` says what actions, observations, rewards and infos are, docs/environment/many_tables.md the rest.

    ``reset(seed=...)`` takes an int, a list or None, ``reset(options=...)`` "reset_mask", bool (num_envs,), the tables
    to reset; "state" or "position" for all of them, or "states" or "positions", one for each; "breaker", 0 the agent or
    1 the opponent, an int or one for each. Tables that start from one state meet the same execution errors; with a seed
    as well, table k draws from seed + k. Positions hold no random stream: each table draws its own errors.

    Parameters
    ----------
    num_envs : int, optional
        Number of tables, in [1, 2**24]; default 1.
    options, **keywords
        The options, or their keywords, see ``SnookerEnv``.
    max_episode_steps : int, optional
        Number of steps after which an episode is truncated; default None: never.
    render_mode : {"rgb_array", "ansi"}, optional
        How ``render`` shows the tables; default None: not at all.
    autoreset_mode : gymnasium.vector.AutoresetMode or str, optional
        NEXT_STEP (default), SAME_STEP or DISABLED, or its value.
    threads : int, optional
        In [1, 1024]; default one for each available processor. Results do not depend on it.
    render_size : (int, int), optional
        Width and height of a table's picture [pixels], each in [100, 8192]; default (1920, 1080).

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> envs = sn.SnookerVectorEnv(8, noise="club", threads=1)
    >>> observations, infos = envs.reset(seed=1)
    >>> observations, rewards, terminations, truncations, infos = envs.step(np.zeros((8, 4)))
    >>> observations.shape, rewards.shape
    ((8, 61), (8,))
    """

    metadata: dict[str, Any] = SnookerEnv.metadata

    options: Options
    tables: Tables

    def __init__(
        self,
        num_envs: int = 1,
        options: Options | None = None,
        *,
        max_episode_steps: int | None = None,
        render_mode: Literal["rgb_array", "ansi"] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        render_size: Sequence[int] = SIZE,
        **keywords: object,
    ):
        n = self.num_envs = integer("num_envs", num_envs, 1, 2**24)
        threads = min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = dict(self.metadata, autoreset_mode=self.autoreset_mode)
        self.render_mode = render_mode
        limit = NEVER if max_episode_steps is None else max_episode_steps
        limit = integer("max_episode_steps", limit, 1, NEVER)
        self.options, self.tables = self._game_of(options, keywords, limit)
        own = copy.deepcopy(self.tables.actions[0].space)  # with its own generator
        self.single_action_space: spaces.Space[Any] = own
        self.single_observation_space: spaces.Space[Any] = self.tables.observation_space()
        self.action_space: spaces.Space[Any] = batch_space(self.single_action_space, n)
        self.observation_space: spaces.Space[Any] = batch_space(self.single_observation_space, n)
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size, modes=PICTURES)
        self._generators: list[Any] = [None] * n
        self._generator_seeds = [-1] * n
        # has the table's stream a key, has it an episode, and has that ended?
        self._keyed, self._begun, self._done = np.zeros((3, n), np.bool_)
        self._recent: list[list[Played]] = [[] for _ in range(n)]  # of the last step or reset, if shown
        self._crew = Threads(threads, watch=None if render_mode is None else self._saw)

    def _game_of(self, given: Options | None, keywords: Any, limit: int) -> tuple[Options, Tables]:
        options, opponent = game_of(given, keywords)
        return options, tables_of(options, opponent, self.num_envs, limit)

    @property
    def positions(self) -> Floats:
        """A copy of the balls' positions on every table, float64 (n, 22, 2) [m]."""
        return self.tables.positions.copy()

    @property
    def on_table(self) -> Bools:
        """A copy: which balls are on every table, bool (n, 22)."""
        return self.tables.on_table.copy()

    # Gymnasium's interface

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin new episodes on all tables, or on some; ``options``: see the class.

        Table k draws from seed + k, or from element k of a list; without a seed the streams go on. Returns
        observations and infos: an array for each key, and under "_key" which tables it holds for. ValueError
        for invalid options, ResetNeeded if a table outside the mask has never been reset."""
        options, tables = known_options(options, MANY), self.tables
        seeds, wanted = seeds_of(seed, self.num_envs), mask_of(options, self.num_envs)
        starts, breakers = starts_of(options, tables, _GENERATOR), breakers_of(options, tables)
        if not (wanted | self._begun).all():
            k = int(np.argmin(wanted | self._begun))
            raise gymnasium.error.ResetNeeded(f"table {k} has no visit yet: reset all tables first")
        rows = np.flatnonzero(wanted).tolist()
        # all seeds are checked before anything changes
        new = [k for k in rows if seeds[k] is not None or self._generators[k] is None]
        for k, made in zip(new, [seeding.np_random(seeds[k]) for k in new], strict=True):
            self._generators[k], self._generator_seeds[k] = made
        for k in rows:
            start, seeded = None if starts is None else starts[k], seeds[k] is not None
            if begin_at(start, tables, k, self._generators[k], seeded=seeded, keyed=bool(self._keyed[k])):
                self._generator_seeds[k] = -1
            self._keyed[k] = True
        dealt = wanted if starts is None else np.zeros(self.num_envs, np.bool_)
        written = tables.output()
        with self._playing():
            tables.reset(dealt, written, self._crew, **breakers)
        self._begun |= wanted
        self._done[wanted] = False
        return self._arrange(written), tables.infos(written.reals, written.counts, wanted)

    def step(self, actions: ArrayLike) -> tuple[Observation, Floats, Bools, Bools, dict[str, Any]]:
        """Play one step on each table.

        ``actions``: float (num_envs, k) within [-1, 1], clipped if up to 1e-6 outside; or choices, int
        (num_envs,). Returns observations and infos as ``reset`` (with SAME_STEP also "final_obs" and
        "final_info"), rewards float64 (num_envs,), terminations and truncations bool (num_envs,). ValueError
        for an action outside the space, ResetNeeded before the first reset, and with DISABLED if an episode
        is over: then nothing is played. After a SimulationError all tables need a reset."""
        a = self.options.rules.actions.check(actions, self.num_envs)
        self._require_begun()
        mode = self.autoreset_mode
        if mode == AutoresetMode.DISABLED and self._done.any():
            what, k = self.options.task, int(np.argmax(self._done))
            first = 'reset(options={"reset_mask": ...}) before step()'
            raise gymnasium.error.ResetNeeded(f"the {what} on table {k} is over: {first}")
        same_step = mode == AutoresetMode.SAME_STEP
        waiting = self._done if mode == AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, np.bool_)
        written = self.tables.output(last=same_step)
        with self._playing():
            self.tables.step(a, waiting, written, self._crew, same_step=same_step)
        done = written.terminated | written.truncated
        infos = self.tables.infos(written.reals, written.counts)
        if same_step:
            self._done = np.zeros(self.num_envs, np.bool_)
            if done.any():
                infos |= self._final(written, done)
        else:
            self._done = done
        return self._arrange(written), written.rewards, written.terminated, written.truncated, infos

    def action_masks(self) -> Bools:
        """Return the available choices, bool (num_envs, 540) or wider. ValueError with ``action="box"``."""
        return self.tables.action_masks()

    def render(self) -> tuple[Picture, ...]:
        """Return a picture of each table, as ``SnookerEnv.render``."""
        each = enumerate(self._recent)
        return tuple(self._pictures.render(self.tables, k, strokes) for k, strokes in each)

    def close_extras(self, **kwargs: object) -> None:
        """End the threads; called by ``close``."""
        if hasattr(self, "_crew"):  # not if the constructor refused its options
            self._crew.shutdown()

    @property
    def threads(self) -> int:
        """Number of threads that play the tables, an int; fixed when the environment is made."""
        return self._crew.threads

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """Each table's NumPy generator, used once: for the key of the table's random stream."""
        for k, generator in enumerate(self._generators):
            if generator is None:
                self._generators[k], self._generator_seeds[k] = seeding.np_random(None)
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each table's generator, a tuple of int; -1 if it came with a state."""
        return tuple(self._generator_seeds) if self.np_random else ()

    # single tables

    def get_state(self) -> list[dict[str, Any]]:
        """Return the state of each table, for ``reset(options={"states": states})``; it counts no steps."""
        each = enumerate(self.np_random)
        return [self.tables.get_state(k) | {"rng": one.bit_generator.state} for k, one in each]

    # parts of reset and step

    def _require_begun(self) -> None:
        if not self._begun.all():
            raise gymnasium.error.ResetNeeded("call reset() before step()")

    @contextmanager
    def _playing(self) -> Iterator[None]:
        """Strokes are played inside: after an error only some tables have played, so all need a reset."""
        if self.render_mode is not None:
            self._recent = [[] for _ in range(self.num_envs)]
        try:
            yield
        except BaseException:
            self._begun[:] = False
            raise

    def _saw(self, k: int, buffers: ShotBuffers, j: int, mine: bool) -> None:
        self._recent[k].append(self.tables.record(k, buffers, j))

    def _arrange(self, written):
        """The observations in the environment's kind."""
        return observations.arrange(self.options.rules.observation, written.observations, written.masks)

    def _final(self, out, done):
        """The entries that SAME_STEP adds: how the episodes ended that ended in this step."""
        last, reals, counts, masks = out.last
        each = observations.arrange(self.options.rules.observation, last, masks)
        if isinstance(each, dict):
            each = [dict(zip(each, parts, strict=True)) for parts in zip(*each.values(), strict=True)]
        final = np.fromiter(each, object, self.num_envs)
        final[~done] = None
        info = self.tables.infos(reals, counts, done)
        return {"final_obs": final, "_final_obs": done.copy(), "final_info": info, "_final_info": done.copy()}
