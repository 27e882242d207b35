"""What do players say, and what does it change? Nominations, concessions, claims, the lot and the choices
after a foul, for the oracle."""

from __future__ import annotations

from copy import deepcopy

from .frame_oracle_rules import ANY, Rules, State, available, over


def named(state: State, x: float) -> int:
    """The ball that the number ``x`` in [-1, 1] nominates: a colour, or 0 for none."""
    if state.ball_on == ANY:
        return 16 + min(5, int(6 * (x + 1) / 2))
    n = min(6, int(7 * (x + 1) / 2)) if state.free_ball else 0
    ball = 15 + n
    return ball if n and state.on_table[ball] and ball not in state.on() else 0


def declared(state: State, x: float, rules: Rules) -> str | None:
    """What the striker declares with the number ``x`` in [-1, 1], where he may."""
    if state.phase == "lot":
        return "the other begins" if x < 0 else None
    if rules.concede and x < -2 / 3:
        return "concede"
    lead = state.scores[state.striker] - state.scores[1 - state.striker]
    if rules.claim and x > 2 / 3 and state.balls == [21] and lead > 7:  # Section 2 Rule 1(b)
        return "claim"
    return None


def ended(state: State, winner: int) -> State:
    """The frame after it was conceded or claimed."""
    after = deepcopy(state)
    over(after, winner)
    return after


def play_again(state: State) -> State:
    """Section 3 Rule 13: the offender plays from the position left; a free ball is void."""
    after = deepcopy(state)
    after.striker, after.phase, after.free_ball, after.miss_called, after.saved = (
        1 - state.striker,
        "stroke",
        False,
        False,
        None,
    )
    after.failures, after.warned = 0, False
    return after


def anywhere(state: State) -> State | None:
    """Six-red snooker, after the fifth miss: the player places the cue ball anywhere; None where snookers are
    required."""
    if state.misses < 5 or abs(state.scores[0] - state.scores[1]) > available(state):
        return None
    after = play_on(state)
    after.in_hand, after.anywhere, after.free_ball, after.on_table[0] = True, True, False, True
    return after


def replace(state: State) -> State:
    """Section 3 Rule 14(b): the balls go back, and the offender plays again, with the same ball on."""
    assert state.saved is not None
    after = deepcopy(state.saved)
    after.scores, after.break_points, after.phase = list(state.scores), 0, "stroke"
    after.failures, after.warned, after.saved, after.miss_called = (
        state.failures,
        state.failures == 2,
        None,
        False,
    )
    after.misses = state.misses
    return after


def play_on(state: State) -> State:
    """The player who was fouled plays himself: the offender's failures are forgotten."""
    after = deepcopy(state)
    after.phase, after.miss_called, after.saved, after.failures, after.warned = (
        "stroke",
        False,
        None,
        0,
        False,
    )
    after.misses = 0
    return after
