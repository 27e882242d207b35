"""Who plays the other side of a frame? Uniform random play and a geometric player as kernels, any callable, or a saved model.

For all tables at which it is the opponent's turn, ``ask(frames, which, generators)`` is called once, in Python, and returns actions or
None. Then ``prepare(frames, which, actions, buffers)``, on several threads, carries them out up to the strike.
"""

from collections.abc import Callable, Sequence
from math import atan2, hypot, inf, pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from .._check import refuse, truth
from .._jit import entry, kernel
from .._types import Action, Bools, Floats, Ints, Observation, ObservationKind
from ..game.balls import N_BALLS, bits
from ..game.frame_columns import CHOICE, IN_HAND, LOT, PHASE, PLAY, STRIKER, choose, draw, strikeable
from ..game.philox import pair
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, BAULK_Y, D_RADIUS, POCKET_AIMS
from . import observations
from .box_actions import Actions
from .discrete_actions import SIZE as CHOICES
from .discrete_actions import Choices
from .saved_models import SavedModel, outline
from .stroke import ShotBuffers, place, strike

if TYPE_CHECKING:
    from .frame import Frames

Policy: TypeAlias = Callable[[Observation, np.random.Generator], Action]
"""A player in Python: maps the observation from its own side of the table, and a generator for its random numbers, to an action."""
OPPONENTS = ("none", "random", "ghost_ball")
PLAYER = 1
"""Index of the opponent in the frame."""

_ROLL = 0.25  # twice a rolling ball's deceleration [m/s^2]
_SLIDE = 1.4  # initial speed of a ball struck in its middle, over the speed with which it rolls on
_PLACES = tuple((x * D_RADIUS, BAULK_Y - y * D_RADIUS) for y in (0.0, 0.5) for x in (-0.8, -0.4, 0.0, 0.4, 0.8))
_USUAL_PLACE = 2


@entry(what="uniform play", seconds=1)
def _uniform(which, streams, actions):
    """Each component of the actions of the tables ``which`` uniform in [-1, 1): the rows of ``actions`` (n, k)."""
    size = actions.shape[1]
    for j in range(which.shape[0]):
        k = which[j]
        for c in range(0, size, 2):
            u, v = pair(streams[k])
            actions[k, c] = 2.0 * u - 1.0
            if c + 1 < size:
                actions[k, c + 1] = 2.0 * v - 1.0


@entry
def _uniform_choice(which, streams, masks, actions):
    """A uniformly random available choice on each of the tables ``which``; masks (len(which), choices)."""
    for j in range(which.shape[0]):
        k, many = which[j], 0
        for c in range(masks.shape[1]):
            many += masks[j, c]
        u, _ = pair(streams[k])
        left = int(u * many)
        for c in range(masks.shape[1]):
            if masks[j, c]:
                if left == 0:
                    actions[k, 0] = c
                left -= 1


class UniformOpponent:
    """Uniform random play: every component of a box action, the decision included; or one of the available discrete actions.

    It never concedes: with ``concede`` its declaration lies above the part of the range that means so.
    """

    def ask(self, frames: "Frames", which: Ints, generators: Sequence[np.random.Generator]) -> Floats:
        """Empty actions: ``prepare`` draws them from each table's own stream."""
        return np.empty((frames.n, frames.rules.actions.size))

    def prepare(self, frames: "Frames", which: Ints, actions: Floats, buffers: ShotBuffers) -> Ints:
        """Carry the strokes out up to the strike; returns the tables with a stroke."""
        own = frames.rules.actions
        if isinstance(own, Choices):
            masks = frames.action_masks(which)
            if own.concede:
                masks[:, CHOICES * (7 if own.nominate else 1)] = False
            _uniform_choice(which, frames.streams, masks, actions)
        else:
            _uniform(which, frames.streams, actions)
            if own.concede:
                actions[which, -1] = (5.0 * actions[which, -1] + 1.0) / 6.0
        return frames.prepare(which, actions, buffers)


