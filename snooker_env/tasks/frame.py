"""How does one agent play a whole frame? The agent's stroke, then the opponent's visit, until the agent is to play or the frame ends.

The agent is player 0 of the ``Frame``, the opponent player 1. With no opponent ("none") the agent plays alone: whenever the table would
go to the other player it comes straight back, penalties still go to the other's score, and after a foul the agent plays on from where
the balls lie, without a free ball.
"""

from dataclasses import replace

from .._check import choice, refuse
from ..game.layouts import layout
from . import observations
from .frame_table import FrameTable
from .opponents import opponent_of
from .rewards import FRAME_REWARDS

AGENT = 0


class FrameTask:
    """A frame of the agent against ``opponent``, on ``table``, a ``FrameTable``."""

    def __init__(self, shooter, *, opponent, trust, miss, reward, observation, max_strokes):
        self.table = FrameTable(shooter, miss=miss, max_strokes=max_strokes)
        self.reward = FRAME_REWARDS[choice("reward", reward, FRAME_REWARDS)]
        self.observation = observation
        self.opponent = opponent_of(opponent, observation, shooter.actions, trust)
        self.opponent_strokes = 0
        """Strokes that the opponent played in the last step (or before the first)."""

    def start(self, plan, rng, watch):
        """A new frame, its table dealt by a ``Plan``. Who breaks is drawn from ``rng`` (alone it is the agent); an opponent who breaks has
        played when this returns.

        A frame that ends within the opponent's first visit is dealt again: each episode holds a stroke of the agent.
        """
        while True:
            breaker = AGENT if self.opponent is None else int(rng.integers(2))
            self.table.start(*layout(plan, rng), breaker=breaker, in_hand=plan.in_hand)
            self._until_agent(rng, watch)
            if not self.table.ended:
                return

    def step(self, action, rng, watch):
        """One step: its reward, and the agent's own stroke as ``Played`` (None if it had the opponent play again).

        ``watch(shot)`` is called after each stroke of either player, or is None and no paths are kept.
        """
        before = self.table.frame
        played = self.table.act(action, rng, path=watch is not None)
        if played is not None and watch is not None:
            watch(played.shot)
        self._until_agent(rng, watch)
        return self.reward(before, self.table.frame, AGENT), played

    def _until_agent(self, rng, watch):
        table, self.opponent_strokes = self.table, 0
        while not table.over and table.frame.striker != AGENT:
            if self.opponent is None:
                if table.frame.phase == "choice":
                    table.choose("play_again")
                table.frame = replace(table.frame, striker=AGENT, break_points=0)
                continue
            if table.stopped:  # after this very stroke, in the middle of a visit too
                return
            played = self.opponent.play(table, self._opponents_view, rng, watch is not None)
            if played is not None:
                self.opponent_strokes += 1
                if watch is not None:
                    watch(played.shot)

    def checked(self, state, generator, *, to_play=False):
        """The ``FrameState`` of a dict; ValueError if it is not sound, or if it is ``to_play`` and there is no more stroke to play."""
        sound = self.table.checked(state, generator, to_play=to_play)
        if sound.frame.striker != AGENT and not self.table.ends_at(sound.frame, sound.strokes):
            raise refuse("state.frame.striker", sound.frame.striker, f"must be {AGENT}, the agent, as always between two steps")
        return sound

    def take(self, sound):
        """Take over a ``FrameState``."""
        self.table.take(sound)
        self.opponent_strokes = 0

    def _opponents_view(self):
        return observations.observe_frame(self.observation, self.table, 1 - AGENT)

    def observe(self):
        """What the agent sees."""
        return observations.observe_frame(self.observation, self.table, AGENT)

    def info(self):
        """What a step of a frame tells besides its stroke; always the same keys."""
        frame = self.table.frame
        return {
            "score": float(frame.scores[AGENT]), "opponent_score": float(frame.scores[1 - AGENT]),
            "strokes": self.table.strokes, "opponent_strokes": self.opponent_strokes,
            "winner": -1 if frame.winner is None else frame.winner,
            "choice": frame.phase == "choice", "free_ball": frame.free_ball, "needs_snookers": frame.needs_snookers(AGENT),
        }  # fmt: skip

    def text(self):
        """One line for the pictures."""
        return frame_text(self.table.frame)


def frame_text(frame):
    """A ``Frame`` in one line."""
    on = frame.ball_on.name.lower().replace("_", " ")
    ended = "" if frame.winner is None else f"   player {frame.winner} wins"
    return f"{frame.scores[0]} - {frame.scores[1]}   player {frame.striker}, break {frame.break_points}   on: {on}{ended}"
