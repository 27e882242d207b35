"""How is the game of an environment configured? All options in one immutable object, validated together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import InitVar, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from gymnasium import spaces

from .._check import choice, integer, number, refuse, refuse_what, truth
from .._types import CueKind, Fidelity, Floats, MissRule, ObservationKind, Solver
from ..game.frame import MISS_RULES
from ..game.layouts import Plan
from ..game.rule_sets import RULES, RuleSet, RulesName, rule_set
from ..geometry import BALL_RADIUS
from ..physics import conditions
from ..physics.cue_room import NO_RAILS, rails_of
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike, physics_with
from ..physics.table import Table, TableLike
from . import observations
from .box_actions import AIMS, Actions
from .declarations import SAYS
from .discrete_actions import Choices
from .noise import Noise, NoiseLike
from .rewards import FRAME_REWARDS, MATCH_REWARDS, REWARDS
from .table_fit import fitted, table_of

TASKS = ("visit", "frame", "match")
MOST_TIME = 15.0
"""The most time to play [s]: the longest shot clock. With more no stroke would ever be in time."""
TIME_TO_PLAY = 9.0
"""Default time [s] between strokes, with a clock: some 14 s a stroke in all, as in professionals' Shoot Out."""
ACTIONS = ("box", "discrete")
CONDITIONS = ("fixed", "drawn")
CUES = ("free", "real")
LAYOUTS = {"visit": "opened", "frame": "break_off", "match": "break_off"}
"""What layout="default" means in each task."""
MAX_STROKES = 1000
"""Default number of strokes after which the referee stops a frame. Random players that aim near a pot needed
284 on average, at most 560 in 2,000 frames (docs/environment/frames.md); some players never finish."""
FRAMES = 7
"""Default length of a match: best of 7."""
OPPONENTS = """must be one of 'none', 'random', 'ghost_ball', the name of another player, a model's file, or an \
object: a player or an OpponentPool; players.SeenPlayer makes a player of what acts on observations"""
_UNSAID: Any = object()
OBJECT = "object"  # as the option ``opponent``: whoever was passed to the environment as an object
NEVER = 2**62  # stands for no limit of strokes or steps


@dataclass(frozen=True)
class Rules:
    """The options of a game in the form that the kernels need, as ``Options.rules`` holds them."""

    actions: Actions | Choices
    noise: Noise
    physics: Physics
    table: Table
    fidelity: Solver  # as ``parse_fidelity`` returns it
    plan: Plan  # how tables are dealt
    reward: str
    observation: ObservationKind
    miss: MissRule = "off"  # of a frame, as all below but one: the rule for a foul and a miss
    max_strokes: int = NEVER  # strokes of both players after which it is stopped
    one_stroke: bool = False  # whether an episode ends with its first stroke
    frames: int = 0  # in a match: of how many frames at most; 0 for a single frame, which is no match
    game: RulesName = "snooker"  # the rule set
    time_to_play: int = 0  # with a clock: from the rest of the balls to the next stroke [ms]
    drawn: bool = False  # whether each episode draws ``physics.conditions`` of its table
    observed: bool = False  # whether observations hold them
    cue: CueKind = "free"  # whether rails and balls are in the way of the cue

    @property
    def rule_set(self) -> RuleSet:
        """The ``RuleSet`` of the game."""
        return rule_set(self.game)

    @property
    def misses(self) -> bool:
        """Whether a foul and a miss is called."""
        return self.miss != "off"

    def packed(self) -> tuple[Floats, Floats, Floats]:
        """For the kernels: options of the action, deviations of the noise, physical parameters. The first and
        the last are one row, for all tables."""
        errors = self.noise.pack(BALL_RADIUS, real=self.cue == "real")
        phys = self.physics.packed_for(self.fidelity)[None]
        return self.with_rails(self.actions.pack())[None], errors, phys

    @property
    def rails(self) -> Floats:
        """The rails that the cue passes over, as of ``cue_room.rails_of``; none: it is free."""
        return rails_of(self.table.noses, self.table.falls) if self.cue == "real" else NO_RAILS

    def with_rails(self, options: Floats) -> Floats:
        """Packed options of actions, with the rails."""
        return np.concatenate([options, self.rails])


GROUPS = {
    "task": ("task", "layout", "reward", "one_stroke", "opponent", "trust", "frames"),
    "action": ("action", "aim", "elevation", "placement", "says"),
    "view": ("observation", "observe_conditions"),
    "shot": ("noise", "physics", "table", "fidelity", "cue", "conditions"),
    "frame": ("miss", "max_strokes", "game", "time_to_play"),
}
"""Groups of options: what is played, how one acts, what one sees, what decides a shot, rules of frames."""
_OF_FRAMES = "opponent", "trust", "miss", "max_strokes", "says", "game", "time_to_play"
_ONLY: dict[str, str] = {**dict.fromkeys(_OF_FRAMES, "frame"), "frames": "match"}
"""The only task that has an option; what is of a frame is of a match, too."""


