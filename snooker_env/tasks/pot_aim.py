"""In which direction must the cue ball leave to pot a ball? The line of a pot, corrected for throw, swerve and the object
ball's own curve: both balls alone are played on unbounded cloth until the object ball rolls, and secant steps correct
the direction by how far it passes the pocket's aim point."""

from math import atan2, hypot, pi

from .._lib.jit import kernel
from ..physics import cloth, cue
from ..physics.arrays import Law
from ..physics.columns import P_E_B, P_MU_S, P_NAP, P_R
from ..physics.cue_room import in_room
from ..physics.detection import pair_time
from ..physics.impact.contact import collide_balls

_ENOUGH = 1e-6  # rad that the object ball may pass the aim point by, a hundredth of the best player's error
_TRIALS = 12
_ROUNDS, _NEARLY = 4, 1e-5  # corrections in ``swerved_aim``; the last may be as large as that [rad]
_STEPS, _THERE = 30, 1e-9  # of Newton's method along the path, two to four as a rule; near enough [m]
_SAME_ROOM = 1e-4
"""A cue that turns by less keeps its elevation while an aim is solved [rad]: nine of ten object balls then pass the aim
point by less than 2e-5 rad."""
_SWERVE = 5e-3  # the same of the first trial, which only shows the way and is never the last [rad]
_WIDEST = 0.12  # rad off the geometric line: far more than any throw and swerve of a pot


@kernel
def stroke_in_room(aim, stroke, positions, on_table, law):
    """(speed, side, top, aim, elevation) of a stroke (speed, side, top, elevation) in the direction ``aim``, raised as it must be."""
    speed, side, top, elevation = stroke
    meant = speed, side, top, aim - cue.squirt(side, law.end_mass_ratio), elevation
    return in_room(meant, positions, on_table, law.rails, law.phys[P_R], law.max_offset)[0]


@kernel
def struck_by(played, law):
    """Velocity and spin of a stroke of ``stroke_in_room``; see ``cue.strike_ball``."""
    (speed, side, top, aim, elevation), R, mu_s = played, law.phys[P_R], law.phys[P_MU_S]
    return cue.strike_ball(speed, aim, side, top, elevation, R, mu_s, law.end_mass_ratio, 0.0)


@kernel
def meets(played, positions, b, law, work):
    """Follow the cue ball of ``stroke_in_room`` until it meets the ball at b -> whether, and when [s]; both are in ``work.motion``."""
    phys, motion, state = law.phys, work.motion, work.state
    (vx, vy, _), w = struck_by(played, law)
    cloth.begin(motion, state, 0, 0.0, (positions[0, 0], positions[0, 1]), (vx, vy), w, phys)
    cloth.begin(motion, state, 1, 0.0, b, (0.0, 0.0), (0.0, 0.0, 0.0), phys)
    t, now = 1e300, 0.0
    while state[0] > cloth.REST:
        t = pair_time(motion, state, 0, 1, now, 2.0 * phys[P_R])
        now = motion[0, cloth.T_END]
        if t <= now:
            return True, t
        cloth.next_phase(motion, state, 0, phys)
    return False, t


@kernel
def _passes(played, positions, b, p, law, work):
    """Angle [rad] by which the ball at b, hit by a stroke of ``stroke_in_room``, passes p on the left; 9: missed."""
    (bx, by), (px, py) = b, p
    phys, motion, state = law.phys, work.motion, work.state
    met, t = meets(played, positions, b, law, work)
    if not met:
        return 9.0
    (x, y), v, w = cloth.evaluate(motion, state, 0, t, phys)
    nx, ny = bx - x, by - y
    d = hypot(nx, ny)
    still, impact = (0.0, 0.0, 0.0), Law(phys, law.fidelity, law.n_steps)
    ball, normal = (v[0], v[1], 0.0), (nx / d, ny / d)
    _, _, v2, w2, solved = collide_balls(ball, w, still, still, normal, impact, phys[P_E_B], work.series)
    if not solved:
        return 9.0
    cloth.begin(motion, state, 1, t, (bx, by), (v2[0], v2[1]), w2, phys)
    if state[1] == cloth.SLIDE:  # the curve ends where it rolls, or at the pocket
        cloth.next_phase(motion, state, 1, phys)
    if state[1] <= cloth.REST:
        return 9.0
    qx, qy = px - bx, py - by
    away = hypot(qx, qy)
    T = 0.0
    # by the nap: the chord of the piece that ends past the pocket is accurate enough
    while state[1] == cloth.BEND and phys[P_NAP] != 0.0:
        T = motion[1, cloth.T_END] - motion[1, cloth.T0]
        (x, y), _v, _w = cloth.evaluate(motion, state, 1, motion[1, cloth.T_END], phys)
        if (x - bx) * qx + (y - by) * qy >= away * away:
            break
        cloth.next_phase(motion, state, 1, phys)
        T = 0.0
    gx, gy = motion[1, cloth.X] - bx, motion[1, cloth.Y] - by
    ux = motion[1, cloth.VX] + 0.5 * motion[1, cloth.AX] * T
    uy = motion[1, cloth.VY] + 0.5 * motion[1, cloth.AY] * T
    # still sliding at the pocket: its chord is accurate enough
    if T == 0.0 and gx * qx + gy * qy > 0.9 * away * away:
        ux, uy = gx, gy
    else:
        qx, qy = qx - gx, qy - gy
    ahead = qx * ux + qy * uy
    # from where the ball lay, even if it begins to roll near the pocket: the slope hardly changes
    return (qx * uy - qy * ux) / (hypot(ux, uy) * away) if ahead > 0.0 else 9.0


