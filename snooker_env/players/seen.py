"""How does a network play? It sees observations and answers with actions; an adapter makes a player."""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np

from .._lib.check import choice, refuse_what
from .._lib.types import Bools, Floats, Integers, Ints, Observation
from ..game import frame_columns as columns
from ..game.balls import mask_of_present
from ..physics.parameters import nominal
from ..planning import Positions
from ..planning.learned.dense_layers import Layers, Weights
from ..planning.positions import PositionsLike, seeds_of
from ..planning.strokes import decode
from ..tasks.discrete_actions import Choices
from ..tasks.frames import Frames, sayings
from ..tasks.observations import STROKE_SIZE, arrange
from ..tasks.options import Options
from ..tasks.visit import Visits
from .player import BoundPlayer, Strokes, place_cue_balls
from .weights import learned_menu

OPTIONS = (*Options.group("action"), *Options.group("view"), "miss")  # with "miss" it sees more


@runtime_checkable
class Seen(Protocol):
    """An object that acts on observations: a network, or a model of another library.

    Its attribute ``options``, if it has one, is a dict of how observations look and actions are read ("action", "observation",
    ... of ``Options``), with "task": "visit" (default) or "frame".

    Examples
    --------
    >>> from snooker_env.players import Seen
    >>> class First:
    ...     def act(self, observations, masks, seeds):
    ...         return masks.argmax(axis=1)
    >>> isinstance(First(), Seen)
    True
    """

    def act(self, observations: Observation, masks: Bools | None, seeds: Ints) -> Any:
        """Return n actions, for n observations, of the kinds that ``options`` say.

        ``masks``: bool (n, choices) with ``action="discrete"``, else None. ``seeds``, int64 (n,): equal rows
        and seeds must give equal actions, however many are asked for."""


class SeenPlayer(BoundPlayer):
    """A player that shows positions to a ``Seen`` as observations and reads its actions as strokes.

    One that sees visits can play frames too: with a free ball any colour is on; a cue ball in hand that its action does not
    place stands where ``ghost_ball`` puts it; after a foul it plays on.

    Parameters
    ----------
    seen, options, name
        The object that acts; how it does, default: its attribute ``options``, or none; the name in errors.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.players import SeenPlayer
    >>> class First:
    ...     def act(self, observations, masks, seeds):
    ...         return masks.argmax(axis=1)
    >>> player = SeenPlayer(First(), {"action": "discrete"}).at({})
    >>> player.play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0]).speed.tolist()
    [0.9]
    """

    seen: Any
    name: str
    frames: bool  # whether it sees frames

    def __init__(self, seen: Any, options: Mapping[str, Any] | None = None, name: str | None = None):
        sees = dict(getattr(seen, "options", {}) if options is None else options)
        self.seen, self.name = seen, name or type(seen).__name__
        task = choice(f"task of player {self.name}", sees.pop("task", "visit"), ("visit", "frame"))
        self.frames = task == "frame"
        for key in sees:
            choice(f"key of the options of player {self.name}", key, OPTIONS)
        if not self.frames:
            sees.pop("says", None)  # there is nothing to say in a visit
        self.sees = sees
        self._rules: Any = None
        self._bind(Options())

    def _bind(self, options: Options) -> None:
        """Read its options with the physics of ``options``; ValueError if they are no environment's."""
        same: dict[str, Any] = {name: getattr(options, name) for name in Options.group("shot")}
        if self.sees.get("observe_conditions"):  # on a table that is not drawn it sees the nominal ones
            same["conditions"] = "drawn"
        if self.frames:
            match = {"frames": options.frames} if options.task == "match" else {}
            same |= {"task": "match" if match else "frame"} | match
            same |= {name: getattr(options, name) for name in Options.group("frame")}
        self._rules = Options(**same | self.sees).rules

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        """See ``Player.play``."""
        at = Positions.of(positions).known_to(self.options.rules)
        keys = seeds_of(seeds, len(at))
        shown, places = self._show(at, keys)
        actions = self._actions(shown, keys)
        said = ()
        if self.frames:
            said = sayings(self._rules, actions, shown.game)
            shown = shown.copy()
            shown.game[np.ix_(said[1] == columns.PLACE_ANYWHERE, [columns.IN_HAND, columns.ANYWHERE])] = 1
        values, start = decode(self._rules, shown, np.arange(len(at)), actions, *said[:1])
        puts = (shown.in_hand & bool(self._rules.actions.placement))[:, None]
        return Strokes(values, np.where(puts, start.positions[:, 0], places), *said)

    def _show(self, at: Positions, keys: Ints) -> tuple[Positions, Floats]:
        """The positions as it sees them, and where cue balls in hand were placed for it (n, 2), else NaN."""
        none = np.full((len(at), 2), np.nan)
        if self.frames:
            return (at if at.of_frames else begun(at)), none
        if not self._rules.actions.placement:
            return place_cue_balls(at, keys)
        anywhere, visits = at.anywhere & at.in_hand, at.as_visits()
        if anywhere.any():  # the places that it knows are those of the D
            put, places = place_cue_balls(at[anywhere], keys[anywhere])
            visits.positions[anywhere], none[anywhere] = put.positions, places
        return visits, none

    def _actions(self, at: Positions, keys: Ints) -> Floats:
        """Its checked actions in n positions; errors name it."""
        n, rules = len(at), self._rules
        tables: Any = (Frames if self.frames else Visits)(rules, n if rules.drawn else 0)
        tables.n, tables.positions, tables.on_table, tables.game = n, at.positions, at.on_table, at.game
        if rules.drawn:  # a table whose constants are not drawn has the nominal ones
            own = at.known_to(rules).conditions
            nominals = np.tile(nominal(rules.physics), (n, 1))
            tables.set_conditions(np.arange(n), nominals if own is None else own)
        if self.frames:
            none = np.zeros_like(at.positions), np.zeros_like(at.on_table)
            tables._saved_positions, tables._saved_on_table = none if at.saved is None else at.saved
        rows = np.arange(n)
        masks = tables.action_masks(rows) if isinstance(rules.actions, Choices) else None
        answer = self.seen.act(arrange(rules.observation, tables.observe(rows), masks), masks, keys)
        try:
            actions = np.asarray(answer)
            if actions.ndim == 0 or len(actions) != n:
                allowed = f"must be {n}, one for each position"
                raise refuse_what("actions", f"array of shape {actions.shape}", allowed)
            return rules.actions.check(actions, n)
        except ValueError as error:
            raise ValueError(f"player {self.name}: act(...) returned {error}") from None


