"""How does a frame between two players go on? A pure, serialisable state machine around the referee.

    frame = Frame.start(breaker=0)
    frame, verdict = frame.play(stroke)         # a Stroke from a simulation, or any other
    frame = frame.choose("play")                # after a foul the opponent decides
    Frame.from_dict(json.loads(json.dumps(frame.to_dict()))) == frame

A ``Frame`` never changes: each act packs it into a row, lets a kernel of ``frame_columns`` change that row, and
unpacks the next frame. Players are 0 and 1. An act that is not allowed raises ValueError. The caller decides on
stalemates (``restart``) and the lot for a re-spotted black; docs/environment/rules.md has the miss rules."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what, truth
from .._lib.jit import entry
from .._lib.types import Ints, MissRule
from . import frame_columns as columns
from .balls import ALL_MASK, BLACK, CUE_BIT, REDS_MASK, BallOn, next_on, points_available
from .frame_columns import Conditions, Effort, Layouts
from .referee import FULL_TABLE, MOST_POINTS, Situation, Stroke, Verdict, ruling_of, verdict_of
from .rule_sets import MOST_MISSES, RuleSet, RulesName, rule_set

MOST_BREAK = 155
"""The highest break (a free ball and the colour after it, then 147), points still on the table included."""
SETTLED: dict[str, Any] = {"ball_on": BallOn.NOTHING, "failures": 0, "saved": None, "misses": 0}
SETTLED |= dict.fromkeys(("free_ball", "miss_called", "warned", "anywhere"), False)
"""The fields of a frame that is over."""


def faults(frame: "Frame") -> Iterator[tuple[bool, str, str]]:
    """Pairs of fields that the rules forbid: (whether this is so, the field, what is allowed)."""
    stroke, after_foul, missing = frame.phase == "stroke", frame.phase == "choice", frame.miss != "off"
    rules = frame.rule_set
    known = frame.on_table | (0 if frame.saved is None else frame.saved.on_table)
    came = 1 << BLACK if frame.respotted_black else 0  # it comes though the frame began without it
    yield bool(known & ~(frame.rack | came)), "rack", "must hold the balls of on_table, and of saved"
    if frame.phase == "over":
        for name, value in SETTLED.items():
            yield getattr(frame, name) != value, name, f'must be {value!r} in phase "over"'
        return
    lowest, left = next_on(frame.on_table), MOST_BREAK - frame.available
    allowed = f'must be {lowest}, the lowest on_table, except in phase "stroke"'
    yield not stroke and frame.ball_on != lowest, "ball_on", allowed
    allowed = f"must be 0 (any colour) or {lowest}, the lowest on_table"
    yield frame.ball_on not in (BallOn.ANY_COLOUR, lowest), "ball_on", allowed
    allowed = f"must be at most {left}: on_table and ball_on offer {frame.available} more"
    yield frame.break_points > left, "break_points", allowed
    new, allowed = frame.free_ball or not stroke, 'must be 0 except in phase "stroke" without free_ball'
    yield new and frame.break_points != 0, "break_points", allowed
    level = frame.on_table == 1 << BLACK and frame.scores[0] == frame.scores[1]
    allowed = "must be False except with level scores and only the black on_table"
    yield frame.respotted_black and not level, "respotted_black", allowed
    lot = frame.phase == "lot" and not frame.respotted_black
    yield lot, "phase", 'must not be "lot" without respotted_black'
    called = after_foul and missing and frame.saved is not None
    allowed = 'must be False except in phase "choice" with a miss rule and saved'
    yield frame.miss_called and not called, "miss_called", allowed
    counting = missing and frame.saved is not None and (stroke or frame.miss_called)
    allowed = 'must be 0 except with a miss rule, saved, and either miss_called or phase "stroke"'
    yield frame.failures > 0 and not counting, "failures", allowed
    warned = stroke and frame.failures == 2
    allowed = f'must be {warned}: True in phase "stroke" with two failures, else False'
    yield frame.warned != warned, "warned", allowed
    yield frame.anywhere and not frame.in_hand, "anywhere", "must be False except with in_hand"
    placed, these = rules.anywhere or rules.most_misses > 0, f"with rules = {frame.rules!r}"
    yield frame.anywhere and not placed, "anywhere", f"must be False {these}"
    yield frame.clock > 0 and not rules.clock, "clock", f"must be 0 {these}, which has no clock"
    late = 0 < rules.clock <= frame.clock and not frame.respotted_black
    yield late, "clock", f"must be below {rules.clock} ms, when the frame ends"
    allowed = f'must not be "choice" {these}: the opponent has nothing to choose'
    yield rules.anywhere and after_foul, "phase", allowed
    yield rules.anywhere and frame.free_ball, "free_ball", f"must be False {these}"
    counted = rules.most_misses and missing and (stroke or frame.miss_called)
    allowed = 'must be 0 except in six-red snooker after a miss: miss_called, or in phase "stroke"'
    yield frame.misses > 0 and not counted, "misses", allowed
    uncounted = frame.miss_called and rules.most_misses > 0 and not frame.misses
    yield uncounted, "misses", "must be above 0 in six-red snooker with miss_called"
    if frame.saved is not None:
        allowed = 'must be None except in phase "choice", or in phase "stroke" with a miss rule'
        yield not (after_foul or (stroke and missing)), "saved", allowed
        gone = frame.saved.on_table ^ frame.on_table
        lost = gone & ~REDS_MASK or gone & frame.on_table
        allowed = "must have the balls on_table after the foul, and no others except reds"
        yield after_foul and lost != 0, "saved", allowed
        for name in ("on_table", "ball_on", "in_hand", "free_ball", "anywhere"):
            other = getattr(frame.saved, name) != getattr(frame, name)
            allowed = f'must have the present {name}: in phase "stroke" it has just been restored'
            yield stroke and other, "saved", allowed


def check_fields(field: str, plain: object, kind: type) -> None:
    """Raise ValueError unless ``plain`` is a dict with exactly the fields of the dataclass ``kind``."""
    names = [part.name for part in fields(kind)]
    if not isinstance(plain, dict) or set(plain) != set(names):
        what = f"a dict of {list(plain)}" if isinstance(plain, dict) else repr(plain)
        raise refuse_what(field, what, "must be a dict and must have exactly the fields " + ", ".join(names))


@contextmanager
def within(field: str) -> Iterator[None]:
    """Prefix the message of a ValueError with ``field``."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{field}.{error}") from None


