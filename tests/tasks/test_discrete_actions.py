"""Does ``action="discrete"`` play the shot it names, with an aim that sends the object ball at the pocket?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv
from snooker_env.game import pots
from snooker_env.game.balls import BLACK, BLUE, BROWN, CUE, N_BALLS, SPOTS, BallOn, mask_of
from snooker_env.game.fouls import Foul
from snooker_env.game.frame_columns import IN_HAND
from snooker_env.game.layouts import layout
from snooker_env.game.pots import POT_COLUMNS
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.kernels import entry
from snooker_env.tasks import CHOICES, choice_of, lines, windows
from snooker_env.tasks.discrete_actions import POTS, SIDES, SIZE, SPEEDS, STROKES, TOPS
from snooker_env.tasks.stroke import VX, VY, WX, WY, WZ
from tests.tables import begun, table_state
from tests.tasks import fair_choices as fair


def test_the_numbers_count_pots_speeds_sides_and_tops():
    assert len(SPEEDS) * len(SIDES) * len(TOPS) == STROKES and SIZE == POTS * STROKES
    assert choice_of(0, 0, 0, 0) == 0
    assert choice_of(POTS - 1, len(SPEEDS) - 1, len(SIDES) - 1, len(TOPS) - 1) == SIZE - 1


@pytest.mark.parametrize("physics", ["paper", "match"])
def test_the_object_ball_rolls_at_the_pocket(physics):
    """Judged by the engine, which the solver does not use: two balls on unbounded cloth."""
    rng = np.random.default_rng(1)
    constants, worst, seen = sn.Physics.preset(physics), [], 0
    while seen < 60:
        cue, ball = rng.uniform((-0.8, -1.6), (0.8, 1.6)), rng.uniform((-0.8, -1.6), (0.8, 1.6))
        positions, on_table = np.zeros((22, 2)), np.zeros(22, bool)
        positions[0], positions[1], on_table[:2] = cue, ball, True
        found = pots.pots(positions, on_table, mask_of([1]), most=1)
        if not len(found) or np.hypot(*(cue - ball)) < 0.2 or found[0, 4] < 0.3:
            continue
        speed, side, top = int(rng.integers(4, 9)), int(rng.integers(3)), int(rng.integers(5))
        env = begun(SnookerEnv(action="discrete", layout="random:1", physics=physics), 0)
        env.tables.positions[0], env.tables.on_table[0] = positions, on_table
        env.tables.game[0, :3] = 1, 0, 0
        env.step(choice_of(0, speed, side, top))
        v, w = env._buffers.v[0, 0], env._buffers.w[0, 0]
        start = env._buffers.shots[0]
        v1, w1 = [start[[VX, VY]], (0, 0)], [start[[WX, WY, WZ]], (0, 0, 0)]
        shot = sn.simulate([cue, ball], v1, w1, table=None, physics=constants)
        hit = shot.events[shot.events["kind"] == sn.EventKind.BALL_BALL]
        rolls = shot.events[(shot.events["kind"] == sn.EventKind.ROLL) & (shot.events["i"] == 1)]
        assert len(hit) and v.shape == (2,) and w.shape == (3,)
        place, way, _ = (a[1] for a in shot.at(float(rolls["time"][0]) + 1e-9))
        pocket = pots.POCKET_AIMS[int(found[0, 1]), :2]
        if (place - ball) @ (pocket - ball) > 0.9 * (pocket - ball) @ (pocket - ball):
            continue
        to = pocket - place
        worst.append(abs(np.arctan2(to[0] * way[1] - to[1] * way[0], to @ way)))
        seen += 1
    assert max(worst) < 1e-5


def test_solved_aims_pot_more_than_straight_lines():
    speed, made = 2 * (SPEEDS[4] - 0.2) / 6.8 - 1, []
    for action, stroke in (("discrete", choice_of(0, 4, 1, 2)), ("box", (speed, 0.0, 0.0, 0.0))):
        options = {"action": action, "aim": "target", "layout": "pots:medium", "physics": "match"}
        env = begun(sn.SnookerVectorEnv(400, **options), 0)
        made.append((env.step(np.array([stroke] * 400))[1] > 0).mean())
    assert made[0] > 0.95 > made[1] + 0.1


def test_masks_offer_the_pots_there_are():
    env = begun(sn.SnookerVectorEnv(200, action="discrete", layout="random:1"), 0)
    visits, masks = env.tables, env.action_masks()
    assert masks.shape == (200, SIZE)
    counts = set()
    for k in range(200):
        on = mask_of([1])  # the one red
        n = len(pots.pots(visits.positions[k], visits.on_table[k], on, most=POTS))
        counts.add(n)
        if n:
            assert masks[k].sum() == STROKES * n and masks[k, : STROKES * n].all()
        else:  # other lines stand for them, see below
            lines = masks[k].reshape(POTS, STROKES)
            assert lines[0].all() and (lines == lines[:, :1]).all()
    assert 0 in counts and len(counts) > 2


# Where there is no direct pot, the lines offered are real strokes, and the windows exact


@entry
def _windows(positions, on_table, on, touching, out):
    return windows.open_windows(positions, on_table, on, touching, out)


@entry
def _lines(positions, on_table, on, found):
    return lines.find_lines(positions, on_table, on, found, False)


def windows_of(positions, on_table, on, touching=0):
    out = np.empty((windows.MOST_EDGES, 3))
    return out[: _windows(positions, on_table, on, touching, out), :2]


def lines_of(positions, on_table, on):
    found = np.empty((lines.LINE_ROWS, POT_COLUMNS))
    return found[: _lines(positions, on_table, on, found), : lines.LINE_WORTH]


def first_met(positions, on_table, angles):
    """The ball met first in each direction, typed anew in NumPy; 0 for none."""
    to = positions - positions[0]
    along = to[:, 0] * np.cos(angles)[:, None] + to[:, 1] * np.sin(angles)[:, None]
    across2 = (to**2).sum(1) - along**2
    met = on_table & (along > 0.0) & (across2 < 4 * R * R)
    runs = np.where(met, along - np.sqrt(np.maximum(0.0, 4 * R * R - across2)), np.inf)
    runs[:, 0] = np.inf
    return np.where(np.isfinite(runs.min(1)), runs.argmin(1), 0)


@pytest.mark.parametrize("kind", ["break_off", "opened", "snookered"])
def test_windows_are_the_directions_in_which_a_ball_on_is_met_first(kind):
    angles = np.linspace(-np.pi, np.pi, 20_000, endpoint=False)
    for seed in range(6):
        positions, on_table = layout(kind, np.random.default_rng(seed))
        on = mask_of(range(1, 16)) if seed % 3 else mask_of([BLUE, BROWN, 3])
        found = windows_of(positions, on_table, on)
        half = 0.5 * (found[:, 1] - found[:, 0])
        off = np.abs((angles[:, None] - found.mean(1) + np.pi) % (2 * np.pi) - np.pi) - half
        sure = np.abs(off).min(1) > 1e-9 if len(found) else np.ones(len(angles), bool)
        met = first_met(positions, on_table, angles)
        assert np.array_equal((off < 0.0).any(1)[sure], ((on >> met) & 1 == 1)[sure])
        assert (np.diff(half) <= 0.0).all()


def test_what_is_seen_is_offered_from_thin_on_either_side_to_full():
    positions, on_table = SPOTS.copy(), np.isin(np.arange(N_BALLS), (CUE, 1, BLACK))
    positions[CUE], positions[1] = (0.0, 0.0), (1.0, 0.0)
    found, half = lines_of(positions, on_table, mask_of([1])), np.arcsin(2 * R)
    assert found[:, 0] == pytest.approx([0.0, -lines.THIN * half, lines.THIN * half], abs=1e-12)
    positions[2], on_table[2] = (-0.6, 0.3), True  # another red: the widest window first
    found, wide = lines_of(positions, on_table, mask_of([1, 2])), np.arctan2(0.3, -0.6)
    thin = lines.THIN * np.arcsin(2 * R / np.hypot(0.6, 0.3))
    assert found[:, 0] == pytest.approx([wide, wide - thin, wide + thin, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("kind", "n", "least", "target"),
    [
        ("break_off", 12, 1.0, 1.0),
        pytest.param("break_off_six_red", 40, 1.0, 1.0, marks=pytest.mark.slow),
        pytest.param("break_off_shoot_out", 40, 1.0, 1.0, marks=pytest.mark.slow),
        pytest.param("snookered", 10, 0.95, 0.95, marks=pytest.mark.slow),
        pytest.param("snookered_match", 30, 0.95, 0.95, marks=pytest.mark.slow),
        pytest.param("frames", 60, 0.99, 0.85, marks=pytest.mark.slow),
    ],
)
def test_there_is_a_fair_choice_and_a_fair_target(kind, n, least, target):
    """In frames the target line leads full at balls in the mouth of a pocket too, which the cue ball follows."""
    shares, aimed = fair.fair_strokes(kind, n, seed=0)
    assert len(shares) > 0.7 * n and (shares > 0.0).mean() >= least and shares.mean() > 0.6
    assert aimed.any(axis=1).mean() >= target and aimed[:, SPEEDS.index(3.6)].mean() >= target - 0.1


def test_an_escape_is_solved_for_the_stroke_that_is_played():
    """Speed, side and top turn the cue ball at a cushion; all choices of one line meet the red."""
    env = sn.SnookerEnv(action="discrete", physics="match", render_mode="ansi")
    wall = {16: (0.15, 0.0), BLUE: (0.0, 0.0), 17: (-0.15, 0.0)}
    table_state(env, {CUE: (0.0, -0.5), 1: (0.0, 0.6), **wall}, BallOn.RED)
    state, aims, met = env.get_state(), [], 0
    picks = [choice_of(0, speed, side, top) for speed in (3, 5, 7) for side in range(3) for top in range(5)]
    for pick in picks:
        env.set_state(state)
        met += env.step(pick)[4]["first_ball"] == 1
        v = env.last_shot.at(0.0)[1][CUE]
        aims.append(np.arctan2(v[1], v[0]))
    assert met >= 0.8 * len(picks) and np.ptp(aims) > 0.05


def touching(ball, others):
    """The fouls of all choices, and the lines, where the cue ball touches a ball on its right; red is on."""
    tables = fair.deal(CHOICES, 0, action="discrete")
    positions, on_table = SPOTS.copy(), np.isin(np.arange(N_BALLS), (CUE, BLACK, ball, *others))
    positions[CUE], positions[ball] = (0.3, 0.3), (0.3 + 2 * R + 1e-5, 0.3)
    for i, place in others.items():
        positions[i] = place
    tables.positions[0], tables.on_table[0], tables.game[0, IN_HAND] = positions, on_table, 0
    assert not fair.has_pot(tables, 0)
    offered = np.flatnonzero(tables.action_masks()[0])
    found = fair.fouls(tables, fair.states(tables, [0])[0], offered[:, None].astype(float))
    return found, lines_of(positions, on_table, mask_of(range(1, 16)))


def test_a_touching_ball_on_is_played_away_from():
    found, aims = touching(1, {})
    assert (np.cos(aims[:, 0]) < 0.0).all() and not (found & Foul.PUSH).any() and (found == 0).mean() > 0.7


def test_a_touching_ball_that_is_not_on_is_not_moved():
    """The blue touches the cue ball on the way to the only red."""
    found, aims = touching(BLUE, {1: (0.8, 0.3)})
    assert (np.cos(aims[:, 0]) < 0.0).all() and not (found & Foul.PUSH).any() and (found == 0).mean() > 0.3
