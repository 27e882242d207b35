"""How is the game of an environment configured? All options in one immutable object, validated together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .._lib.check import choice, integer, number, refuse, refuse_what, truth
from .._lib.types import CueKind, Fidelity, Floats, MissRule, ObservationKind, Solver
from ..game.frame import MISS_RULES
from ..game.layouts import STORED_IN, LayoutPlan, bank, plan_of
from ..game.rule_sets import RULES, RuleSet, RulesName, rule_set
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics import conditions
from ..physics.cue_room import NO_RAILS, rails_of
from ..physics.impact.contact import parse_fidelity
from ..physics.parameters import Physics, PhysicsLike, physics_with
from ..physics.table import SAME_BALL, UNBOUNDED, Table, TableLike, deepest
from . import observations
from .box_actions import AIMS, Actions
from .declarations import SAYS
from .discrete_actions import Choices
from .kernel_arrays import Packed, pack_cue
from .noise import Noise, NoiseLike
from .rewards import FRAME_REWARDS, MATCH_REWARDS, REWARDS
from .stroke_menu import LEAST_SPEEDS, MOST_SPEEDS, SPEEDS, Menu

TASKS = ("visit", "frame", "match")
MOST_TIME = 15.0  # the most time to play [s]: the longest shot clock, after which no stroke is in time
TIME_TO_PLAY = 9.0
"""Default time [s] between strokes, with a clock: some 14 s a stroke in all, as in professionals' Shoot Out."""
ACTIONS = ("box", "discrete", "strokes")
CONDITIONS = ("fixed", "drawn")
CUES = ("free", "real")
LAYOUTS = {"visit": "opened", "frame": "break_off", "match": "break_off"}
"""What layout="default" means in each task."""
MAX_STROKES = 1000
"""Default number of strokes after which the referee stops a frame. Random players that aim near a pot needed
284 on average, at most 560 in 2,000 frames (docs/environment/frames.md); some players never finish."""
FRAMES = 7  # default length of a match: best of 7
OPPONENTS = """must be one of 'none', 'random', 'ghost_ball', the name of another player, a model's file, or an \
object: a player or an OpponentPool; players.SeenPlayer wraps an object that acts on observations"""
OBJECT = "object"  # as the option ``opponent``: whoever was passed to the environment as an object
NEVER = 2**62  # stands for no limit of strokes or steps
_NOSES_AGREE = 1e-9  # tolerance of noses, jaws and falls [m]


def table_of(table: TableLike) -> Table:
    """The ``Table`` of an environment's argument; ValueError unless it leaves every place free that a layout may deal: the noses
    must be snooker's, and no jaw or fall may reach a ball at |x| <= 0.86275, |y| <= 1.75825."""
    cloth = Table.of(table)
    if cloth is UNBOUNDED:
        raise refuse("table", table, 'must be "match", "tight" or a Table')
    if cloth.ball_radius is not None and abs(cloth.ball_radius - BALL_RADIUS) > SAME_BALL:
        made = f"this one is made for balls of radius {cloth.ball_radius:g} m, snooker's have {BALL_RADIUS:g}"
        allowed = f'must be "match", "tight" or a Table of snooker\'s bed in Snooker-v0: {made}'
        raise refuse("table", cloth.name, allowed)
    _check_noses(cloth)
    _check_pockets(cloth)
    most = (observations.REACH - 1.0) * HALF_WIDTH
    if (past := deepest(cloth.jaws, cloth.falls, cloth.bounds, BALL_RADIUS)) > most:
        allowed = f"must let no ball rest more than {most:.3g} m past the noses, where observations end (one can {past:.3g} m past them)"
        raise refuse("table", cloth.name, allowed)
    return cloth


def _check_noses(cloth: Table) -> None:
    for axis, half in enumerate((HALF_WIDTH, HALF_LENGTH)):
        for side in (-1, 1):
            levels = cloth.noses[(cloth.noses[:, 0] == axis) & (cloth.noses[:, 1] == side), 2]
            if not len(levels) or np.abs(levels - half).max() > _NOSES_AGREE:
                at = f"{'xy'[axis]} = {side * half:g}"
                places = ", ".join(f"{side * level:g}" for level in levels) or "none"
                allowed = f"must have its noses at {at} in Snooker-v0, whose layouts are made for that bed (found {places})"
                raise refuse("table", cloth.name, allowed)


