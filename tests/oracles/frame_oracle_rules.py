"""What does a referee decide after a stroke? The rules of a frame in plain Python, for the oracle that checks
``snooker_env``.

Written from the rules of snooker (WPBSA; references in the code are to their sections and rules) and from the
documented options of the environment, with no use of ``snooker_env.game``. Geometry is in
``frame_oracle_geometry``.

Balls have the ids of the environment: 0 the cue ball, 1 to 15 the reds, 16 to 21 yellow to black. What is on
is -1 nothing, 0 any colour, 1 a red, 2 to 7 yellow to black. A decision that hangs on rounding is None, and
everything that follows from it is in ``unsure``.
"""

from __future__ import annotations

import math
from copy import deepcopy

import numpy as np

from . import frame_oracle_geometry as geometry
from .frame_oracle_state import ANY, BLACK, COLOURS, RED, REDS, YELLOW, Rules, State, Stroke, Verdict, value

NO_CONTACT, WRONG_FIRST, WRONG_POT, CUE_POTTED, PUSH, BEHIND = (
    "no contact",
    "wrong first",
    "wrong pot",
    "cue potted",
    "push",
    "behind",
)
NO_CUSHION, LATE = "no cushion", "late"
TOUCH = 50e-6
"""A referee sees no gap below this [m]."""


ATTEMPT = geometry.D2
"""``miss="attempt"``: the cue ball that comes as near as this to a ball on shows the best effort [m], by the
documentation."""


def available(state: State) -> int:
    """Points that are left on the table for the striker; a free ball is one more red with its black, or the
    ball on once more."""
    seven = 7 if state.ball_on == ANY else 0
    extra = 0
    if state.free_ball and set(state.balls) - set(state.on()):
        extra = 8 if state.ball_on == RED else state.ball_on
    return 8 * state.reds + seven + extra + sum(value(i) for i in state.balls if i in COLOURS)


def short(state: State) -> bool:
    """Whether a player needs penalty points, of whom only the striker has the colour after a red and the free
    ball; or just as many are left on the table as the players differ by.
    """
    lead = state.scores[state.striker] - state.scores[1 - state.striker]
    for_both = 8 * state.reds + sum(value(i) for i in state.balls if i in COLOURS)
    return -lead > available(state) or lead > for_both or abs(lead) == available(state)


def touching(state: State, cue: np.ndarray) -> list[int]:
    """The balls that the cue ball touches."""
    return [i for i in state.balls if np.hypot(*(state.positions[i] - cue)) - geometry.D2 < TOUCH]


def _into(ball: np.ndarray, stroke: Stroke, time: float) -> bool:
    """Whether the cue ball was played into a touching ball: its straight line meets it, or they met at
    once."""
    speed = float(np.hypot(*stroke.velocity))
    ahead = math.isfinite(geometry.enter(stroke.cue, stroke.velocity / speed, ball, geometry.D2))
    return ahead or (time * speed <= 10e-6 and float(stroke.velocity @ (ball - stroke.cue)) > 0)


