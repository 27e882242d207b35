"""How does a frame between two players go on? A pure, serialisable state machine around the referee, without physics.

    frame = Frame.start(breaker=0)
    frame, verdict = frame.play(stroke)         # a Stroke from a simulation, or any other
    frame = frame.choose("play")                # after a foul the opponent decides
    Frame.from_dict(json.loads(json.dumps(frame.to_dict()))) == frame

A ``Frame`` never changes: each act returns the next one. Players are 0 and 1. An act that is not allowed raises ``ValueError``.

A foul and a miss: ``miss="off"`` never calls it (an agent could be sent back to the same position for ever). ``miss="clear_path"`` calls
it where geometry alone decides: the striker failed to strike a ball on first although a straight path to a part of one was clear. It is
not called when either player needed penalty points before or after the stroke, or when the points left equalled the difference. After a
miss with a clear full-ball path, a second failure from the same position is a miss whatever the scores; then the striker is warned, and
the third loses the frame.

Left out, because a simulator cannot judge it: whether an attempt was the best possible (so no miss is called on a snookered striker) and
whether a failure was deliberate; when there is a stalemate (``restart`` only carries one out); time wasting and conduct; balls that fall
in unprovoked or are moved by others; fouls before the stroke on a replaced position. The lot for a re-spotted black is passed in.
"""

from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Literal, TypeAlias

from .._check import choice, integer, refuse, refuse_what, truth
from .._types import MissRule
from .balls import ALL_MASK, BLACK, COLOURS_MASK, CUE_BIT, REDS_MASK, VALUES, BallOn, ids_of, next_on
from .referee import FULL_TABLE, MOST_POINTS, Situation, Stroke, Verdict, judge
from .ruling import Foul, Outcome

Choice: TypeAlias = Literal["play", "play_again", "replace"]
"""What may be chosen after a foul."""

PHASES = ("stroke", "choice", "lot", "over")
MISS_RULES = ("off", "clear_path")
MOST_BREAK = 155
"""The highest break: a free ball and the colour after it, then 147. A break and the points still on the table are never more together."""


def points_available(on_table: int, ball_on: int) -> int:
    """The most points that can still be scored: 8 for each red, 7 if a colour is on after a red, and the values of the colours."""
    reds = bin(on_table & REDS_MASK).count("1")
    return 8 * reds + 7 * (ball_on == BallOn.ANY_COLOUR) + int(sum(VALUES[i] for i in ids_of(on_table & COLOURS_MASK)))


