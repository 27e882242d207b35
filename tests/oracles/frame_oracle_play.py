"""Does the environment judge as the oracle does? Plays frames through ``MatchEnv`` and compares every stroke
and decision.

The oracle is fed with what the environment shows to anyone: ``get_state`` before and after, the action, and
the ``Shot`` (events, balls potted, positions at rest). Its own state goes on from one stroke to the next and
takes over only where balls came to rest.
"""

from __future__ import annotations

from collections import Counter
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np

import snooker_env as sn

from . import frame_oracle_decisions as decisions
from . import frame_oracle_geometry as geometry
from . import frame_oracle_rules as oracle
from .frame_oracle_rules import Rules, State, Stroke
from .frame_oracle_tables import table

FOULS = {
    1: oracle.NO_CONTACT,
    2: oracle.WRONG_FIRST,
    4: oracle.WRONG_POT,
    8: oracle.CUE_POTTED,
    128: oracle.PUSH,
    4096: oracle.BEHIND,
    32768: oracle.NO_CUSHION,
    65536: oracle.LATE,
}
PLACE = 3e-6
"""How far apart two places of a ball may be that the two sides computed [m]."""
FOLLOWS = {
    "free_ball": ["free_ball"],
    "miss": ["miss_called", "failures", "warned", "phase", "winner"],
    "spot": ["positions"],
    "behind": [],
}
"""What follows from a decision that hangs on rounding."""
LIKE = (
    "scores",
    "striker",
    "ball_on",
    "in_hand",
    "free_ball",
    "respotted_black",
    "phase",
    "winner",
    "break_points",
    "miss_called",
    "failures",
    "warned",
    "misses",
    "clock",
    "anywhere",
)


@dataclass
class Tally:
    """What was compared, and what it exercised."""

    frames: int = 0
    strokes: int = 0
    undecidable: Counter = field(default_factory=Counter)
    seen: Counter = field(default_factory=Counter)
    disagreements: list = field(default_factory=list)


@dataclass(frozen=True)
class Kind:
    """One kind of frame: the options of the environment and who plays."""

    name: str
    player: str
    options: dict
    tables: bool = False
    """Whether it begins from a random table and is left after a few strokes."""


def state_of(saved: dict) -> State:
    """The oracle's state of a ``get_state`` of the environment."""
    frame = saved["frame"]
    last = frame.get("saved")
    state = State(
        np.array(saved["positions"], float),
        np.array(saved["on_table"], bool),
        list(frame["scores"]),
        frame["striker"],
        frame["ball_on"],
        frame["in_hand"],
        frame["free_ball"],
        frame["respotted_black"],
        frame["phase"],
        frame["winner"],
        frame["break_points"],
        frame["miss_called"],
        frame["failures"],
        frame["warned"],
    )
    state.saved = last
    state.misses, state.clock, state.anywhere = frame["misses"], frame["clock"], frame["anywhere"]
    return state


def stroke_of(shot, nominated=None) -> Stroke:
    """What happened in a ``Shot``."""
    events = shot.events
    own = events[(events["i"] == 0) | ((events["kind"] == 0) & (events["j"] == 0))]
    impacts = own[own["kind"] == sn.EventKind.BALL_BALL]
    t = impacts["time"][0] if len(impacts) else np.inf
    first = sorted({int(j) for j in impacts["j"][impacts["time"] == t]})
    rails = own["time"][(own["kind"] == sn.EventKind.CUSHION) | (own["kind"] == sn.EventKind.JAW)]
    leaving = [(int(e["j"]), float(e["time"])) for e in impacts if e["time"] < rails.min(initial=np.inf)]
    potted = [int(i) for i in np.flatnonzero(np.asarray(shot.potted) >= 0)]
    at, velocities, _ = shot.at(0.0)
    cushion = bool(((events["kind"] == sn.EventKind.CUSHION) | (events["kind"] == sn.EventKind.JAW)).any())
    return Stroke(
        at[0],
        first,
        potted,
        np.array(shot.positions),
        leaving,
        velocities[0],
        nominated=nominated,
        cushion=cushion,
        duration=round(1000 * shot.duration),
    )


def among(shot, balls):
    """The same stroke with only these balls, and the cue ball, on the table."""
    present = np.isin(np.arange(22), [0, *balls])
    return sn.simulate(*shot.at(0.0), shot.table, shot.physics, on_table=present)


