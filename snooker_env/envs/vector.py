"""How do thousands of tables play side by side? The native vector environment of ``Snooker-v0``: steps as
kernels, on several threads.

gymnasium.make_vec("Snooker-v0", num_envs=1024, vectorization_mode="vector_entry_point", noise="club")
"""

from collections.abc import Collection, Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .._check import choice, integer, refuse
from .._types import Bools, Floats, Observation
from ..tasks import observations
from ..tasks.discrete_actions import Choices
from ..tasks.options import NEVER, Options
from ..tasks.tables import Tables
from ..tasks.threads import Threads, processors
from .given_arrays import OUTPUTS, arrays_given
from .opponents import game_of, tables_of
from .pictures import SIZE, Picture, Pictures
from .record import Recent
from .reset_options import MANY, Start, breakers_of, given_of, mask_of, seeds_of, starts_of
from .snooker import SnookerEnv
from .table_calls import TableCalls

PICTURES = ("rgb_array", "ansi")


class SnookerVectorEnv(TableCalls, VectorEnv[Any, Any, Any]):
    """Many tables side by side: bit for bit those of ``SyncVectorEnv`` with the same seeds.

    The steps run as compiled kernels on several threads. ``SnookerEnv`` specifies actions, observations,
    rewards and infos.

    **Opponents.** In a frame, the opponents "random" and "ghost_ball" run as kernels. Any other player is
    asked once for all tables that wait for it. A callable is called table by table or, if it has a method
    ``many(observations, generators, masks) -> actions``, that once.

    **Reset.** ``reset(seed=...)`` takes an int, a list or None, as ``SyncVectorEnv`` does.
    ``reset(options=...)`` takes these keys:

    | key | value |
    |---|---|
    | "reset_mask" | bool array (num_envs,): the tables to reset; without it, all |
    | "state" | a state of ``SnookerEnv.get_state`` for all of them |
    | "states" | a list with one state for each, as ``get_state`` returns it |
    | "position" | a ``snooker_env.Position`` for all of them |
    | "positions" | a list with one position for each |
    | "breaker" | in a frame or match: who breaks instead of the draw, 0 the agent or 1 the opponent; an int, or one for each |

    A state holds its random stream, so all tables that start from one state meet the same execution errors.
    With a seed as well, table k draws from seed + k. Positions hold no random stream: each table draws its
    own errors.

    **Results in given arrays.** ``reset`` and ``step`` can write into arrays of the caller, for instance in
    shared memory: ``out={"observations": ..., "rewards": ..., "terminations": ..., "truncations": ...}``. Any
    of them may be given, C-contiguous and with the right shape and dtype; the same arrays are then returned.

    **Pictures** show the paths of the last shots. A window ("human") is available for ``SnookerEnv`` only.

    Parameters
    ----------
    num_envs : int, optional
        Number of tables, in [1, 2**24]; default 1.
    options : Options, optional
        The options, see ``SnookerEnv``. Default None: they are made from the keywords.
    max_episode_steps : int, optional
        Number of steps after which an episode is truncated; default None: never.
    render_mode : {"rgb_array", "ansi"}, optional
        How ``render`` shows the tables; default None: not at all.
    autoreset_mode : gymnasium.vector.AutoresetMode or str, optional
        NEXT_STEP (default), SAME_STEP or DISABLED, or its value.
    threads : int, optional
        Number of threads, in [1, 1024]; default one for each available processor. Results do not depend on
        it.
    render_size : (int, int), optional
        Width and height of a table's picture [pixels], each in [100, 8192]; default (1920, 1080).
    **given
        The keywords of ``Options``, in place of ``options``.

    Raises
    ------
    ValueError
        If an argument is invalid.
    TypeError
        For an unknown keyword.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> envs = sn.SnookerVectorEnv(8, noise="club", threads=1)
    >>> observations, infos = envs.reset(seed=1)
    >>> observations, rewards, terminations, truncations, infos = envs.step(np.zeros((8, 4)))
    >>> observations.shape, rewards.shape
    ((8, 121), (8,))
    """

    metadata: dict[str, Any] = SnookerEnv.metadata

    num_envs: int
    options: Options
    autoreset_mode: AutoresetMode
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
        **given: Any,
    ):
        self.num_envs = integer("num_envs", num_envs, 1, 2**24)
        threads = min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024)
        self.autoreset_mode = (
            autoreset_mode if isinstance(autoreset_mode, AutoresetMode) else AutoresetMode(autoreset_mode)
        )
        self.metadata = dict(self.metadata, autoreset_mode=self.autoreset_mode)
        if render_mode is not None:
            choice("render_mode", render_mode, PICTURES)
        self.options, opponent = self._game_of(options, given)
        limit = (
            NEVER if max_episode_steps is None else integer("max_episode_steps", max_episode_steps, 1, NEVER)
        )
        self.render_mode = render_mode
        self.tables = self._tables_of(opponent, limit)
        self._one = SnookerEnv._of(self.options, self.tables.view(0), render_mode, render_size)
        self.single_action_space: Any = self._one.action_space
        self.single_observation_space: Any = self._one.observation_space
        self.action_space: Any = batch_space(self.single_action_space, self.num_envs)
        self.observation_space: Any = batch_space(self.single_observation_space, self.num_envs)
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size)
        self._generators: list[Any] = [None] * self.num_envs
        self._generator_seeds = [-1] * self.num_envs
        self._keyed = np.zeros(self.num_envs, np.bool_)  # has the table's stream a key?
        self._begun = np.zeros(self.num_envs, np.bool_)
        self._done = np.zeros(self.num_envs, np.bool_)
        self._recent = Recent(self.tables)
        self._crew = Threads(threads, watch=None if render_mode is None else self._recent.saw)

    _both: dict[str, Any] = {}  # noqa: RUF012 - {"either": True} where both sides are played by the caller

    def _game_of(self, options: Options | None, given: dict[str, Any]) -> tuple[Options, Any]:
        """The options, and who sits opposite the agent."""
        return game_of(options, given)

    def _tables_of(self, opponent: Any, limit: int) -> Tables:
        return tables_of(self.options, opponent, self.num_envs, limit)

    # Gymnasium's interface
    # --------------------------------------------------------------------------------------------------------

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
        out: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin new visits or frames on all tables, or on some.

        Parameters
        ----------
        seed : int, list or None, optional
            Seeds of the random numbers from now on: table k draws from seed + k, or from element k of the
            list. Default None: the streams go on.
        options : dict, optional
            Keys "reset_mask", "state", "states", "position", "positions", "breaker", see the class.
        out : dict, optional
            {"observations": arrays to write them into}, see the class.

        Returns
        -------
        observations : numpy.ndarray or dict
            float32 (num_envs, k), or a dict of such arrays.
        infos : dict
            An array for each key of ``SnookerEnv``'s info; the array under "_key" marks the tables that it
            holds for.

        Raises
        ------
        ValueError
            If the options are invalid, or a state or position is.
        gymnasium.error.ResetNeeded
            If a table outside the mask has never been reset.
        """
        options = given_of(options, MANY)
        seeds, wanted = seeds_of(seed, self.num_envs), mask_of(options, self.num_envs)
        check = lambda state: self.tables.checked(state, self.np_random[0], to_play=True, **self._both)  # noqa: E731
        starts = starts_of(options, self.num_envs, self.tables, check)
        breakers = breakers_of(options, self.num_envs, self.options, two_players=bool(self._both))
        if not (wanted | self._begun).all():
            raise gymnasium.error.ResetNeeded(
                f"table {int(np.argmin(wanted | self._begun))} has no visit yet: reset all tables first"
            )
        given = self._given(out, ("observations",))
        tables = np.flatnonzero(wanted).tolist()
        made = {
            k: seeding.np_random(seeds[k])
            for k in tables
            if seeds[k] is not None or self._generators[k] is None
        }
        for k, own in made.items():
            self._generators[k], self._generator_seeds[k] = own
        for k in tables:
            if starts is not None:
                self._take(k, starts[k], seeded=seeds[k] is not None)
            if seeds[k] is not None or not self._keyed[k]:
                self.tables.seed(k, self._generators[k])
                self._keyed[k] = True
        fresh = wanted if starts is None else np.zeros(self.num_envs, np.bool_)
        written = self.tables.output(given=given)
        self._prepare_crew()
        try:
            self.tables.reset(fresh, written, self._crew, **breakers)
        except BaseException:
            self._begun[:] = False  # the opponent may have broken off on some tables only
            raise
        self._begun |= wanted
        self._done[wanted] = False
        return self._shaped(written, out), self.tables.infos(written.reals, written.counts, wanted)

    def step(
        self, actions: Any, *, out: dict[str, Any] | None = None
    ) -> tuple[Observation, Floats, Bools, Bools, dict[str, Any]]:
        """Play one step on each table.

        Parameters
        ----------
        actions : array_like
            float (num_envs, k) within [-1, 1], or int (num_envs,): choices.
        out : dict, optional
            Arrays to write the results into, see the class.

        Returns
        -------
        observations : numpy.ndarray or dict
            float32 (num_envs, k), or a dict of such arrays.
        rewards : numpy.ndarray
            float64 (num_envs,).
        terminations, truncations : numpy.ndarray
            bool (num_envs,).
        infos : dict
            An array for each key of ``SnookerEnv``'s info; the array under "_key" marks the tables that it
            holds for. With SAME_STEP also "final_obs" and "final_info".

        Raises
        ------
        ValueError
            If an action is not in the action space, or an array of ``out`` does not fit; then nothing is
            played.
        gymnasium.error.ResetNeeded
            Before the first reset, and with DISABLED if an episode is over.
        SimulationError
            If a shot cannot be computed; all tables then need a reset.
        """
        a = self.options.rules.actions.check_many(actions, self.num_envs)
        given = self._given(out, OUTPUTS)
        if not self._begun.all():
            raise gymnasium.error.ResetNeeded("call reset() before step()")
        mode = self.autoreset_mode
        if mode == AutoresetMode.DISABLED and self._done.any():
            k = int(np.argmax(self._done))
            what = self.options.task
            raise gymnasium.error.ResetNeeded(
                f'the {what} on table {k} is over: reset(options={{"reset_mask": ...}}) before step()'
            )
        same_step = mode == AutoresetMode.SAME_STEP
        waiting = self._done if mode == AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, np.bool_)
        written = self.tables.output(last=same_step, given=given)
        self._prepare_crew()
        try:
            self.tables.step(a, waiting, written, self._crew, same_step=same_step)
        except BaseException:
            self._begun[:] = False  # only some tables have played
            raise
        done = written.terminated | written.truncated
        infos = self.tables.infos(written.reals, written.counts, np.ones(self.num_envs, np.bool_))
        if same_step:
            self._done = np.zeros(self.num_envs, np.bool_)
            if done.any():
                infos |= self._final(written, done)
        else:
            self._done = done
        return self._shaped(written, out), written.rewards, written.terminated, written.truncated, infos

    def action_masks(self) -> Bools:
        """Return the available choices on each table, with ``action="discrete"``.

        Returns bool (num_envs, 540). ValueError with ``action="box"``.
        """
        if not isinstance(self.options.rules.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.tables.action_masks()

    def render(self) -> tuple[Picture, ...]:
        """Return a picture of each table; a recorder gets the motion of all of them at once.

        Returns uint8 (H, W, 3) arrays with "rgb_array", str with "ansi".
        """
        return self._pictures.render_all(self.tables, self._recent.strokes)

    def _prepare_crew(self) -> None:
        self._crew.generators = self._generators
        if self.render_mode is not None:
            self._recent.begin()

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads; called by ``close``."""
        self._crew.shutdown()

    @property
    def threads(self) -> int:
        """Number of threads that play the tables, an int; fixed when the environment is made."""
        return self._crew.threads

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The NumPy generator of each table, a tuple. Each is used once, for the key of its table's random
        stream."""
        for k in range(self.num_envs):
            if self._generators[k] is None:
                self._seed_generator(k, None)
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each table's generator, a tuple of int; -1 if it came with a state."""
        return tuple(self._generator_seeds) if self.np_random else ()

    def _seed_generator(self, k: int, seed: int | None) -> None:
        self._generators[k], self._generator_seeds[k] = seeding.np_random(seed)

    # states
    # --------------------------------------------------------------------------------------------------------

    def get_state(self) -> list[dict[str, Any]]:
        """Return the state of each table, as ``SnookerEnv.get_state`` does.

        Returns one dict of JSON types for each table; ``reset(options={"states": states})`` restores them.
        """
        return [
            self.tables.get_state(k) | {"rng": g.bit_generator.state} for k, g in enumerate(self.np_random)
        ]

    def _take(self, k: int, start: Start, *, seeded: bool) -> None:
        rng = start.take(self.tables, k)
        if rng is not None:
            self._keyed[k] = True
            if not seeded:
                self._generators[k].bit_generator.state, self._generator_seeds[k] = rng, -1

    # parts of reset and step
    # --------------------------------------------------------------------------------------------------------

    def _given(self, out: Any, names: Collection[str]) -> dict[str, Any]:
        """The validated arrays to write into."""
        boxes = None if self.options.observation == "flat" else self.observation_space.spaces
        return arrays_given(out, names, self.num_envs, self.tables.SIZE, boxes)

    def _shaped(self, written, out):
        """The observations in the environment's kind, in the arrays of ``out`` if these are given."""
        made = observations.shaped(self.options.observation, written.observations, written.masks)
        if out is not None and "observations" in out and self.options.observation != "flat":
            for name, array in out["observations"].items():
                array[...] = made[name]
            return out["observations"]
        return made

    def _final(self, out, done):
        """The entries that SAME_STEP adds: how the episodes ended that ended in this step."""
        rows = observations.shaped(self.options.observation, out.last_observations, out.last_masks)
        each = (
            rows
            if self.options.observation == "flat"
            else ({name: rows[name][k] for name in rows} for k in range(self.num_envs))
        )
        final = np.fromiter(each, object, self.num_envs)
        final[~done] = None
        info = self.tables.infos(out.last_reals, out.last_counts, done)
        return {"final_obs": final, "_final_obs": done.copy(), "final_info": info, "_final_info": done.copy()}
