"""What is the game on the page? A list of acts, each with the table and the random stream after it. Strokes are rounded before they
are played, and places after them, to whole multiples of powers of two: a table on this grid is the same on every machine."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import product
from math import hypot, pi
from typing import Any, TypeAlias, cast

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what, truth
from .._lib.types import CueKind, Floats, Ints, NoiseName
from ..advice import CueStroke
from ..game.balls import CUE, NAMES, BallOn, mask_of_present
from ..game.fouls import AUTO
from ..game.frame import Choice, Frame, write_frame
from ..game.frame_columns import STROKES
from ..game.in_hand import place_cue
from ..game.rule_sets import RULES, RulesName, rule_set
from ..planning.position import Position
from ..planning.positions import Positions, of_tables
from ..planning.stroke_columns import FARTHEST
from ..players import FRAMES, Strokes
from ..players.luck import expect_win, luck_of
from ..players.table_report import nominations_of, visit_of
from ..replays.chances import Standing
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, STEEPEST
from ..tasks.frames import Frames, Seat
from ..tasks.noise import LEVELS
from ..tasks.options import CUES, Options
from ..tasks.played import Played
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import Crew, StepOutput, Tables
from ..tasks.threads import Threads

Places: TypeAlias = Floats | list[list[float]]
DECLINED = 0  # the nomination of a player who does not use a free ball
STATE = ("positions", "on_table", "frame", "strokes", "stream")  # fields of the table in a saved game
STEP = 2.0**-21
"""Of places [m]: two balls in contact, each moved by half a step, overlap by less than the micrometre that is allowed."""
SPEED, TIP, TILT, TURN = 512, 512, 1024, 2**22
"""Steps of a stroke: of its speed a m/s, of its tip a ball's radius, of its elevation a radian, of its direction a turn."""
LOW = (int(MIN_SPEED * SPEED) + 1, -int(FARTHEST * TIP), -int(FARTHEST * TIP), -TURN // 2, 0)
HIGH = (int(MAX_SPEED * SPEED), int(FARTHEST * TIP), int(FARTHEST * TIP), TURN // 2 - 1, int(STEEPEST * TILT))
"""The ends of a stroke's numbers, as ``numbers_of`` lists them."""
_NEAR = sorted(product(range(-4, 5), repeat=2), key=lambda shift: hypot(*shift))


@dataclass(frozen=True, eq=False)
class Act:
    """An act in the game: "new", "stroke", "choice", "set_up", "load", "concede" or "claim"."""

    what: str
    state: dict[str, Any]  # the table after it, as JSON types
    player: int | None = None  # who did it
    played: Played | None = None  # for a stroke: as it was struck, simulated and judged
    asked: dict[str, Any] = field(default_factory=dict)  # what was asked for, as JSON types
    luck: float = 0.0  # of a stroke, in its player's chance to win; 0 in practice
    answers: "Act | None" = None  # for a choice: the foul

    @property
    def standing(self) -> Standing:
        places, here = np.array(self.state["positions"]), np.array(self.state["on_table"])
        return Standing(Frame.from_dict(self.state["frame"]), places, here)


class Session:
    """A frame to play, set up, undo, save and load; ``flight``: balls fly, and the cue can be raised to 70 degrees."""

    hints: list[int]  # how often each seat asked for advice in this frame
    undone: int  # how often something was taken back in it
    acts: list[Act]
    at: int  # number of acts that count; the following ones were undone
    tables: Frames  # of the one table

    def __init__(self, *, layout: str = "break_off", seed: int = 0, flight: bool = False):
        more: dict[str, Any] = {"elevation": 70, "physics": {"flight": True}} if flight else {}
        box = Options(task="frame", max_strokes=None, miss="clear_path", cue="real", **FRAMES)
        self.options: Options = box.but(**more)  # of this frame, without execution errors
        self.noise: list[NoiseName] = ["none", "none"]  # of each seat
        # alone: player 0 has every turn, and after a foul the balls stay as they lie
        self.practice: bool = False
        self.begun: int = 0  # games begun or loaded so far
        self._generator = np.random.default_rng(0)
        self._buffers = ShotBuffers(1, path=True)
        self._with: dict[str, Options] = {}
        self.new(layout=layout, seed=seed)

    @property
    def frame(self) -> Frame:
        return self.tables.frame(0)

    @property
    def cue(self) -> CueKind:
        """Whether rails and balls are in the way of the cue: "real" or "free"."""
        return self.options.cue

    @cue.setter
    def cue(self, kind: CueKind) -> None:
        if kind != self.cue:
            state = self.state
            self._play_by(self.options.but(cue=kind))
            self._set(state)

    @property
    def breaks(self) -> list[list[int]]:
        """The breaks of each seat in this frame, the one that goes on last."""
        found: list[list[int]] = [[], []]
        for k in self.strokes:
            if (one := self.acts[k].played) is not None and one.points and not one.penalty:
                own = found[one.player]
                own[len(own) - (one.break_before > 0) :] = [one.break_before + one.points]
        return found

    @property
    def state(self) -> dict[str, Any]:
        state = self.tables.get_state(0)
        return {name: state[name] for name in STATE}

    @property
    def strokes(self) -> list[int]:
        return [k for k, act in enumerate(self.acts[: self.at]) if act.played is not None]

    @property
    def position(self) -> Positions:
        return of_tables(self.tables)

    def as_visit(self) -> Positions:
        if self.frame.phase == "over":
            raise refuse("phase", "over", "must not be over: there is no stroke to play")
        return visit_of(self.frame, self.position)

    def options_with(self, noise: NoiseName) -> Options:
        """The options of this frame for a player with these execution errors."""
        if noise not in self._with:
            self._with[noise] = self.options.but(noise=noise)
        return self._with[noise]

    @contextmanager
    def as_a_whole(self) -> Iterator["Session"]:
        """What is done in this context is done as a whole: after an exception the session is as it was before."""
        state, kept = self.state, self.__dict__.copy()
        kept |= {name: list(kept[name]) for name in ("acts", "noise", "hints")}
        try:
            yield self
        except BaseException:
            self.__dict__.update(kept)
            self._set(state)
            raise

    def twin(self) -> "Session":
        """A copy for another thread; of the acts it holds the last one only."""
        other = copy(self)
        other._buffers, other.noise = ShotBuffers(1, path=True), list(self.noise)
        other.tables = Frames(self.options.rules, 1)
        other._set(self.state)
        other.acts, other.at = [self.acts[self.at - 1]], 1
        return other

    def new(
        self, *, layout: str | None = None, seed: int = 0, breaker: int = 0, game: str | None = None
    ) -> None:
        integer("seed", seed, 0, 2**63 - 1)
        integer("breaker", breaker, 0, 1)
        self._play_by(self._but(layout, game))
        self.tables.seed(0, np.random.default_rng(seed))
        self.tables.deal(np.zeros(1, np.int64), drawn=False)
        self._write(replace(self.frame, striker=breaker, breaker=breaker))
        self._begin("new")

    def _but(self, layout: str | None, game: str | None) -> Options:
        """The options with another layout and game; the Shoot Out has no miss rule."""
        rules = self.options.game if game is None else cast(RulesName, choice("game", game, RULES))
        miss = "off" if rule_set(rules).anywhere else "clear_path"
        return self.options.but(layout=layout or self.options.layout, game=rules, miss=miss)

    def _play_by(self, options: Options) -> None:
        self.options, self._with = options, {}
        self.tables = Frames(options.rules, 1)

    def play(self, stroke: CueStroke, *, nominated: int = AUTO) -> Act:
        """Play the stroke; ``nominated``: a colour, AUTO for the one first struck, or DECLINED."""
        if self.frame.in_hand and self.frame.phase == "stroke":
            self.place(*(stroke.place or self.tables.positions[0, CUE].tolist()))
        stroke = stroke_of(numbers_of(stroke))
        frame, tables, before = self.frame, self.tables, self.state
        if frame.phase != "stroke":
            choose = 'must be "stroke": choose first (play, play_again, replace or anywhere)'
            raise refuse("phase", frame.phase, choose if frame.phase == "choice" else "must not be over")
        if nominated not in nominable(frame):
            names = [NAMES[i] for i in nominations_of(frame)]
            allowed = f"must be one of {names}" if names else "must be left out: no colour is to be named now"
            raise refuse("nominate", NAMES[nominated], allowed)
        striker = frame.striker
        tables.sit([Seat.of(self.options_with(noise).rules) for noise in self.noise])
        actions = Strokes(stroke.numbers()[None]).actions(self.options, self.position)
        kept = list[Played]()
        meant = {**stroke.to_dict(), "place": before["positions"][CUE] if frame.in_hand else None}
        asked = {**meant, "noise": self.noise[striker], "practice": self.practice, "cue": self.cue}
        asked |= {"nominate": nominated}
        tables.nominated[0] = nominated
        crew = Crew(self._buffers, lambda k, buffers, j, agents: kept.append(tables.record(k, buffers, j)))
        luck = self._luck(actions, striker)
        tables.turn(lambda which, b: tables.prepare(which, actions, b, striker), tables.output(), crew)
        played = replace(kept[0], before=frame, meant=meant)
        if self.practice and self.frame.phase != "over" and self.frame.striker == 1:
            after = self.frame.choose("play_again") if self.frame.phase == "choice" else self.frame
            self._write(replace(after, striker=0))
        self._settle(before["positions"])
        return self._did(Act("stroke", self.state, striker, played, asked, luck))

    def _luck(self, actions: Floats, striker: int) -> float:
        """The luck of a stroke that is about to be played, by the chance to win under the larger errors of both."""
        if self.practice or self.noise[striker] == "none":
            return 0.0
        errors = max(self.noise, key=lambda name: LEVELS[name].direction_deg())

        def turn(copies: Tables, rows: Ints, out: StepOutput) -> None:
            assert isinstance(copies, Frames)
            each, crew = actions[rows], Threads(1)
            copies.turn(lambda which, b: copies.prepare(which, each, b, striker), out, crew)

        first = luck_of(self.tables, np.zeros(1, np.int64), turn, expect_win, self.options_with(errors))
        return float(first[0] if striker == 0 else -first[0])

    def choose(self, what: str) -> Act:
        """Take the decision after a foul of the opponent: "play", "play_again", or after a miss "replace"."""
        frame = self.frame
        if frame.phase != "choice":
            raise refuse("choice", what, "must be left out: the other player has not just fouled")
        after = frame.choose(cast(Choice, what))
        if what == "replace":
            kept = self.tables.layouts_before
            self.tables.positions[:], self.tables.on_table[:] = kept.positions, kept.on_table
        return self._decide("choice", after, {"choice": what})

    def concede(self) -> Act:
        return self._decide("concede", self.frame.concede(self.frame.striker), {"declare": "concede"})

    def claim(self) -> Act:
        """The striker, more than seven points ahead with the black alone on the table, claims the frame."""
        return self._decide("claim", self.frame.claim(), {"declare": "claim"})

    def place(self, x: float, y: float) -> list[float]:
        """Put the cue ball in hand on the free place nearest to (x, y), of the D or of the table, and return it."""
        frame = self.frame
        if not frame.in_hand or frame.phase != "stroke":
            raise refuse("place", [x, y], "must be left out: the cue ball is not in hand")
        places = self.tables.positions[0]
        places[CUE] = place_cue(places, self.tables.on_table[0], x, y, anywhere=frame.anywhere)
        self._put(CUE)
        self.acts[self.at - 1] = replace(self.acts[self.at - 1], state=self.state)
        return places[CUE].tolist()

    def set_up(
        self, position: Position, *, scores: Any = (0, 0), striker: int = 0, free_ball: bool = False
    ) -> None:
        if position.over:
            raise refuse("over", True, "must be false: there is no stroke to play")
        positions, on_table, _ = position.arrays()
        game: Any = {"scores": tuple(scores) if isinstance(scores, list) else scores, "striker": striker}
        game |= {"breaker": striker, "free_ball": free_ball, "break_points": position.points}
        game |= {"in_hand": position.in_hand, "on_table": mask_of_present(on_table) & ~1}
        rules: Any = {"miss": self.options.miss, "rules": self.options.game}
        frame = Frame(**game, **rules, ball_on=BallOn[str(position.on).upper()])
        state = {"positions": positions.tolist(), "on_table": on_table.tolist(), "frame": frame.to_dict()}
        self._set(state | {"strokes": 0, "stream": self.tables.streams[0].tolist()})
        self._did(Act("set_up", self.state))

    def go_to(self, at: int, acts: Sequence[Act] = ()) -> bool:
        """The game as it stood before act ``at``, of these acts if there are any; returns whether there is such a place."""
        if self.acts[: len(acts)] != [*acts]:  # else what was played since can be done again, too
            self.acts = [*acts]
        if not 1 <= at <= len(self.acts):
            return False
        self._set(self.acts[at - 1].state)
        self.at = at
        return True

    def save(self) -> dict[str, Any]:
        return {"practice": self.practice, "noise": list(self.noise), "cue": self.cue, "state": self.state}

    def load(self, saved: object) -> None:
        """Restore a result of ``save``. ValueError names what is invalid, and then nothing has changed."""
        if not isinstance(saved, dict) or set(saved) != {"practice", "noise", "cue", "state"}:
            raise refuse_what("saved", "something else", "must be a dict with practice, noise, cue and state")
        noise = read_levels("saved.noise", saved["noise"])
        practice, cue = truth("saved.practice", saved["practice"]), choice("saved.cue", saved["cue"], CUES)
        state = saved["state"]
        if not isinstance(state, dict) or set(state) != set(STATE):
            raise refuse_what("saved.state", "something else", f"must be a dict with {list(STATE)}")
        frame = state["frame"]
        with self.as_a_whole():
            self._play_by(self._but(None, frame.get("rules", "snooker") if isinstance(frame, dict) else None))
            self._set(state)
            self.practice, self.cue, self.noise = practice, cast(CueKind, cue), noise
            self._begin("load")

    def _begin(self, what: str) -> None:
        self.acts, self.at, self.begun = [Act(what, self.state)], 1, self.begun + 1
        self.hints, self.undone = [0, 0], 0

    def _settle(self, before: Places) -> None:
        """Put all balls on the grid after a stroke, before which they lay ``before`` (22, 2) [m]."""
        places, on_table = self.tables.positions[0], self.tables.on_table[0]
        moved = list_moved(before, Standing(self.frame, places, on_table))
        still = on_table.copy()
        still[[CUE, *moved]] = False
        places[still] = np.asarray(before)[still]
        for ball in moved:
            self._put(ball)

    def _put(self, ball: int) -> None:
        """Put a ball on the point of the grid nearest to it where it may lie; ValueError if there is none."""
        places, on_table, frame = self.tables.positions[0], self.tables.on_table[0], self.frame
        here, in_hand = steps_of(places[ball]), ball == CUE and frame.in_hand
        for shift in _NEAR:
            places[ball] = x, y = ((here + shift) * STEP).tolist()
            put = place_cue(places, on_table, x, y, anywhere=frame.anywhere) if in_hand else (x, y)
            if put == (x, y) and (in_hand or self.is_sound()):
                return
        raise refuse_what("place", NAMES[ball], "must have a point of the grid near it where it may lie")

    def is_sound(self) -> bool:
        """Whether no ball overlaps another, or lies where it cannot."""
        rules = self.options.rules
        try:
            rules.table.check(self.tables.positions[0], rules.physics.R, on_table=self.tables.on_table[0])
        except ValueError:
            return False
        return True

    def _decide(self, what: str, after: Frame, asked: dict[str, str]) -> Act:
        striker, foul = self.frame.striker, self.acts[self.at - 1] if what == "choice" else None
        self._write(after)
        return self._did(Act(what, self.state, striker, asked=asked, answers=foul))

    def _did(self, act: Act) -> Act:
        del self.acts[self.at :]
        self.acts.append(act)
        self.at += 1
        return act

    def _set(self, state: dict[str, Any]) -> None:
        # no rewards are paid here, and no stroke draws from the generator
        alone = {"opponent": 0, "unpaid": 0, "due": False, "rng": self._generator.bit_generator.state}
        try:
            self.tables.set_state(0, self.tables.check_state(state | alone, self._generator, either=True))
        except ValueError as error:
            raise ValueError(re.sub(r"state\.(frame\.)?", "", str(error))) from None

    def _write(self, frame: Frame) -> None:
        strokes = int(self.tables.game[0, STROKES])
        write_frame(frame, strokes, self.tables.game[0], self.tables.layouts_before, 0)


def read_levels(field: str, names: object) -> list[NoiseName]:
    """The execution errors of both seats, two names of ``LEVELS``; ValueError for anything else."""
    if not isinstance(names, list) or len(names) != 2:
        raise refuse(field, names, "must be two names")
    return [cast(NoiseName, choice(f"{field}[{k}]", name, LEVELS)) for k, name in enumerate(names)]


def nominable(frame: Frame) -> list[int]:
    """What may be said with a stroke: AUTO, DECLINED with a free ball, or a colour that may be named."""
    return [AUTO, *[DECLINED] * frame.free_ball, *nominations_of(frame)]


def numbers_of(stroke: CueStroke) -> list[int]:
    """Speed, side, top, direction and elevation of a stroke as whole numbers, those nearest to them."""
    speed, side, top, aim, elevation = stroke.numbers().tolist()
    tip = int if hypot(round(side * TIP), round(top * TIP)) > FARTHEST * TIP else round  # towards the middle
    turns = (round(aim / (2.0 * pi) * TURN) + TURN // 2) % TURN - TURN // 2
    near = round(speed * SPEED), tip(side * TIP), tip(top * TIP), turns, round(elevation * TILT)
    return [min(high, max(low, step)) for low, step, high in zip(LOW, near, HIGH, strict=True)]


def stroke_of(numbers: list[int]) -> CueStroke:
    """The stroke that ``numbers_of`` turns into these numbers; ValueError if there is none."""
    speed, side, top, aim, elevation = numbers
    aimed = {"aim": aim * (2.0 * pi / TURN), "elevation": elevation / TILT}
    return CueStroke.of({"speed": speed / SPEED, "side": side / TIP, "top": top / TIP, **aimed})


def steps_of(places: Places | Sequence[float]) -> Ints:
    """The points of the grid nearest to places [m]."""
    return np.rint(np.asarray(places) / STEP).astype(np.int64)


def list_moved(before: Places, after: Standing) -> list[int]:
    """Balls on the table that lie at another point of the grid than they lay; without a cue ball in hand."""
    moved = (steps_of(before) != steps_of(after.positions)).any(axis=1) & after.on_table
    moved[CUE] &= not after.frame.in_hand
    return np.flatnonzero(moved).tolist()