@kernel
def _off(played, line, far, positions, law, work):
    """Angle [rad], in (-pi, pi], from ``line`` to where ``played`` takes the cue ball after ``far`` [m], or where it stops."""
    phys, motion, state = law.phys, work.motion, work.state
    cx, cy = positions[0, 0], positions[0, 1]
    (vx, vy, _), w = struck_by(played, law)
    cloth.begin(motion, state, 0, 0.0, (cx, cy), (vx, vy), w, phys)
    x, y = cx + vx, cy + vy
    while state[0] > cloth.REST:
        low, high = motion[0, cloth.T0], motion[0, cloth.T_END]
        t = high
        for k in range(_STEPS):
            (x, y), v, _ = cloth.evaluate(motion, state, 0, t, phys)
            dx, dy = x - cx, y - cy
            away = hypot(dx, dy)
            if (k == 0 and away < far) or abs(away - far) < _THERE:
                break
            low, high = (low, t) if away > far else (t, high)
            t -= (away - far) * away / (dx * v[0] + dy * v[1])
            if not low < t < high:
                t = 0.5 * (low + high)
        if hypot(x - cx, y - cy) > far - _THERE:
            break
        cloth.next_phase(motion, state, 0, phys)
    off = atan2(y - cy, x - cx) - line
    return off - 2.0 * pi * round(off / (2.0 * pi))


@kernel
def swerved_aim(line, far, stroke, positions, on_table, law, work):
    """Direction [rad] in which a stroke (speed, side, top, elevation) leaves, so that its swerve under a raised cue brings it
    to the place ``far`` along the direction ``line``. A free cue's is the line itself."""
    if law.rails.shape[0] == 0 or stroke[1] == 0.0:
        return line
    aim, last_aim, last, slope = line, line, 0.0, 1.0
    for k in range(_ROUNDS):
        off = _off(stroke_in_room(aim, stroke, positions, on_table, law), line, far, positions, law, work)
        if k and aim != last_aim:  # the elevation turns with the aim, if little
            slope = min(2.0, max(0.5, (off - last) / (aim - last_aim)))
        last_aim, last = aim, off
        aim -= off / slope
        if abs(off) < _NEARLY:
            break
    return aim


@kernel
def aim_from(begin, effort, positions, on_table, ball, target, ghost, stroke, law, work):
    """``solved_aim``, sought from the direction ``begin`` on [rad], and the stroke as ``stroke_in_room``. ``effort``: how far the
    ball may pass the target [rad], by how much the cue may turn at the same elevation [rad], the most trials."""
    enough, same, trials = effort
    (px, py), (gx, gy) = target, ghost
    cx, cy, bx, by = positions[0, 0], positions[0, 1], positions[ball, 0], positions[ball, 1]
    line = atan2(gy - cy, gx - cx)
    # an error turns the object ball's direction the other way, magnified by path / (2 R cos cut)
    far = hypot(gx - cx, gy - cy)
    run = hypot(px - bx, py - by)
    cut = ((gx - cx) * (px - bx) + (gy - cy) * (py - by)) / (far * run)
    slope = -far / (2.0 * law.phys[0] * max(cut, 0.05))
    squirted = cue.squirt(stroke[1], law.end_mass_ratio)
    raised_at, played = begin, stroke_in_room(begin, stroke, positions, on_table, law)
    if law.rails.shape[0] and stroke[1] != 0.0:
        # a raised cue with side bends the path: by more than a thin cut or a soft stroke would show
        begin -= _off(played, line, max(far, law.phys[P_R]), positions, law, work)
    aim, best, least, found = begin, begin, 9.0, played
    last_aim, last = begin, 9.0
    for k in range(trials):
        if abs(aim - raised_at) > (same if k else _SWERVE):
            played, raised_at = stroke_in_room(aim, stroke, positions, on_table, law), aim
        speed, side, top, _, elevation = played
        at_aim = speed, side, top, aim - squirted, elevation
        off = _passes(at_aim, positions, (bx, by), target, law, work)
        if abs(aim - raised_at) <= same:
            if abs(off) < abs(least):
                best, least, found = aim, off, at_aim
            if abs(off) <= enough:
                break
        if off == 9.0:  # missed, or it never arrived: turn towards the ball's middle
            middle = atan2(by - cy, bx - cx)
            turn = middle + (begin - line) - aim
            turn -= 2.0 * pi * round(turn / (2.0 * pi))
            aim += 0.25 * turn
            continue
        if last != 9.0 and aim != last_aim:
            secant = (off - last) / (aim - last_aim)
            if 0.2 < secant / slope < 5.0:
                slope = secant
        last_aim, last = aim, off
        step = -off / slope
        limit = 0.5 * _WIDEST
        aim = min(begin + _WIDEST, max(begin - _WIDEST, aim + min(limit, max(-limit, step))))
    return best, found


@kernel
def solved_aim(positions, on_table, ball, target, ghost, stroke, law, work):
    """Direction [rad] in which a stroke (speed, side, top, elevation) sends ``ball`` to ``target``, its cue raised as needed."""
    line = atan2(ghost[1] - positions[0, 1], ghost[0] - positions[0, 0])
    effort = _ENOUGH, _SAME_ROOM, _TRIALS
    return aim_from(line, effort, positions, on_table, ball, target, ghost, stroke, law, work)[0]