@dataclass(frozen=True, kw_only=True)
class Saved:
    """The position before a stroke, to be restored after a foul and a miss.

    Attributes
    ----------
    on_table : int
        Mask of the object balls on the table.
    ball_on : BallOn
        What the striker must hit first.
    in_hand : bool
        The stroke is played from the D.
    free_ball : bool
        The striker had a free ball.
    layout : tuple or None
        The caller's own record of the positions, anything that JSON can hold. It is stored and returned, never read.
    """

    on_table: int
    ball_on: BallOn
    in_hand: bool
    free_ball: bool
    layout: tuple[Any, ...] | None = None

    def __post_init__(self) -> None:
        _set(self, "on_table", _object_balls(self.on_table))
        for name in ("in_hand", "free_ball"):
            _set(self, name, truth(name, getattr(self, name)))
        _set(self, "ball_on", Situation(on_table=self.on_table, ball_on=self.ball_on, free_ball=self.free_ball).ball_on)


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame between two strokes.

    Attributes
    ----------
    scores : (int, int)
        Points of the two players.
    striker : int
        The player who is next. In phase "choice" the one who chooses; in phase "lot" the last striker.
    breaker : int
        The player who broke off; unchanged by a restart.
    break_points : int
        Points of the striker's visit so far.
    on_table : int
        Mask of the object balls on the table.
    ball_on : BallOn
        What the striker must hit first.
    in_hand : bool
        The stroke is played from the D.
    free_ball : bool
        The striker may nominate a free ball (in phase "choice": after the choice to play).
    respotted_black : bool
        The black has been re-spotted: scores were level.
    phase : {"stroke", "choice", "lot", "over"}
        "stroke": ``play`` is next. "choice": after a foul, ``choose``. "lot": before a re-spotted black, ``draw``. "over".
    winner : int, or None
        The player who has won; None before the end.
    miss : {"off", "clear_path"}
        The rule for a foul and a miss: one of ``MISS_RULES``.
    miss_called : bool
        The last stroke was a foul and a miss, so that the position may be replaced.
    failures : int
        Misses in succession from one position with a clear full-ball path.
    warned : bool
        The striker has been warned that one more failure loses the frame.
    saved : Saved, or None
        The position before the last stroke, if it was a foul.
    """

    scores: tuple[int, int] = (0, 0)
    striker: int = 0
    breaker: int = 0
    break_points: int = 0
    on_table: int = FULL_TABLE
    ball_on: BallOn = BallOn.RED
    in_hand: bool = True
    free_ball: bool = False
    respotted_black: bool = False
    phase: Literal["stroke", "choice", "lot", "over"] = "stroke"
    winner: int | None = None
    miss: MissRule = "off"
    miss_called: bool = False
    failures: int = 0
    warned: bool = False
    saved: Saved | None = None

    def __post_init__(self) -> None:
        choice("phase", self.phase, PHASES)
        choice("miss", self.miss, MISS_RULES)
        for name, high in (("striker", 1), ("breaker", 1), ("break_points", MOST_BREAK), ("failures", 2)):
            if not _plain(getattr(self, name), high):
                _set(self, name, integer(name, getattr(self, name), 0, high))
        for name in ("in_hand", "free_ball", "respotted_black", "miss_called", "warned"):
            if type(getattr(self, name)) is not bool:
                _set(self, name, truth(name, getattr(self, name)))
        if not isinstance(self.scores, tuple) or len(self.scores) != 2:
            raise refuse("scores", self.scores, "must be a tuple of two integers")
        if not all(_plain(points, MOST_POINTS) for points in self.scores):
            _set(self, "scores", tuple(integer(f"scores[{k}]", points, 0, MOST_POINTS) for k, points in enumerate(self.scores)))
        _set(self, "on_table", _object_balls(self.on_table))
        if self.saved is not None and not isinstance(self.saved, Saved):
            raise refuse("saved", self.saved, "must be a Saved or None")
        if (self.winner is None) == (self.phase == "over"):
            raise refuse("winner", self.winner, 'must be 0 or 1 in phase "over", else None')
        if self.phase == "over":
            _set(self, "winner", integer("winner", self.winner, 0, 1))
            _set(self, "ball_on", BallOn(integer("ball_on", self.ball_on, BallOn.NOTHING, BallOn.BLACK)))
        else:
            _set(self, "ball_on", self.situation.ball_on)  # the situation checks it against the table

    def _faults(self):
        """Pairs of fields that the rules forbid: (whether this is so, the field, what is allowed)."""
        stroke, after_foul, missing = self.phase == "stroke", self.phase == "choice", self.miss != "off"
        if self.phase == "over":
            for name, value in _SETTLED.items():
                yield getattr(self, name) != value, name, f'must be {value!r} in phase "over"'
            return
        lowest, left = next_on(self.on_table), MOST_BREAK - self.available
        yield not stroke and self.ball_on != lowest, "ball_on", f'must be {lowest}, the lowest on_table, except in phase "stroke"'
        yield self.ball_on not in (BallOn.ANY_COLOUR, lowest), "ball_on", f"must be 0 (any colour) or {lowest}, the lowest on_table"
        yield self.break_points > left, "break_points", f"must be at most {left}: on_table and ball_on offer {self.available} more"
        new = self.free_ball or not stroke
        yield new and self.break_points != 0, "break_points", 'must be 0 except in phase "stroke" without free_ball'
        level = self.on_table == 1 << BLACK and self.scores[0] == self.scores[1]
        yield self.respotted_black and not level, "respotted_black", "must be False except with level scores and only the black on_table"
        yield self.phase == "lot" and not self.respotted_black, "phase", 'must not be "lot" without respotted_black'
        called = after_foul and missing and self.saved is not None
        yield self.miss_called and not called, "miss_called", 'must be False except in phase "choice" with a miss rule and saved'
        counting = missing and self.saved is not None and (stroke or self.miss_called)
        allowed = 'must be 0 except with a miss rule, saved, and either miss_called or phase "stroke"'
        yield self.failures > 0 and not counting, "failures", allowed
        warned = stroke and self.failures == 2
        yield self.warned != warned, "warned", f'must be {warned}: True in phase "stroke" with two failures, else False'
        if self.saved is not None:
            allowed = 'must be None except in phase "choice", or in phase "stroke" with a miss rule'
            yield not (after_foul or (stroke and missing)), "saved", allowed
            gone = self.saved.on_table ^ self.on_table
            lost = gone & ~REDS_MASK or gone & self.on_table
            yield after_foul and lost, "saved", "must have the balls on_table after the foul, and no others except reds"
            for name in _REPLACED:
                other = getattr(self.saved, name) != getattr(self, name)
                yield stroke and other, "saved", f'must have the present {name}: in phase "stroke" it has just been restored'

    def _check_fit(self):
        for wrong, name, allowed in self._faults():
            if wrong:
                raise refuse_what(name, "a position" if name == "saved" else repr(getattr(self, name)), allowed)

    @classmethod
    def start(cls, *, breaker: int = 0, miss: MissRule = "off", on_table: int = FULL_TABLE) -> "Frame":
        """A new frame. ``on_table``: mask of the balls, for a start with fewer of them."""
        ball_on = next_on(integer("on_table", on_table, 0, ALL_MASK))
        return cls(striker=breaker, breaker=breaker, miss=miss, on_table=on_table & ~CUE_BIT, ball_on=BallOn(ball_on))

    @property
    def situation(self) -> Situation:
        """The ``Situation`` in which the referee judges the next stroke."""
        lead = self.scores[self.striker] - self.scores[1 - self.striker]
        return Situation(on_table=self.on_table, ball_on=self.ball_on, free_ball=self.free_ball, lead=lead)

    @property
    def available(self) -> int:
        """The most points that can still be scored (without a free ball)."""
        return points_available(self.on_table, self.ball_on)

    def needs_snookers(self, player: int) -> bool:
        """Whether ``player`` trails by more points than can still be scored, and so needs penalty points."""
        integer("player", player, 0, 1)
        return self.scores[1 - player] - self.scores[player] > self.available

    def _in_phase(self, phase, act):
        if self.phase != phase:
            raise refuse("phase", self.phase, f"must be {phase!r} to {act}")

    def _over(self, winner: int, **changes: Any) -> "Frame":
        return replace(self, phase="over", winner=winner, **_SETTLED | changes)

    def play(
        self, stroke: Stroke, *, clear_path: bool = False, full_ball_path: bool = False, layout: tuple[Any, ...] | None = None
    ) -> tuple["Frame", Verdict]:
        """One stroke: the next frame and the referee's ``Verdict``.

        ``clear_path``, ``full_ball_path``: whether before the stroke a straight path was clear to any part, and to the full face, of a
        ball on (``paths.paths``); used with ``miss="clear_path"`` only. ``layout``: see ``Saved``.
        """
        self._in_phase("stroke", "play")
        verdict = judge(self.situation, stroke)
        me, other = self.striker, 1 - self.striker
        gained = {me: verdict.points, other: verdict.penalty}
        score = {"scores": (self.scores[0] + gained[0], self.scores[1] + gained[1]), "on_table": verdict.on_table}
        if verdict.over:
            return self._over(me if verdict.outcome == Outcome.STRIKER_WINS else other, **score), verdict
        after = replace(
            self,
            striker=other if verdict.stays is False else me,
            break_points=self.break_points + verdict.points if verdict.stays else 0,
            ball_on=verdict.ball_on,
            in_hand=verdict.in_hand,
            free_ball=verdict.free_ball,
            miss_called=False,
            failures=0,
            warned=False,
            saved=None,
            **score,
        )
        if verdict.outcome == Outcome.RESPOTTED_BLACK:
            return replace(after, phase="lot", respotted_black=True), verdict
        if not verdict.fouls:
            return after, verdict
        if self.warned and full_ball_path and verdict.fouls & (Foul.NO_CONTACT | Foul.WRONG_FIRST):
            return after._over(other), verdict
        called = self._is_miss(verdict, after, clear_path, full_ball_path)
        saved = Saved(on_table=self.on_table, ball_on=self.ball_on, in_hand=self.in_hand, free_ball=self.free_ball, layout=layout)
        failures = self.failures + 1 if called and full_ball_path else 0
        return replace(after, phase="choice", miss_called=called, failures=failures, saved=saved), verdict

    def _is_miss(self, verdict, after, clear_path, full_ball_path):
        """Whether a foul is a miss too, as far as geometry and scores decide it."""
        if self.miss == "off" or not verdict.fouls & (Foul.NO_CONTACT | Foul.WRONG_FIRST):
            return False
        if full_ball_path and self.failures:
            return True
        decided = any(abs(f.scores[0] - f.scores[1]) >= f.available for f in (self, after))
        return bool(clear_path or full_ball_path) and not decided

    @property
    def choices(self) -> tuple[Choice, ...]:
        """The opponent's choices after a foul; empty in other phases."""
        if self.phase != "choice":
            return ()
        return ("play", "play_again", "replace") if self.miss_called else ("play", "play_again")

    def choose(self, what: Choice) -> "Frame":
        """The opponent's decision after a foul, which is final.

        "play": the opponent plays the table as it lies (with the free ball, if there is one). "play_again": the offender plays it, and
        a free ball is void. "replace", after a miss: ``saved`` is restored and the offender plays from there; the penalty stands.
        """
        self._in_phase("choice", "choose")
        choice("choice", what, self.choices)
        if what == "play":
            return replace(self, phase="stroke", miss_called=False, failures=0, saved=None)
        again = replace(self, phase="stroke", striker=1 - self.striker, free_ball=False, miss_called=False)
        if what == "play_again":
            return replace(again, failures=0, saved=None)
        assert self.saved is not None  # a miss is never called without it
        before = {name: getattr(self.saved, name) for name in _REPLACED}
        return replace(again, warned=self.failures >= 2, **before)

    def draw(self, first: int) -> "Frame":
        """The winner of the lot has chosen that player ``first`` begins at the re-spotted black."""
        self._in_phase("lot", "draw")
        return replace(self, phase="stroke", striker=integer("first", first, 0, 1), break_points=0)

    @property
    def may_claim(self) -> bool:
        """Whether the striker may claim the frame: only the black is left and the lead is more than 7."""
        return self.phase == "stroke" and self.on_table == 1 << BLACK and self.situation.lead > 7

    def claim(self) -> "Frame":
        """The striker claims the frame."""
        if not self.may_claim:
            raise refuse("lead", self.situation.lead if self.phase == "stroke" else self.phase, "must be over 7 with only the black left")
        return self._over(self.striker)

    def concede(self, player: int) -> "Frame":
        """``player`` concedes the frame; only the striker may."""
        if self.phase not in ("stroke", "choice") or integer("player", player, 0, 1) != self.striker:
            raise refuse("player", player, "must be the striker of a frame that is not over")
        return self._over(1 - player)

    def restart(self) -> "Frame":
        """The referee ends a stalemate: scores are void, the balls are set up again and the same player breaks."""
        if self.phase == "over":
            raise refuse("phase", self.phase, "must not be over to restart")
        return Frame.start(breaker=self.breaker, miss=self.miss)

    def to_dict(self) -> dict[str, Any]:
        """The frame as plain numbers, strings, lists and None, for JSON."""
        plain = asdict(self) | {"scores": list(self.scores), "ball_on": int(self.ball_on)}
        if self.saved is not None:
            plain["saved"]["ball_on"] = int(self.saved.ball_on)
        return plain

    @classmethod
    def from_dict(cls, plain: dict[str, Any], field: str = "frame") -> "Frame":
        """The frame from the result of ``to_dict``, also after a round trip through JSON.

        Raises ValueError, which names the wrong part of ``field``; also where the rules forbid a combination of parts.
        """
        _check_fields(field, plain, cls)
        saved, scores = plain["saved"], plain["scores"]
        if saved is not None:
            _check_fields(f"{field}.saved", saved, Saved)
            with _within(f"{field}.saved"):
                saved = Saved(**saved | {"layout": _tuples(saved["layout"])})
        with _within(field):
            frame = cls(**plain | {"scores": tuple(scores) if isinstance(scores, list) else scores, "saved": saved})
            frame._check_fit()
        return frame


