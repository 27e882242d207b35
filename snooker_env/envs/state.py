"""Is a saved state sound? Checks every part of what ``SnookerEnv.get_state`` returned before any of it is taken over."""

from typing import NamedTuple

import numpy as np

from .._check import array, flags, integer, refuse, truth
from ..game.balls import CUE, N_BALLS, REDS_MASK, BallOn, balls_on


class State(NamedTuple):
    """A sound state: what ``SnookerEnv`` is made of between two shots."""

    positions: np.ndarray
    on_table: np.ndarray
    ball_on: BallOn
    in_hand: bool
    points: int
    over: bool
    stream: list
    """Key and counter of the table's stream of random numbers."""
    rng: dict


KEYS = State._fields
FRAME_KEYS = (*(key for key in KEYS if key != "stream"), "frame")
"""In a frame everything is drawn from the environment's own generator, "rng"."""


def check_keys(state, keys):
    """Raise ValueError unless ``state`` is a dict with these keys."""
    if not isinstance(state, dict):
        raise refuse("state", state, "must be a state of get_state(), a dict")
    if missing := sorted(set(keys) - set(state)):
        raise refuse("state", sorted(state, key=str), f"must be a state of get_state(); missing {missing}")


def checked_layout(state, table, R):
    """The arrays positions (22, 2) and on_table (22,) of a state; ValueError unless they are a sound layout."""
    positions = array("state.positions", state["positions"], (N_BALLS, 2))
    on_table = flags("state.on_table", state["on_table"], (N_BALLS,))
    table.check(positions, R, "state.positions", on_table)
    return positions, on_table


def check_rng(rng, generator):
    """Raise ValueError unless ``rng`` is a state that the numpy ``generator`` could take over; the generator is left as it is."""
    trial = type(generator.bit_generator)()
    try:
        trial.state = rng
    except (TypeError, ValueError, KeyError):
        raise refuse("state.rng", rng, f"must be the state of a {type(trial).__name__} generator") from None


def check_stream(stream):
    """Key and counter of a stream as a list of two ints; ValueError if they are none."""
    if not isinstance(stream, list | tuple) or len(stream) != 2:
        raise refuse("state.stream", stream, "must be two integers, key and counter")
    return [integer(f"state.stream[{k}]", word, 0, 2**64 - 1) for k, word in enumerate(stream)]


def checked(state, table, R, generator):
    """The ``State`` that a dict describes; ValueError names the first part that is wrong.

    ``generator``: the numpy Generator that is to take over the part "rng"; it is left as it is.
    """
    check_keys(state, KEYS)
    if unknown := [key for key in state if key not in KEYS]:
        raise refuse("state", unknown, f"must be a state of get_state() with the keys {list(KEYS)} only")
    positions, on_table = checked_layout(state, table, R)
    over, in_hand = truth("state.over", state["over"]), truth("state.in_hand", state["in_hand"])
    ball_on = BallOn(integer("state.ball_on", state["ball_on"], BallOn.NOTHING, BallOn.BLACK))
    mask = int(on_table @ (1 << np.arange(N_BALLS)))
    if not over:  # then a shot is to be played from here
        if not on_table[CUE]:
            raise refuse("state.on_table", on_table.tolist(), "must hold the cue ball while the visit goes on")
        if not balls_on(ball_on, mask):
            raise refuse("state.ball_on", ball_on.name, "must name balls of which one is on the table")
        if ball_on > BallOn.RED and mask & REDS_MASK:
            raise refuse("state.ball_on", ball_on.name, "must be RED or ANY_COLOUR while reds are on the table")
    check_rng(state["rng"], generator)
    points, stream = integer("state.points", state["points"], 0, 155), check_stream(state["stream"])
    return State(positions, on_table, ball_on, in_hand, points, over, stream, state["rng"])
