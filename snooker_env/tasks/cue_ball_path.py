"""Where will a stroke leave the cue ball, and in a safety the ball that it meets? By closed forms: no shot is simulated.

The solved aim says where the cue ball meets the ball to be potted. From there ``cloth`` moves it; each meeting with a
nose or another ball is a single impact. Its path is tested in chords, three for the parabola of a sliding ball. Balls
that it meets stay where they are, and the potted one is gone."""

from math import cos, hypot, sin, sqrt

import numpy as np

from .._lib.jit import entry, kernel
from ..game.balls import N_BALLS, SPOTS, VALUES, bits, touching_balls
from ..game.frame_columns import strikeable
from ..game.paths import find_first_ball
from ..geometry import AIM_X, AIM_Y, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from ..physics import cloth
from ..physics.arrays import Law
from ..physics.columns import P_E_B, P_G, P_MU_R, P_R
from ..physics.impact.contact import collide_balls, collide_cushion, cushion_restitution
from .box_actions import tip_on_disc
from .kernel_arrays import CueLaw
from .lines import new_work
from .noise import with_errors
from .pot_aim import meets, stroke_in_room
from .stroke import row_of

X, Y, NOSES, BALLS, LENGTH, LOST, HIT, NEAR, MISSED, REACH, OBJECT, ASIDE = range(12)
SEEN = 12
"""Predictions of a stroke: where the cue ball stops [m]; how many noses and balls it meets; how far it runs [m]; 1 if
a pocket takes it; how fast it meets the first other ball [m/s]; how near it passes to a pocket [m]; 1 if it does not
reach the ball, 2 if it passes it; how far the ball to be potted would roll, over the distance to the pocket; its speed
[m/s], and the sine of the angle by which it leaves off the line to the pocket."""
NONE = 8  # no ball is on: the visit has cleared the table
MEETINGS, PHASES, PARTS = 12, 60, 3
"""Meetings of a cue ball that are predicted, phases of its motion, and chords of a sliding phase."""
TAKEN = 0.055  # a cue ball that reaches the line of the noses so near to a pocket's aim point is taken [m]
FAREST = 3.0  # largest ``REACH``
_LONGEST = 60.0  # longest phase that is looked at [s]


@kernel
def _moment(motion, state, t0, t1, share, x, y, normal, phys):
    """When in (t0, t1) the cue ball passes the line through (x, y) with this normal: by share of the chord, then a step of Newton's."""
    t = t0 + (t1 - t0) * share
    (px, py), v, _ = cloth.evaluate(motion, state, 0, t, phys)
    speed = v[0] * normal[0] + v[1] * normal[1]
    if speed > 1e-3:
        t -= ((px - x) * normal[0] + (py - y) * normal[1]) / speed
    return min(max(t, t0), t1)