@kernel
def _full(positions, on_table, ball):
    """Whether the cue ball can roll straight at the middle of ``ball`` without touching another ball."""
    cx, cy = positions[0, 0], positions[0, 1]
    dx, dy = positions[ball, 0] - cx, positions[ball, 1] - cy
    far = hypot(dx, dy)
    for i in range(1, N_BALLS):
        if i == ball or not on_table[i]:
            continue
        ox, oy = positions[i, 0] - cx, positions[i, 1] - cy
        along = min(max(0.0, far - 2.0 * BALL_RADIUS), max(0.0, (ox * dx + oy * dy) / far))
        if hypot(ox - along * dx / far, oy - along * dy / far) < 2.0 * BALL_RADIUS:
            return False
    return True


@kernel
def _wanted(positions, on_table, on, found, stream):
    """Speed [m/s] and direction [rad] of the geometric player's shot at the balls in the mask ``on``."""
    x, y = positions[0, 0], positions[0, 1]
    if find_pots(positions, on_table, on, BALL_RADIUS, found):
        ball, pocket, gx, gy = int(found[0, POT_BALL]), int(found[0, POT_POCKET]), found[0, GHOST_X], found[0, GHOST_Y]
        run = hypot(POCKET_AIMS[pocket, AIM_X] - positions[ball, 0], POCKET_AIMS[pocket, AIM_Y] - positions[ball, 1])
        needed = _SLIDE * sqrt(_ROLL * (run + 0.6)) / max(found[0, COS_CUT], 0.2)  # of the cue ball at the impact
        return min(6.0, _SLIDE * sqrt(_ROLL * hypot(gx - x, gy - y) + needed * needed)), atan2(gy - y, gx - x)
    near, ball = inf, -1
    for i in range(1, N_BALLS):
        if (on >> i) & 1 and _full(positions, on_table, i):
            far = hypot(positions[i, 0] - x, positions[i, 1] - y)
            if far < near:
                near, ball = far, i
    if ball > 0:
        return _SLIDE * sqrt(_ROLL * near) + 0.5, atan2(positions[ball, 1] - y, positions[ball, 0] - x)
    u, _ = pair(stream)
    return 3.0, pi * (2.0 * u - 1.0)


@entry(what="the geometric opponent", seconds=2)
def _ghost_ball(which, positions, on_table, game, streams, options, noise, r, v, w, here, shots):
    """The turns of ``GhostBallOpponent`` on the tables ``which``, up to the strike."""
    found = np.empty((1, POT_COLUMNS))
    for j in range(which.shape[0]):
        k = which[j]
        p, on, row, stream = positions[k], on_table[k], game[k], streams[k]
        fouled = row[PHASE] == CHOICE
        if fouled:
            choose(row, PLAY)
        elif row[PHASE] == LOT:
            draw(row, row[STRIKER])
        mask = strikeable(row, bits(on) & ~1)
        if row[IN_HAND]:
            widest, best = 0.0, _USUAL_PLACE
            for c in range(len(_PLACES)):
                place(p, on, *_PLACES[c])
                if find_pots(p, on, mask, BALL_RADIUS, found) and found[0, TOLERANCE] > widest:
                    widest, best = found[0, TOLERANCE], c
            place(p, on, *_PLACES[best])
        u, anywhere = pair(stream)
        jitter, _ = pair(stream)
        speed, aim = 3.0, pi * (2.0 * u - 1.0)
        if not (fouled and anywhere < 0.1):
            speed, aim = _wanted(p, on, mask, found, stream)
        strike((speed * (0.9 + 0.2 * jitter), 0.0, 0.0, aim, 0.0), p, on, stream, options, noise, j, r, v, w, here, shots)