def path_of(shot) -> np.ndarray:
    """The cue ball's way up to its first impact with a ball, or to rest; close enough to know its distances
    to some nm."""
    own = shot.events[(shot.events["i"] == 0) & (shot.events["kind"] == sn.EventKind.BALL_BALL)]
    end = float(own["time"][0]) if len(own) else shot.duration
    knots = shot.events["time"][(shot.events["i"] == 0) & (shot.events["time"] < end)]
    times = np.unique(np.concatenate([np.linspace(0.0, end, 4001), knots]))
    times = times[times <= end - 1e-12]
    return shot.at(times)[0][:, 0]


def differences(expected: State, found: State, unsure=(), skip=()) -> list[str]:
    """The names of what differs between the oracle's state and the environment's, without what rounding
    decides."""
    if "behind" in unsure:
        return []
    excused = set(skip) | {name for reason in unsure for name in FOLLOWS[reason]}
    if expected.phase == "over":
        excused |= {"striker", "in_hand", "failures", "warned", "misses", "anywhere"}  # nobody is to play
    if expected.phase == "drawn":
        excused |= {"striker", "phase"}
    names = [name for name in LIKE if getattr(expected, name) != getattr(found, name) and name not in excused]
    if expected.phase != "over" and (expected.on_table != found.on_table).any():
        names.append("on_table")
    there = expected.on_table.copy()
    there[0] &= not expected.in_hand
    apart = np.abs(expected.positions - found.positions)[there].max(initial=0.0)
    if expected.phase != "over" and apart > PLACE and "positions" not in excused:
        names.append("positions")
    return names


@dataclass
class Case:
    """One stroke as it was played, and what the environment made of it."""

    before: State
    stroke: Stroke
    rules: Rules
    found: State
    info: dict

    def compare(self, rules=oracle, skip=()):
        """The oracle's verdict, its state, and the names of what differs."""
        verdict, expected = rules.judge(rules.State(**vars(self.before)), self.stroke, self.rules)
        names = differences(expected, self.found, verdict.unsure, skip)
        if "behind" in verdict.unsure:
            return verdict, expected, names
        fouls = {name for bit, name in FOULS.items() if self.info["fouls"] & bit}
        if fouls != verdict.fouls:
            names.append(f"fouls {sorted(fouls)}, oracle {sorted(verdict.fouls)}")
        for name in ("penalty", "points"):
            if self.info[name] != getattr(verdict, name):
                names.append(f"{name} {self.info[name]:g}, oracle {getattr(verdict, name)}")
        return verdict, expected, names


