"""How is the game of an environment configured? All options in one immutable object, validated together when it is made.

``SnookerEnv``, ``SnookerVectorEnv``, ``MatchEnv``, ``SnookerVecEnv`` and ``planning.Planner`` take an ``Options``, or its fields as
keywords.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from gymnasium import spaces

from .._check import choice, integer, number, refuse, refuse_what, truth
from .._types import Fidelity, Floats, MissRule, ObservationKind, Solver
from ..game.frame import MISS_RULES
from ..game.layouts import Plan
from ..game.rule_sets import RULES, RuleSet, RulesName, rule_set
from ..geometry import BALL_RADIUS
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike
from ..physics.table import Table, TableLike
from . import observations
from .box_actions import AIMS, Actions
from .discrete_actions import Choices
from .noise import Noise, NoiseLike
from .rewards import FRAME_REWARDS, MATCH_REWARDS, REWARDS
from .table_fit import fitted, table_of

TASKS = ("visit", "frame", "match")
MOST_TIME = 15.0
"""The most time to play [s]: the longest shot clock. With more no stroke would ever be in time, and the frame's clock would not start."""
TIME_TO_PLAY = 9.0
"""Default time [s] from the rest of the balls to the next stroke, in a game with a clock. With the strokes' own duration some 14 s a
stroke, as in the Shoot Out of professionals."""
ACTIONS = ("box", "discrete")
LAYOUTS = {"visit": "opened", "frame": "break_off", "match": "break_off"}
"""What layout="default" means in each task."""
MAX_STROKES = 1000
"""Default number of strokes of both players after which the referee stops a frame. Uniformly random players that aim near a pot needed 284
on average, and never more than 560 in 2,000 frames (``benchmarks.frames``). Players that only foul, or only pass the turn, never finish.
"""
FRAMES = 7
"""Default length of a match: best of 7."""
OBJECT = "object"
"""As the option ``opponent``: whoever was passed to the environment as an object."""
NEVER = 2**62
"""Stands for no limit of strokes or steps."""


@dataclass(frozen=True)
class Rules:
    """The options of a game in the form that the kernels need, as ``Options.rules`` holds them."""

    actions: Actions | Choices
    """``Actions`` or ``Choices``."""
    noise: Noise
    physics: Physics
    table: Table
    fidelity: Solver
    """As ``parse_fidelity`` returns it."""
    plan: Plan
    """How tables are dealt."""
    reward: str
    observation: ObservationKind
    miss: MissRule = "off"
    """In a frame: the rule for a foul and a miss."""
    max_strokes: int = NEVER
    """In a frame: number of strokes of both players after which it is stopped."""
    one_stroke: bool = False
    """In a visit: whether it ends after its first stroke."""
    frames: int = 0
    """In a match: of how many frames at most. 0 for a single frame, which is no match."""
    game: RulesName = "snooker"
    """In a frame: the rule set."""
    time_to_play: int = 0
    """In a frame with a clock: the time from the rest of the balls to the next stroke [ms]."""

    @property
    def rule_set(self) -> RuleSet:
        """The ``RuleSet`` of the game."""
        return rule_set(self.game)

    @property
    def misses(self) -> bool:
        """Whether a foul and a miss is called."""
        return self.miss != "off"

    def packed(self) -> tuple[Floats, Floats, Floats]:
        """For the kernels: options of the action, deviations of the noise, physical parameters."""
        return self.actions.pack(), self.noise.pack(BALL_RADIUS), self.physics.pack()