def tuples(value: object) -> Any:
    """Nested lists, as JSON returns them, as nested tuples."""
    return tuple(map(tuples, value)) if isinstance(value, list | tuple) else value


Choice: TypeAlias = Literal["play", "play_again", "replace", "anywhere"]  # what may be chosen after a foul
CHOICES = get_args(Choice)
PHASES = ("stroke", "choice", "lot", "over")
MISS_RULES = ("off", "clear_path", "attempt")  # names by the codes of ``frame_columns``
MOST_CLOCK = 2**50  # upper limit of a frame's clock [ms]
_NUMBERS = ("striker", "breaker", "on_table", "failures", "clock", "misses", "rack")
_INTEGERS = {name: getattr(columns, name.upper()) for name in _NUMBERS} | {"break_points": columns.POINTS}
_TRUTHS = ("in_hand", "free_ball", "respotted_black", "miss_called", "warned", "anywhere")
_FLAGS = {name: getattr(columns, name.upper()) for name in _TRUTHS}
"""The columns of the fields of a ``Frame`` that are plain integers, and bools."""


class _Answers(NamedTuple):
    """What a frame allows."""

    needs_snookers: tuple[bool, bool]
    shot_clock: int
    miss: int  # REPLACE or PLACE_ANYWHERE, if the opponent may choose it; else PLAY
    claim: bool


@entry
def _ask(row, rules):
    needs = columns.needs_snookers(row, 0), columns.needs_snookers(row, 1)
    after_miss = columns.allowed_choice(row, columns.REPLACE, rules)
    return _Answers(needs, columns.shot_clock(row, rules), after_miss, columns.may_claim(row))


_play = entry(columns.after_stroke, what="the rules of frames", seconds=1)
_CHOOSE, _DRAW, _CLAIM, _CONCEDE = range(4)


@entry
def _act(row, act, number):
    if act == _CHOOSE:
        columns.choose(row, number)
    elif act == _DRAW:
        columns.draw(row, number)
    elif act == _CLAIM:
        columns.claim(row)
    else:
        columns.concede(row)