_SETTLED = {
    "ball_on": BallOn.NOTHING, "free_ball": False, "miss_called": False, "failures": 0, "warned": False, "saved": None,
}  # fmt: skip
"""The fields of a frame that is over."""

_REPLACED = ("on_table", "ball_on", "in_hand", "free_ball")
"""The fields that are restored with a position that is replaced."""


def _set(frozen, name, value):
    object.__setattr__(frozen, name, value)


def _plain(value, high):
    """Whether it is an int in [0, high]: a quick test before the full check, which it nearly always spares."""
    return type(value) is int and 0 <= value <= high


def _object_balls(mask):
    if integer("on_table", mask, 0, ALL_MASK) & CUE_BIT:
        raise refuse("on_table", mask, "must name object balls only")
    return int(mask)


def _check_fields(field, plain, kind):
    names = [part.name for part in fields(kind)]
    if not isinstance(plain, dict):
        raise refuse(field, plain, "must be a dict with the fields " + ", ".join(names))
    if set(plain) != set(names):
        found = f"a dict without {[n for n in names if n not in plain]} and with the others {[n for n in plain if n not in names]}"
        raise refuse_what(field, found, "must have exactly the fields " + ", ".join(names))


@contextmanager
def _within(field):
    """Prefix the message of a ValueError with ``field``."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{field}.{error}") from None


def _tuples(value):
    """Nested lists, as JSON returns them, as nested tuples."""
    return tuple(map(_tuples, value)) if isinstance(value, list | tuple) else value