class GhostBallOpponent:
    """The geometric player: the widest direct pot (``game.pots``), struck in the middle, as softly as possible.

    * Without a pot it rolls full at the nearest ball on with a clear path; without one, it strikes in a random direction.
    * With the cue ball in hand it takes the best of ten places. After a foul it always plays the table as it lies.
    * It allows for neither throw nor position.
    * Its speed varies by a tenth, and after a foul of the opponent it strikes in a random direction one time in ten. Otherwise two exact
      players could repeat one failing stroke for ever.
    """

    def ask(self, frames: "Frames", which: Ints, generators: Sequence[np.random.Generator]) -> None:
        """None: it plays as a kernel."""

    def prepare(self, frames: "Frames", which: Ints, actions: Any, buffers: ShotBuffers) -> Ints:
        """Carry its strokes out up to the strike, one on each table."""
        b = buffers
        options, noise, _ = frames.packed
        _ghost_ball(which, frames.positions, frames.on_table, frames.game, frames.streams, options, noise, b.r, b.v, b.w, b.here, b.shots)
        return which


class AskedOpponent:
    """A player given by a policy, ``policy(observation, rng) -> action``, in the environment's own spaces, decision and placement included.

    A policy with a method ``many(observations, generators, masks) -> actions`` is called once for all tables that wait for it: observations
    with a leading axis, as many generators, and the masks of discrete actions (None for box actions).
    """

    def __init__(self, policy: Policy):
        self.policy = policy

    def ask(self, frames: "Frames", which: Ints, generators: Sequence[np.random.Generator]) -> Floats:
        """Its actions on the tables ``which``: (n, k). Raises ValueError, naming "opponent's action", for an invalid one."""
        rules, k_of = frames.rules, which.tolist()
        seen = frames.observe(which, PLAYER)
        wished = self._wishes(rules, seen, [generators[k] for k in k_of], frames, which)
        actions = np.zeros((frames.n, rules.actions.size))
        for j, k in enumerate(k_of):
            try:
                actions[k] = rules.actions.check(wished[j])
            except ValueError as error:
                raise ValueError(f"opponent's {error}") from None
        return actions

    def _wishes(self, rules, seen, generators, frames, which):
        many = getattr(self.policy, "many", None)
        if many is None:
            return [self.policy(observations.shaped(rules.observation, row.copy()), rng) for row, rng in zip(seen, generators, strict=True)]
        masks = frames.action_masks(which) if isinstance(rules.actions, Choices) else None
        wished = many(observations.shaped(rules.observation, seen), generators, masks)
        if not hasattr(wished, "__len__") or len(wished) != len(which):
            raise refuse("opponent's actions", wished, f"must be {len(which)}, one for each table that waits")
        return wished

    def prepare(self, frames: "Frames", which: Ints, actions: Floats, buffers: ShotBuffers) -> Ints:
        """Carry the strokes out up to the strike; returns the tables with a stroke."""
        return frames.prepare(which, actions, buffers)


