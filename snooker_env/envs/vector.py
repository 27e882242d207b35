"""How do thousands of tables play side by side? The native vector environment of ``Snooker-v0``: steps as kernels, spread over threads.

gymnasium.make_vec("Snooker-v0", num_envs=1024, vectorization_mode="vector_entry_point", noise="club")
"""

import copy
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
from ..tasks.kinds import TABLES
from ..tasks.options import NEVER, Options, options_of
from ..tasks.tables import Tables
from ..tasks.threads import Threads, processors
from .given_arrays import OUTPUTS, arrays_given
from .pictures import SIZE, Picture, Pictures
from .record import Recent
from .reset_options import MANY, Start, given_of, mask_of, seeds_of, starts_of
from .snooker import SnookerEnv
from .table_calls import check_name

PICTURES = ("rgb_array", "ansi")


class SnookerVectorEnv(VectorEnv[Any, Any, Any]):
    """Many tables side by side: the same shots, rewards and infos, bit for bit, as ``SyncVectorEnv`` of ``SnookerEnv`` with the same seeds.

    Pictures show the paths of the last shots; a window ("human") shows one environment only.
    In a frame the opponents "random" and "ghost_ball" play as kernels. A callable is asked in Python, table by table; one that has a method
    ``many(observations, generators, masks) -> actions`` is called once for all tables that wait for it, and so is a saved model (whose
    arithmetic on many rows may differ in the last bits from that on one).

    ``reset(seed=...)`` takes an int, a list or None as ``SyncVectorEnv`` does; options: "reset_mask" (bool array: only those tables),
    "state" (of ``SnookerEnv.get_state``, for all of them) or "states" (of ``get_state``: a list of one each). A state holds its random
    numbers, so that all tables given one state meet the same errors of ``noise``; with a seed too, table k draws them from seed + k.
    In place of states "position" or "positions" (``snooker_env.Position``), which hold none: each table draws its own.

    ``reset`` and ``step`` write into arrays that they are given: ``out={"observations": ..., "rewards": ..., "terminations": ...,
    "truncations": ...}``, any of them, of the right shape and dtype, C-contiguous (shared memory, for instance); these are returned.

    Parameters
    ----------
    num_envs : int
        How many tables.
    options : Options, optional
        How the game is played, as for ``SnookerEnv``; None: it is made of the keywords.
    max_episode_steps : int, optional
        Steps after which an episode is truncated; None: never.
    render_mode : {"rgb_array", "ansi"}, optional
    autoreset_mode : gymnasium.vector.AutoresetMode or its value
        NEXT_STEP, SAME_STEP or DISABLED.
    threads : int, optional
        How many to use; None: one for each core. Results do not depend on it.
    render_size : (int, int)
        Width and height of a table's picture [pixels].
    **given
        The keywords of ``Options``, in place of ``options``.

    Raises
    ------
    ValueError, TypeError
        For a bad argument, for an unknown one.

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
        self, num_envs: int = 1, options: Options | None = None, *, max_episode_steps: int | None = None,
        render_mode: Literal["rgb_array", "ansi"] | None = None, autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None, render_size: Sequence[int] = SIZE, **given: Any,
    ):  # fmt: skip
        self.num_envs = integer("num_envs", num_envs, 1, 2**24)
        threads = min(1024, processors()) if threads is None else integer("threads", threads, 1, 1024)
        self.autoreset_mode = autoreset_mode if isinstance(autoreset_mode, AutoresetMode) else AutoresetMode(autoreset_mode)
        self.metadata = dict(self.metadata, autoreset_mode=self.autoreset_mode)
        if render_mode is not None:
            choice("render_mode", render_mode, PICTURES)
        self.options = options_of(options, given)
        limit = NEVER if max_episode_steps is None else integer("max_episode_steps", max_episode_steps, 1, NEVER)
        self.render_mode = render_mode
        self._one = SnookerEnv(self.options, render_mode=render_mode, render_size=render_size)
        self.single_action_space: Any = self._one.action_space
        self.single_observation_space: Any = self._one.observation_space
        self.action_space: Any = batch_space(self.single_action_space, self.num_envs)
        self.observation_space: Any = batch_space(self.single_observation_space, self.num_envs)
        self.tables = TABLES[self.options.task](self.options.rules, self.num_envs, limit=limit)
        self._pictures = Pictures(self.options.rules.table, render_mode, render_size)
        self._generators: list[Any] = [None] * self.num_envs
        self._generator_seeds = [-1] * self.num_envs
        self._keyed = np.zeros(self.num_envs, np.bool_)  # has the table's stream a key?
        self._begun = np.zeros(self.num_envs, np.bool_)
        self._done = np.zeros(self.num_envs, np.bool_)
        self._recent = Recent(self.tables)
        self._crew = Threads(threads, watch=None if render_mode is None else self._recent.saw)

    # Gymnasium's interface -------------------------------------------------------------------------------------------------

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None, out: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """New visits or frames on all tables, or on some.

        Parameters
        ----------
        seed : int, list or None
            Table k draws from seed + k, or from the k-th of the list; None: the random numbers go on.
        options : dict, optional
            "reset_mask"; "state", "states", "position" or "positions": see above.
        out : dict of arrays, optional
            {"observations": where to write them}.

        Returns
        -------
        observations : float32 (num_envs, k) or dict
        infos : dict

        Raises
        ------
        ValueError
            For other options, and states and positions that are not sound.
        gymnasium.error.ResetNeeded
            If a table that is not reset has never been.
        """
        options = given_of(options, MANY)
        seeds, wanted = seeds_of(seed, self.num_envs), mask_of(options, self.num_envs)
        check = lambda state: self.tables.checked(state, self.np_random[0], to_play=True)  # noqa: E731
        starts = starts_of(options, self.num_envs, self.tables, check)
        if not (wanted | self._begun).all():
            raise gymnasium.error.ResetNeeded(f"table {int(np.argmin(wanted | self._begun))} has no visit yet: reset all tables first")
        given = self._given(out, ("observations",))
        tables = np.flatnonzero(wanted).tolist()
        made = {k: seeding.np_random(seeds[k]) for k in tables if seeds[k] is not None or self._generators[k] is None}
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
            self.tables.reset(fresh, written, self._crew)
        except BaseException:
            self._begun[:] = False  # an opponent who breaks has played on some tables and not on others
            raise
        self._begun |= wanted
        self._done[wanted] = False
        return self._shaped(written, out), self.tables.infos(written.reals, written.counts, wanted)

    def step(self, actions: Any, *, out: dict[str, Any] | None = None) -> tuple[Observation, Floats, Bools, Bools, dict[str, Any]]:
        """One step of each table.

        Parameters
        ----------
        actions : array_like, float (num_envs, k) or int (num_envs,)
            Within [-1, 1], or choices.
        out : dict of arrays, optional
            Where to write results, see above.

        Returns
        -------
        observations : float32 (num_envs, k) or dict
        rewards : float64 (num_envs,)
        terminations, truncations : bool (num_envs,)
        infos : dict
            An array for each key, and "_key" which tables it is about; with SAME_STEP also "final_obs" and "final_info".

        Raises
        ------
        ValueError
            If an action is not in the action space, or an array of ``out`` does not fit; then nothing is played.
        gymnasium.error.ResetNeeded
            Before the first reset, and with DISABLED where an episode is over.
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
            raise gymnasium.error.ResetNeeded(f'the {what} on table {k} is over: reset(options={{"reset_mask": ...}}) before step()')
        same_step = mode == AutoresetMode.SAME_STEP
        waiting = self._done if mode == AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, np.bool_)
        written = self.tables.output(last=same_step, given=given)
        self._prepare_crew()
        try:
            self.tables.step(a, waiting, written, self._crew, same_step=same_step)
        except BaseException:
            self._begun[:] = False  # some tables have played and some not
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
        """With ``action="discrete"``: which choices there are on each table.

        Returns
        -------
        bool (num_envs, n)

        Raises
        ------
        ValueError
            With ``action="box"``.
        """
        if not isinstance(self.options.rules.actions, Choices):
            raise refuse("action", "box", 'must be "discrete": a Box has no masks')
        return self.tables.action_masks()

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """For each table what ``SnookerEnv`` calls ``name``, as ``SyncVectorEnv.call`` gives it.

        Parameters
        ----------
        name : str
            An attribute, or a method.
        *args, **kwargs
            What the method gets.

        Returns
        -------
        tuple
            One for each table.

        Raises
        ------
        ValueError
            For what does not belong to one table.
        AttributeError
            For what is not there.
        """
        check_name(name)
        found = [getattr(self._table(k, generator), name) for k, generator in enumerate(self.np_random)]
        return tuple(each(*args, **kwargs) if callable(each) else each for each in found)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """``call`` without arguments.

        Parameters
        ----------
        name : str
            An attribute of ``SnookerEnv``.

        Returns
        -------
        tuple
            One for each table.
        """
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Not to be had: the tables share everything.

        Parameters
        ----------
        name, values
            Anything.

        Raises
        ------
        AttributeError
            Always.
        """
        raise AttributeError(f"{name} cannot be set: the tables share everything; make another environment")

    def _table(self, k: int, generator: np.random.Generator) -> SnookerEnv:
        """Table k as a ``SnookerEnv``; they share the table's state."""
        env = copy.copy(self._one)
        env.tables, env._np_random, env._np_random_seed = self.tables.view(k), generator, self._generator_seeds[k]
        return env

    def render(self) -> tuple[Picture, ...]:
        """A picture of each table; to a recorder the motion of all of them at once, see Pictures and films of ``SnookerEnv``.

        Returns
        -------
        tuple of uint8 (H, W, 3) or str
            With "rgb_array", with "ansi".
        """
        return self._pictures.render_all(self.tables, self._recent.strokes)

    def _prepare_crew(self) -> None:
        self._crew.generators = self._generators
        if self.render_mode is not None:
            self._recent.begin()

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads."""
        self._crew.shutdown()

    @property
    def threads(self) -> int:
        """How many threads play the tables, fixed when the environment is made."""
        return self._crew.threads

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The numpy generator of each table; each is asked once, for the key of its table's stream."""
        for k in range(self.num_envs):
            if self._generators[k] is None:
                self._seed_generator(k, None)
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each table's generator; -1 where it came with a state."""
        return tuple(self._generator_seeds) if self.np_random else ()

    def _seed_generator(self, k: int, seed: int | None) -> None:
        self._generators[k], self._generator_seeds[k] = seeding.np_random(seed)

    # states ----------------------------------------------------------------------------------------------------------------

    def get_state(self) -> list[dict[str, Any]]:
        """The state of each table, as ``SnookerEnv.get_state`` gives it; steps towards ``max_episode_steps`` are not part of it.

        Returns
        -------
        list of dict
        """
        return [self.tables.get_state(k) | {"rng": g.bit_generator.state} for k, g in enumerate(self.np_random)]

    def _take(self, k: int, start: Start, *, seeded: bool) -> None:
        rng = start.take(self.tables, k)
        if rng is not None:
            self._keyed[k] = True
            if not seeded:
                self._generators[k].bit_generator.state, self._generator_seeds[k] = rng, -1

    # parts of reset and step -----------------------------------------------------------------------------------------------

    def _given(self, out: Any, names: Collection[str]) -> dict[str, Any]:
        """The arrays to write into, checked."""
        flat = self.options.observation == "flat"
        boxes = None if flat else {part: box.shape for part, box in self.observation_space.spaces.items()}
        return arrays_given(out, names, self.num_envs, self.tables.SIZE, boxes)

    def _shaped(self, written, out):
        """The observations as the environment's kind; in the arrays of ``out`` if these are given."""
        made = observations.shaped(self.options.observation, written.observations)
        if out is not None and "observations" in out and self.options.observation != "flat":
            for name, array in out["observations"].items():
                array[...] = made[name]
            return out["observations"]
        return made

    def _final(self, out, done):
        """What SAME_STEP adds: how the episodes ended that ended in this step."""
        rows = observations.shaped(self.options.observation, out.last_observations)
        each = rows if self.options.observation == "flat" else ({name: rows[name][k] for name in rows} for k in range(self.num_envs))
        final = np.fromiter(each, object, self.num_envs)
        final[~done] = None
        info = self.tables.infos(out.last_reals, out.last_counts, done)
        return {"final_obs": final, "_final_obs": done.copy(), "final_info": info, "_final_info": done.copy()}