class Checker:
    """One environment whose frames are checked."""

    def __init__(self, kind: Kind, record: bool = False):
        self.kind, self.tally = kind, Tally()
        self.cases: list[Case] | None = [] if record else None
        self._last: dict = {}
        self._seed = 0
        self.env = sn.match_env(**{"aim": "target", "max_strokes": None, **kind.options})
        self.env.keep_history = True
        given = {name: kind.options[name] for name in ("miss", "game") if name in kind.options}
        given |= {name: True for name in kind.options.get("says", ()) if name != "decision"}
        if "time_to_play" in kind.options:
            given["time_to_play"] = round(1000 * kind.options["time_to_play"])
        self.rules = Rules(**given)
        names = (
            ["speed", "side", "top", "aim", "across", "back"]
            + ["nominate"] * self.rules.nominate
            + ["decision"]
        )
        names += ["declaration"] * (self.rules.concede or self.rules.claim or self.rules.lot)
        self.at = {name: k for k, name in enumerate(names)}
        """The number of an action that says what."""

    def frame(self, seed: int, most: int = 5000, begin=table) -> None:
        """Play and check one frame; of a kind with tables it begins from one that ``begin`` makes."""
        env, rng = self.env, np.random.default_rng(seed)
        env.reset(seed=seed)
        self._seed = seed
        if self.kind.tables:
            env.set_state(begin(env.get_state(), rng))
            most = 8
        self._last = env.get_state()
        state = state_of(self._last)
        if not self.kind.tables:
            self._begins(state)
        for _ in range(most):
            if state.phase == "over":
                break
            state = self._turn(state, rng)
        else:
            self.tally.seen["left unfinished"] += 1
        self.tally.frames += 1

    def _next_frame(self, expected, found, before):
        """A match: the frame counts, and the next begins at once, with the other player's break, or the match
        is decided."""
        after = self._last
        won = list(before["frames"])
        won[expected.winner] += 1
        self.tally.seen[f"frame won, {min(won)} to {max(won)}"] += 1
        if after["frames"] != won:
            self._disagree(
                "frames won", [f"{after['frames']}, oracle {won}"], expected, found, (before, None, None)
            )
        if max(won) > self.kind.options["frames"] // 2:
            if found.phase != "over":
                self._disagree("end of the match", ["phase"], expected, found, (before, None, None))
            return found
        self.tally.frames += 1
        breaks = after["first_break"] if sum(won) % 2 == 0 else 1 - after["first_break"]
        if found.striker != breaks or after["first_break"] != before["first_break"]:
            self._disagree("break", ["striker"], expected, found, (before, None, None))
        self._begins(found)
        return found

    def _begins(self, state):
        there = [i for i in range(22) if not (self.rules.game == "six_red" and 6 < i < 16)]
        racked = state.scores == [0, 0] and state.ball_on == 1 and state.in_hand and state.phase == "stroke"
        racked = racked and [*np.flatnonzero(state.on_table)] == there
        spots = all(np.allclose(state.positions[i], at, atol=1e-12) for i, at in geometry.SPOTS.items())
        if not (racked and spots):
            self._disagree("start", ["start"], state, state, None)

    def _turn(self, state, rng):
        env = self.env
        action = self._action(state, rng)
        before = self._last
        env.keep_history = False  # forget the strokes so far
        env.keep_history = True
        env.step(action)
        self._last = env.get_state()
        found = state_of(self._last)
        shot = env.last_shot
        player = self._decide(state, action)
        in_time = (
            oracle.late(player, self.rules)
            if player.phase == "stroke" and self.rules.game == "shoot_out"
            else None
        )
        if in_time is not None:
            verdict, expected = in_time
            names, unsure = differences(expected, found, verdict.unsure), verdict.unsure
            info = env.infos["player_0"]
            if info["fouls"] != 65536 or info["penalty"] != verdict.penalty:
                names.append(f"late: {info['fouls']} {info['penalty']}, oracle {verdict.penalty}")
            self.count(player, Stroke(found.positions[0], [], [], found.positions), verdict, expected)
        elif shot is None:
            names, expected, unsure = differences(player, found), player, set()
        else:
            expected, names, unsure = self._stroke(player, action, shot, found)
        if expected.phase == "over" and self.kind.options.get("task") == "match":
            return self._next_frame(expected, found, before)
        if names:
            self._disagree("stroke", names, expected, found, (before, action, shot))
        if names or unsure:
            found.saved = deepcopy(player) if found.miss_called else None
            return found
        return self._go_on(expected, found)

    def _decide(self, state, action):
        """The state in which a stroke is played, after a decision; or the one that a decision alone
        leaves."""
        says = (
            decisions.declared(state, float(action[self.at["declaration"]]), self.rules)
            if "declaration" in self.at
            else None
        )
        if says:
            self.tally.seen[says] += 1
        if says in ("concede", "claim"):
            return decisions.ended(state, 1 - state.striker if says == "concede" else state.striker)
        if state.phase == "lot":
            after = deepcopy(state)
            after.phase = "stroke"
            after.striker = 1 - state.striker if says else state.striker
            return after
        if state.phase != "choice":
            return state
        decision = float(action[self.at["decision"]])
        if decision < -1 / 3:
            self.tally.seen["played again as left"] += 1
            return decisions.play_again(state)
        if decision > 1 / 3 and self.rules.game == "six_red" and state.misses == 5:
            after = decisions.anywhere(state)
            self.tally.seen["placed anywhere" if after else "not anywhere: snookers required"] += 1
            return after or decisions.play_on(state)
        if decision > 1 / 3 and state.miss_called:
            self.tally.seen["replaced"] += 1
            return decisions.replace(state)
        return decisions.play_on(state)

    def _stroke(self, state, action, shot, found):
        said = decisions.named(state, float(action[self.at["nominate"]])) if self.rules.nominate else None
        stroke = stroke_of(shot, said)
        if self.rules.miss == "attempt":
            stroke.path, stroke.among = path_of(shot), lambda balls: path_of(among(shot, balls))
        if state.in_hand and state.anywhere:
            self._anywhere(state, action, stroke.cue)
        elif state.in_hand:
            x = float(action[self.at["across"]]) * geometry.D_RADIUS
            y = (
                geometry.BAULK
                - np.sqrt(max(0.0, geometry.D_RADIUS**2 - x * x)) * (float(action[self.at["back"]]) + 1) / 2
            )
            wish = geometry.nearest_in_d((x, y), state.positions[state.balls])
            if np.hypot(*(wish - stroke.cue)) > PLACE:
                self._disagree("placed", ["placed"], state, state, (wish, stroke.cue))
        elif np.hypot(*(state.positions[0] - stroke.cue)) > PLACE:
            self._disagree("moved", ["moved"], state, state, (state.positions[0], stroke.cue))
        case = Case(state, stroke, self.rules, found, self.env.infos["player_0"])
        if self.cases is not None:
            self.cases.append(deepcopy(case))
        verdict, expected, names = case.compare()
        self.count(state, stroke, verdict, expected)
        return expected, names, verdict.unsure

    def _anywhere(self, state, action, cue):
        """Where a cue ball that may stand anywhere was placed: where the player wished it, or no farther away
        than need be."""
        self.tally.seen["stroke from anywhere"] += 1
        wish = np.array(
            [
                geometry.HALF_WIDTH * float(action[self.at["across"]]),
                geometry.HALF_LENGTH * float(action[self.at["back"]]),
            ]
        )
        bed = np.array([geometry.HALF_WIDTH, geometry.HALF_LENGTH]) - geometry.R
        wish = np.clip(wish, -bed, bed)
        others = state.positions[state.balls]
        far = float(np.hypot(*(wish - cue)))
        turns = np.linspace(0, 2 * np.pi, 180, endpoint=False)
        nearer = wish + max(0.0, far - 2e-4) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        wrong = not geometry.free_anywhere(cue, others, -60e-6)
        if wrong or (far > 2e-4 and any(geometry.free_anywhere(at, others, 0.0) for at in nearer)):
            self._disagree("placed", ["anywhere"], state, state, (wish, cue))

    def count(self, state, stroke, verdict, expected):
        """Add one stroke to the tally."""
        self.tally.strokes += 1
        seen = self.tally.seen
        seen.update(f"foul: {name}" for name in verdict.fouls)
        seen.update(verdict.notes)
        seen.update(
            [f"penalty {verdict.penalty}"] if verdict.penalty else [f"points {min(verdict.points, 8)}"]
        )
        if state.free_ball:
            seen["stroke with a free ball"] += 1
        if expected.free_ball:
            seen["free ball given"] += 1
        if len(stroke.first) > 1:
            seen["two balls at once"] += 1
        if state.in_hand:
            seen["stroke from the D"] += 1
        if expected.phase == "over":
            how = (
                "re-spotted black"
                if state.respotted_black
                else "third miss"
                if "third miss" in verdict.notes
                else "black"
            )
            seen[f"end: {how}, {'foul' if verdict.fouls else 'score'}"] += 1
        self.tally.undecidable.update(verdict.unsure)

    def _go_on(self, expected, found):
        """The oracle's own state, with the places of the balls as they lie; who plays a re-spotted black is
        drawn by lot."""
        expected.positions = found.positions
        if expected.phase == "drawn":
            expected.phase, expected.striker = found.phase, found.striker
        return expected

    def _disagree(self, what, names, expected, found, data):
        self.tally.disagreements.append((what, names, expected, found, (self._seed, *(data or ()))))

    def _action(self, state, rng):
        """An action of a player who pots now and then, so that frames come to their end."""
        if self.kind.player == "ghost_ball" and rng.random() < 0.85:
            return self._soft_pot(state, rng)
        action = rng.uniform(-1.0, 1.0, self._shape())
        if "declaration" in self.at and rng.random() < 0.995 and state.phase != "lot" and state.balls != [21]:
            action[self.at["declaration"]] *= 0.6  # a player who resigns at random never comes to the end
        if self.kind.player == "steady" and rng.random() < 0.7:
            action[0] = rng.uniform(-0.75, -0.1)
            action[1:3] *= 0.2
            action[3] *= 0.15
        return np.float32(action)

    def _soft_pot(self, state, rng):
        """The widest pot, soft and plain."""
        action = np.zeros(self._shape(), np.float32)
        action[0] = -0.38
        action[4:] = rng.uniform(-1, 1, len(action) - 4)
        return action

    def _shape(self):
        space = self.env.action_space
        return (space("player_0") if callable(space) else space).shape
