"""Does ``SnookerEnv`` with a built-in opponent judge as the oracle does? Checks the strokes of both players
from ``env.history``.

What an opponent chose after a foul is not shown; it is inferred from who played next, and from where. All
else is compared.
"""

from __future__ import annotations

from copy import deepcopy

import numpy as np

import snooker_env as sn

from . import frame_oracle_decisions as decisions
from . import frame_oracle_geometry as geometry
from . import frame_oracle_rules as oracle
from .frame_oracle_play import Case, Checker, Kind, differences, state_of, stroke_of


class OpponentChecker(Checker):
    """Frames of an agent against a built-in opponent."""

    def __init__(self, kind: Kind, record: bool = False):
        super().__init__(
            Kind(kind.name, kind.player, {k: v for k, v in kind.options.items() if k != "opponent"}), record
        )
        given = {
            "task": "frame",
            "aim": "target",
            "max_strokes": None,
            "placement": True,
            "says": ["decision"],
            **kind.options,
        }
        self.env = sn.SnookerEnv(**given)
        self.env.keep_history = True

    def frame(self, seed: int, most: int = 3000) -> None:
        """Play and check one frame."""
        env, rng = self.env, np.random.default_rng(seed)
        env.keep_history = False
        env.keep_history = True
        env.reset(seed=seed)
        self._seed = seed
        frame = env.get_state()["frame"]
        state = self._racked(frame)
        state = self._follow(state, None)
        for _ in range(most):
            if env.over:
                break
            action = self._action(state, rng)
            env.keep_history = False
            env.keep_history = True
            env.step(action)
            state = self._follow(state, action)
        self.tally.frames += 1

    def _racked(self, frame):
        """The start of the frame, before the opponent's first visit."""
        positions, on_table = np.zeros((22, 2)), np.ones(22, bool)
        for i, at in geometry.SPOTS.items():
            positions[i] = at
        first = self.env.history[0].player if self.env.history else frame["striker"]
        if self.env.history:
            positions[1:16] = self.env.history[0].shot.at(0.0)[0][1:16]
        else:
            positions[:] = self.env.positions
        return oracle.State(positions, on_table, [0, 0], first, 1, True)

    def _follow(self, state, action):
        """Check every stroke of the last step; the state after it."""
        for played in self.env.history:
            start = played.shot.at(0.0)[0]
            state = self._chosen(state, played.player, start)
            found = self._found(state, played)
            info = {"fouls": int(played.fouls), "penalty": played.penalty, "points": played.points}
            stroke = stroke_of(played.shot)
            case = Case(state, stroke, self.rules, found, info)
            verdict, expected, names = case.compare(
                skip=("miss_called", "failures", "warned", "respotted_black")
            )
            self.count(state, stroke, verdict, expected)
            if state.in_hand and not self._in_d(stroke.cue, state):
                names.append("placed")
            if names:
                self._disagree("stroke", names, expected, found, (None, action, played.shot))
            expected.positions = found.positions
            if expected.phase == "drawn":
                expected.phase, expected.striker = "stroke", found.striker
            state = expected
        found = state_of(self.env.get_state())
        if found.phase != "choice":
            state = self._chosen(state, found.striker, found.positions)
        names = differences(state, found)
        if names:
            self._disagree("step", names, state, found, (None, action, None))
            found.saved = state.saved
            return found
        if state.in_hand:
            state.positions[0] = found.positions[0]
        return state

    def _chosen(self, state, player, start):
        """The state after a decision that led to ``player`` playing from ``start``."""
        if state.phase != "choice":
            return state
        if player == state.striker:
            return decisions.play_on(state)
        again = decisions.play_again(state)
        if not state.miss_called:
            return again
        back = decisions.replace(state)
        balls = [i for i in range(22) if back.on_table[i] and (i or not back.in_hand)]
        if np.allclose(back.positions[balls], start[balls], rtol=0, atol=1e-12):
            self.tally.seen["replaced"] += 1
            return back
        self.tally.seen["played again as left"] += 1
        return again

    def _found(self, state, played):
        phase = "over" if played.over else "choice" if played.choice else "stroke"
        found = deepcopy(state)
        found.positions, found.on_table = played.positions.copy(), played.on_table.copy()
        found.scores, found.striker, found.ball_on, found.in_hand = (
            list(played.scores),
            played.next_player,
            int(played.next_on),
            played.in_hand,
        )
        found.free_ball, found.phase, found.winner, found.break_points = (
            played.next_free_ball,
            phase,
            played.winner,
            played.break_points,
        )
        return found

    def _in_d(self, at, state):
        off = at - [0.0, geometry.BAULK]
        inside = off[1] <= 1e-9 and np.hypot(*off) <= geometry.D_RADIUS + 1e-9
        return inside and geometry.free(at, state.positions[state.balls])
