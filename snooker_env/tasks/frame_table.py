"""How is a frame played on a table that is simulated? A ``Frame`` of the rules and the balls' places, kept in step stroke by stroke.

Players are 0 and 1. A cue ball in hand is put at once on the free place of the D nearest to its usual place for the break, so that it
can be seen; whoever plays may place it elsewhere first. The physics is planar: no ball ever leaves the table and the cue ball jumps
none, so those fouls of the referee cannot come up here.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .._check import choice, integer, refuse
from ..game.apply_ruling import settle_table
from ..game.balls import COLOURS_MASK, CUE, CUE_BIT, N_BALLS, SPOTS, balls_on
from ..game.frame import MISS_RULES, Frame
from ..game.in_hand import place_cue
from ..game.paths import paths
from ..game.referee import Stroke, Verdict
from ..game.ruling import AUTO
from ..simulation import Shot
from .states import checked_frame, layout_of
from .stroke import Shooter, mask, stroke_of

MAX_STROKES = 1000
"""Strokes of both players after which the referee stops a frame, unless told otherwise. Uniformly random players that aim near a pot needed
263, and in 2,000 frames never more than 516 (``benchmarks.frames``); players that only foul, or only hand the table over, never end.
"""


class Played(NamedTuple):
    """One stroke of a frame."""

    striker: int
    ball_on: int
    """What was on before it, a ``BallOn``."""
    shot: Shot
    stroke: Stroke
    verdict: Verdict


class FrameTable:
    """A frame in progress: ``frame``, ``positions`` (22, 2) [m], ``on_table`` (22,) bool and ``strokes``, those of both players so far.

    ``max_strokes``: after so many strokes the referee stops the frame, None for never.
    """

    def __init__(self, shooter: Shooter, *, miss="off", max_strokes=None):
        self.shooter, self.miss = shooter, choice("miss", miss, MISS_RULES)
        self.max_strokes = None if max_strokes is None else integer("max_strokes", max_strokes, 1, 10**9)
        self.strokes = 0
        self.frame = Frame.start(miss=miss)
        self.positions, self.on_table = SPOTS.copy(), np.ones(N_BALLS, bool)

    def start(self, positions, on_table, *, breaker, in_hand):
        """A new frame from a layout; ``in_hand``: its cue ball may be moved within the D."""
        self.positions, self.on_table, self.strokes = positions, on_table, 0
        frame = Frame.start(breaker=breaker, miss=self.miss, on_table=mask(on_table))
        self.frame = replace(frame, in_hand=in_hand)

    @property
    def over(self):
        """Whether the frame has ended by the rules."""
        return self.frame.phase == "over"

    @property
    def ended(self):
        """Whether there is nothing more to play: the frame is over, or stopped."""
        return self.ends_at(self.frame, self.strokes)

    @property
    def stopped(self):
        """Whether the referee has stopped the frame, which went nowhere: nobody has won it."""
        return self.ended and not self.over

    def ends_at(self, frame, strokes):
        """Whether nothing is played from that ``Frame`` after so many strokes."""
        return frame.phase == "over" or (self.max_strokes is not None and strokes >= self.max_strokes)

    @property
    def on(self):
        """Mask of the balls that the striker may strike first: those on, and with a free ball every colour."""
        on_table = mask(self.on_table) & ~CUE_BIT
        return balls_on(self.frame.ball_on, on_table) | (COLOURS_MASK & on_table if self.frame.free_ball else 0)

    def choose(self, what):
        """The decision after a foul: "play", "play_again", or after a miss "replace", which brings the balls back too."""
        saved = self.frame.saved
        self.frame = self.frame.choose(what)
        if what == "replace":
            assert saved is not None and saved.layout is not None  # kept by ``play`` whenever a miss can be called
            positions, on_table = saved.layout
            self.positions, self.on_table = np.array(positions), np.array(on_table)

    def place(self, x, y):
        """Put the cue ball in hand at (x, y); if a ball is in the way, on the nearest free place of the D."""
        if not self.frame.in_hand:
            raise refuse("in_hand", False, "must be True to place the cue ball")
        self.on_table[CUE] = False
        self.positions[CUE] = place_cue(self.positions, self.on_table, x, y)
        self.on_table[CUE] = True

    def play(self, intended, rng, *, nominated=AUTO, path=False):
        """One stroke, ``intended`` = (speed, side, top, aim, elevation); returns what was ``Played``.

        ``rng``: for the noise, and for the lot before a re-spotted black (its winner is taken to play first). ``nominated``: the id of a
        colour after a red or as the free ball; left to the referee it is the one first struck.
        """
        before, miss = self.frame, self.miss == "clear_path"
        clear = paths(self.positions, self.on_table, self.on) if miss else (False, False)
        layout = layout_of(self.positions, self.on_table) if miss else None
        shot = self.shooter.shoot(intended, self.positions, self.on_table, rng, path=path)
        stroke = replace(stroke_of(shot, self.positions, self.on_table, intended[0]), nominated=nominated)
        jaws = self.shooter.table.jaws[:, :3]
        verdict, self.positions, self.on_table = settle_table(shot.positions, self.on_table, before.situation, stroke, jaws=jaws)
        # what only the settled table shows: a snooker counts after a foul, and is a foul itself behind the free ball
        stroke = replace(stroke, snookered=verdict.free_ball, behind_free_ball=bool(verdict.fouls & verdict.fouls.BEHIND_FREE_BALL))
        self.frame, verdict = before.play(stroke, clear_path=clear[0], full_ball_path=clear[1], layout=layout)
        self.strokes += 1
        if self.frame.phase == "lot":
            self.frame = self.frame.draw(int(rng.integers(2)))
        if self.frame.in_hand and not self.over:
            self.place(*SPOTS[CUE])
        return Played(before.striker, int(before.ball_on), shot, stroke, verdict)

    def act(self, action, rng, *, path=False):
        """Carry out an action (a list that ``Actions.check`` gave) of the player whose turn it is: decision, placement, stroke.

        Returns what was ``Played``, or None if the decision handed the table back to the offender.
        """
        actions = self.shooter.actions
        if self.frame.phase == "choice":
            wish = actions.decide(action)
            what = wish if wish in self.frame.choices else "play"
            self.choose(what)
            if what != "play":
                return None
        if self.frame.in_hand and actions.placement:
            self.place(*actions.place(action))
        return self.play(actions.shot(action, self.positions, self.on_table, self.on), rng, path=path)

    def get_state(self):
        """The frame, the balls and the number of strokes as JSON types."""
        table = {"positions": self.positions.tolist(), "on_table": self.on_table.tolist()}
        return {"frame": self.frame.to_dict(), **table, "strokes": self.strokes}

    def checked(self, state, generator=None, *, to_play=False):
        """The ``FrameState`` of a dict; ValueError if it is not sound, or if it is ``to_play`` and has no more stroke to play.

        ``generator``: see ``checked_frame``.
        """
        sound = checked_frame(state, self.miss, self.shooter.table, self.shooter.physics.R, generator)
        if to_play and sound.frame.phase == "over":
            raise refuse("state.frame.phase", "over", 'must not be "over": there is no shot to play from this state')
        if to_play and self.ends_at(sound.frame, sound.strokes):
            raise refuse("state.strokes", sound.strokes, f"must be below max_strokes = {self.max_strokes}: there is no shot left to play")
        return sound

    def take(self, sound):
        """Take over a ``FrameState``."""
        self.frame, self.positions, self.on_table, self.strokes, _ = sound

    def set_state(self, state):
        """Take over what ``get_state`` gave; ValueError if it is not sound, and then nothing has changed."""
        self.take(self.checked(state))