class SavedPolicy:
    """A model saved by Stable-Baselines3 or sb3-contrib. Its pickles run when it is loaded, so ``trust`` is required.

    The model may have been trained on frames or on the visit task, with the observation kind, aim and action options of this environment. A
    model of the visit task does not get the frame's entries, and its decision is to play. Actions are deterministic. A model that does not
    fit is refused by the plain data in its file, before anything in it runs.
    """

    path: Path
    kind: ObservationKind
    actions: Actions | Choices
    trust: bool
    replaced: bool
    """Whether the environment shows the layout that "replace" restores."""

    def __init__(self, path: str | Path, kind: ObservationKind, actions: Actions | Choices, trust: bool, replaced: bool = False):
        self.path, self.kind, self.actions, self.trust, self.replaced = Path(path), kind, actions, trust, replaced
        self._network = self._load()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_network": None}  # loaded again where it is needed

    def __call__(self, observation: Observation, rng: np.random.Generator) -> Action:
        """The action of one table."""
        one = {name: part[None] for name, part in observation.items()} if isinstance(observation, dict) else observation[None]
        return self.many(one, [rng], None)[0]

    def many(self, observation: Observation, generators: Sequence[np.random.Generator], masks: Bools | None) -> Any:
        """The actions of all tables with these observations; ``masks``: of discrete actions, or None."""
        if self._network is None:
            self._network = self._load()
        if self._network.observation_space == observations.space(self.kind):
            observation = visit_part(observation)
        elif self.replaced and self._network.observation_space == observations.space(self.kind, frame=True):
            observation = without_replaced(observation)
        if isinstance(self.actions, Choices):
            masked = {"action_masks": masks[:, : self._network.action_space.n]} if self._masked and masks is not None else {}
            return self._network.predict(observation, deterministic=True, **masked)[0]
        actions = np.clip(self._network.predict(observation, deterministic=True)[0], -1.0, 1.0)
        missing = self.actions.size - actions.shape[1]
        return np.append(actions, np.zeros((len(actions), missing), actions.dtype), axis=1) if missing else actions

    def _load(self):
        seen = [observations.space(self.kind), observations.space(self.kind, frame=True)]
        seen += [observations.space(self.kind, frame=True, replaced=True)] if self.replaced else []
        discrete, actions = isinstance(self.actions, Choices), self.actions
        most = actions.choices if isinstance(actions, Choices) else actions.size
        strokes = CHOICES if discrete else actions.size - actions.decision - actions.declares
        sizes = [most] if actions.nominate else sorted({strokes, most})  # a nomination cannot be left out
        fitting: list[tuple[str, Any]] = [("Discrete", str(size)) if discrete else ("Box", [size]) for size in sizes]
        saved = SavedModel.of(self.path, "opponent")
        if saved.action[0] != fitting[0][0]:
            raise saved.refused(f"must be a model whose actions are a {fitting[0][0]}")
        other_view = saved.refused(f'must be a model that sees observation="{self.kind}" of the visit or frame task and nothing else')
        other_actions = saved.refused(f"must be a model with {' or '.join(map(str, sizes))} actions")
        if saved.observation not in [outline(space) for space in seen]:
            raise other_view
        if tuple(saved.action) not in [tuple(one) for one in fitting]:
            raise other_actions
        network = saved.network(self.trust, "trust=True")
        self._masked = discrete and saved.algorithm[1] == "MaskablePPO"
        if network.observation_space not in seen:  # a file's description may not match its content
            raise other_view
        if outline(network.action_space) not in fitting:
            raise other_actions
        return network


Opponent: TypeAlias = UniformOpponent | GhostBallOpponent | AskedOpponent


def visit_part(observation: Observation) -> Observation:
    """The part of a frame's observations that the visit task has too."""
    if isinstance(observation, dict):
        return {"balls": observation["balls"], "state": observation["state"][..., : len(observations.STATE_ENTRIES)]}
    return observation[..., : observations.SIZE]


def without_replaced(observation: Observation) -> Observation:
    """A frame's observations without the layout that "replace" restores."""
    if isinstance(observation, dict):
        return {"balls": observation["balls"], "state": observation["state"]}
    return observation[..., : observations.FRAME_SIZE]


def opponent_of(
    opponent: str | Path | Policy, kind: ObservationKind, actions: Actions | Choices, trust: bool = False, *, replaced: bool = False
) -> Opponent | None:
    """The player that ``opponent`` names; None for "none".

    ``kind``: of the observation; ``trust``: code in a model's file may run; ``replaced``: the observation holds that layout.
    """
    allowed = "must be one of " + ", ".join(map(repr, OPPONENTS)) + ", a path to a model (.zip), or a callable(observation, rng) -> action"
    truth("trust", trust)
    if not isinstance(opponent, str | Path):
        if not (callable(opponent) or callable(getattr(opponent, "many", None))):
            raise refuse("opponent", opponent, allowed)
        return AskedOpponent(opponent)
    if str(opponent) in OPPONENTS:
        return {"none": lambda: None, "random": UniformOpponent, "ghost_ball": GhostBallOpponent}[str(opponent)]()
    if Path(opponent).suffix != ".zip":
        raise refuse("opponent", opponent, allowed)
    return AskedOpponent(SavedPolicy(opponent, kind, actions, trust, replaced))
