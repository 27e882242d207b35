"""Is a saved state valid? Checks every part of the result of ``get_state`` before any of it is used."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import array, flags, integer, number, refuse, refuse_what, truth
from .._lib.types import Bools, Floats, Vector
from ..game import balls
from ..game.frame import MOST_BREAK, Frame
from ..game.in_hand import within_d
from ..physics.conditions import RANGES
from ..physics.table import Table
from .options import Rules

MOST = 2**53 - 1  # largest score and number of strokes in a saved frame: a float of it is still exact
FAR = 1000.0  # limit of the coordinates of a ball off the table [m]: they mean nothing, but must not overflow


class State(NamedTuple):
    """A valid state of a visit: everything of a ``SnookerEnv`` between two shots."""

    positions: Floats
    on_table: Bools
    ball_on: balls.BallOn
    in_hand: bool
    points: int
    over: bool
    stream: list[int]  # key and counter of the table's random stream
    rng: dict[str, Any]
    conditions: dict[str, float] | None = None  # the constants drawn, by name; None: they are fixed


class FrameState(NamedTuple):
    """A valid state of a frame or match, in ``SnookerEnv`` or with two players."""

    frame: Frame
    positions: Floats
    on_table: Bools
    strokes: int
    opponent: int  # which member of a pool plays, counted from 1; 0: none is drawn
    unpaid: int  # what the agent has earned and no reward has paid: points, or frames with reward="frames"
    due: bool  # whether the episode ended before the agent's first stroke, and the next step reports it
    stream: list[int]  # key and counter of the table's random stream
    rng: dict[str, Any]
    frames: tuple[int, int] | None = None  # of a match, as the next: the frames that each player has won
    first_break: int | None = None  # who broke first
    conditions: dict[str, float] | None = None  # the constants drawn, by name; None: they are fixed


_NAMES = ("state.positions", "state.on_table")


def check_layout(
    names: tuple[str, str], positions: Sequence[Vector], on_table: object, table: Table, R: float
) -> tuple[Floats, Bools]:
    """The arrays positions (22, 2), on_table (22,); ValueError, with one of ``names``, if not a layout."""
    field = names[0]
    places, present = array(field, positions, (balls.N_BALLS, 2)), flags(names[1], on_table, (balls.N_BALLS,))
    for i, place in enumerate(positions):
        if any(isinstance(x, bool | np.bool_) for x in place):  # NumPy converts them to 0 and 1
            raise refuse(f"{field}[{i}]", list(place), "must be two real numbers")
    if len(far := np.flatnonzero(np.abs(places).max(axis=1) > FAR)):
        allowed = f"must be within {FAR:g} m, also off the table"
        raise refuse(f"{field}[{far[0]}]", places[far[0]].tolist(), allowed)
    table.check(places, R, field, present)
    return places, present


def check_in_hand(field: str, in_hand: bool, name: str, positions: Floats) -> None:
    """ValueError if a cue ball in hand is not in the D, where it is shown until it is placed."""
    if in_hand and not within_d(*positions[balls.CUE]):
        x, y = positions[balls.CUE].tolist()
        allowed = f"must be False with the cue ball at {name}[{balls.CUE}] = ({x:g}, {y:g}), outside the D"
        raise refuse(field, in_hand, allowed)


def _check_like(field, value, known):
    """ValueError unless ``value`` has the structure of ``known``: dicts of the same keys, the same types."""
    if not isinstance(known, dict):
        if type(value) is not type(known):
            raise refuse(field, value, f"must be of type {type(known).__name__}")
        return
    if not isinstance(value, dict) or set(value) != set(known):
        raise refuse(field, value, f"must be a dict with the keys {sorted(known)}")
    for key in known:
        _check_like(f"{field}.{key}", value[key], known[key])


def check_rng(rng: Mapping[str, Any], generator: np.random.Generator) -> None:
    """ValueError unless ``rng`` is a state that the NumPy ``generator``, which is not changed, could take."""
    trial = type(generator.bit_generator)()
    _check_like("state.rng", rng, trial.state)
    try:
        trial.state = rng
    except (TypeError, ValueError, OverflowError) as error:
        allowed = f"must be the state of a {type(trial).__name__} generator ({error})"
        raise refuse("state.rng", rng, allowed) from None


def check_stream(stream: object) -> list[int]:
    """Key and counter of a stream as a list of two ints; ValueError if they are none."""
    if not isinstance(stream, list | tuple) or len(stream) != 2:
        raise refuse("state.stream", stream, "must be two integers, key and counter")
    return [integer(f"state.stream[{k}]", word, 0, 2**64 - 1) for k, word in enumerate(stream)]


def check_keys(state: object, keys: tuple[str, ...], rules: Rules) -> dict[str, float] | None:
    """The constants drawn, in their order, None if they are fixed; ValueError unless ``state`` is a dict with these keys."""
    if not isinstance(state, dict):
        raise refuse("state", state, "must be a state of get_state(), a dict")
    keys = (*keys, "conditions") if rules.drawn else keys
    allowed = f"must be a state of get_state() here, with the keys {list(keys)}"
    if missing := sorted(set(keys) - set(state)):
        raise refuse_what("state", f"a dict without {missing}", allowed)
    if unknown := [key for key in state if key not in keys]:
        raise refuse_what("state", f"a dict with {unknown}", f"{allowed} only")
    if not rules.drawn:
        return None
    values = state["conditions"]
    if not isinstance(values, dict) or set(values) != set(RANGES):
        allowed = f"must be a dict of the constants {list(RANGES)}"
        raise refuse("state.conditions", values, allowed)
    each = RANGES.items()
    return {name: number(f"state.conditions.{name}", values[name], *ends) for name, ends in each}


def check_visit(
    state: Mapping[str, Any], rules: Rules, generator: np.random.Generator, *, to_play: bool = False
) -> State:
    """The ``State`` of a dict; ValueError names the first wrong part, or if none is left ``to_play``."""
    conditions, table, R = check_keys(state, State._fields[:-1], rules), rules.table, rules.physics.R
    positions, on_table = check_layout(_NAMES, state["positions"], state["on_table"], table, R)
    over, in_hand = truth("state.over", state["over"]), truth("state.in_hand", state["in_hand"])
    on = integer("state.ball_on", state["ball_on"], balls.BallOn.NOTHING, balls.BallOn.BLACK)
    ball_on = balls.BallOn(on)
    mask = balls.mask_of_present(on_table)
    if not over:  # then there must be a shot to play
        if not on_table[balls.CUE]:
            allowed = "must hold the cue ball while the visit goes on"
            raise refuse("state.on_table", on_table.tolist(), allowed)
        balls.check_ball_on("state.ball_on", ball_on, mask, "state.on_table")
        check_in_hand("state.in_hand", in_hand, "state.positions", positions)
    check_rng(state["rng"], generator)
    points, stream = integer("state.points", state["points"], 0, MOST_BREAK), check_stream(state["stream"])
    more = balls.points_available(mask, ball_on)
    if points + more > MOST_BREAK:
        allowed = f"must be at most {MOST_BREAK - more}: state.on_table and state.ball_on offer {more} more"
        raise refuse("state.points", points, allowed)
    if over and to_play:
        raise refuse("state.over", True, "must be False: there is no shot to play from this state")
    return State(positions, on_table, ball_on, in_hand, points, over, stream, state["rng"], conditions)


def check_frame_state(
    state: Mapping[str, Any], rules: Rules, generator: np.random.Generator, *, lot: bool
) -> FrameState:
    """The ``FrameState`` of a dict; ValueError names the first wrong part. ``lot``: whether a player may be asked who begins."""
    *keys, won, first, _ = FrameState._fields
    conditions = check_keys(state, (*keys, won, first, "best_of") if rules.frames else tuple(keys), rules)
    miss, table, R = rules.miss, rules.table, rules.physics.R
    positions, on_table = check_layout(_NAMES, state["positions"], state["on_table"], table, R)
    frame = Frame.from_dict(state["frame"], "state.frame")
    strokes = integer("state.strokes", state["strokes"], 0, MOST)
    for k, points in enumerate(frame.scores):
        integer(f"state.frame.scores[{k}]", points, 0, MOST)
    if frame.miss != miss:
        raise refuse("state.frame.miss", frame.miss, f"must be {miss!r}, as this environment plays")
    if frame.rules != rules.game:
        raise refuse("state.frame.rules", frame.rules, f"must be {rules.game!r}, as this environment plays")
    if frame.phase == "lot" and not lot:
        allowed = "must not be between two steps: the lot is drawn in the step of the stroke before"
        raise refuse("state.frame.phase", frame.phase, allowed)
    if frame.phase != "over":
        if balls.mask_of_present(on_table) != frame.on_table | balls.CUE_BIT:
            allowed = "must hold the cue ball and the balls of state.frame.on_table, no others"
            raise refuse("state.on_table", on_table.tolist(), allowed)
        in_d = frame.in_hand and not frame.anywhere
        check_in_hand("state.frame.in_hand", in_d, "state.positions", positions)
    if frame.saved is not None:
        frame = replace(frame, saved=_check_return(frame, table, R))
    stream = check_stream(state["stream"])
    check_rng(state["rng"], generator)
    opponent = integer("state.opponent", state["opponent"], 0, MOST)
    unpaid, due = integer("state.unpaid", state["unpaid"], -MOST, MOST), truth("state.due", state["due"])
    one = frame, positions, on_table, strokes, opponent, unpaid, due, stream, state["rng"]
    made = FrameState(*one, conditions=conditions)
    if not rules.frames:
        return made
    frames, first_break = _check_match(state, frame, rules.frames)
    return made._replace(frames=frames, first_break=first_break)


def _check_match(state, frame, best_of):
    """The frames won and who broke first, of a match of ``best_of`` frames."""
    if integer("state.best_of", state["best_of"], 1, MOST) != best_of:
        raise refuse("state.best_of", state["best_of"], f"must be {best_of}, as this environment plays")
    won, needed = state["frames"], best_of // 2 + 1
    if not isinstance(won, list | tuple) or len(won) != 2:
        raise refuse("state.frames", won, "must be two integers, the frames that each player has won")
    won = integer("state.frames[0]", won[0], 0, needed), integer("state.frames[1]", won[1], 0, needed)
    for k, n in enumerate(won):
        if (n == needed) != (frame.winner == k):
            allowed = f"must be {needed} for the winner of a match that is over, else below"
            raise refuse(f"state.frames[{k}]", n, allowed)
    return won, integer("state.first_break", state["first_break"], 0, 1)


def _check_return(frame, table, R):
    """The position to which a frame may return, with its layout checked like that of the state itself."""
    saved, field = frame.saved, "state.frame.saved.layout"
    if saved.layout is None and not frame.miss_called:
        return saved
    if frame.miss == "off":
        raise refuse_what(field, "a layout", 'must be None with miss = "off": no position is ever replaced')
    if not isinstance(saved.layout, tuple) or len(saved.layout) != 2:
        raise refuse(field, saved.layout, "must be positions and on_table, as they were before the foul")
    positions, on_table = check_layout((f"{field}[0]", f"{field}[1]"), *saved.layout, table, R)
    if balls.mask_of_present(on_table) != saved.on_table | balls.CUE_BIT:
        allowed = "must hold the cue ball and the balls of state.frame.saved.on_table, no others"
        raise refuse(f"{field}[1]", on_table.tolist(), allowed)
    check_in_hand("state.frame.saved.in_hand", saved.in_hand and not saved.anywhere, f"{field}[0]", positions)
    layout = tuple(map(tuple, positions.tolist())), tuple(on_table.tolist())  # unchanging, and for JSON
    return replace(saved, layout=layout)
