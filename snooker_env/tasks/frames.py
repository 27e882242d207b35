"""How is a frame played, on one table or on thousands? A step is a turn of the agent, player 0, and all of the opponent's after
it. In a turn ``frame_kernels`` ``decide`` and ``conclude``, the referee, before and after ``stroke.address`` and ``stroke.run``."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np

from .._lib.check import refuse
from .._lib.types import Bools, Floats, Ints, Singles
from ..game import frame_columns as columns
from ..game.balls import CUE_BIT, N_BALLS, SPOTS, BallOn, mask_of_present
from ..game.fouls import AUTO
from ..game.frame import MISS_RULES, Frame, frame_of, write_frame
from ..game.layouts import deal_tables
from ..physics.conditions import COLUMNS as CONDITIONS
from . import frame_kernels
from .box_actions import Actions
from .discrete_actions import Choices
from .frame_kernels import AGENT
from .noise import Noise
from .options import NEVER, Rules
from .rewards import FRAMES_PAID, MATCH_REWARDS
from .states import FrameState, check_frame_state
from .stroke import ShotBuffers
from .tables import I_POINTS, I_SECONDS, REALS, Crew, StepOutput, Tables, uniform
from .visit import Visits

OPPONENT = 1 - AGENT  # index of the opponent in the frame, and of its seat
_OF_FRAMES = ("strokes", "opponent_strokes", "winner")
_OF_MATCHES = [columns.FRAMES_0, columns.FRAMES_1, columns.FIRST_BREAK]
Asked: TypeAlias = tuple[Floats, Floats, Ints, Ints, Ints]
"""Of n tables: strokes (n, 5), places of cue balls in hand (n, 2), nominations, decisions and declarations (n,)."""
Prepare: TypeAlias = Callable[[Ints, ShotBuffers], Ints]
"""Carries strokes of tables out up to the strike; returns the tables with a stroke."""


class Opponent(Protocol):
    """Who plays the other side of frames."""

    name: str

    def strokes(self, frames: "Frames", which: Ints, crew: Crew) -> Asked:
        """What it plays on the tables ``which``, with a row for each table of ``frames``."""
        ...


@dataclass(frozen=True)
class Seat:
    """One side of frames; ``player`` None: whoever calls ``Frames`` decides."""

    actions: Actions | Choices
    noise: Noise
    player: Opponent | None = None

    @classmethod
    def of(cls, rules: Rules, player: Opponent | None = None) -> "Seat":
        """The seat with the actions and errors of ``rules``."""
        return cls(rules.actions, rules.noise, player)


def sayings(rules: Rules, actions: Floats, game: Ints) -> tuple[Ints, Ints, Ints]:
    """Nominations, decisions and declarations (n,), as in ``players.Strokes``, of checked actions (n, k)."""
    nominated, decisions, declared = np.empty((3, len(game)), np.int64)
    reads, code = rules.actions.pack(), rules.rule_set.code
    frame_kernels.read_sayings(actions, reads, game, code, nominated, decisions, declared)
    return nominated, decisions, declared


class Frames(Tables):
    """n tables, each in the middle of its own frame, or of a frame of its match; one that the referee stops is truncated."""

    REALS: tuple[str, ...] = (*REALS, "score", "opponent_score", "clock")
    FLAGS: tuple[str, ...] = ("choice", "free_ball", "needs_snookers", "anywhere", "warned")
    COUNTS: tuple[str, ...] = (*Tables.COUNTS, *_OF_FRAMES, *FLAGS, "misses", "failures")
    COLUMNS = columns.COLUMNS

    nominated: Ints
    """(n,) The colour that the striker has nominated after a red or as its free ball, 0 for a free ball
    declined; AUTO, as always between two strokes: the colour first struck. Unchecked."""
    due: Bools  # (n,) which ended in the opponent's first visit: the next step plays nothing and reports it
    through: Bools  # (n,) which episodes of one stroke have ended
    seats: tuple[Seat, ...]  # the agent's, and the other's if it does not play alone; no player: by ``turn``

    def __init__(self, rules: Rules, n: int = 1, *, limit: int = NEVER, seats: Sequence[Seat] | None = None):
        if rules.frames:
            self.COUNTS = (*self.COUNTS, "frames_won", "opponent_frames", "frame")
        super().__init__(rules, n, limit=limit)
        self.sit([Seat.of(rules)] if seats is None else seats)
        self._saved_positions, self._saved_on_table = self.positions.copy(), self.on_table.copy()
        self._replies, self._played = np.zeros(n, np.int64), np.zeros(n, np.int64)
        self.nominated, (self.due, self.through) = np.full(n, AUTO, np.int64), np.zeros((2, n), np.bool_)
        self._reward, self._miss = MATCH_REWARDS.index(rules.reward), MISS_RULES.index(rules.miss)
        game, won = rules.rule_set, rules.frames // 2 + 1
        limits = limit, rules.max_strokes, rules.one_stroke, won, game.clock
        self._numbers = game.code, self._miss, rules.time_to_play, self._reward, *limits
        self.positions[:], self.on_table[:] = SPOTS, True  # the state of a frame before its first reset
        if n:
            start = Frame.start(miss=rules.miss, rules=rules.game)
            write_frame(start, 0, self.game[0], self.layouts_before, 0)
            self.game[:] = self.game[0]
            self.on_table[:, 1:] = [rules.rule_set.on_table >> i & 1 for i in range(1, N_BALLS)]
        self._jaws = np.ascontiguousarray(rules.table.jaws[:, :3])

    def sit(self, seats: Sequence[Seat]) -> None:
        """Assign the seats: one, or two."""
        self.seats = tuple(seats)
        self._read(tuple(seat.actions for seat in seats), tuple(seat.noise for seat in seats))
        # the winner of the lot is asked if either player can say who begins
        self._lot = any("lot" in seat.actions.says for seat in self.seats)

    @property
    def layouts_before(self) -> columns.Layouts:
        """Where the balls lay before the last strokes: ``frame_columns.Layouts``."""
        return columns.Layouts(self._saved_positions, self._saved_on_table)

    @property
    def _parts(self):
        """For kernels: the parts of ``TableArrays``, ``Layouts`` and ``frame_kernels.Setting``, in plain tuples."""
        saved = self._saved_positions, self._saved_on_table
        return self.arrays, saved, (*self._numbers, self._lot, self._jaws)

    def _columns(self) -> tuple[str, ...]:
        more = ("_saved_positions", "_saved_on_table", "_replies", "_played", "nominated", "due", "through")
        return super()._columns() + more

    def frame(self, k: int) -> Frame:
        """The ``game.frame.Frame`` on table k."""
        return frame_of(self.game[k], self.rules.miss, self.layouts_before, k, self.rules.game)

    def lead(self) -> Ints:
        """The agent's scores minus the opponent's: (n,)."""
        return self.game[:, columns.SCORE_0 + AGENT] - self.game[:, columns.SCORE_1 - AGENT]

    def are_stopped_short(self) -> Bools:
        """Which frames the referee stops after ``max_strokes``: bool (n,)."""
        return self.game[:, columns.STROKES] >= self.rules.max_strokes

    def are_over(self) -> Bools:
        return super().are_over() | self.are_stopped_short() | self.through

    def are_told_over(self) -> Bools:
        return self.are_over() & ~self.due

    def interrupt(self) -> None:
        """See ``Tables.interrupt``: tables at which it is the opponent's turn."""
        self.begun[self.game[:, columns.STRIKER] != AGENT] = False

    # a turn

    def prepare(self, which: Ints, actions: Floats, buffers: ShotBuffers, side: int = AGENT) -> Ints:
        """Decisions and strokes of the seat ``side`` up to the strike; returns the tables with a stroke."""
        reads = self.actions[side]
        if reads.declares or "nominate" in reads.says or self.game[which, columns.PHASE].any():
            plays = np.empty(len(which), np.bool_)
            frame_kernels.decide(which, actions, self._own[side][0], *self._parts, plays)
            which = which[plays]
        self.address(which, actions, buffers, side)
        self.hold_late(which, buffers)
        return which

    def hold_late(self, which: Ints, buffers: ShotBuffers) -> None:
        """With a shot clock: shots that would not be begun within it are not played."""
        if self.rules.rule_set.clock:
            limits, b = (self.rules.rule_set.code, self.rules.time_to_play), buffers
            frame_kernels.hold_late(which, self.game, *limits, b.v, b.w, b.aloft, b.shots)

    def carry_out(self, which: Ints, asked: Asked, buffers: ShotBuffers, side: int) -> Ints:
        """Carry the strokes ``asked`` of the seat ``side`` out up to the strike; returns the tables with a stroke."""
        playing, packed = np.empty(len(which), np.int64), self.pack(side)[1:3]
        m = frame_kernels.carry_out(which, asked, *self._parts, packed, buffers.struck, playing)
        self.hold_late(playing[:m], buffers)
        return playing[:m]

    def complete(
        self, which: Ints, out: StepOutput, b: ShotBuffers, crew: Crew, *, reported: bool, alone: bool = False
    ) -> None:
        """Play and judge the shots struck. ``reported``: in ``out``; ``alone``: the agent plays on."""
        if not len(which):
            return
        unfinished = self.run(which, b)
        self._conclude(which, b, out, reported, alone)
        for j in unfinished:
            self._conclude(which[j : j + 1], self.again(which, j, b), out, reported, alone)
        crew.saw(which, b, reported)

    def _conclude(self, which, b, out, reported, alone):
        tables, saved, setting = self._parts
        if self.rules.miss != "off":
            cushions = self.rules.table.noses, self.rules.table.jaws
            frame_kernels.remember(which, tables, saved, b.played, *cushions)
        if self._miss == columns.ATTEMPTS:
            frame_kernels.judge_attempts(which, b, self)
        played = self._played if reported else self._replies
        frame_kernels.conclude(which, tables, b.played, setting, reported, alone, played, out.arrays)

    def turn(self, prepare: Prepare, out: StepOutput, crew: Crew, which: Ints | None = None) -> Bools:
        """One turn of the strikers on ``which`` (or all); returns where there was a stroke, (n,)."""
        playing = np.flatnonzero(~self.are_over()) if which is None else which
        self._played[playing] = 0
        crew(playing, lambda which, b: self.complete(prepare(which, b), out, b, crew, reported=True))
        self.go_on(playing)
        return self._played > 0

    def turns(self, actions: Sequence[Floats], out: StepOutput, crew: Crew) -> Bools:
        """One turn on each table that goes on; ``actions``: of each side (n, k). Returns where there was a stroke, (n,)."""
        going, striker = ~self.are_over(), self.game[:, columns.STRIKER].copy()
        self._played[:] = 0
        for side, its in enumerate(actions):
            prepare = lambda which, b, its=its, side=side: self.prepare(which, its, b, side)  # noqa: E731
            self.turn(prepare, out, crew, np.flatnonzero(going & (striker == side)))
        self._replies[:] = self._played * (striker != AGENT)
        crew(np.flatnonzero(going), lambda which, _: self._finish(which, out))
        out.terminated[~going] = self.game[~going, columns.OVER]
        out.truncated[~going] = ~out.terminated[~going]
        crew(np.flatnonzero(~going), lambda which, _: self._show(which, out))
        return self._played > 0

    def go_on(self, which: Ints) -> None:
        """After each turn, in a match: count the frames that have ended, and set up the next ones unless it is decided."""
        ended = which[self.game[which, columns.OVER] != 0] if self.rules.frames else which[:0]
        if not len(ended):
            return
        game, plan = self.game, self.rules.plan
        game[ended, columns.FRAMES_0 + game[ended, columns.WINNER]] += 1
        won = game[ended, columns.FRAMES_0 : columns.FRAMES_1 + 1]
        if not len(ended := ended[won.max(axis=1) <= self.rules.frames // 2]):
            return
        deal_tables(ended, plan.code, plan.tables, self.streams, self.positions, self.on_table)
        kept = [columns.FRAMES_0, columns.FRAMES_1, columns.FIRST_BREAK, columns.STEPS, columns.PAID]
        before = game[ended][:, kept]  # what was not paid stays so
        if self._reward != FRAMES_PAID:
            before[:, -1] -= self.lead()[ended]
        first = before[:, :3].sum(axis=1) % 2 if len(self.seats) == 2 else np.full(len(ended), AGENT)
        frame_kernels.begin(ended, first, plan.in_hand, self.on_table, game)
        game[ended[:, None], kept] = before

    # steps and resets of the frame task

    def step(
        self, actions: Floats, waiting: Bools, out: StepOutput, crew: Crew, *, same_step: bool = False
    ) -> None:
        """See ``Tables.step``. After SimulationError what was placed or decided stands."""
        anew, alone = bool(waiting.any()), len(self.seats) == 1
        playing = np.flatnonzero(~waiting) if anew else np.arange(self.n)
        self._replies[:] = self._played[:] = 0

        def play(which, buffers):
            acting = which[~self.due[which]] if self.due.any() else which
            struck = self.prepare(acting, actions, buffers)
            self.complete(struck, out, buffers, crew, reported=True, alone=alone)
            self.go_on(acting)
            if alone:
                # even if a state of two players left a decision or lot
                self.game[acting, columns.STRIKER] = AGENT
                self._finish(which, out)

        crew(playing, play)
        if not alone:
            self._reply(playing, out, crew)
            crew(playing, lambda which, _: self._finish(which, out))
        if same_step:
            ended = np.flatnonzero(out.terminated | out.truncated)
            out.keep_last(ended)
            self._start(ended, out, crew)
        elif anew:
            self._start(np.flatnonzero(waiting), out, crew)

    def _finish(self, which, out):
        counted = self.due, self.through, self._replies, self._played
        frame_kernels.finish(which, *self._parts, *counted, out.arrays)
        self.show_rest(which, out)

    def _reply(self, which, out, crew):
        """All strokes of the opponent until it is the agent's turn or the frame has ended."""
        opponent = self.seats[OPPONENT].player
        assert opponent is not None  # ``turn`` plays for two without
        while len(which := which[(self.game[which, columns.STRIKER] != AGENT) & ~self.are_over()[which]]):
            asked = opponent.strokes(self, which, crew)

            def play(part, buffers, asked=asked):
                struck = self.carry_out(part, asked, buffers, OPPONENT)
                self.complete(struck, out, buffers, crew, reported=False)
                self.go_on(part)

            crew(which, play)

    def reset(self, wanted: Bools, out: StepOutput, crew: Crew, *, breakers: Ints | None = None) -> None:
        """See ``Tables.reset``. ``breakers``: see ``deal``."""
        self.begun[wanted] = False  # until the opponent has played, if it breaks
        self._start(np.flatnonzero(wanted), out, crew, breakers)
        crew(np.flatnonzero(~wanted), lambda which, _: self._show(which, out))

    def _start(self, which, out, crew, breakers=None):
        """New frames, with the opponent's first visit if it breaks."""
        alone = len(self.seats) == 1
        self._replies[which] = 0
        crew(which, lambda part, _: self.deal(part, drawn=not alone, breakers=breakers))
        if not alone and self.seats[OPPONENT].player is not None:
            try:
                self._reply(which, out, crew)
            except BaseException:
                self.begun[which] = False
                raise
        self.due[which] = self.are_over()[which]
        crew(which, lambda part, _: self._show(part, out))

    def deal(self, which: Ints, *, drawn: bool, breakers: Ints | None = None) -> None:
        """New frames on ``which``. The agent breaks or, if ``drawn``, ``breakers`` (n,); without them by lot, of one stroke the agent."""
        plan, first = self.rules.plan, np.full(len(which), AGENT)
        deal_tables(which, plan.code, plan.tables, self.streams, self.positions, self.on_table)
        if drawn:  # a number in any case, so that the errors of strokes do not depend on it
            lots = np.empty((len(which), 2))
            uniform(which, self.streams, lots)
            if breakers is not None:
                first = breakers[which]
            elif not self.rules.one_stroke:
                first = (2.0 * lots[:, 0]).astype(np.int64)
        frame_kernels.begin(which, first, plan.in_hand, self.on_table, self.game)
        self.begun[which], self.nominated[which] = True, AUTO
        self.due[which] = self.through[which] = False
        self.draw_conditions(which)

    def _show(self, which, out):
        frame_kernels.show(which, AGENT, *self._parts, self._replies, out.arrays)
        self.show_rest(which, out)

    def info_of(self, player: int, last: StepOutput | None) -> dict[str, Any]:
        """The info of the first table as ``player`` sees it; ``last``: output of the last stroke."""
        out, first = self.output(), np.zeros(1, np.int64)  # the entries that depend on the player
        frame_kernels.show(first, player, *self._parts, self._replies, out.arrays)
        if self.rules.drawn:
            out.reals[:, -CONDITIONS:] = self.conditions
        if last is not None:
            for column in (I_POINTS, I_SECONDS):
                out.reals[0, column] = last.reals[0, column]
            many = len(Tables.COUNTS)
            out.counts[0, :many] = last.counts[0, :many]
        return self.info(out, 0)

    def observe(self, which: Ints, player: int = AGENT) -> Singles:
        rows = np.empty((len(which), self.SIZE), np.float32)
        frame_kernels.observe(which, player, *self._parts, rows)
        self.observe_rest(which, np.arange(len(which)), rows, player)
        return rows

    # states

    def get_state(self, k: int) -> dict[str, Any]:
        """See ``Tables.get_state``: the fields of a ``states.FrameState`` except "rng"."""
        strokes, opponent = self.game[k, [columns.STROKES, columns.OPPONENT]].tolist()
        unpaid = int(self._worth(k) - self.game[k, columns.PAID])
        paid = {"opponent": opponent, "unpaid": unpaid, "due": bool(self.due[k])}
        state = super().get_state(k) | {"frame": self.frame(k).to_dict(), "strokes": strokes} | paid
        if not self.rules.frames:
            return state
        *won, first = self.game[k, _OF_MATCHES].tolist()
        return state | {"frames": won, "first_break": first, "best_of": self.rules.frames}

    def _worth(self, k):
        """What the agent has earned in the episode so far, as its reward counts."""
        won = self.game[k, columns.FRAMES_0 + AGENT] - self.game[k, columns.FRAMES_1 - AGENT]
        return won if self._reward == FRAMES_PAID else self.lead()[k]

    def check_state(
        self, state: Any, generator: np.random.Generator, *, to_play: bool = False, either: bool = False
    ) -> FrameState:
        """See ``Tables.check_state``. The striker must be the agent, unless ``either``, or if the caller plays both sides."""
        either = either or (len(self.seats) == 2 and self.seats[OPPONENT].player is None)
        sound = check_frame_state(state, self.rules, generator, lot=self._lot)
        over, stopped = sound.frame.phase == "over", sound.strokes >= self.rules.max_strokes
        if sound.due and not (over or stopped):
            raise refuse("state.due", True, "must be False: the frame goes on")
        if sound.due:
            return sound
        if to_play and over:
            allowed = 'must not be "over": there is no shot to play from this state'
            raise refuse("state.frame.phase", "over", allowed)
        if to_play and stopped:
            limit = self.rules.max_strokes
            allowed = f"must be below max_strokes = {limit}: there is no shot left to play"
            raise refuse("state.strokes", sound.strokes, allowed)
        if not either and sound.frame.striker != AGENT and not (over or stopped):
            allowed = f"must be {AGENT}, the agent, as always between two steps"
            raise refuse("state.frame.striker", sound.frame.striker, allowed)
        return sound

    def set_state(self, k: int, state: FrameState) -> None:
        self.positions[k], self.on_table[k] = state.positions, state.on_table
        write_frame(state.frame, state.strokes, self.game[k], self.layouts_before, k)
        self.game[k, columns.OPPONENT] = state.opponent
        self.game[k, _OF_MATCHES] = *(state.frames or (0, 0)), state.frame.breaker
        if state.first_break is not None:
            self.game[k, columns.FIRST_BREAK] = state.first_break
        self.game[k, columns.PAID] = self._worth(k) - state.unpaid
        self._set_state(k, state)
        self._replies[k], self.begun[k], self.due[k], self.nominated[k] = 0, True, state.due, AUTO
        self.through[k] = False

    def standing(self, k: int) -> dict[str, Any]:
        frame = self.frame(k)
        now = {"scores": frame.scores, "break_points": frame.break_points, "winner": frame.winner}
        turn = {"next_player": frame.striker, "next_free_ball": frame.free_ball}
        return now | turn | {"choice": frame.phase == "choice", "frame": frame}

    def set_position(self, k: int, positions: Floats, on_table: Bools, game: Ints) -> None:
        """See ``Tables.set_position``. Player 0 is at the table; the points are its break."""
        ball_on, in_hand, points = game[[columns.BALL_ON, columns.IN_HAND, columns.POINTS]].tolist()
        balls, rules = mask_of_present(on_table) & ~CUE_BIT, self.rules
        on = {"ball_on": BallOn(ball_on), "in_hand": bool(in_hand), "break_points": points}
        frame = Frame(on_table=balls, rack=balls, miss=rules.miss, rules=rules.game, **on)
        self.positions[k], self.on_table[k] = positions, on_table
        write_frame(frame, 0, self.game[k], self.layouts_before, k)
        self._replies[k], self.begun[k], self.nominated[k] = 0, True, AUTO
        self.due[k] = self.through[k] = False

    def text(self, k: int) -> str:
        frame = self.frame(k)
        *won, _ = self.game[k, _OF_MATCHES].tolist()
        match = f"frames {won[0]} - {won[1]}   " if self.rules.frames else ""
        on, wins = frame.ball_on.name.lower().replace("_", " "), frame.winner
        turn = f"player {frame.striker}, break {frame.break_points}   on: {on}"
        ended = "" if wins is None else f"   player {wins} wins"
        return f"{match}{frame.scores[0]} - {frame.scores[1]}   {turn}{ended}"


TABLES: dict[str, type[Tables]] = {"visit": Visits, "frame": Frames, "match": Frames}
"""Which class plays each ``task``."""