def _check_pockets(cloth: Table) -> None:
    room = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS
    kinds = ("jaws", cloth.jaws, BALL_RADIUS), ("falls", cloth.falls, 0.0)
    for name, circles, more in kinds:
        reach = circles[:, 2] + more
        inside = reach - np.hypot(*np.maximum(np.abs(circles[:, :2]) - room, 0.0).T)
        if len(inside) and inside.max() > _NOSES_AGREE:
            k = int(inside.argmax())
            free = f"|x| <= {room[0]:g}, |y| <= {room[1]:g} in Snooker-v0, whose layouts put balls there"
            into = f"{name}[{k}], its whole circle, reaches {inside[k]:.3g} m into that"
            allowed = f"must leave a ball's centre free in {free}: {into}"
            raise refuse("table", cloth.name, allowed)


def fit_plan(layout: str, cloth: Table) -> LayoutPlan:
    """The ``LayoutPlan`` of a layout on a table, without the stored tables that do not fit its pockets."""
    plan = plan_of(layout)
    return plan_of(layout, _unfit(cloth, STORED_IN[layout][0])) if len(plan.tables) else plan


@lru_cache(8)
def _unfit(cloth: Table, which: str) -> tuple[int, ...]:
    """Indices of the tables of a bank with a ball, as dealt or mirrored, in a jaw or over a fall."""
    if cloth is Table.preset("match"):
        return ()  # the stored tables were played on it
    tables = bank(which)
    return tuple(sorted({*cloth.unfit(tables, BALL_RADIUS), *cloth.unfit(tables * (-1.0, 1.0), BALL_RADIUS)}))


@dataclass(frozen=True)
class Rules:
    """The options of a game in the form that the kernels need, as ``Options.rules`` holds them."""

    actions: Actions | Choices
    noise: Noise
    physics: Physics
    table: Table
    fidelity: Solver  # as ``parse_fidelity`` returns it
    plan: LayoutPlan  # how tables are dealt
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
    speeds: int = SPEEDS  # cue speeds along each pot of a menu

    @property
    def rule_set(self) -> RuleSet:
        """The ``RuleSet`` of the game."""
        return rule_set(self.game)

    def pack(self) -> Packed:
        """For the kernels, with one row of cues and constants for all tables."""
        errors = self.noise.pack(BALL_RADIUS, real=self.cue == "real")
        cues, phys = self.cue_row[None], self.physics.packed_for(self.fidelity)[None]
        return self.actions.pack(), cues, errors, phys

    @property
    def cue_row(self) -> Floats:
        """The cue's row, of ``kernel_arrays.pack_cue``."""
        return pack_cue(self.physics, self.rails)

    @property
    def rails(self) -> Floats:
        """The rails that the cue passes over, as of ``cue_room.rails_of``; none: it is free."""
        return rails_of(self.table.noses, self.table.falls) if self.cue == "real" else NO_RAILS


GROUPS: dict[str, tuple[str, ...]] = {
    "task": ("task", "layout", "reward", "one_stroke", "opponent", "trust", "frames"),
    "action": ("action", "aim", "elevation", "placement", "says"),
    "view": ("observation", "speeds", "observe_conditions"),
    "shot": ("noise", "physics", "table", "fidelity", "cue", "conditions"),
    "frame": ("miss", "max_strokes", "game", "time_to_play"),
}
"""Groups of options: the game, the actions, the view, the world of a shot, the rules of frames."""
_OF_FRAMES = "opponent", "trust", "miss", "max_strokes", "says", "game", "time_to_play"
_ONLY: dict[str, str] = {**dict.fromkeys(_OF_FRAMES, "frame"), "frames": "match"}
"""The only task that has an option; a match has every option of a frame."""


def _order_says(says: object) -> tuple[str, ...]:
    """The option ``says`` in the order of ``SAYS``."""
    if isinstance(says, str) or not isinstance(says, Collection):
        raise refuse("says", says, f"must be a sequence of some of {', '.join(map(repr, SAYS))}")
    spoken = {choice("says", name, SAYS) for name in says}
    return tuple(name for name in SAYS if name in spoken)