def begun(at: Positions) -> Positions:
    """Positions of visits as those of frames: the striker's points alone have been scored."""
    game = np.zeros((len(at), columns.COLUMNS), np.int64)
    game[:, : columns.VISIT_COLUMNS], game[:, columns.WINNER] = at.game, -1
    game[:, columns.SCORE_0] = at.points
    masks = np.array([mask_of_present(on_table) & ~1 for on_table in at.on_table], np.int64)
    game[:, [columns.ON_TABLE, columns.RACK]] = masks[:, None]
    return Positions(at.positions, at.on_table, game, None, at.conditions)


class MenuNetwork:
    """A ``Seen`` that chooses from menus of a "visit" or a "frame" by the ``layers`` of a ``snooker_env.sb3.StrokesPolicy``."""

    def __init__(self, layers: Weights, task: str) -> None:
        self.options: dict[str, str] = {"action": "strokes", "observation": "strokes", "task": task}
        self._layers = Layers(layers, "tanh")

    def act(self, observations: Observation, masks: Bools | None, seeds: Ints) -> Ints:
        """The choice with the highest score for each observation (n, K * 23 + S); ``masks`` (n, K): those on the menu."""
        seen, there = np.asarray(observations), np.asarray(masks, np.bool_)
        n, choices = there.shape
        strokes = seen[:, : choices * STROKE_SIZE].reshape(n, choices, STROKE_SIZE)
        state = np.repeat(seen[:, None, choices * STROKE_SIZE :], choices, axis=1)
        rows = np.concatenate([strokes, state], axis=2)
        scores = self._layers(rows.reshape(n * choices, rows.shape[2])).reshape(n, choices)
        return np.where(there, scores, -np.inf).argmax(axis=1)


class MenuPlayer(SeenPlayer):
    """``strokes``: one network for visits, another for frames."""

    def __init__(self) -> None:
        self._networks = [MenuNetwork(learned_menu(f"{task}s"), task) for task in ("visit", "frame")]
        super().__init__(self._networks[0], name="strokes")
        self.frames = True  # it knows them; bound, it sees what its options say

    def _bind(self, options: Options) -> None:
        self.frames = options.task != "visit"
        self.seen = self._networks[self.frames]
        super()._bind(options)
