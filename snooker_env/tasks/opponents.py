"""Who plays the other side of a frame? Two players as kernels, any callable, saved model or player, or a pool of them.

For all tables at which it is the opponent's turn, ``ask(frames, which, generators)`` is called once, in Python, and returns actions or
None. Then ``prepare(frames, which, actions, buffers)``, on several threads, carries them out up to the strike.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, cast

import numpy as np

from .. import _entry_points
from .._check import refuse, refuse_what, truth
from .._types import Action, Bools, Floats, Ints, Observation, ObservationKind
from . import observations
from .box_actions import Actions
from .discrete_actions import SIZE as CHOICES
from .discrete_actions import Choices
from .ghost_ball import GhostBallOpponent
from .opponent_pool import OpponentPool, PoolOpponent
from .player_opponent import PlayerOpponent, is_player
from .saved_models import SavedModel, by_train, entries, one_thread, outline
from .stroke import ShotBuffers
from .uniform_opponent import UniformOpponent

if TYPE_CHECKING:
    from .frame import Frames


class Player(Protocol):
    """Any player of this project: ``options`` says how its actions are read."""

    options: Any

    def act(self, tables: Any, observations: Any, going: Bools) -> Any:
        """An action for each table; only those of the tables ``going`` are played."""


Policy: TypeAlias = Callable[[Observation, np.random.Generator], Action]
"""A player in Python: maps the observation from its own side of the table, and a generator for its random numbers, to an action."""
OPPONENTS = ("none", "random", "ghost_ball")
ALLOWED = (
    "must be one of " + ", ".join(map(repr, OPPONENTS)) + ", a path to a model (.zip), the name of a player, a callable(observation, rng) "
    "-> action, a player with options and act(...), or an OpponentPool"
)
PLAYER = 1
"""Index of the opponent in the frame."""


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
            rows = [row.copy() for row in seen]
            shown = frames.action_masks(which) if rules.observation == "masked" else [None] * len(rows)
            views = [observations.shaped(rules.observation, row, mask) for row, mask in zip(rows, shown, strict=True)]
            return [self.policy(view, rng) for view, rng in zip(views, generators, strict=True)]
        masks = frames.action_masks(which) if isinstance(rules.actions, Choices) else None
        wished = many(observations.shaped(rules.observation, seen, masks), generators, masks)
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
        own = self._network.observation_space
        if self.kind == "masked":  # one of strokes alone does not see what else may be chosen
            observation = observation | {"action_mask": observation["action_mask"][..., : self._network.action_space.n]}
        if own in self._views(False):
            observation = visit_part(observation)
        elif self.replaced and own in self._views(True):
            observation = without_replaced(observation)
        if isinstance(self.actions, Choices):
            masked = {"action_masks": masks[:, : self._network.action_space.n]} if self._masked and masks is not None else {}
            return self._greedy(observation, **masked)
        actions = np.clip(self._greedy(observation), -1.0, 1.0)
        missing = self.actions.size - actions.shape[1]
        return np.append(actions, np.zeros((len(actions), missing), actions.dtype), axis=1) if missing else actions

    def _greedy(self, observation, **masked):
        with one_thread():
            return self._network.predict(observation, deterministic=True, **masked)[0]

    def _sizes(self):
        """The sizes of the actions of models that fit."""
        actions = self.actions
        most = actions.choices if isinstance(actions, Choices) else actions.size
        strokes = CHOICES if isinstance(actions, Choices) else actions.size - actions.decision - actions.declares
        return [most] if actions.nominate else sorted({strokes, most})  # a nomination cannot be left out

    def _views(self, frame, *, replaced=False):
        """The observation spaces of models of frames, or of visits, that fit."""
        sizes = self._sizes() if self.kind == "masked" else [0]
        return [observations.space(self.kind, frame=frame, replaced=replaced, choices=size) for size in sizes]

    def _load(self):
        seen = self._views(False) + self._views(True) + (self._views(True, replaced=True) if self.replaced else [])
        discrete, sizes = isinstance(self.actions, Choices), self._sizes()
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


Opponent: TypeAlias = UniformOpponent | GhostBallOpponent | AskedOpponent | PlayerOpponent | PoolOpponent
OpponentLike: TypeAlias = str | Path | Policy | Player | OpponentPool
"""What the option ``opponent`` accepts."""


def asked(opponent: Opponent, frames: "Frames", which: Ints, generators: Sequence[np.random.Generator]) -> list[tuple[Any, Ints, Any]]:
    """Who plays on which of the tables ``which``, and his actions there, for his ``prepare``: [(player, tables, actions), ...]."""
    if isinstance(opponent, PoolOpponent):
        return opponent.asked(frames, which, generators)
    return [(opponent, which, opponent.ask(frames, which, generators))]


def visit_part(observation: Observation) -> Observation:
    """The part of a frame's observations that the visit task has too."""
    if isinstance(observation, dict) and "action_mask" in observation:
        return observation | {"observations": visit_part(observation["observations"])}
    if isinstance(observation, dict):
        return {"balls": observation["balls"], "state": observation["state"][..., : len(observations.STATE_ENTRIES)]}
    return observation[..., : observations.SIZE]