@dataclass(frozen=True, kw_only=True)
class Saved:
    """The position before a stroke, to be restored after a foul and a miss; other fields as in ``Frame``."""

    on_table: int
    ball_on: BallOn
    in_hand: bool
    free_ball: bool
    anywhere: bool = False
    layout: tuple[Any, ...] | None = None  # the caller's record, for JSON; stored and returned, never read

    def __post_init__(self) -> None:
        _set(self, "on_table", _object_balls(self.on_table))
        for name in ("in_hand", "free_ball", "anywhere"):
            _set(self, name, truth(name, getattr(self, name)))
        at = Situation(on_table=self.on_table, ball_on=self.ball_on, free_ball=self.free_ball)
        _set(self, "ball_on", at.ball_on)


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame between two strokes."""

    scores: tuple[int, int] = (0, 0)  # of the two players
    striker: int = 0  # the next player; in phase "choice" who chooses, in "lot" the last striker
    breaker: int = 0  # who broke off; unchanged by a restart
    break_points: int = 0  # of the striker's visit so far
    on_table: int = FULL_TABLE  # mask of the object balls
    ball_on: BallOn = BallOn.RED  # what the striker must hit first
    in_hand: bool = True  # the stroke is played from the D
    free_ball: bool = False  # the striker may nominate one; in phase "choice": after the choice to play
    respotted_black: bool = False  # scores were level
    phase: Literal["stroke", "choice", "lot", "over"] = "stroke"  # next: play, choose, draw, nothing
    winner: int | None = None  # in phase "over" only
    rules: RulesName = "snooker"  # one of ``rule_sets.RULES``
    miss: MissRule = "off"  # one of ``MISS_RULES``; "off" in the Shoot Out, which has none
    miss_called: bool = False  # the last stroke was a foul and a miss, so that the position may be replaced
    failures: int = 0  # misses in succession from one position with a clear full-ball path
    warned: bool = False  # one more failure loses the frame
    saved: Saved | None = None  # the position before the last stroke, if it was a foul
    clock: int = 0  # simulated time played in a game with a clock [ms]
    misses: int = 0  # in six-red snooker: foul-and-a-miss calls in succession
    anywhere: bool = False  # a cue ball in hand may be placed anywhere on the table, not in the D only
    rack: int = FULL_TABLE  # mask of the object balls that the frame began with, for a restart

    def __post_init__(self) -> None:
        choice("phase", self.phase, PHASES)
        choice("miss", self.miss, MISS_RULES)
        if rule_set(self.rules).anywhere and self.miss != "off":
            allowed = f"must be 'off' with rules = {self.rules!r}: no miss is called in this game"
            raise refuse("miss", self.miss, allowed)
        most = (("break_points", MOST_BREAK), ("failures", 2), ("misses", MOST_MISSES), ("clock", MOST_CLOCK))
        for name, high in (("striker", 1), ("breaker", 1), *most):
            _set(self, name, integer(name, getattr(self, name), 0, high))
        for name in _TRUTHS:
            _set(self, name, truth(name, getattr(self, name)))
        if not isinstance(self.scores, tuple) or len(self.scores) != 2:
            raise refuse("scores", self.scores, "must be a tuple of two integers")
        scores = (integer(f"scores[{k}]", n, 0, MOST_POINTS) for k, n in enumerate(self.scores))
        _set(self, "scores", tuple(scores))
        _set(self, "on_table", _object_balls(self.on_table))
        _set(self, "rack", _object_balls(self.rack, "rack"))
        if self.saved is not None and not isinstance(self.saved, Saved):
            raise refuse("saved", self.saved, "must be a Saved or None")
        if (self.winner is None) == (self.phase == "over"):
            raise refuse("winner", self.winner, 'must be 0 or 1 in phase "over", else None')
        if self.phase == "over":
            _set(self, "winner", integer("winner", self.winner, 0, 1))
            _set(self, "ball_on", BallOn(integer("ball_on", self.ball_on, BallOn.NOTHING, BallOn.BLACK)))
        else:
            _set(self, "ball_on", self.situation.ball_on)  # the situation checks it against the table

    @classmethod
    def start(
        cls,
        *,
        breaker: int = 0,
        miss: MissRule = "off",
        on_table: int | None = None,
        rules: RulesName = "snooker",
    ) -> "Frame":
        """A new frame. ``on_table``: mask of the balls, for a start with others than the rule set's."""
        balls = rule_set(rules).on_table
        if on_table is not None:
            balls = integer("on_table", on_table, 0, ALL_MASK) & ~CUE_BIT
        game = {"rules": rules, "miss": miss, "on_table": balls, "rack": balls}
        return cls(striker=breaker, breaker=breaker, ball_on=BallOn(next_on(balls)), **game)

    @property
    def rule_set(self) -> RuleSet:
        """The ``RuleSet`` of ``rules``."""
        return rule_set(self.rules)

    @property
    def situation(self) -> Situation:
        """The ``Situation`` in which the referee judges the next stroke."""
        lead = self.scores[self.striker] - self.scores[1 - self.striker]
        on, free = self.ball_on, self.free_ball
        return Situation(on_table=self.on_table, ball_on=on, free_ball=free, lead=lead, rules=self.rules)

    @property
    def available(self) -> int:
        """The most points that the striker can still score."""
        return points_available(self.on_table, self.ball_on, self.free_ball)

    def _do(self, act, number=0):
        """The frame after one of the acts of ``_act``."""
        row = _pack(self)
        _act(row, act, number)
        return _unpack(row, self.rules, self.miss, None if self.saved is None else self.saved.layout)

    def _answers(self):
        return _ask(_pack(self), self.rule_set.code)

    def needs_snookers(self, player: int) -> bool:
        """Whether ``player`` trails by more than is left for them; a free ball is the striker's alone."""
        return self._answers().needs_snookers[integer("player", player, 0, 1)]

    def _in_phase(self, phase, act):
        if self.phase != phase:
            raise refuse("phase", self.phase, f"must be {phase!r} to {act}")

    def play(
        self,
        stroke: Stroke,
        *,
        clear_path: bool = False,
        full_ball_path: bool = False,
        attempt: bool = True,
        layout: tuple[Any, ...] | None = None,
        time_to_play: int = 0,
        duration: int = 0,
    ) -> tuple["Frame", Verdict]:
        """One stroke: the next frame and the referee's ``Verdict``.

        ``clear_path``, ``full_ball_path`` (``paths.best_paths`` before the stroke) and ``attempt`` (whether the cue ball came near
        a ball on) are for the miss rules; ``layout``: see ``Saved``. For a clock [ms]: ``time_to_play`` before the stroke,
        ``duration`` after it; a stroke later than the shot clock counts as ``Stroke(late=True)``."""
        self._in_phase("stroke", "play")
        late, lasted, rules = False, 0, self.rule_set
        integer("time_to_play", time_to_play, 0, MOST_CLOCK)
        if rules.clock:
            late = 0 < self._answers().shot_clock < time_to_play
            lasted = integer("duration", duration, 0, MOST_CLOCK)
        result = ruling_of(self.situation, Stroke(late=True) if late else stroke)
        conditions = Conditions(rules.code, MISS_RULES.index(self.miss), int(time_to_play))
        row, effort = _pack(self), Effort(bool(clear_path), bool(full_ball_path), bool(attempt))
        _play(row, result, conditions, effort, layout is not None, lasted)
        return _unpack(row, self.rules, self.miss, layout), verdict_of(result)

    @property
    def choices(self) -> tuple[Choice, ...]:
        """The opponent's choices after a foul; empty in other phases."""
        if self.phase != "choice":
            return ()
        after_miss = self._answers().miss
        return CHOICES[:2] if after_miss == columns.PLAY else (*CHOICES[:2], CHOICES[after_miss])

    def choose(self, what: Choice) -> "Frame":
        """The opponent's decision after a foul, which is final.

        "play": the opponent plays the table as it lies, with the free ball, if any. "play_again": the offender plays it,
        without. "replace", after a miss: the offender plays from ``saved``. "anywhere", after the last miss in
        succession: the opponent plays from anywhere, without a free ball."""
        self._in_phase("choice", "choose")
        choice("choice", what, self.choices)
        if what == "replace" and self.saved is None:
            raise refuse("saved", None, 'must be the position before the miss to choose "replace"')
        return self._do(_CHOOSE, CHOICES.index(what))

    def draw(self, first: int) -> "Frame":
        """The winner of the lot has chosen that player ``first`` begins at the re-spotted black."""
        self._in_phase("lot", "draw")
        return self._do(_DRAW, integer("first", first, 0, 1))

    @property
    def may_claim(self) -> bool:
        """Whether the striker may claim the frame: only the black is left and the lead is more than 7."""
        return self._answers().claim

    def claim(self) -> "Frame":
        """The striker claims the frame."""
        if not self.may_claim:
            allowed = "must be over 7 with only the black left"
            raise refuse("lead", self.situation.lead if self.phase == "stroke" else self.phase, allowed)
        return self._do(_CLAIM)

    def concede(self, player: int) -> "Frame":
        """``player`` concedes the frame; only the striker may."""
        if integer("player", player, 0, 1) != self.striker or self.phase not in ("stroke", "choice"):
            raise refuse("player", player, "must be the striker of a frame that is not over")
        return self._do(_CONCEDE)

    def restart(self) -> "Frame":
        """A stalemate: scores are void, the balls of ``rack`` are set up again and the same player breaks."""
        if self.phase == "over":
            raise refuse("phase", self.phase, "must not be over to restart")
        return Frame.start(breaker=self.breaker, miss=self.miss, rules=self.rules, on_table=self.rack)

    def to_dict(self) -> dict[str, Any]:
        """The frame as plain numbers, strings, lists and None, for JSON."""
        plain = asdict(self) | {"scores": list(self.scores), "ball_on": int(self.ball_on)}
        if self.saved is not None:
            plain["saved"]["ball_on"] = int(self.saved.ball_on)
        return plain

    @classmethod
    def from_dict(cls, plain: dict[str, Any], field: str = "frame") -> "Frame":
        """The frame of ``to_dict``, also after JSON; ValueError names the wrong part of ``field``."""
        check_fields(field, plain, cls)
        saved, scores = plain["saved"], plain["scores"]
        if saved is not None:
            check_fields(f"{field}.saved", saved, Saved)
            with within(f"{field}.saved"):
                saved = Saved(**saved | {"layout": tuples(saved["layout"])})
        scores = tuple(scores) if isinstance(scores, list) else scores
        with within(field):
            frame = cls(**plain | {"scores": scores, "saved": saved})
            for wrong, name, allowed in faults(frame):
                if wrong:
                    value = "a position" if name == "saved" else repr(getattr(frame, name))
                    raise refuse_what(name, value, allowed)
        return frame


