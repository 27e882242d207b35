"""How does a frame between two players go on? A pure, serialisable state machine around the referee, without physics.

    frame = Frame.start(breaker=0)
    frame, verdict = frame.play(stroke)         # a Stroke seen in a simulation, or any other
    frame = frame.choose("play")                # after a foul the opponent decides
    Frame.from_dict(json.loads(json.dumps(frame.to_dict()))) == frame

A ``Frame`` never changes: each act returns the next one. Players are 0 and 1. An act that is not open raises ``ValueError``.

A foul and a miss: ``miss="off"`` never calls it (an agent could be sent back to the same position for ever). ``miss="clear_path"`` calls
what geometry alone decides: the striker failed to strike a ball on first although a straight path to a part of one was clear; not
when either player needed penalty points before or after the stroke, or the points left equalled the difference. After a miss with a
clear full-ball path, a second failure from the same position is a miss whatever the scores, and once warned the third loses the frame.

Left out, because a simulator cannot judge it: whether an attempt was the best that could be made (so no miss is called on a snookered
striker) and whether a failure was deliberate; when a stalemate has come (``restart`` only carries one out); time wasting and conduct;
balls that fall in unprovoked or are moved by others; fouls before the stroke on a replaced position. The lot for a re-spotted black
is not drawn here but passed in.
"""

from dataclasses import asdict, dataclass, fields, replace

from .._check import choice, integer, refuse
from .balls import ALL_MASK, BLACK, COLOURS_MASK, CUE_BIT, REDS_MASK, VALUES, BallOn, ids_of, next_on
from .referee import FULL_TABLE, Situation, judge
from .ruling import Foul, Outcome

PHASES = ("stroke", "choice", "lot", "over")
MISS_RULES = ("off", "clear_path")


def points_available(on_table, ball_on):
    """The most points that the balls on the table still offer: 8 a red, 7 if a colour is on after a red, and the colours' values."""
    reds = bin(on_table & REDS_MASK).count("1")
    return 8 * reds + 7 * (ball_on == BallOn.ANY_COLOUR) + int(sum(VALUES[i] for i in ids_of(on_table & COLOURS_MASK)))