def without_replaced(observation: Observation) -> Observation:
    """A frame's observations without the layout that "replace" restores."""
    if isinstance(observation, dict) and "action_mask" in observation:
        return observation | {"observations": without_replaced(observation["observations"])}
    if isinstance(observation, dict):
        return {"balls": observation["balls"], "state": observation["state"]}
    return observation[..., : observations.FRAME_SIZE]


def opponent_of(
    opponent: OpponentLike, kind: ObservationKind, actions: Actions | Choices, trust: bool = False, *, shared: Mapping[str, Any],
    replaced: bool = False,
) -> Opponent | None:  # fmt: skip
    """The player that ``opponent`` names; None for "none".

    ``kind``: of the observation; ``trust``: code in a model's file may run; ``shared``: the options that both players share; ``replaced``:
    the observation holds the layout that "replace" restores.
    """
    truth("trust", trust)
    if isinstance(opponent, OpponentPool):
        return PoolOpponent(opponent, partial(opponent_of, kind=kind, actions=actions, trust=trust, shared=shared, replaced=replaced))
    if isinstance(opponent, type):
        raise refuse("opponent", opponent, f"must be an instance and not the class: {opponent.__name__}(...)")
    if not isinstance(opponent, str | Path):
        if is_player(opponent):
            return PlayerOpponent(opponent, actions.physics, shared)
        if not (callable(opponent) or callable(getattr(opponent, "many", None))):
            raise _no_opponent(opponent)
        return AskedOpponent(cast(Policy, opponent))
    name = str(opponent)
    if name in OPPONENTS:
        return {"none": lambda: None, "random": UniformOpponent, "ghost_ball": GhostBallOpponent}[name]()
    if Path(name).suffix == ".zip" and not _of_train(name):
        return AskedOpponent(SavedPolicy(name, kind, actions, trust, replaced))
    if not name:
        raise refuse("opponent", name, ALLOWED)
    try:
        player = _entry_points.load(_entry_points.PLAYER)(name, trust=trust)
    except ValueError as error:
        if Path(name).exists() or ":" in name:
            raise ValueError(f"opponent = {name!r}: {error}") from error
        names = dict.fromkeys((*OPPONENTS, *_entry_points.load(_entry_points.NAMES)()))
        known = "must be one of " + ", ".join(map(repr, names)) + ", MODULE:CLASS, a model (.zip) or the folder of a training run"
        raise refuse("opponent", opponent, known) from error
    return PlayerOpponent(player, actions.physics, shared, name)


def _no_opponent(thing: Any) -> ValueError:
    """The error for what is no opponent."""
    if not callable(getattr(thing, "act", None)):
        return refuse("opponent", thing, ALLOWED)
    what = f"a {type(thing).__name__} with act(...)" + (" and options that are no mapping" if hasattr(thing, "options") else " alone")
    return refuse_what("opponent", what, "must also have options, a mapping that says how its actions are read: {} for the default options")


def _of_train(name: str) -> bool:
    """Whether that is a model of this repository's ``train.py``; False for what is no sound model's file."""
    try:
        return by_train(entries(name))
    except Exception:  # ``SavedPolicy`` says what is wrong with it
        return False