def _pack(frame):
    """A ``Frame`` as a row of ``frame_columns``, but for the layout that is stored with it."""
    row = np.zeros(columns.COLUMNS, np.int64)
    for name, column in (*_INTEGERS.items(), *_FLAGS.items()):
        row[column] = getattr(frame, name)
    row[columns.BALL_ON], row[columns.PHASE] = frame.ball_on, PHASES.index(frame.phase)
    row[columns.SCORE_0], row[columns.SCORE_1] = frame.scores
    row[columns.WINNER] = -1 if frame.winner is None else frame.winner
    row[columns.OVER] = frame.phase == "over"
    saved = frame.saved
    if saved is not None:
        row[columns.SAVED], row[columns.SAVED_LAYOUT] = 1, saved.layout is not None
        row[columns.SAVED_ON_TABLE], row[columns.SAVED_BALL_ON] = saved.on_table, saved.ball_on
        row[columns.SAVED_FREE_BALL] = saved.free_ball
        row[columns.SAVED_IN_HAND] = saved.in_hand + saved.anywhere
    return row


def _unpack(row, rules, miss, layout):
    """The ``Frame`` of a row; ``layout``: the one stored with it, if any."""
    at = row.tolist()
    saved = None
    if at[columns.SAVED]:
        placed, kept = at[columns.SAVED_IN_HAND], layout if at[columns.SAVED_LAYOUT] else None
        balls = {"on_table": at[columns.SAVED_ON_TABLE], "ball_on": BallOn(at[columns.SAVED_BALL_ON])}
        cue = {"in_hand": placed > 0, "anywhere": placed == 2}
        saved = Saved(**balls, **cue, free_ball=bool(at[columns.SAVED_FREE_BALL]), layout=kept)
    fields: dict[str, Any] = {name: at[column] for name, column in _INTEGERS.items()}
    fields |= {name: bool(at[column]) for name, column in _FLAGS.items()}
    fields |= {"scores": (at[columns.SCORE_0], at[columns.SCORE_1]), "ball_on": BallOn(at[columns.BALL_ON])}
    fields |= {"phase": PHASES[at[columns.PHASE]], "rules": rules, "miss": miss, "saved": saved}
    return Frame(**fields, winner=None if at[columns.WINNER] < 0 else at[columns.WINNER])


def frame_of(row: Ints, miss: MissRule, layouts: Layouts, k: int, rules: RulesName = "snooker") -> Frame:
    """The ``Frame`` of a row (COLUMNS,) of a table; row k of ``layouts`` is what may be replaced."""
    layout = None
    if row[columns.SAVED_LAYOUT]:
        layout = tuple(map(tuple, layouts.positions[k].tolist())), tuple(layouts.on_table[k].tolist())
    return _unpack(row, rules, miss, layout)


def write_frame(frame: Frame, strokes: int, row: Ints, layouts: Layouts, k: int) -> None:
    """Write a checked ``Frame`` into the row (COLUMNS,) of a table, its layout into row k of ``layouts``."""
    row[:] = _pack(frame)
    row[columns.STROKES] = strokes
    if frame.saved is not None and frame.saved.layout is not None:
        layouts.positions[k], layouts.on_table[k] = map(np.array, frame.saved.layout)


def _set(frozen, name, value):
    object.__setattr__(frozen, name, value)


def _object_balls(mask, name="on_table"):
    if integer(name, mask, 0, ALL_MASK) & CUE_BIT:
        raise refuse(name, mask, "must name object balls only")
    return int(mask)