@dataclass(frozen=True, kw_only=True)
class Saved:
    """The position before a stroke, to be restored after a foul and a miss."""

    on_table: int
    ball_on: BallOn
    in_hand: bool
    free_ball: bool
    layout: tuple | None = None
    """The caller's own record of where the balls lay, anything that JSON can hold; it is kept and handed back, not read."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame between two strokes."""

    scores: tuple[int, int] = (0, 0)
    striker: int = 0
    """Who plays next. In phase "choice" the one who chooses; in phase "lot" the last striker."""
    breaker: int = 0
    """Who broke off; kept through a restart."""
    break_points: int = 0
    """Points of the striker's visit so far."""
    on_table: int = FULL_TABLE
    """Mask of the object balls on the table."""
    ball_on: BallOn = BallOn.RED
    in_hand: bool = True
    free_ball: bool = False
    """The striker may nominate a free ball (in phase "choice": if he chooses to play)."""
    respotted_black: bool = False
    phase: str = "stroke"
    """"stroke": ``play`` is next. "choice": after a foul, ``choose``. "lot": before a re-spotted black, ``draw``. "over"."""
    winner: int | None = None
    miss: str = "off"
    """The rule for a foul and a miss: one of ``MISS_RULES``."""
    miss_called: bool = False
    """The last stroke was a foul and a miss, so that the position may be replaced."""
    failures: int = 0
    """Misses in succession from one position with a clear full-ball path."""
    warned: bool = False
    """The striker has been told that one more failure loses the frame."""
    saved: Saved | None = None
    """The position before the last stroke, if it was a foul."""

    def __post_init__(self):
        choice("phase", self.phase, PHASES)
        choice("miss", self.miss, MISS_RULES)
        for name, low, high in (("striker", 0, 1), ("breaker", 0, 1), ("on_table", 0, ALL_MASK), ("break_points", 0, 155)):
            integer(name, getattr(self, name), low, high)
        if not isinstance(self.scores, tuple) or len(self.scores) != 2:
            raise refuse("scores", self.scores, "must be a tuple of two integers")
        for points in self.scores:
            integer("scores", points, 0, 10_000)
        integer("failures", self.failures, 0, 10_000)
        if (self.winner is None) == (self.phase == "over"):
            raise refuse("winner", self.winner, 'must be 0 or 1 in phase "over", else None')
        if self.winner is not None:
            integer("winner", self.winner, 0, 1)
        if self.phase == "over":
            return
        object.__setattr__(self, "ball_on", self.situation.ball_on)  # the situation checks it against the table

    @classmethod
    def start(cls, *, breaker=0, miss="off", on_table=FULL_TABLE):
        """A new frame; ``on_table`` if it starts from a table with fewer balls."""
        ball_on = next_on(integer("on_table", on_table, 0, ALL_MASK))
        return cls(striker=breaker, breaker=breaker, miss=miss, on_table=on_table & ~CUE_BIT, ball_on=BallOn(ball_on))

    @property
    def situation(self):
        """What the referee needs to judge the next stroke."""
        lead = self.scores[self.striker] - self.scores[1 - self.striker]
        return Situation(on_table=self.on_table, ball_on=self.ball_on, free_ball=self.free_ball, lead=lead)

    @property
    def available(self):
        """Points that the table still offers (a free ball not counted)."""
        return points_available(self.on_table, self.ball_on)

    def needs_snookers(self, player):
        """Whether ``player`` trails by more than the table offers, and so needs penalty points."""
        integer("player", player, 0, 1)
        return self.scores[1 - player] - self.scores[player] > self.available

    def _in_phase(self, phase, act):
        if self.phase != phase:
            raise refuse("phase", self.phase, f"must be {phase!r} to {act}")

    def _over(self, winner, **changes):
        settled = {"phase": "over", "winner": winner, "ball_on": BallOn.NOTHING, "free_ball": False, "miss_called": False, "saved": None}
        return replace(self, **settled | changes)

    def play(self, stroke, *, clear_path=False, full_ball_path=False, layout=None):
        """One stroke: the next frame and the referee's ``Verdict``.

        ``clear_path`` and ``full_ball_path`` say whether before the stroke a straight path was clear to any part, and to the full face,
        of a ball on (``paths.paths``); they matter with ``miss="clear_path"`` only. ``layout``: see ``Saved``.
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
    def choices(self):
        """What the opponent may choose after a foul; empty in other phases."""
        if self.phase != "choice":
            return ()
        return ("play", "play_again", "replace") if self.miss_called else ("play", "play_again")

    def choose(self, what):
        """The opponent's decision after a foul; it cannot be taken back.

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
        before = {name: getattr(self.saved, name) for name in ("on_table", "ball_on", "in_hand", "free_ball")}
        return replace(again, warned=self.failures >= 2, **before)

    def draw(self, first):
        """Who plays first at a re-spotted black: the winner of the lot has chosen ``first``."""
        self._in_phase("lot", "draw")
        return replace(self, phase="stroke", striker=integer("first", first, 0, 1), break_points=0)

    @property
    def may_claim(self):
        """Whether the striker may claim the frame: only the black is left and he leads by more than 7."""
        return self.phase == "stroke" and self.on_table == 1 << BLACK and self.situation.lead > 7

    def claim(self):
        """The striker claims the frame."""
        if not self.may_claim:
            raise refuse("lead", self.situation.lead if self.phase == "stroke" else self.phase, "must be over 7 with only the black left")
        return self._over(self.striker)

    def concede(self, player):
        """``player`` gives the frame up; only the striker may."""
        if self.phase not in ("stroke", "choice") or integer("player", player, 0, 1) != self.striker:
            raise refuse("player", player, "must be the striker of a frame that is not over")
        return self._over(1 - player)

    def restart(self):
        """The referee ends a stalemate: scores are void, the balls are set up again and the same player breaks."""
        if self.phase == "over":
            raise refuse("phase", self.phase, "must not be over to restart")
        return Frame.start(breaker=self.breaker, miss=self.miss)

    def to_dict(self):
        """The frame as plain numbers, strings, lists and None: what JSON can hold."""
        plain = asdict(self) | {"scores": list(self.scores), "ball_on": int(self.ball_on)}
        if self.saved is not None:
            plain["saved"]["ball_on"] = int(self.saved.ball_on)
        return plain

    @classmethod
    def from_dict(cls, plain):
        """The frame that ``to_dict`` gave, also after a round trip through JSON. Unknown or missing fields raise ``ValueError``."""
        names = [field.name for field in fields(cls)]
        if not isinstance(plain, dict) or sorted(plain) != sorted(names):
            raise refuse("frame", plain, "must have exactly the fields " + ", ".join(names))
        saved = plain["saved"]
        if saved is not None:
            layout = _tuples(saved["layout"])
            saved = Saved(**saved | {"ball_on": BallOn(saved["ball_on"]), "layout": layout})
        return cls(**plain | {"scores": tuple(plain["scores"]), "ball_on": BallOn(plain["ball_on"]), "saved": saved})


def _tuples(value):
    """Lists, as JSON gives them back, as tuples all the way down."""
    return tuple(map(_tuples, value)) if isinstance(value, list | tuple) else value