def judge(state: State, stroke: Stroke, rules: Rules) -> tuple[Verdict, State]:
    """The verdict on a stroke, and the frame after it."""
    verdict, after = Verdict(), deepcopy(state)
    after.anywhere = False
    after.positions = stroke.rest.copy()
    for i in stroke.potted:
        after.on_table[i] = False
    target, nominee = _targets(state, stroke, rules)
    von = state.ball_on if state.ball_on != ANY else value(target[0]) if len(target) == 1 else 7
    base = max(4, von)
    legal = [*target, *nominee]
    costs: list[int] = []
    touched = touching(state, stroke.cue)
    first = list(stroke.first)
    pushed = [i for i, time in stroke.leaving if i in touched and _into(state.positions[i], stroke, time)]
    if pushed:  # Section 3 Rule 8: he must play away from it without moving it
        verdict.fouls.add(PUSH)
        # a free ball has the value of the ball on
        costs += [base, *(value(i) for i in pushed if i not in nominee)]
    else:
        declared = [i for i in touched if i in (nominee if nominee and rules.nominate else legal)]
        if declared:
            verdict.notes.add("touching ball on, played away")
            first = []
        elif touched:
            verdict.notes.add("touching ball not on")
        if not first and not declared:
            verdict.fouls.add(NO_CONTACT)
            costs.append(base)
    wrong = [i for i in first if i not in legal]
    if len(first) > 1 and not wrong:  # Rule 6: only two reds, or the free ball and a ball on
        together = all(i in REDS for i in first) or (set(first) & set(nominee) and set(first) & set(target))
        wrong = [] if together else [i for i in first]
    if nominee and first and not wrong and not set(first) & set(nominee) and rules.nominate:
        wrong = first  # Rule 12(b)(i): the ball nominated must be struck first
    if wrong:
        verdict.fouls.add(WRONG_FIRST)
        costs += [base, *(value(i) for i in first if i in wrong)]
    bad = [i for i in stroke.potted if i and i not in legal]
    if bad:
        verdict.fouls.add(WRONG_POT)
        costs += [base, *(value(i) for i in bad)]
    if rules.game == "shoot_out" and not stroke.potted and not stroke.cushion:
        verdict.fouls.add(NO_CUSHION)
        costs.append(base)
    if 0 in stroke.potted:
        verdict.fouls.add(CUE_POTTED)
        costs.append(base)
        after.in_hand = after.on_table[0] = True  # it lies in the D until it is placed
    else:
        after.in_hand = False
    good = [i for i in stroke.potted if i in legal]
    real = [i for i in good if i not in nominee]
    worth = von if good else 0  # Rule 12(e): ball on and free ball together count once
    if state.ball_on == RED:
        worth = len(good)
    stays = set(i for i in stroke.potted if i in REDS)
    if not costs and state.ball_on >= YELLOW:
        stays |= set(real)
    _spot([i for i in stroke.potted if i in COLOURS and i not in stays], after, verdict)
    after.free_ball = False
    hiding = target if state.ball_on == ANY and rules.game == "six_red" else nominee
    if hiding and not costs and not worth:
        _behind(state, after, hiding[0], verdict, rules)
        if verdict.fouls:
            costs.append(base)
    if costs:
        verdict.penalty = max(costs)
        _foul(state, after, stroke, verdict, rules, legal)
    else:
        verdict.points = worth
        _fair(state, after, stroke, verdict, real)
    if rules.game == "shoot_out":
        _shoot_out(state, after, stroke, verdict, rules)
    return verdict, after


def _targets(state: State, stroke: Stroke, rules: Rules) -> tuple[list[int], list[int]]:
    """The balls on in this stroke, and the free ball as a list of at most one."""
    on, first = state.on(), stroke.first
    named = stroke.nominated
    if state.ball_on == ANY:
        if not rules.nominate:
            colours = [i for i in first if i in COLOURS]
            named = colours[0] if colours else None
            if not colours and (touched := [i for i in touching(state, stroke.cue) if i in COLOURS]):
                named = touched[0]
        return ([named] if named else []), []
    if state.free_ball:
        if not rules.nominate:
            others = [i for i in first if i not in on and i in state.balls]
            if not first:
                others = [i for i in touching(state, stroke.cue) if i not in on]
            named = others[0] if others else None
        return on, [named] if named and named not in on else []
    return on, []


def _spot(colours: list[int], after: State, verdict: Verdict) -> None:
    """Section 3 Rule 7: own spots first where they are free, then from the highest value down."""
    waiting = sorted(colours, reverse=True)
    standing = [i for i in range(22) if after.on_table[i] and (i or not after.in_hand)]
    for own in (True, False):
        for i in list(waiting):
            others = after.positions[standing]
            is_free = geometry.decided(
                lambda slack, i=i, others=others: geometry.free(
                    geometry.SPOTS[i], others, geometry.TOUCH + slack
                )
            )
            if is_free is None:
                verdict.unsure.add("spot")
            if own and not is_free:
                continue
            place = geometry.spotted_place(i, others)
            spot = next((k for k, at in geometry.SPOTS.items() if at == place), None)
            verdict.notes.add("own spot" if spot == i else "another spot" if spot else "beside its spot")
            after.positions[i], after.on_table[i] = place, True
            standing.append(i)
            waiting.remove(i)
            verdict.spotted.append(i)


def _seen(after: State):
    """Cue ball, balls on and balls not on for the player to come."""
    on = after.on()
    others = [i for i in after.balls if i not in on]
    return after.positions[0], after.positions[on], after.positions[others], others