@kernel
def _run(positions, on_table, skip, law, work, out):
    """Follow the ball of ``work.motion``, which has just met ball ``skip`` or is it, to where it stops; fills ``out``."""
    phys, motion, state = law.phys, work.motion, work.state
    R, d = phys[P_R], 2.0 * phys[P_R]
    right, top = HALF_WIDTH - R, HALF_LENGTH - R
    still, gone, near = (0.0, 0.0, 0.0), 1 << skip, out[NEAR] * out[NEAR]
    for _ in range(PHASES):
        if state[0] <= cloth.REST or out[NOSES] + out[BALLS] > MEETINGS:
            break
        begin, end = motion[0, cloth.T0], motion[0, cloth.T_END]
        end = min(end, begin + _LONGEST)
        met, who, t, parts = 0, 0, end, PARTS if state[0] == cloth.SLIDE else 1
        nx = ny = 0.0
        for part in range(parts):
            t0, t1 = begin + (end - begin) * part / parts, begin + (end - begin) * (part + 1) / parts
            (ax, ay), va, _ = cloth.evaluate(motion, state, 0, t0, phys)
            (bx, by), _, _ = cloth.evaluate(motion, state, 0, t1, phys)
            length = hypot(bx - ax, by - ay)
            if length < 1e-6:
                continue
            ux, uy, far = (bx - ax) / length, (by - ay) / length, length
            if ux * ux > 1e-12:
                run = ((right if ux > 0.0 else -right) - ax) / ux
                if run < far:
                    far, met, nx, ny = max(0.0, run), 1, 1.0 if ux > 0.0 else -1.0, 0.0
            if uy * uy > 1e-12:
                run = ((top if uy > 0.0 else -top) - ay) / uy
                if run < far:
                    far, met, nx, ny = max(0.0, run), 1, 0.0, 1.0 if uy > 0.0 else -1.0
            for i in range(1, N_BALLS):
                if on_table[i] and not (gone >> i) & 1:
                    px, py = positions[i, 0] - ax, positions[i, 1] - ay
                    along, across = px * ux + py * uy, px * uy - py * ux
                    if along > 0.0 and across * across < d * d:
                        run = along - sqrt(d * d - across * across)
                        if run < far:
                            far, met, who = max(0.0, run), 2, i
            ex, ey = ax + far * ux, ay + far * uy
            for k in range(POCKET_AIMS.shape[0]):
                px, py = POCKET_AIMS[k, AIM_X] - ax, POCKET_AIMS[k, AIM_Y] - ay
                along = min(max(px * ux + py * uy, 0.0), far)
                dx, dy = px - along * ux, py - along * uy
                near = min(near, dx * dx + dy * dy)
                dx, dy = POCKET_AIMS[k, AIM_X] - ex, POCKET_AIMS[k, AIM_Y] - ey
                if met == 1 and dx * dx + dy * dy < TAKEN * TAKEN:
                    out[X], out[Y], out[LOST] = ex, ey, 1.0
            out[LENGTH] += far
            out[NEAR] = sqrt(near)
            if out[LOST] > 0.0:
                return
            if met:
                share = far / length
                if met == 2:
                    nx, ny = (positions[who, 0] - ex) / d, (positions[who, 1] - ey) / d
                if parts == 1:  # it slows down along the chord
                    v = hypot(va[0], va[1])
                    slowing = 2.0 * (v * (t1 - t0) - length) / ((t1 - t0) * (t1 - t0))
                    root = sqrt(max(0.0, v * v - 2.0 * slowing * far))
                    share = min(1.0, 2.0 * far / max(1e-9, v + root) / (t1 - t0))
                t = _moment(motion, state, t0, t1, share, ex, ey, (nx, ny), phys)
                break
        if met == 0:
            cloth.next_phase(motion, state, 0, phys)
            continue
        (x, y), v, w = cloth.evaluate(motion, state, 0, t, phys)
        ball = v[0], v[1], 0.0
        if met == 1:
            x, y = min(max(x, -right), right), min(max(y, -top), top)
            e = cushion_restitution(v[0] * nx + v[1] * ny, phys)
            v, w, _ok = collide_cushion(ball, w, (nx, ny), law, e, work.series)
            out[NOSES] += 1.0
        else:
            nx, ny = positions[who, 0] - x, positions[who, 1] - y
            away = hypot(nx, ny)
            nx, ny = nx / away, ny / away
            if out[BALLS] == 0.0:
                out[HIT] = max(0.0, v[0] * nx + v[1] * ny)
            v, w, _v, _w, _ok = collide_balls(ball, w, still, still, (nx, ny), law, phys[P_E_B], work.series)
            out[BALLS] += 1.0
            gone |= 1 << who
        cloth.begin(motion, state, 0, t, (x, y), (v[0], v[1]), w, phys)
    (x, y), _v, _w = cloth.evaluate(motion, state, 0, motion[0, cloth.T0], phys)
    out[X], out[Y] = x, y


