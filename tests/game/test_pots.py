"""Are the pots that are offered ones that can be played, and those along runs that were listed before the same?"""

import numpy as np

from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.game import pots
from snooker_env.game.balls import N_BALLS, mask_of
from snooker_env.game.pots import RUNS, list_runs, pots_along
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from snooker_env.kernels import entry


@entry
def _counted(positions, on_table, on, most):
    return pots.count_pots(positions, on_table, on, BALL_RADIUS, most)


def plainly(positions, on_table, on):
    """Every ball and pocket, by the formulas of the module's docstring, without any short cut."""
    found, d = [], 2.0 * BALL_RADIUS

    def clear(a, b, skip, reach):
        others = [positions[i] for i in range(22) if on_table[i] and i not in (0, skip)]
        along = b - a
        return all(
            np.hypot(*(p - a - np.clip((p - a) @ along / (along @ along), 0.0, 1.0) * along)) >= reach
            for p in others
        )

    for ball in range(1, 22):
        for k in range(6) if on_table[ball] and (on >> ball) & 1 else ():
            b, cue, pocket, axis = positions[ball], positions[0], POCKET_AIMS[k, :2], POCKET_AIMS[k, 2:4]
            run = np.hypot(*(pocket - b))
            way = (pocket - b) / run
            ghost = b - d * way
            path = np.hypot(*(ghost - cue))
            cut = (ghost - cue) @ way / path
            corner = pots._CORNER_ANGLE, pots._CORNER_WINDOW
            angles, widths = (pots._MIDDLE_ANGLE, pots._MIDDLE_WINDOW) if POCKET_AIMS[k, 4] else corner
            width = np.interp(np.degrees(np.arccos(np.clip(way @ axis, -1.0, 1.0))), angles, widths)
            inside = (np.abs(ghost) <= np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS + 1e-9).all()
            free = clear(b, pocket, ball, d) and clear(cue, ghost, ball, d * (1.0 - 1e-9))
            if width > 0.0 and cut >= 0.05 and inside and free:
                found.append((width / (2.0 * run) * d * cut / path, ball, k, *ghost, cut))
    return sorted(found, reverse=True)


def test_short_cuts_leave_no_pot_out():
    """Random layouts, a third with balls frozen to rails; the widest four, and their number alone."""
    rng, met = np.random.default_rng(5), 0
    for trial in range(120):
        reach = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS
        positions, on_table = rng.uniform(-1, 1, (22, 2)) * reach, rng.random(22) < rng.random()
        on_table[0] = True
        if trial % 3 == 0:
            positions[:8, 0] = np.sign(positions[:8, 0]) * reach[0]
        on = int(rng.choice([mask_of(range(1, 16)), mask_of(range(16, 22)), mask_of([17])]))
        expected = plainly(positions, on_table, on)
        found = pots.pots(positions, on_table, on)
        pairs = [(int(p[pots.POT_BALL]), int(p[pots.POT_POCKET])) for p in found]
        assert pairs == [(ball, k) for _, ball, k, *_ in expected]
        if expected:
            columns = np.array([(x, y, cut, width) for width, _, _, x, y, cut in expected])
            assert np.allclose(found[:, pots.GHOST_X :], columns, rtol=1e-9, atol=1e-12)
        assert np.array_equal(pots.pots(positions, on_table, on, most=4), found[:4])
        for most in (1, 4, 99):
            assert _counted(positions, on_table, on, most) == min(most, len(found))
        met += len(found)
    assert met > 400


@entry
def _list(positions, on_table, on, runs):
    return list_runs(positions, on_table, on, BALL_RADIUS, runs)


@entry
def _find_both(positions, on_table, on, runs, many, found, along):
    before = pots.find_pots(positions, on_table, on, BALL_RADIUS, found)
    return before, pots_along(runs, many, positions, on_table, BALL_RADIUS, along)


def test_pots_along_runs_are_those_that_are_found_bit_for_bit():
    """Runs are listed with the cue ball elsewhere; then it lies at ten places of each table."""
    rng, met, full = np.random.default_rng(5), 0, 0
    tables = SnookerVectorEnv(40, layout="random:6", threads=1)
    tables.reset(seed=3)
    for k in range(40):
        positions, on_table = tables.tables.positions[k].copy(), tables.tables.on_table[k].copy()
        on = mask_of(np.flatnonzero(on_table[1:] & (rng.random(N_BALLS - 1) < 0.7)) + 1)
        runs = np.empty(RUNS)
        many = _list(positions, on_table, on, runs)
        for most in (4, 16) * 10:
            positions[0] = rng.uniform(-0.95, 0.95, 2) * (HALF_WIDTH, HALF_LENGTH)
            found, along = np.zeros((most, pots.POT_COLUMNS)), np.zeros((most, pots.POT_COLUMNS))
            count, same = _find_both(positions, on_table, on, runs, many, found, along)
            assert count == same and np.array_equal(found, along)
            met, full = met + count, full + (count == most)
    assert met > 1000 and full > 20