def _snookered(after: State, verdict: Verdict) -> bool:
    """Section 2 Rule 17."""
    cue, on, others, _ = _seen(after)
    if after.in_hand:
        verdict.notes.add("snookered test in hand")
        hidden, margin = geometry.snookered_in_hand(on, others, after.positions[after.balls])
        if abs(margin) < 1e-6:
            verdict.unsure.add("free_ball")
        return hidden
    answer = geometry.decided(lambda slack: geometry.snookered(cue, on, others, slack))
    if answer is None:
        verdict.unsure.add("free_ball")
    return bool(answer)


def _behind(state: State, after: State, nominee: int, verdict: Verdict, rules: Rules) -> None:
    """Section 3 Rule 12(b)(ii): the next player snookered behind the free ball; not with only pink and black
    left."""
    after = deepcopy(after)
    after.ball_on = after.next_on()
    if set(after.balls) == {20, 21} and rules.game != "six_red":
        return
    cue, on, others, ids = _seen(after)

    def behind(slack):
        if nominee not in ids or not geometry.snookered(cue, on, others, slack):
            return False
        return ids.index(nominee) in geometry.effective_snookering_balls(cue, on, others, slack)

    answer = geometry.decided(behind)
    if answer is None:
        verdict.unsure.add("behind")
    if answer:
        verdict.fouls.add(BEHIND)


def _fair(state: State, after: State, stroke: Stroke, verdict: Verdict, real: list[int]) -> None:
    other = 1 - state.striker
    after.phase, after.miss_called, after.failures, after.warned, after.saved = (
        "stroke",
        False,
        0,
        False,
        None,
    )
    after.misses = 0
    after.scores[state.striker] += verdict.points
    after.break_points = state.break_points + verdict.points if verdict.points else 0
    if not verdict.points:
        after.striker, after.ball_on = other, after.next_on()
        return
    if state.respotted_black or state.ball_on == BLACK:
        _last_black(after, verdict)
    elif state.ball_on == RED:
        after.ball_on = ANY
    elif state.ball_on == ANY or real:
        after.ball_on = after.next_on()


def _last_black(after: State, verdict: Verdict) -> None:
    """Section 3 Rule 4: the first score or foul with only the black left ends the frame, unless the scores
    are equal."""
    if after.scores[0] == after.scores[1]:
        verdict.notes.add("black re-spotted")
        after.respotted_black, after.ball_on, after.in_hand, after.free_ball, after.phase = (
            True,
            BLACK,
            True,
            False,
            "drawn",
        )
        after.on_table[1:21], after.on_table[[0, 21]] = False, True
        after.positions[21] = geometry.SPOTS[21]
        after.break_points = 0
    else:
        over(after, int(after.scores[1] > after.scores[0]))


def over(after: State, winner: int) -> None:
    after.phase, after.winner, after.ball_on, after.free_ball = "over", winner, -1, False
    after.miss_called, after.saved = False, None


def _shoot_out(state: State, after: State, stroke: Stroke, verdict: Verdict, rules: Rules) -> None:
    """The Shoot Out: in hand anywhere after a foul; the clock, from the first stroke on, which does not end a
    re-spotted black. Time is up when the ten minutes are full."""
    if verdict.fouls and after.phase == "stroke":
        after.in_hand = after.anywhere = after.on_table[0] = True
    after.clock = state.clock + stroke.duration + (rules.time_to_play if state.clock else 0)
    if after.phase == "stroke" and not state.respotted_black and after.clock + rules.time_to_play >= 600_000:
        verdict.notes.add("time is up")
        after.anywhere = False
        _last_black(after, verdict)


def late(state: State, rules: Rules) -> tuple[Verdict, State] | None:
    """The Shoot Out: the verdict on a stroke that was not begun in time, and the frame after it; None if it
    is in time."""
    limit = 15_000 if state.clock < 300_000 else 10_000
    if rules.game != "shoot_out" or not state.clock or rules.time_to_play <= limit:
        return None
    verdict, after = Verdict(fouls={LATE}), deepcopy(state)
    verdict.penalty = max(5, state.ball_on)  # after a red no colour has been nominated
    nothing = Stroke(state.positions[0], [], [], state.positions, duration=limit - rules.time_to_play)
    _foul(state, after, nothing, verdict, rules, [])
    _shoot_out(state, after, nothing, verdict, rules)
    return verdict, after