@dataclass(frozen=True, kw_only=True)
class Options:
    """All options of a game: the keywords of ``gymnasium.make("Snooker-v0", ...)``, validated together. ValueError names a
    field of the wrong type or in conflict with another; TypeError an unknown one.

    Parameters
    ----------
    task : str, default "visit"
        "visit": build a break until the first miss or foul. "frame": play a whole frame. "match": the best of several.
    layout : str, default "default"
        How tables are dealt (docs/environment/layouts.md): "opened", "held_out", "safety", "held_out_safety", "escape",
        "held_out_escape", "break_off", "break_off:N" (a rack of N reds), "line_up", "colours", "random:N" (N reds),
        "snookered", "pots:easy", "pots:medium" or "pots:hard". "default": "opened", in a frame "break_off".
    action : str, default "box"
        "box": numbers in [-1, 1]. "discrete": one integer that means a pot, a speed, a side and a top, in [0, 540)
        unless ``says`` adds more. "strokes": one integer that means a stroke on a menu for the position, in [0, 108), in a
        frame [0, 158).
    aim : str, default "pot"
        What the aim of a box action means. "pot": it picks a pot, else a fair stroke's line, for which the aim is solved.
        "absolute": a direction from +x. "target": an angle from the best pot's line, else from a fair stroke's.
    observation : str, default "default"
        "pots", of a visit: one array of the four widest pots. "flat": one array of all balls. "balls": the same as a
        dict of two. "masked", with ``action="discrete"``: a dict of the flat array and the available choices. "strokes": one
        array of what a player foresees of each stroke on the menu.
        "default": "pots", in a frame "flat".
    noise : str, dict or Noise, default "none"
        Execution errors: "none", "professional", "amateur", "club", "beginner", "robot", "olympiad", or standard deviations as a
        dict of the fields of ``snooker_env.tasks.Noise``.
    reward : str, default "points"
        "points"; of a visit "points_and_fouls", "pots" or "legal"; of a frame "win"; of a match also "frames".
    elevation : bool or float, default False
        Whether a box action has a number for the elevation of the cue: up to 30 degrees, or up to the degrees given (5 to 70).
    placement : bool, default False
        Whether a box action has two numbers for the place of a cue ball in hand.
    speeds : int, default 9
        Cue speeds along each pot of the menu, from 2 to 20: it has 12 times as many strokes, in a frame 50 more.
    physics : str, dict, Physics or None, default "paper"
        "paper", "match", or a dict of overrides as ``Physics.of`` takes them; balls keep the radius of snooker balls.
    table : str or Table, default "match"
        "match", "tight", or a ``Table`` with cushions where a snooker table has them.
    fidelity : str, default "standard"
        How impacts are solved (docs/physics/fidelity.md): "fast", "standard", "reference" or "euler:N".
    cue : str, default "free"
        "free": the cue passes through rails and balls. "real": it is raised over them, and errors grow with its elevation.
    conditions : str, default "fixed"
        "drawn": each episode draws eight constants of its table (docs/environment/conditions.md). Infos hold them.
    observe_conditions : bool, default False
        Whether observations include the drawn constants, scaled to [-1, 1].
    one_stroke : bool, default False
        Whether an episode ends with its first stroke; in a frame with the first that is no foul, after 20 steps at most.
        Not of a match.
    opponent : str or Path, default "none"
        Of a frame: "none", or what ``snooker_env.player`` takes: a player's name, a model's ``.zip`` and more. Several
        names with commas are a pool, of whom one is drawn for each frame: "search,planner".
        Environments also take objects (docs/environment/opponents.md); their options then say "object".
    trust : bool, default False
        Of a frame: whether code in an opponent's ``.zip`` may run.
    miss : str, default "off"
        Of a frame: "off", "clear_path" or "attempt", the rule for a foul and a miss (docs/environment/rules.md).
    max_strokes : int or None, default 1000
        Of a frame: strokes of both players after which the referee stops it and its match; None: never.
    says : sequence of str, default ()
        Of a frame: what an action says beside the stroke, some of "nominate" (the colour after a red, and a free ball;
        else the one struck first), "decision" (after a foul; box actions only), "concede", "claim" (the frame, if the
        rules allow it) and "lot" (whether the winner of the lot for a re-spotted black lets the other player begin).
    game : str, default "snooker"
        Of a frame: "snooker", "six_red" or "shoot_out", the rules of the game (docs/environment/rules.md).
    time_to_play : float, default 9.0
        Of a frame of the Shoot Out: the time from the rest of the balls to the next stroke [s], at most 15.
    frames : int, default 7
        Of a match: an odd number, the most frames that it can have.

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
    action: Literal["box", "discrete", "strokes"] = "box"
    aim: Literal["pot", "absolute", "target"] = "pot"
    observation: Literal["default"] | ObservationKind = "default"
    noise: NoiseLike = "none"
    reward: Literal["points", "points_and_fouls", "pots", "legal", "win", "frames"] = "points"
    elevation: bool | float = False
    placement: bool = False
    speeds: int = SPEEDS
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
    rules: Rules = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "says", _order_says(self.says))
        frame = choice("task", self.task, TASKS) != "visit"
        physics, table = self._physics(), table_of(self.table)
        fidelity, noise = parse_fidelity(self.fidelity), Noise.of(self.noise)
        for name, read in (("physics", physics), ("noise", noise)):
            if isinstance(getattr(self, name), dict):  # a dict may change later
                object.__setattr__(self, name, read)
        integer("speeds", self.speeds, LEAST_SPEEDS, MOST_SPEEDS)
        actions = self._actions()
        choice("cue", self.cue, CUES)
        default = isinstance(self.layout, str) and self.layout == "default"
        layout = LAYOUTS[self.task] if default else self.layout
        if self.game == "six_red" and isinstance(layout, str) and layout == "break_off":
            layout = f"break_off:{rule_set(self.game).reds}"
        plan = fit_plan(layout, table)
        kinds = observations.OBSERVATIONS[frame:]  # "pots" is of visits alone
        choice("observation", self.observation, ("default", *kinds))
        kind = kinds[0] if self.observation == "default" else self.observation
        if kind == "masked" and not isinstance(actions, Choices):
            allowed = 'must be "pots", "flat" or "balls" with action="box": a Box has no masks'
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
        frames = integer("frames", self.frames, 1, 999) if self.task == "match" else 0
        if self.task == "match" and frames % 2 == 0:
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
                words = "Options hold text only: pass an object to the environment, beside them"
                raise refuse("opponent", self.opponent, f"{OPPONENTS}; {words}")
            object.__setattr__(self, "opponent", str(self.opponent))
        pause = round(1000 * number("time_to_play", self.time_to_play, 0.001, MOST_TIME))
        world = actions, noise, physics, table, fidelity, plan, self.reward, kind
        play = self.miss, limit, one_stroke, frames, self.game, pause
        read = Rules(*world, *play, drawn, observed, self.cue, self.speeds)
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
        for end in zip(*conditions.RANGES.values(), strict=True) if drawn else ():
            try:
                physics_with(physics, end).check_stopping()
            except ValueError as error:
                allowed = f"must be 'fixed' with these physics, which do not suit every table drawn: {error}"
                raise refuse("conditions", "drawn", allowed) from None
        return drawn, observed

    def _actions(self) -> Actions | Choices:
        if (kind := choice("action", self.action, ACTIONS)) == "box":
            return Actions(self.aim, self.elevation, self.placement, self.says)
        for name in ("elevation", "placement"):
            if getattr(self, name) is not False:
                raise refuse(name, getattr(self, name), f'must be False with action="{kind}"')
        if kind == "strokes" and self.says:
            raise refuse("says", self.says, 'must be () with action="strokes"')
        if "decision" in self.says:
            raise refuse("says", self.says, 'must not hold "decision" with action="discrete"')
        choice("aim", self.aim, AIMS)  # checked but unused: the aim is solved
        return Menu(self.speeds, frame=self.task != "visit") if kind == "strokes" else Choices(self.says)

    def _check_task(self) -> None:
        """Raise ValueError if an option of another task is changed."""
        for f in _FIELDS:
            only, value = _ONLY.get(f.name), getattr(self, f.name)
            if only is None or self.task == only or (self.task == "match" and only == "frame"):
                continue
            if not isinstance(value, (type(f.default), np.bool_)) or value != f.default:
                allowed = f'must be {f.default!r} with task="{self.task}"; it belongs to task="{only}"'
                raise refuse(f.name, value, allowed)

    @classmethod
    def group(cls, name: str, task: str | None = None) -> dict[str, Any]:
        """Name and default of each option of a group of ``GROUPS``, or of those of this ``task``. ValueError for an unknown one."""
        members = GROUPS[choice("name", name, GROUPS)]
        kinds = TASKS if task is None else {"match": TASKS[1:]}.get(choice("task", task, TASKS), (task,))
        keys = {key for key in members if _ONLY.get(key) in (None, *kinds)}
        return {f.name: f.default for f in _FIELDS if f.name in keys}

    def but(self, **changes: object) -> "Options":
        """Return a validated copy with some fields changed. ValueError as of ``Options``."""
        return replace(self, **changes)


_FIELDS = tuple(f for f in fields(Options) if f.init)
NAMES = tuple(f.name for f in _FIELDS)


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