@dataclass(frozen=True, kw_only=True)
class Options:
    """All options of a game: the keywords of ``gymnasium.make("Snooker-v0", ...)``, validated together. An ``Options`` is immutable.

    Parameters
    ----------
    task : {"visit", "frame", "match"}, optional
        "visit" (default): build a break until the first miss or foul. "frame": play a whole frame. "match": the best of several frames;
        what is said below of a frame holds for a match, too.
    layout : str, optional
        How tables are dealt: "opened", "held_out", "break_off", "line_up", "colours", "random:N" (N reds), "snookered", "pots:easy",
        "pots:medium" or "pots:hard". "default": "opened" in a visit, "break_off" in a frame.
    action : {"box", "discrete"}, optional
        "box" (default): numbers in [-1, 1]. "discrete": one integer that means a pot, a speed, a side and a top, in [0, 540) unless options
        of frames add more.
    aim : {"absolute", "target"}, optional
        Reference direction of the aim in a box action: +x (default), or the line of the best pot or, without one, of a fair stroke.
    observation : {"flat", "balls", "masked"}, optional
        "flat" (default): one array. "balls": a dict of two arrays. "masked", with ``action="discrete"``: a dict of the flat array and the
        available choices.
    noise : str, dict or Noise, optional
        Execution errors: the name of a level, or standard deviations, see ``snooker_env.tasks.Noise``. Default "none".
    reward : {"points", "points_and_fouls", "pots", "legal", "win", "frames"}, optional
        Default "points". The first four are available in a visit, "points" and "win" in a frame, "frames" also in a match.
    elevation : bool, optional
        Whether a box action holds the elevation of the cue; default False.
    placement : bool, optional
        Whether a box action holds the place in the D for a cue ball in hand; default False.
    physics : str, dict, Physics or None, optional
        Physical constants, as ``Physics.of`` takes them, with snooker's ball radius. Default "paper".
    table : str or Table, optional
        "match" (default), "tight", or a ``Table`` whose noses are where snooker's are.
    fidelity : str, optional
        How impacts are solved: "fast", "standard" (default), "reference" or "euler:N".
    opponent : str or Path, optional
        In a frame: "none" (default), or what ``snooker_env.player`` takes: the name of a player, a model's ``.zip``, ... Environments
        also take objects as their keyword ``opponent`` (docs/environment/opponents.md); their options then say "object".
    miss : {"off", "clear_path", "attempt"}, optional
        In a frame: the rule for a foul and a miss (docs/environment/rules.md). Default "off".
    decision : bool, optional
        In a frame: whether a box action holds the decision after a foul of the opponent; default False.
    max_strokes : int or None, optional
        In a frame: number of strokes of both players after which the referee stops it; default 1000, None for never. A match stops with it.
    one_stroke : bool, optional
        In a visit: whether it ends after its first stroke; default False.
    trust : bool, optional
        In a frame: whether code in an opponent's ``.zip`` may run; default False.
    nominate : bool, optional
        In a frame: whether an action names the colour after a red, and a free ball. Default False: the colour struck first is taken as the
        one nominated.
    concede, claim : bool, optional
        In a frame: whether the striker's action may concede the frame, or claim it where the rules allow it. Default False.
    lot : bool, optional
        In a frame: whether the winner of the lot for a re-spotted black may let the other player begin. Default False: he begins.
    game : {"snooker", "six_red", "shoot_out"}, optional
        In a frame: the rules of the game (``snooker_env.game.rule_sets``). Default "snooker".
    time_to_play : float, optional
        In a frame of the Shoot Out: the time from the rest of the balls to the next stroke [s], at most 15; default 9.
    frames : int, optional
        In a match: the most frames that it can have, an odd number; default 7.

    Attributes
    ----------
    rules : Rules
        The same options in the form that the kernels need.

    Raises
    ------
    ValueError
        If an option is unknown, has the wrong type, or conflicts with another. The message names the field.

    Examples
    --------
    >>> from snooker_env import Options
    >>> options = Options(task="frame", noise="club")
    >>> options.noise, options.but(noise="none").noise
    ('club', 'none')
    """

    task: Literal["visit", "frame", "match"] = "visit"
    layout: str = "default"
    action: Literal["box", "discrete"] = "box"
    aim: Literal["absolute", "target"] = "absolute"
    observation: ObservationKind = "flat"
    noise: NoiseLike = "none"
    reward: Literal["points", "points_and_fouls", "pots", "legal", "win", "frames"] = "points"
    elevation: bool = False
    placement: bool = False
    physics: PhysicsLike = "paper"
    table: TableLike = "match"
    fidelity: Fidelity = "standard"
    opponent: str | Path = "none"
    miss: MissRule = "off"
    decision: bool = False
    max_strokes: int | None = MAX_STROKES
    one_stroke: bool = False
    trust: bool = False
    nominate: bool = False
    concede: bool = False
    claim: bool = False
    lot: bool = False
    game: RulesName = "snooker"
    time_to_play: float = TIME_TO_PLAY
    frames: int = FRAMES
    rules: Rules = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        frame = choice("task", self.task, TASKS) != "visit"
        physics, table = self._physics(), table_of(self.table)
        fidelity, noise = parse_fidelity(self.fidelity), Noise.of(self.noise)
        for name, read in (("physics", physics), ("noise", noise)):
            if isinstance(getattr(self, name), dict):  # a dict may change later
                object.__setattr__(self, name, read)
        actions = self._actions(physics)
        default = isinstance(self.layout, str) and self.layout == "default"
        layout = LAYOUTS[self.task] if default else self.layout
        if self.game == "six_red" and isinstance(layout, str) and layout == "break_off":
            layout = f"break_off:{rule_set(self.game).reds}"
        plan = fitted(layout, table)
        if choice("observation", self.observation, observations.OBSERVATIONS) == "masked" and not isinstance(actions, Choices):
            raise refuse("observation", self.observation, 'must be "flat" or "balls" with action="box": a Box has no masks')
        truth("trust", self.trust)
        choice("reward", self.reward, {"visit": REWARDS, "frame": FRAME_REWARDS, "match": MATCH_REWARDS}[self.task])
        one_stroke = truth("one_stroke", self.one_stroke)
        limit = NEVER
        frames = self._frames()
        if frame:
            choice("miss", self.miss, MISS_RULES)
            choice("game", self.game, RULES)
            if rule_set(self.game).anywhere and self.miss != "off":
                raise refuse("miss", self.miss, f'must be "off" with game="{self.game}", in which no miss is called')
            if not rule_set(self.game).clock and self.time_to_play != TIME_TO_PLAY:
                raise refuse("time_to_play", self.time_to_play, f'must be {TIME_TO_PLAY} with game="{self.game}", which has no clock')
            limit = NEVER if self.max_strokes is None else integer("max_strokes", self.max_strokes, 1, 10**9)
            if not isinstance(self.opponent, str | Path) or not str(self.opponent):
                raise refuse("opponent", self.opponent, "must be text in Options; pass an object to the environment, beside them")
            object.__setattr__(self, "opponent", str(self.opponent))
            if one_stroke:
                raise refuse("one_stroke", True, f'must be False with task="{self.task}"; it belongs to task="visit"')
        else:
            self._check_visit()
        read = Rules(
            actions, noise, physics, table, fidelity, plan, self.reward, self.observation, self.miss, limit, one_stroke, frames,
            self.game, round(1000 * number("time_to_play", self.time_to_play, 0.001, MOST_TIME)),
        )  # fmt: skip
        object.__setattr__(self, "rules", read)

    def _frames(self) -> int:
        """The length of a match; 0 for another task."""
        if self.task != "match":
            if type(self.frames) is not int or self.frames != FRAMES:
                raise refuse("frames", self.frames, f'must be {FRAMES} with task="{self.task}"; it belongs to task="match"')
            return 0
        if integer("frames", self.frames, 1, 999) % 2 == 0:
            raise refuse("frames", self.frames, "must be odd, so that one player wins")
        return int(self.frames)

    def _physics(self) -> Physics:
        physics = Physics.of(self.physics)
        if physics.R != BALL_RADIUS:
            raise refuse("physics.R", physics.R, f"must be {BALL_RADIUS} in Snooker-v0: spots, rack and pockets are made for it")
        physics.check_stopping()
        return physics

    def _actions(self, physics: Physics) -> Actions | Choices:
        said = {"nominate": self.nominate, "concede": self.concede, "claim": self.claim, "lot": self.lot}
        if choice("action", self.action, ACTIONS) == "box":
            return Actions(self.aim, self.elevation, self.placement, physics, self.decision, **said)
        for name in ("elevation", "placement", "decision"):
            if getattr(self, name) is not False:
                raise refuse(name, getattr(self, name), 'must be False with action="discrete"')
        choice("aim", self.aim, AIMS)  # checked but unused: the aim is solved
        return Choices(physics, **said)

    def _check_visit(self) -> None:
        """Raise ValueError if an option of frames is changed in a visit."""
        usual = {f.name: f.default for f in fields(self)}
        for name in FRAME_ONLY:
            value = getattr(self, name)
            if not isinstance(value, (type(usual[name]), np.bool_)) or value != usual[name]:
                raise refuse(name, value, f'must be {usual[name]!r} with task="visit"; it belongs to task="frame"')

    def but(self, **changes: Any) -> "Options":
        """Return a copy with some options changed.

        Parameters
        ----------
        **changes
            Fields and their new values.

        Returns
        -------
        Options
            The new options, validated.

        Raises
        ------
        ValueError
            For the same reasons as ``Options``.

        Examples
        --------
        >>> from snooker_env import Options
        >>> Options().but(layout="line_up").layout
        'line_up'
        """
        return replace(self, **changes)


FRAME_ONLY = ("opponent", "trust", "miss", "decision", "max_strokes", "nominate", "concede", "claim", "lot", "game", "time_to_play")
"""Options that have a meaning in the frame task only."""
NAMES = tuple(f.name for f in fields(Options) if f.init)


def observation_space_of(options: Options) -> spaces.Box | spaces.Dict:
    """The observation space of a game with these options."""
    rules = options.rules
    choices = rules.actions.choices if isinstance(rules.actions, Choices) else 0
    return observations.space(options.observation, frame=options.task != "visit", replaced=rules.misses, choices=choices)


def options_of(options: Options | None, given: Mapping[str, Any]) -> Options:
    """The ``Options`` of an environment that was given ``options`` (None or an ``Options``) and the keywords ``given``.

    Raises ValueError for invalid values, TypeError for an unknown keyword.
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