def _foul(
    state: State, after: State, stroke: Stroke, verdict: Verdict, rules: Rules, legal: list[int]
) -> None:
    other = 1 - state.striker
    after.scores[other] += verdict.penalty
    after.break_points, after.miss_called, after.saved = 0, False, None
    after.striker = other
    if state.respotted_black:
        verdict.notes.add("foul on the re-spotted black")
        over(after, other)
        return
    if state.ball_on == BLACK:
        _last_black(after, verdict)
        after.failures, after.warned = 0, False
        return
    after.ball_on, after.phase = after.next_on(), "choice"
    if rules.game == "shoot_out":
        after.phase = "stroke"
        return
    after.free_ball = _snookered(after, verdict)
    missed = bool(verdict.fouls & {NO_CONTACT, WRONG_FIRST})
    if rules.miss != "off" and missed:
        _miss(state, after, stroke, verdict, rules)
    else:
        after.failures, after.warned, after.misses = 0, False, 0


def _gap(state: State, path: np.ndarray, on: list[int]) -> float:
    """How near the cue ball came to one of these balls [m]."""
    return min(float(np.hypot(*(path - state.positions[i]).T).min()) for i in on) - geometry.D2


def _miss(state: State, after: State, stroke: Stroke, verdict: Verdict, rules: Rules) -> None:
    """Section 3 Rule 14(c) and (d)."""
    on = state.on()
    if state.free_ball:  # any ball could be on
        on = state.balls
    others = [i for i in state.balls if i not in on]
    where = stroke.cue, state.positions[on], state.positions[others]
    clear = geometry.decided(lambda slack: geometry.clear_path(*where, slack))
    full = geometry.decided(lambda slack: _full_ball(state, on, others, stroke.cue, slack))
    if state.in_hand and not full:  # the striker chose the place: from the best one
        clear, full = _best_in_hand(state, on, others, clear)
    if clear is None or full is None:
        verdict.unsure.add("miss")
    needed = short(state) or short(after)
    again = state.failures > 0 and full
    poor = bool(clear)
    if rules.miss == "attempt" and not clear:
        gap = _gap(state, stroke.path, on)
        if gap > ATTEMPT and not state.in_hand:
            shut = geometry.shut_in(stroke.cue, state.positions[on], state.positions[others])
            if shut is None:
                verdict.unsure.add("miss")
            elif shut:  # impossible to hit: where it would have gone but for the balls between
                verdict.notes.add("shut in")
                ahead = [i for i in on if (state.positions[i] - stroke.cue) @ stroke.velocity > 0]
                gap = _gap(state, stroke.among(ahead), ahead) if ahead else math.inf
        if abs(gap - ATTEMPT) < 1e-6:
            verdict.unsure.add("miss")
        poor = gap > ATTEMPT
        verdict.notes.add("a poor attempt at an escape" if poor else "a good attempt at an escape")
    called = poor and (again or not needed)
    if called and state.misses == 5:
        verdict.notes.add("no sixth miss in succession")
        called = False
    if poor and needed:
        verdict.notes.add(
            "no miss: penalty points needed" if not again else "miss although penalty points are needed"
        )
    if not called:
        after.failures, after.warned, after.misses = 0, False, 0
        return
    verdict.notes.add("miss" if full else "miss, part of a ball visible")
    after.failures = state.failures + 1 if full else 0
    after.misses = state.misses + 1 if rules.game == "six_red" else 0
    if after.misses == 5:
        verdict.notes.add("fifth miss in succession")
    if state.warned and full:
        verdict.notes.add("third miss")
        over(after, 1 - state.striker)
        return
    after.miss_called, after.warned = True, False
    after.saved = deepcopy(state)


def _best_in_hand(
    state: State, on: list[int], others: list[int], clear: bool | None
) -> tuple[bool | None, bool | None]:
    """Whether there is a clear and a full-ball path from some place in hand; ``clear``: from that played
    from. None: none was found."""
    found: bool | None = clear or None
    for place in (geometry.BED if state.anywhere else geometry.GRID)[::7]:
        if geometry.free(place, state.positions[state.balls], TOUCH):
            if _full_ball(state, on, others, place, geometry.NEAR):
                return True, True
            found = (
                found
                or geometry.clear_path(place, state.positions[on], state.positions[others], geometry.NEAR)
                or None
            )
    return found, None


def _full_ball(state: State, on: list[int], others: list[int], cue: np.ndarray, slack: float) -> bool:
    """Section 3 Rule 14(d): "central, full-ball contact"; of a red, its complete diameter, which other reds
    do not obstruct."""
    for i in on:
        between = others if i in REDS else [k for k in state.balls if k != i]
        if geometry.full_ball(cue, state.positions[[i]], state.positions[between], slack):
            return True
    return False