@kernel
def _meet(played, ball, positions, cue_law, work, out):
    """The cue ball of a stroke of ``stroke_in_room`` meets ``ball``, past all others: whether, the ball's velocity and spin.
    The cue ball's way begins there; clears ``out`` (SEEN,)."""
    phys, motion, state = cue_law.phys, work.motion, work.state
    law = Law(phys, cue_law.fidelity, cue_law.n_steps)
    cx, cy, bx, by = positions[0, 0], positions[0, 1], positions[ball, 0], positions[ball, 1]
    for c in range(SEEN):
        out[c] = 0.0
    out[NEAR], still = 9.0, (0.0, 0.0, 0.0)
    met, t = meets(played, positions, (bx, by), cue_law, work)
    (x, y), v, w = cloth.evaluate(motion, state, 0, t if met else motion[0, cloth.T0], phys)
    if not met:
        out[X], out[Y] = x, y
        out[MISSED] = 1.0 if hypot(x - cx, y - cy) < hypot(bx - cx, by - cy) else 2.0
        return False, still, still
    nx, ny = bx - x, by - y
    away, ball_v = hypot(nx, ny), (v[0], v[1], 0.0)
    met_at = nx / away, ny / away
    own, w, other, spin, _ok = collide_balls(ball_v, w, still, still, met_at, law, phys[P_E_B], work.series)
    cloth.begin(motion, state, 0, t, (x, y), (own[0], own[1]), w, phys)
    return True, other, spin


@kernel
def foresee_pot(played, pot, positions, on_table, cue_law, work, out):
    """Predict a stroke of ``stroke_in_room`` at a pot, of ball and pocket: fills ``out`` (SEEN,)."""
    phys, (ball, pocket) = cue_law.phys, pot
    met, other, _spin = _meet(played, ball, positions, cue_law, work, out)
    if not met:
        return
    px = POCKET_AIMS[pocket, AIM_X] - positions[ball, 0]
    py = POCKET_AIMS[pocket, AIM_Y] - positions[ball, 1]
    run, speed = hypot(px, py), hypot(other[0], other[1])
    out[OBJECT], out[ASIDE] = speed, (px * other[1] - py * other[0]) / (run * max(speed, 1e-9))
    # it slides, and rolls on with 5/7 of its speed
    rolls = (25.0 / 49.0) * speed * speed / (2.0 * phys[P_MU_R] * phys[P_G])
    out[REACH] = min(FAREST, rolls / run)
    _run(positions, on_table, ball, Law(phys, cue_law.fidelity, cue_law.n_steps), work, out)


@kernel
def foresee_contact(stroke, positions, on_table, cue_law, work, out, its):
    """Predict a stroke (5,) and the first ball in its way, into ``out`` and ``its``; returns that ball, 0 for none."""
    phys, motion, state = cue_law.phys, work.motion, work.state
    law = Law(phys, cue_law.fidelity, cue_law.n_steps)
    ux, uy = cos(stroke[3]), sin(stroke[3])
    ball = find_first_ball(positions, on_table, positions[0, 0], positions[0, 1], ux, uy, 1e9)
    for c in range(SEEN):
        out[c] = its[c] = 0.0
    out[MISSED], its[NEAR] = 2.0, 9.0
    if ball == 0:
        return 0
    with_tip = stroke[0], stroke[1], stroke[2], stroke[4]
    played = stroke_in_room(stroke[3], with_tip, positions, on_table, cue_law)
    met, other, spin = _meet(played, ball, positions, cue_law, work, out)
    if not met:
        return 0
    _run(positions, on_table, ball, law, work, out)
    at = positions[ball, 0], positions[ball, 1]
    cloth.begin(motion, state, 0, 0.0, at, (other[0], other[1]), spin, phys)
    _run(positions, on_table, ball, law, work, its)
    return ball


@kernel
def _with_error(meant, error, noise, most, tried):
    """Fill ``tried`` (5,) with the stroke ``meant`` (5,) under a standard normal ``error`` (5,)."""
    played = with_errors(meant[0], meant[1], meant[2], meant[3], meant[4], error, noise)
    tried[0], tried[3], tried[4] = played[0], played[3], played[4]
    tried[1], tried[2] = tip_on_disc(played[1], played[2], most)


