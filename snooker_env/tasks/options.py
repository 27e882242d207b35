"""How is the game played that an environment offers? All its options in one frozen place, checked together when they are made.

``SnookerEnv``, ``SnookerVectorEnv``, ``MatchEnv``, ``SnookerVecEnv`` and ``planning.Planner`` take the same ``Options``, or the same
keywords, of which they make one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .._check import choice, integer, refuse, refuse_what, truth
from .._types import Fidelity, Floats, MissRule, ObservationKind, Solver
from ..game.frame import MISS_RULES
from ..game.layouts import Plan
from ..geometry import BALL_RADIUS
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike
from ..physics.table import Table, TableLike
from .box_actions import AIMS, Actions
from .discrete_actions import Choices
from .noise import Noise, NoiseLike
from .observations import OBSERVATIONS
from .opponents import Opponent, Policy, opponent_of
from .rewards import FRAME_REWARDS, REWARDS
from .table_fit import fitted, table_of

TASKS = ("visit", "frame")
ACTIONS = ("box", "discrete")
LAYOUTS = {"visit": "opened", "frame": "break_off"}
"""What layout="default" is in each task."""
MAX_STROKES = 1000
"""Strokes of both players after which the referee stops a frame, unless told otherwise. Uniformly random players that aim near a pot needed
284, and in 2,000 frames never more than 560 (``benchmarks.frames``); players that only foul, or only hand the table over, never end.
"""
NEVER = 2**62
"""A limit of strokes or steps that is none."""


@dataclass(frozen=True)
class Rules:
    """The options of a game as its kernels need them: what ``Options.rules`` holds."""

    actions: Actions | Choices
    """``Actions`` or ``Choices``."""
    noise: Noise
    physics: Physics
    table: Table
    fidelity: Solver
    """As ``parse_fidelity`` gives it."""
    plan: Plan
    """How tables are dealt."""
    reward: str
    observation: ObservationKind
    miss: bool = False
    """Of a frame: whether a foul and a miss is called."""
    max_strokes: int = NEVER
    """Of a frame: after how many strokes of both players it is stopped."""
    opponent: Opponent | None = None
    """Of a frame: who plays the other side, as ``opponents.opponent_of`` gives it."""

    def packed(self) -> tuple[Floats, Floats, Floats]:
        """For the kernels: options of the action, deviations of the noise, physical parameters."""
        return self.actions.pack(), self.noise.pack(BALL_RADIUS), self.physics.pack()


@dataclass(frozen=True, kw_only=True)
class Options:
    """What may be chosen of a game. The fields are the keywords of ``gymnasium.make("Snooker-v0", ...)``; an ``Options`` never changes.

    Parameters
    ----------
    task : {"visit", "frame"}
        Build a break until the first miss or foul, or play a whole frame.
    layout : str
        How tables are dealt: "opened", "held_out", "break_off", "line_up", "colours", "random:N" (N reds), "snookered", "pots:easy",
        "pots:medium", "pots:hard". "default": "opened" in a visit, "break_off" in a frame.
    action : {"box", "discrete"}
        Numbers in [-1, 1], or one number that means a pot, a speed, a side and a top (``snooker_env.tasks.discrete_actions``).
    aim : {"absolute", "target"}
        What the aim of a box action is measured from: +x, or the best potting line.
    observation : {"flat", "balls"}
        One array, or a dict of two.
    noise : str, dict or Noise
        Errors of execution: a level's name, or standard deviations; see ``snooker_env.tasks.Noise``.
    reward : {"points", "points_and_fouls", "pots", "win"}
        The first three in a visit, "points" and "win" in a frame.
    elevation : bool
        Whether a box action holds the cue's elevation.
    placement : bool
        Whether a box action holds the place in the D of a cue ball in hand.
    physics : str, dict, Physics or None
        As ``Physics.of`` takes it, with snooker's ball radius.
    table : str or Table
        "match", "tight", or a table with snooker's bed.
    fidelity : str
        "fast", "standard", "reference" or "euler:N": how impacts are solved.
    opponent : str, path or callable
        Of a frame: "none", "random", "ghost_ball", a model's ``.zip``, or ``opponent(observation, rng) -> action``.
    miss : {"off", "clear_path"}
        Of a frame: the rule for a foul and a miss (``snooker_env.game.frame``).
    decision : bool
        Of a frame: whether a box action holds the decision after a foul of the other player.
    max_strokes : int, optional
        Of a frame: after how many strokes of both players together the referee stops it; None: never.
    trust : bool
        Of a frame: whether the code in an opponent's ``.zip`` may run.

    Attributes
    ----------
    rules : Rules
        The same as the kernels need it, made when the options are.

    Raises
    ------
    ValueError
        For whatever is unknown, of the wrong type, or does not go with another. The message names the field.

    Examples
    --------
    >>> from snooker_env import Options
    >>> options = Options(task="frame", noise="club")
    >>> options.noise, options.but(noise="none").noise
    ('club', 'none')
    """

    task: Literal["visit", "frame"] = "visit"
    layout: str = "default"
    action: Literal["box", "discrete"] = "box"
    aim: Literal["absolute", "target"] = "absolute"
    observation: ObservationKind = "flat"
    noise: NoiseLike = "none"
    reward: Literal["points", "points_and_fouls", "pots", "win"] = "points"
    elevation: bool = False
    placement: bool = False
    physics: PhysicsLike = "paper"
    table: TableLike = "match"
    fidelity: Fidelity = "standard"
    opponent: str | Path | Policy = "none"
    miss: MissRule = "off"
    decision: bool = False
    max_strokes: int | None = MAX_STROKES
    trust: bool = False
    rules: Rules = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        frame = choice("task", self.task, TASKS) == "frame"
        physics, table = self._physics(), table_of(self.table)
        fidelity, noise = parse_fidelity(self.fidelity), Noise.of(self.noise)
        for name, read in (("physics", physics), ("noise", noise)):
            if isinstance(getattr(self, name), dict):  # which may change later
                object.__setattr__(self, name, read)
        actions = self._actions(physics)
        default = isinstance(self.layout, str) and self.layout == "default"
        plan = fitted(LAYOUTS[self.task] if default else self.layout, table)
        choice("observation", self.observation, OBSERVATIONS)
        truth("trust", self.trust)
        choice("reward", self.reward, FRAME_REWARDS if frame else REWARDS)
        miss, limit, opponent = False, NEVER, None
        if frame:
            miss = choice("miss", self.miss, MISS_RULES) == "clear_path"
            limit = NEVER if self.max_strokes is None else integer("max_strokes", self.max_strokes, 1, 10**9)
            opponent = opponent_of(self.opponent, self.observation, actions, self.trust)
        else:
            self._check_visit()
        read = Rules(actions, noise, physics, table, fidelity, plan, self.reward, self.observation, miss, limit, opponent)
        object.__setattr__(self, "rules", read)

    def _physics(self) -> Physics:
        physics = Physics.of(self.physics)
        if physics.R != BALL_RADIUS:
            raise refuse("physics.R", physics.R, f"must be {BALL_RADIUS} in Snooker-v0: spots, rack and pockets are made for it")
        physics.check_stopping()
        return physics

    def _actions(self, physics: Physics) -> Actions | Choices:
        if choice("action", self.action, ACTIONS) == "box":
            return Actions(self.aim, self.elevation, self.placement, physics, self.decision)
        for name in ("elevation", "placement", "decision"):
            if getattr(self, name) is not False:
                raise refuse(name, getattr(self, name), 'must be False with action="discrete"')
        choice("aim", self.aim, AIMS)  # it has no say: the aim is solved
        return Choices(physics)

    def _check_visit(self) -> None:
        """Raise ValueError unless what belongs to a frame is left as it is."""
        usual = {f.name: f.default for f in fields(self)}
        for name in FRAME_ONLY:
            value = getattr(self, name)
            if not isinstance(value, (type(usual[name]), np.bool_)) or value != usual[name]:
                raise refuse(name, value, f'must be {usual[name]!r} with task="visit"; it belongs to task="frame"')

    def but(self, **changes: Any) -> "Options":
        """The same with some options changed.

        Parameters
        ----------
        **changes
            Fields and their new values.

        Returns
        -------
        Options

        Raises
        ------
        ValueError
            As for the options themselves.
        """
        return replace(self, **changes)


FRAME_ONLY = ("opponent", "trust", "miss", "decision", "max_strokes")
"""Options that mean something in the frame task only."""
NAMES = tuple(f.name for f in fields(Options) if f.init)


def options_of(options: Options | None, given: Mapping[str, Any]) -> Options:
    """The ``Options`` of an environment that was given ``options`` (None or some) and the keywords ``given``.

    Raises ValueError for what is not sound, TypeError for a keyword that is unknown.
    """
    if options is None:
        for name in given:
            if name not in NAMES:
                raise TypeError(f"got an unexpected keyword argument {name!r}; the options are {', '.join(NAMES)}")
        return Options(**given)
    if not isinstance(options, Options):
        raise refuse("options", options, "must be an Options or None")
    if given:
        raise refuse_what("options", "an Options", f"must be None with the keywords {sorted(given)}: change them with options.but(...)")
    return options