def _said(says: object, flags: Mapping[str, Any]) -> tuple[str, ...]:
    """The option ``says`` with the flags that are its other spelling, in the order of ``SAYS``."""
    if isinstance(says, str) or not isinstance(says, Collection):
        raise refuse("says", says, f"must be a sequence of some of {', '.join(map(repr, SAYS))}")
    spoken = {choice("says", name, SAYS) for name in says}
    for name, flag in flags.items():
        if flag is not _UNSAID:
            spoken = spoken | {name} if truth(name, flag) else spoken - {name}
    return tuple(name for name in SAYS if name in spoken)


@dataclass(frozen=True, kw_only=True)
class Options:
    """All options of a game: the keywords of ``gymnasium.make("Snooker-v0", ...)``, validated together. ValueError, which
    names the field, if one is of the wrong type or conflicts with another; TypeError for an unknown one.

    Parameters
    ----------
    task : {"visit", "frame", "match"}, optional
        "visit" (default): build a break until the first miss or foul. "frame": play a whole frame. "match":
        the best of several; what is said below of a frame holds for a match, too.
    layout : str, optional
        How tables are dealt: "opened", "held_out", "safety", "held_out_safety", "escape", "held_out_escape",
        "break_off", "line_up", "colours", "random:N" (N reds), "snookered", "pots:easy", "pots:medium" or
        "pots:hard". "default": "opened", in a frame "break_off".
    action : {"box", "discrete"}, optional
        "box" (default): numbers in [-1, 1]. "discrete": one integer that means a pot, a speed, a side and a
        top, in [0, 540) unless options of frames add more.
    aim : {"absolute", "target"}, optional
        Where a box action's aim is measured from: +x (default), or the best pot's line, else a fair stroke's.
    observation : {"flat", "balls", "masked"}, optional
        "flat" (default): one array. "balls": a dict of two. "masked", with ``action="discrete"``: a dict of
        the flat array and the available choices.
    noise : str, dict or Noise, optional
        Execution errors: the name of a level, or standard deviations, see ``Noise``. Default "none".
    reward : {"points", "points_and_fouls", "pots", "legal", "win", "frames"}, optional
        Default "points". The first four are of a visit, "points" and "win" of a frame, "frames" also of a match.
    elevation : bool or float, optional
        Whether a box action holds the elevation of the cue; True: up to 30 degrees; or up to so many degrees, 5 to 70.
    placement : bool, optional
        Whether it holds the place of a cue ball in hand. Default False.
    physics : str, dict, Physics or None, optional
        As ``Physics.of`` takes them, with snooker's ball radius. Default "paper".
    table : str or Table, optional
        "match" (default), "tight", or a ``Table`` whose noses are where snooker's are.
    cue : {"free", "real"}, optional
        "free" (default): the cue passes through rails and balls. "real": it is raised over them as far as it
        must be, and errors grow with its elevation (docs/environment/specification.md).
    fidelity : str, optional
        How impacts are solved: "fast", "standard" (default), "reference" or "euler:N".
    conditions : {"fixed", "drawn"}, optional
        "drawn": each episode draws eight constants of its table, in place of those of ``physics``, as
        ``Physics.drawn`` does, with its own random stream. Infos hold them. Default "fixed".
    observe_conditions : bool, optional
        Whether observations hold the constants drawn, from -1 to 1. Default False.
    opponent : str or Path, optional
        In a frame: "none" (default), or what ``snooker_env.player`` takes: a player's name, a model's
        ``.zip``, ... Environments also take objects (docs/environment/opponents.md); their options then say
        "object".
    miss : {"off", "clear_path", "attempt"}, optional
        In a frame: the rule for a foul and a miss (docs/environment/rules.md). Default "off".
    max_strokes : int or None, optional
        In a frame: strokes of both after which the referee stops it and its match; default 1000, None: never.
    one_stroke : bool, optional
        Whether an episode ends with its first stroke; in a frame, where the agent then begins, with its first one that
        is no foul, when it is its turn again without a choice to make, after 20 steps at most. Not of a match.
        Default False.
    trust : bool, optional
        In a frame: whether code in an opponent's ``.zip`` may run. Default False.
    says : sequence of str, optional
        In a frame: what an action says beside the stroke, some of "nominate" (the colour after a red, and a
        free ball; else the one struck first), "decision" (after a foul, of box actions only), "concede",
        "claim" (the frame, where the rules allow it) and "lot" (whether the winner of the lot for a re-spotted
        black lets the other player begin; else it begins). Default: nothing.
    nominate, decision, concede, claim, lot : bool, optional
        Whether ``says`` has them: ``decision=True`` adds "decision" to it. To be read as attributes, too.
    game : {"snooker", "six_red", "shoot_out"}, optional
        In a frame: the rules of the game (``snooker_env.game.rule_sets``). Default "snooker".
    time_to_play : float, optional
        In a frame of the Shoot Out: from the rest of the balls to the next stroke [s], at most 15; default 9.
    frames : int, optional
        In a match: the most frames that it can have, an odd number; default 7.

    Attributes
    ----------
    rules : Rules
        The same options in the form that the kernels need.

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
    elevation: bool | float = False
    placement: bool = False
    physics: PhysicsLike = "paper"
    table: TableLike = "match"
    fidelity: Fidelity = "standard"
    cue: CueKind = "free"
    conditions: Literal["fixed", "drawn"] = "fixed"
    observe_conditions: bool = False
    one_stroke: bool = False
    opponent: str | Path = "none"
    trust: bool = False
    miss: MissRule = "off"
    max_strokes: int | None = MAX_STROKES
    says: Sequence[str] = ()
    game: RulesName = "snooker"
    time_to_play: float = TIME_TO_PLAY
    frames: int = FRAMES
    nominate: InitVar[bool] = _UNSAID
    decision: InitVar[bool] = _UNSAID
    concede: InitVar[bool] = _UNSAID
    claim: InitVar[bool] = _UNSAID
    lot: InitVar[bool] = _UNSAID
    rules: Rules = field(init=False, repr=False, compare=False)

    def __post_init__(self, *flags: object) -> None:
        object.__setattr__(self, "says", _said(self.says, dict(zip(SAYS, flags, strict=True))))
        frame = choice("task", self.task, TASKS) != "visit"
        physics, table = self._physics(), table_of(self.table)
        fidelity, noise = parse_fidelity(self.fidelity), Noise.of(self.noise)
        for name, read in (("physics", physics), ("noise", noise)):
            if isinstance(getattr(self, name), dict):  # a dict may change later
                object.__setattr__(self, name, read)
        actions = self._actions(physics)
        choice("cue", self.cue, CUES)
        default = isinstance(self.layout, str) and self.layout == "default"
        layout = LAYOUTS[self.task] if default else self.layout
        if self.game == "six_red" and isinstance(layout, str) and layout == "break_off":
            layout = f"break_off:{rule_set(self.game).reds}"
        plan = fitted(layout, table)
        kind = choice("observation", self.observation, observations.OBSERVATIONS)
        if kind == "masked" and not isinstance(actions, Choices):
            allowed = 'must be "flat" or "balls" with action="box": a Box has no masks'
            raise refuse("observation", self.observation, allowed)
        truth("trust", self.trust)
        drawn, observed = self._conditions(physics)
        rewards = {"visit": REWARDS, "frame": FRAME_REWARDS, "match": MATCH_REWARDS}
        choice("reward", self.reward, rewards[self.task])
        one_stroke = truth("one_stroke", self.one_stroke)
        if one_stroke and self.task == "match":
            raise refuse("one_stroke", True, 'must be False with task="match"')
        limit = NEVER
        self._check_task()
        frames = self.frames if self.task == "match" else 0
        if self.task == "match" and integer("frames", frames, 1, 999) % 2 == 0:
            raise refuse("frames", frames, "must be odd, so that one player wins")
        if frame:
            choice("miss", self.miss, MISS_RULES)
            choice("game", self.game, RULES)
            if rule_set(self.game).anywhere and self.miss != "off":
                allowed = f'must be "off" with game="{self.game}", in which no miss is called'
                raise refuse("miss", self.miss, allowed)
            if not rule_set(self.game).clock and self.time_to_play != TIME_TO_PLAY:
                allowed = f'must be {TIME_TO_PLAY} with game="{self.game}", which has no clock'
                raise refuse("time_to_play", self.time_to_play, allowed)
            limit = NEVER if self.max_strokes is None else integer("max_strokes", self.max_strokes, 1, 10**9)
            if not isinstance(self.opponent, str | Path) or not str(self.opponent):
                allowed = f"{OPPONENTS}; Options hold text: pass an object to the environment, beside them"
                raise refuse("opponent", self.opponent, allowed)
            object.__setattr__(self, "opponent", str(self.opponent))
        pause = round(1000 * number("time_to_play", self.time_to_play, 0.001, MOST_TIME))
        world = actions, noise, physics, table, fidelity, plan, self.reward, self.observation
        read = Rules(
            *world, self.miss, limit, one_stroke, frames, self.game, pause, drawn, observed, self.cue
        )
        object.__setattr__(self, "rules", read)

    def _physics(self) -> Physics:
        physics = Physics.of(self.physics)
        if physics.R != BALL_RADIUS:
            allowed = f"must be {BALL_RADIUS} in Snooker-v0: spots, rack and pockets are made for it"
            raise refuse("physics.R", physics.R, allowed)
        physics.check_stopping()
        return physics

    def _conditions(self, physics: Physics) -> tuple[bool, bool]:
        """Whether the constants of tables are drawn, and observed; ValueError if they do not go together."""
        drawn = choice("conditions", self.conditions, CONDITIONS) == "drawn"
        observed = truth("observe_conditions", self.observe_conditions)
        if observed and not drawn:
            allowed = 'must be False with conditions="fixed": there is nothing to observe'
            raise refuse("observe_conditions", True, allowed)
        for end in (conditions.LOW, conditions.HIGH) if drawn else ():
            try:
                physics_with(physics, end).check_stopping()
            except ValueError as error:
                allowed = f"must be 'fixed' with these physics, which do not go with a table drawn: {error}"
                raise refuse("conditions", "drawn", allowed) from None
        return drawn, observed

    def _actions(self, physics: Physics) -> Actions | Choices:
        if choice("action", self.action, ACTIONS) == "box":
            return Actions(self.aim, self.elevation, self.placement, physics, self.says)
        for name in ("elevation", "placement", "decision"):
            if getattr(self, name) is not False:
                raise refuse(name, getattr(self, name), 'must be False with action="discrete"')
        choice("aim", self.aim, AIMS)  # checked but unused: the aim is solved
        return Choices(physics, self.says)

    def _check_task(self) -> None:
        """Raise ValueError if an option of another task is changed."""
        for f in _FIELDS:
            only, value = _ONLY.get(f.name), getattr(self, f.name)
            if only is None or self.task == only or (self.task == "match" and only == "frame"):
                continue
            if not isinstance(value, (type(f.default), np.bool_)) or value != f.default:
                says = f.name == "says"
                name, value, usual = (self.says[0], True, False) if says else (f.name, value, f.default)
                allowed = f'must be {usual!r} with task="{self.task}"; it belongs to task="{only}"'
                raise refuse(name, value, allowed)

    @classmethod
    def group(cls, name: str, task: str | None = None) -> dict[str, Any]:
        """Return name and default of each option of a group: "task", "action", "view", "shot" or "frame";
        with ``task``, of those that this task has. ValueError if there is no such group or task."""
        members = GROUPS[choice("name", name, GROUPS)]
        kinds = TASKS if task is None else {"match": TASKS[1:]}.get(choice("task", task, TASKS), (task,))
        keys = {key for key in members if _ONLY.get(key) in (None, *kinds)}
        return {f.name: f.default for f in _FIELDS if f.name in keys}

    def but(self, **changes: Any) -> "Options":
        """Return a validated copy with some fields changed. ValueError as of ``Options``."""
        flags = dict.fromkeys(SAYS, _UNSAID) if "says" in changes else {}  # else they are those of this one
        return replace(self, **flags | changes)


_FIELDS = tuple(f for f in fields(Options) if f.init)
NAMES = (*(f.name for f in _FIELDS), *SAYS)


def _has(name):
    def has(self) -> bool:
        return name in self.says

    return property(has, doc=f'Whether ``says`` has "{name}", a bool.')


for _name in SAYS:
    setattr(Options, _name, _has(_name))


def observation_space_of(
    options: Options, actions: Actions | Choices | None = None
) -> spaces.Box | spaces.Dict:
    """The observation space of a game with these options, for a player with these ``actions`` if they differ."""
    rules, frame = options.rules, options.task != "visit"
    actions = rules.actions if actions is None else actions
    choices = actions.choices if isinstance(actions, Choices) else 0
    more = {"replaced": rules.misses, "conditions": rules.observed}
    return observations.space(options.observation, frame=frame, choices=choices, **more)


def options_of(options: Options | None, keywords: Mapping[str, Any]) -> Options:
    """The ``Options`` that are ``options`` or of the ``keywords``; TypeError for an unknown keyword."""
    if options is None:
        for name in keywords:
            if name not in NAMES:
                allowed = f"got an unexpected keyword argument {name!r}; the options are {', '.join(NAMES)}"
                raise TypeError(allowed)
        return Options(**keywords)
    if not isinstance(options, Options):
        raise refuse("options", options, "must be an Options or None")
    if keywords:
        allowed = f"must be None with the keywords {sorted(keywords)}: change them with options.but(...)"
        raise refuse_what("options", "an Options", allowed)
    return options