@kernel
def leave(ball, ball_on, positions, on_table, after, there):
    """The table after ``ball`` is potted: fills ``after`` and ``there``, and returns the ball on or ``NONE``."""
    reds = False
    for i in range(N_BALLS):
        after[i, 0], after[i, 1], there[i] = positions[i, 0], positions[i, 1], on_table[i]
        reds = reds or (0 < i < 16 and on_table[i] and i != ball)
    if VALUES[ball] > 1 and ball_on == 0:
        after[ball, 0], after[ball, 1] = SPOTS[ball, 0], SPOTS[ball, 1]
    else:
        there[ball] = False
    if VALUES[ball] == 1:
        return 0
    if reds:
        return 1
    for i in range(16, N_BALLS):
        if there[i]:
            return VALUES[i]
    return NONE


@kernel
def is_fair(ball, touching, on):
    """Whether a stroke whose cue ball meets ``ball``, 0 for none, is fair with these masks of balls that touch it and are on.
    Away from a touching ball on every contact is fair; into a touching ball is a push."""
    return ball > 0 and not (touching >> ball) & 1 and (touching & on != 0 or (on >> ball) & 1 != 0)


@entry(what="the paths of balls", seconds=18)
def predict(balls, rows, strokes, pots, errors, noise, law, out, met):
    """Predict strokes (n, 5) on the tables ``rows`` (n,), each under standard normal ``errors`` (k, 5): at ``pots`` (n, 2), ball and
    pocket, into ``out`` (n k, 1, SEEN), of the cue ball, or, into ``out`` (n k, 2, SEEN), at whatever is in their way, the second
    of the two: ``met`` (n k,) is that ball, 0 for none."""
    (positions, on_table), (phys, ratios, fidelity, n_steps, most, rails) = balls, law
    work, tried = new_work(), np.empty(5)
    for j in range(out.shape[0]):
        i = j // errors.shape[0]
        k = rows[i]
        own, p, here = row_of(k, phys), positions[k], on_table[k]
        its = CueLaw(phys[own], ratios[own], fidelity, n_steps, most, rails)
        _with_error(strokes[i], errors[j % errors.shape[0]], noise, most, tried)
        if out.shape[1] == 1:
            played = stroke_in_room(tried[3], (tried[0], tried[1], tried[2], tried[4]), p, here, its)
            foresee_pot(played, (pots[i, 0], pots[i, 1]), p, here, its, work, out[j, 0])
        else:
            met[j] = foresee_contact(tried, p, here, its, work, out[j, 0], out[j, 1])


@entry
def leave_pots(balls, rows, pots, seen, left):
    """Fill ``left``: the positions, on_table and the ball on or ``NONE`` after ``pots`` (n, 2) of strokes ``seen`` (n, SEEN)."""
    (positions, on_table, ball_on), (after, there, on) = balls, left
    for j in range(rows.shape[0]):
        k = rows[j]
        on[j] = leave(pots[j, 0], ball_on[k], positions[k], on_table[k], after[j], there[j])
        after[j, 0, 0], after[j, 0, 1] = seen[j, X], seen[j, Y]


@entry
def leave_contacts(balls, rows, met, seen, left):
    """Fill ``left``: the positions after strokes without a pot that are ``seen`` (n, 2, SEEN) at the balls ``met`` (n,); whether fair."""
    (positions, on_table, game), (after, fair) = balls, left
    for j in range(rows.shape[0]):
        k, ball = rows[j], met[j]
        p, here = positions[k], on_table[k]
        fair[j] = is_fair(ball, touching_balls(p, here), strikeable(game[k], bits(here) & ~1))
        for b in range(N_BALLS):
            after[j, b, 0], after[j, b, 1] = p[b, 0], p[b, 1]
        if ball:
            after[j, 0, 0], after[j, 0, 1] = seen[j, 0, X], seen[j, 0, Y]
            after[j, ball, 0], after[j, ball, 1] = seen[j, 1, X], seen[j, 1, Y]
