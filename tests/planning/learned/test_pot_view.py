"""Does an agent see each pot as the docstring of ``with_pots`` says?"""

from math import hypot, log10

import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import BLACK, CUE, BallOn, mask_of
from snooker_env.game.pots import pots
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from snooker_env.planning import Positions
from snooker_env.planning.learned import stroke_policy as pot_view
from snooker_env.tasks.discrete_actions import POTS
from snooker_env.tasks.observations import SIZE
from snooker_env.tasks.visit import BALL_ON
from tests.positions import tables
from tests.shots import shot

VALUES = {**dict.fromkeys(range(1, 16), 1), **{14 + k: k for k in range(2, 8)}}


def pot_entries(positions, pot):
    """What is to be seen of one pot."""
    ball, pocket, _, _, _, tolerance = pot
    cue, at, into = positions[CUE], positions[int(ball)], POCKET_AIMS[int(pocket), :2]
    run = (into - at) / hypot(*(into - at))
    way = at - 2 * BALL_RADIUS * run - cue
    path = hypot(*way)
    way = way / path
    sine, cosine = way[0] * run[1] - way[1] * run[0], way @ run
    size, worth = np.array((HALF_WIDTH, HALF_LENGTH)), (1 + log10(tolerance) / 2, VALUES[int(ball)] / 7)
    distances = path / HALF_LENGTH - 1, hypot(*(into - at)) / HALF_LENGTH - 1
    return np.clip([1, *way, sine, cosine, *distances, *worth, *at / size, *into / size], -1, 1)


@pytest.mark.parametrize("ball_on", [BallOn.RED, BallOn.ANY_COLOUR])
def test_every_pot_is_shown_entry_by_entry(ball_on):
    env = tables(30, layout="random:5", seed=1, observation="flat")
    states = [state | {"ball_on": int(ball_on)} for state in env.get_state()]
    observations, _ = env.reset(options={"states": states})
    at, pockets = Positions.of(env), set()
    assert (at.game[:, BALL_ON] == int(ball_on)).all()
    shown = pot_view.with_pots(observations)
    balls = range(1, 16) if ball_on == BallOn.RED else range(16, BLACK + 1)
    assert np.array_equal(shown[:, :SIZE], observations) and shown.shape == (30, pot_view.SHOWN)
    for k in range(30):
        on = mask_of(i for i in balls if at.on_table[k, i])
        direct = pots(at.positions[k], at.on_table[k], on, most=POTS)
        wanted = np.zeros((POTS, pot_view.POT_ENTRIES))
        for j, pot in enumerate(direct):
            wanted[j] = pot_entries(at.positions[k], pot)
            pockets.add(int(pot[1]))
        assert shown[k, SIZE:].reshape(POTS, -1) == pytest.approx(wanted, abs=2e-5)
    assert pockets == set(range(6))


def test_pot_view_shows_the_line_that_the_aim_is_read_against():
    table = SnookerEnv(aim="target", observation="flat", layout="held_out")
    for seed in range(20):
        observation = pot_view.with_pots(table.reset(seed=seed)[0][None])[0]
        rows = observation[SIZE:].reshape(-1, pot_view.POT_ENTRIES)
        assert np.array_equal(observation[:SIZE], Positions.of(table).observations()[0])
        direction = shot(
            table.options.rules.actions, np.zeros(4), table.positions, table.on_table, table.tables.on(0)
        )[3]
        assert rows[0] == pytest.approx([1, np.cos(direction), np.sin(direction), *rows[0, 3:]], abs=5e-6)
        shown = rows[rows[:, 0] == 1]
        # sine and cosine of one angle
        assert np.hypot(shown[:, 3], shown[:, 4]) == pytest.approx(1.0, abs=1e-6)
        # widest first, then nothing
        assert np.all(np.diff(shown[:, 7]) <= 0) and not rows[len(shown) :].any()
