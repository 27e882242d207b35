"""Does ``action="discrete"`` play the shot it names, with an aim that sends the object ball at the pocket?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv
from snooker_env.game import pots
from snooker_env.game.balls import mask_of
from snooker_env.tasks.discrete_actions import POTS, SIDES, SIZE, SPEEDS, STROKES, TOPS, choice_of
from tests.tables import begun

R = 0.02625


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
        v, w = env._record.buffers.v[0, 0], env._record.buffers.w[0, 0]
        start = env._record.buffers.shots[0]
        v1, w1 = [start[:2], (0, 0)], [start[2:5], (0, 0, 0)]
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
        else:  # other lines stand for them, see test_lines.py
            lines = masks[k].reshape(POTS, STROKES)
            assert lines[0].all() and (lines == lines[:, :1]).all()
    assert 0 in counts and len(counts) > 2
