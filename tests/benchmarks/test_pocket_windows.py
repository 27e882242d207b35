"""Are the pockets' windows narrower for firm shots, the same for clean ones, and pool's as published?"""

import numpy as np
import pytest

import snooker_env as sn
from benchmarks.pockets import openings
from benchmarks.pockets import windows as pocket_windows
from benchmarks.pockets.windows import CORNER, MIDDLE, Paths, alone, drops, play_strokes_at, strokes, windows
from snooker_env.physics.engine import EventKind

ANGLES = {CORNER: (0, 20, 40), MIDDLE: (0, 30, 45, 60)}
PRESETS, TABLES = ("paper", "match"), ("match", "tight")
SPEEDS = (0.5, 1.0, 6.0)


def widths(preset, table, pocket, speeds=SPEEDS, rolling=True):
    """Lateral windows [mm] by angle and speed, from 0.3 m."""
    here, angles = alone(sn.Table.preset(table), pocket), np.radians(ANGLES[pocket])[:, None]
    paths = Paths(angles, 0.3, np.array(speeds), rolling, False)
    return 1e3 * windows(here, paths, sn.Physics.preset(preset)).width


def measure_openings(pocket, speeds, rolling, physics, distance=0.3, halvings=30):
    """The largest offset [m] at which a ball that runs along the axis drops without a jaw in its log, by
    speed."""
    speeds = np.asarray(speeds, float)
    low, high = np.zeros(len(speeds)), np.full(len(speeds), 0.05)

    def free(s):
        hit, _, out = play_strokes_at(
            pocket,
            strokes(pocket, s, 0.0, distance, speeds, rolling, False, physics),
            physics,
            log=32,
        )
        logged = np.arange(out.event_what.shape[1]) < out.n_events[:, None]
        return hit & ~((out.event_what[:, :, 0] == EventKind.JAW) & logged).any(1)

    if not free(low).all() or free(high).any():
        raise RuntimeError("the clean opening is not within the search")
    for _ in range(halvings):
        s = 0.5 * (low + high)
        ok = free(s)
        low, high = np.where(ok, s, low), np.where(ok, high, s)
    return low


def all_clean_drop(pocket, speeds, physics, distance=0.3, n=41):
    """Do all balls within the clean opening drop, at every speed, rolling or not?"""
    most = openings.clean(pocket, physics.R)
    s = np.linspace(-most, most, n)[:, None, None] * (1 - 1e-9)
    return bool(
        drops(
            pocket,
            0.0,
            distance,
            np.asarray(speeds)[:, None],
            np.array([True, False]),
            physics,
            s,
        ).all()
    )


@pytest.mark.parametrize("rolling", [True, False])
@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize(("table", "pocket"), [("match", CORNER), ("tight", CORNER), ("match", MIDDLE)])
def test_a_firm_shot_has_a_narrower_window_than_a_soft_one(preset, table, pocket, rolling):
    """Every window here is wider than the clean opening, or needs a jaw."""
    slowest, slow, firm = widths(preset, table, pocket, (1.0, 2.0, 6.0) if not rolling else SPEEDS, rolling).T
    assert (firm < slow - (1.5 if rolling else 0.5)).all() and (firm < slowest - 3.0).all()


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("pocket", [CORNER, MIDDLE])
@pytest.mark.parametrize("table", TABLES)
def test_the_clean_opening_is_the_same_at_all_speeds(preset, table, pocket):
    here, physics = alone(sn.Table.preset(table), pocket), sn.Physics.preset(preset)
    speeds = (0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0)
    assert all_clean_drop(here, speeds, physics)
    clean, free = openings.clean(here, physics.R), measure_openings(here, speeds, True, physics)
    assert (free > clean - 5e-5).all()
    # so far behind the edge a ball still meets a jaw
    assert (free[np.array(speeds) >= 6.0] < clean + 1e-4).all()


def test_a_window_is_what_a_dense_scan_finds():
    here, physics = alone(sn.Table.preset("match"), MIDDLE), sn.Physics.preset("match")
    for angle, speed in ((0.0, 2.0), (np.radians(45), 6.0)):
        found = windows(here, Paths(angle, 0.3, speed, True, False), physics)
        step = 1e-4
        s = np.arange(-0.06, 0.06, step)
        hit = drops(here, angle, 0.3, speed, True, physics, s)
        assert abs(hit.sum() * step - found.width) < 1.5e-3
        low, high = float(found.low), float(found.high)
        at = np.array([low - 1e-7, low, high, high + 1e-7])
        dropped = drops(here, angle, 0.3, speed, True, physics, at)
        assert dropped.tolist() == [False, True, True, False]


def test_the_openings_are_those_that_table_py_speaks_of():
    for table, pocket, name, mm in (
        ("match", CORNER, "throat", 86.0),
        ("tight", CORNER, "throat", 80.14),
        ("match", CORNER, "at the fall", 88.68),
        ("tight", CORNER, "at the fall", 83.95),
        ("match", MIDDLE, "fall to jaw", 100.96),
        ("tight", MIDDLE, "fall to jaw", 100.96),
    ):
        metres = openings.openings(alone(sn.Table.preset(table), pocket))[name]
        assert 1e3 * metres == pytest.approx(mm, abs=0.006)


ALCIATORE = {
    "corner": {0: 2.668, 10: 2.607, 20: 2.425},
    "side": {0: 3.229, 15: 3.077, 30: 2.629, 45: 1.920},
}
"""Effective target sizes of pool pockets for slow shots [in], off the axis [degrees], by the formulas of TP 3.5 and 3.6."""
INCH = 0.0254


def test_slow_mirrors_are_alciatore_s_pockets_on_the_pool9_table():
    """The preset's own arrays: two of its pockets, each alone, aimed at through the middle of the mouth."""
    physics = sn.Physics(R=1.125 * INCH, e_c=1.0, mu_c=0.0, mu_s=1e-9, mu_r=1e-9)
    table = sn.Table.preset("pool9")
    for kind, k in (("corner", 3), ("side", 2)):
        jaws, fall = table.jaws[4 * k : 4 * k + 4], table.falls[k]
        mouth = jaws[jaws[:, 2] == 0.0, :2].mean(axis=0)
        axis = np.arctan2(*(fall[:2] - mouth)[::-1])
        noses = pocket_windows.endless(table.noses, *mouth)
        assert len(noses) == 2
        here = pocket_windows.LonePocket(sn.Table(kind, noses, jaws, fall[None]), tuple(mouth), float(axis))
        paths = Paths(np.radians(list(ALCIATORE[kind])), 0.4, 0.1, False, False)
        inches = windows(here, paths, physics).width / INCH
        assert inches == pytest.approx(list(ALCIATORE[kind].values()), abs=0.01)
