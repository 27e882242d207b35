"""What is there to draw? A table, its lines, balls and overlays, in metres and without a drawing library.

World frame: origin at the table's centre, +x to the yellow side, +y to the black end. ``scene`` says what lies on the table now,
``Film`` and ``shot_scenes`` cut a shot into the pictures of a film. The parts of a table that never move, and ``scene_data``, which is
all that a drawing in another language needs, are in ``outline``; colours are in ``palette``.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import array, integer, number, refuse
from .._types import Flags, Floats, Ints, Vector, Vectors
from ..game.balls import CUE, N_BALLS
from ..geometry import BALL_RADIUS
from ..physics.engine import EventKind
from ..physics.table import Table, TableLike
from ..simulation import Shot
from .outline import outline as outline  # a part of what there is to draw
from .outline import scene_data as scene_data
from .palette import COLOURS, LETTERS
from .turning import Turning


@dataclass(frozen=True)
class ScoreBar:
    """What a score bar under the table says, as on television. What is not known is left out: None, "" or ().

    Attributes
    ----------
    players : tuple of str
        Their names: none, one or two.
    scores : tuple of int
        Their points in this frame, one for each player.
    striker : int, or None
        Whose turn it is, an index of ``players``.
    break_points : int, or None
        Points of the visit so far.
    potted : tuple of int
        Ids of the balls potted in this visit, in their order.
    reds_left : int, or None
        Reds on the table.
    points_on : int, or None
        Points that are still on the table.
    ball_on : str
        What must be struck: "red", "any colour", "blue", "free ball", ...
    words : str
        One line: what just happened, in the referee's words.

    Examples
    --------
    >>> from snooker_env.render.scene import ScoreBar
    >>> ScoreBar(("Ann", "Bob"), (41, 12), striker=0, break_points=16, potted=(1, 21, 2, 21), ball_on="red").scores
    (41, 12)
    """

    players: tuple[str, ...] = ()
    scores: tuple[int, ...] = ()
    striker: int | None = None
    break_points: int | None = None
    potted: tuple[int, ...] = ()
    reds_left: int | None = None
    points_on: int | None = None
    ball_on: str = ""
    words: str = ""

    def __post_init__(self):
        if len(self.players) > 2 or not all(isinstance(name, str) for name in self.players):
            raise refuse("players", self.players, "must be the names of at most two players")
        if len(self.scores) != len(self.players):
            raise refuse("scores", self.scores, f"must hold one number for each of the {len(self.players)} players")
        if self.striker is not None and self.striker not in range(len(self.players)):
            raise refuse("striker", self.striker, "must be None or an index of players")
        for ball in self.potted:
            integer("potted", ball, 1, N_BALLS - 1)


@dataclass(frozen=True, eq=False)
class Scene:
    """One picture. Only balls on the table are in it; k of them.

    Attributes
    ----------
    table : Table
        What it lies on.
    ids : int64
        (k,) ball ids: 0 the cue ball, 1 to 15 reds, 16 to 21 yellow to black.
    positions : float64
        (k, 2) [m].
    ball_radius : float
        [m].
    paths : dict of int to float64
        Ball id -> (m, 2) [m]: where that ball ran.
    aim : float64, or None
        (m, 2) [m]: line of aim.
    ghost : float64, or None
        (2,) [m]: where the cue ball should meet its object ball, drawn as an outline.
    ghosts : dict of int to float64
        Ball id -> (m, 2) [m]: where that ball was, drawn faded; e.g. of ``contacts``.
    turns : dict of int to float64
        Ball id -> (4,) the unit quaternion (w, x, y, z) that turns the ball from how it lay to how it lies. Such a ball has spots.
    text : str
        One line of status, shown where there is no ``bar``.
    bar : ScoreBar, or None
    lettered : bool
        Whether balls carry their letters, so that nobody depends on colours.
    """

    table: Table
    ids: Ints
    positions: Floats
    ball_radius: float
    paths: dict[int, Floats]
    aim: Floats | None
    ghost: Floats | None
    ghosts: dict[int, Floats]
    turns: dict[int, Floats]
    text: str
    bar: ScoreBar | None
    lettered: bool

    @property
    def colours(self) -> NDArray[np.uint8]:
        """(k, 3) uint8."""
        return COLOURS[self.ids]

    @property
    def labels(self) -> tuple[str, ...]:
        """One letter a ball."""
        return tuple(LETTERS[i] for i in self.ids)


def scene(
    table: TableLike,
    positions: Vectors,
    on_table: Flags | None = None,
    *,
    ball_radius: float | None = None,
    paths: Mapping[int, Vectors] | None = None,
    aim: Vectors | None = None,
    ghost: Vector | None = None,
    ghosts: Mapping[int, Vectors] | None = None,
    turns: Mapping[int, Vector] | None = None,
    text: str = "",
    bar: ScoreBar | None = None,
    lettered: bool = False,
) -> Scene:
    """What to draw: n <= 22 balls with the ids 0 .. n-1, and what to lay over them. Arrays are copied.

    Parameters
    ----------
    table : str, Table or None
        As in ``snooker_env.simulate``.
    positions : array_like, float (n, 2)
        [m]
    on_table : array_like, bool (n,), optional
        None: all are.
    ball_radius : float, optional
        [m]; None: that of the table, or snooker's.
    paths : dict, optional
        {ball id: (m, 2) points}, e.g. of ``ball_paths``.
    aim : array_like, float (m, 2), optional
        Points of a line.
    ghost : array_like, float (2,), optional
        A ball's outline.
    ghosts : dict, optional
        {ball id: (m, 2) places} where that ball is drawn faded, e.g. {0: contacts(shot)}.
    turns : dict, optional
        {ball id: (4,) quaternion}, as in ``Scene``.
    text : str
        One line of status.
    bar : ScoreBar, optional
        In place of the text.
    lettered : bool
        Letters on the balls.

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        On bad input; the message names the field, its value and what is allowed.
    """
    r = array("positions", positions, (-1, 2))
    if len(r) > N_BALLS:
        raise refuse("positions", f"array of shape {r.shape}", f"must hold at most {N_BALLS} balls")
    here = np.ones(len(r), bool) if on_table is None else np.array(on_table)
    if here.shape != (len(r),) or here.dtype != bool:
        raise refuse("on_table", f"{here.dtype} array of shape {here.shape}", f"must be bool of shape ({len(r)},)")
    if bar is not None and not isinstance(bar, ScoreBar):
        raise refuse("bar", bar, "must be None or a ScoreBar")
    ids, table = np.flatnonzero(here), Table.of(table)
    radius = (table.ball_radius or BALL_RADIUS) if ball_radius is None else number("ball_radius", ball_radius, 1e-3, 1)
    return Scene(
        table, ids, r[ids], radius, _by_ball("paths", paths, (-1, 2)), None if aim is None else array("aim", aim, (-1, 2)),
        None if ghost is None else array("ghost", ghost, (2,)), _by_ball("ghosts", ghosts, (-1, 2)), _by_ball("turns", turns, (4,)),
        str(text), bar, bool(lettered),
    )  # fmt: skip


def _by_ball(field, given, shape):
    for ball in given or {}:
        if ball not in range(N_BALLS):
            raise refuse(field, ball, f"must have ball ids 0 to {N_BALLS - 1} as keys")
    return {int(ball): array(f"{field}[{ball}]", value, shape) for ball, value in (given or {}).items()}


def ball_paths(shot: Shot, balls: Iterable[int] = (CUE,), until: float | None = None, step: float = 0.02) -> dict[int, Floats]:
    """{ball: (m, 2) points [m]} of a ``Shot`` from its start to the time ``until`` [s] (None: to its end), every ``step`` seconds.

    Times of impacts are added, so that corners are sharp; a ball that did not move has no path.
    """
    until = shot.duration if until is None else min(number("until", until, 0.0), shot.duration)
    return {ball: points for ball, (points, _) in _timed_paths(shot, balls, until, step).items()}


def _timed_paths(shot, balls, until, step=0.02):
    """{ball: its path's points (m, 2) [m] and their times (m,) [s]}."""
    times = np.append(np.arange(0.0, until, number("step", step, 0.0, open_low=True)), until)
    impacts = shot.events["time"][shot.events["kind"] <= EventKind.POT]
    times = np.union1d(times, impacts[impacts < until])
    r = shot.at(times)[0]
    paths = {}
    for ball in balls:
        points = r[:, ball]
        moved = np.append(True, np.any(np.abs(np.diff(points, axis=0)) > 1e-5, axis=1))
        if moved.sum() > 1:
            paths[int(ball)] = points[moved], times[moved]
    return paths


def contacts(shot: Shot, ball: int = CUE) -> Floats:
    """Where a ball was when it met other balls, for faded ghosts.

    Parameters
    ----------
    shot : Shot
    ball : int

    Returns
    -------
    float64 (m, 2)
        [m], in the order of time; one that would lie half over the last is left out.
    """
    return _timed_contacts(shot, ball)[0]


def _timed_contacts(shot, ball):
    """``contacts`` and their times (m,) [s]."""
    met = shot.events[(shot.events["kind"] == EventKind.BALL_BALL) & ((shot.events["i"] == ball) | (shot.events["j"] == ball))]
    kept = []
    for place, time in zip(shot.at(met["time"])[0][:, ball].reshape(-1, 2), met["time"], strict=True):
        if not kept or np.hypot(*(place - kept[-1][0])) > shot.physics.R:
            kept.append((place, time))
    return np.array([place for place, _ in kept]).reshape(-1, 2), np.array([time for _, time in kept])


class Film:
    """A ``Shot`` as it is seen: a ``Scene`` at any time of it, and all that change once are computed once.

    Parameters
    ----------
    table : str, Table or None
        As in ``snooker_env.simulate``.
    shot : Shot
        With its path.
    trail : iterable of int
        Balls whose path grows as they run.
    spots : iterable of int
        Balls with spots, which show how they turn.
    faded : iterable of int
        Balls of which a faded ghost stays wherever they met others, from then on.
    overlays
        As in ``scene``.

    Attributes
    ----------
    duration : float
        Of the shot [s].
    """

    def __init__(
        self, table: TableLike, shot: Shot, *, trail: Iterable[int] = (CUE,), spots: Iterable[int] = (), faded: Iterable[int] = (),
        **overlays: Any,
    ):  # fmt: skip
        self.duration = shot.duration
        self._table, self._shot, self._overlays = Table.of(table), shot, {"ball_radius": shot.physics.R, **overlays}
        self._paths = _timed_paths(shot, trail, shot.duration)
        self._turning = {int(ball): Turning(shot, ball) for ball in spots}
        self._contacts = {int(ball): _timed_contacts(shot, ball) for ball in faded}
        drops = shot.events[shot.events["kind"] == EventKind.POT]
        self._gone_at = np.where(shot.on_table, np.inf, -1.0)  # -1: not on the table when the shot began
        self._gone_at[drops["i"]] = drops["time"]

    def at(self, t: float) -> Scene:
        """The picture at a time.

        Parameters
        ----------
        t : float
            From the start of the shot [s].

        Returns
        -------
        Scene
        """
        r = self._shot.at(t)[0]
        paths = {}
        for ball, (points, times) in self._paths.items():
            so_far = int(np.searchsorted(times, t, side="right"))
            done = points[:so_far]
            if np.any(np.abs(done[-1] - r[ball]) > 1e-5):
                done = np.concatenate([done, r[ball : ball + 1]])
            if len(done) > 1:
                paths[ball] = done
        turns = {ball: turning.at(t) for ball, turning in self._turning.items()}
        ghosts = {ball: places[times <= t] for ball, (places, times) in self._contacts.items()}
        return scene(self._table, r, self._gone_at > t, **{"paths": paths, "turns": turns, "ghosts": ghosts, **self._overlays})

    def scenes(self, fps: float = 30.0, speed: float = 1.0) -> Iterator[Scene]:
        """One picture every ``speed / fps`` seconds of the shot's own time, and one of its end.

        Parameters
        ----------
        fps : float
            Pictures a second of the film.
        speed : float
            2.0: twice as fast as in life.

        Yields
        ------
        Scene
        """
        step = number("speed", speed, 0.0, open_low=True) / number("fps", fps, 0.0, open_low=True)
        for t in np.append(np.arange(0.0, self.duration, step), self.duration):
            yield self.at(float(t))


def shot_scenes(
    table: TableLike,
    shot: Shot,
    *,
    fps: float = 30.0,
    speed: float = 1.0,
    trail: Iterable[int] = (CUE,),
    spots: Iterable[int] = (),
    faded: Iterable[int] = (),
    **overlays: Any,
) -> Iterator[Scene]:
    """The film of a ``Shot``: one ``Scene`` every speed / fps seconds of the shot's own time, and one of its end.

    A potted ball leaves the picture when it drops. The other arguments are those of ``Film``, which gives a picture of any time.
    """
    return Film(table, shot, trail=trail, spots=spots, faded=faded, **overlays).scenes(fps, speed)
