"""Does the built-in opponent "ghost_ball" play sensibly where it has no pot? Its break-offs, soft strokes, escapes, and what it repeats."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, CUE, N_BALLS, SPOTS, YELLOW
from snooker_env.game.frame_columns import FAILURES, IN_HAND, SAVED
from snooker_env.game.pots import pots
from snooker_env.game.ruling import Foul
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, HALF_WIDTH
from snooker_env.tasks.frame import Frames
from snooker_env.tasks.ghost_ball import GhostBallOpponent
from snooker_env.tasks.options import Options
from snooker_env.tasks.plain_stroke import _REBOUND
from snooker_env.tasks.stroke import AIM, CUE_SPEED, ShotBuffers
from snooker_env.tasks.tables import I_FOULS, Crew

PLAYER = GhostBallOpponent()


def dealt(n, **options):
    """New frames at which player 0 is to play."""
    tables = Frames(Options(task="frame", aim="target", placement=True, decision=True, **options).rules, n)
    for k in range(n):
        tables.seed(k, np.random.default_rng(k))
    tables.deal(np.arange(n), drawn=False)
    return tables


def turn(tables, which=None):
    """One stroke of "ghost_ball" on each of the tables: its fouls (n,) and the buffers."""
    which = np.arange(tables.n) if which is None else which
    buffers, out = ShotBuffers(len(which)), tables.output()
    tables.complete(PLAYER.prepare(tables, which, None, buffers), out, buffers, Crew(buffers), own=True)
    return out.counts[which, I_FOULS], buffers


@pytest.mark.parametrize("noise", ["none", "professional", "club"])
def test_it_breaks_off_without_a_foul_and_brings_the_cue_ball_back(noise):
    tables = dealt(300, noise=noise)
    fouls, _ = turn(tables)
    assert (fouls != 0).mean() < 0.02
    assert (tables.positions[:, CUE, 1] < BAULK_Y).mean() > 0.8
    assert 0.35 < (tables.positions[:, CUE, 0] < 0.0).mean() < 0.65 or noise == "none"


@pytest.mark.parametrize("noise", ["none", "professional"])
def test_it_escapes_from_most_snookers(noise):
    fouls, _ = turn(dealt(300, noise=noise, layout="snookered"))
    assert (fouls != 0).mean() < 0.1


def test_it_rarely_fouls_where_no_pot_is_on():
    tables, which, fouls, many = dealt(60, noise="professional"), np.arange(60), 0, 0
    while len(which):
        without = [not (tables.game[k, IN_HAND] or len(pots(tables.positions[k], tables.on_table[k], tables.on(k)))) for k in which]
        found, _ = turn(tables, which)
        fouls, many = fouls + np.sum(found[without] != 0), many + sum(without)
        which = which[~tables.ended()[which]]
    assert many > 200 and fouls / many < 0.08


def test_in_hand_without_a_pot_it_stands_where_it_sees_a_ball_on():
    """It stood on the brown's spot, two micrometres from the brown, and saw no red."""
    tables = dealt(1)
    tables.positions[0, 5], tables.on_table[0, 6:16] = (0.0, 1.7), False
    tables.game[0, SAVED] = 0
    fouls, _ = turn(tables)
    assert fouls[0] == 0


def test_the_rebound_is_that_of_the_simulator():
    for row, degrees in zip(_REBOUND[:9], range(0, 90, 10), strict=True):
        normal, along = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        v, w = sn.strike(speed=2.0, aim=np.radians(degrees), top=0.4)
        start = HALF_WIDTH - BALL_RADIUS - 0.2 * normal, 0.4 - 0.2 * along
        shot = sn.simulate([start], [v[:2]], [w])
        first, rolls = shot.events["time"][:2]
        (at,), (before,), _ = shot.at(first - 1e-9)
        (on,), (after,), _ = shot.at(rolls + 1e-9)
        speed = np.hypot(*before)
        found = (-after[0] / speed, after[1] / speed, (at - on)[0] / speed**2, (on - at)[1] / speed**2)
        assert found == pytest.approx(row, abs=2e-3)


def snookered_again(n, failures):
    """Tables with one and the same snooker, as after "replace"."""
    tables = dealt(n, layout="snookered", miss="clear_path")
    tables.positions[:], tables.on_table[:], tables.game[:] = tables.positions[0], tables.on_table[0], tables.game[0]
    tables.game[:, SAVED], tables.game[:, FAILURES] = failures > 0, failures
    return tables


def test_its_strokes_from_one_position_differ():
    """Otherwise two exact players could repeat one failing stroke for ever."""
    for failures in (0, 1):
        _, buffers = turn(snookered_again(20, failures))
        assert np.ptp(buffers.shots[:, CUE_SPEED]) > 0.1 and len(set(buffers.shots[:, AIM].tolist())) == 20
    first, again = (turn(snookered_again(100, failures))[1].shots[:, AIM] for failures in (0, 1))
    assert np.ptp(again) > 2.0 * np.ptp(first)  # after a failure, other windows as well


def test_a_ball_on_that_it_touches_is_played_away_from():
    tables = dealt(1)
    positions, on_table = SPOTS.copy(), np.zeros(N_BALLS, bool)
    on_table[[CUE, 1, YELLOW, BLACK]] = True
    positions[CUE], positions[1] = (0.3, 0.3), (0.3 + 2 * BALL_RADIUS, 0.3)
    tables.positions[0], tables.on_table[0], tables.game[0, IN_HAND] = positions, on_table, 0
    fouls, buffers = turn(tables)
    assert fouls[0] == 0 and np.cos(buffers.shots[0, AIM]) < -0.8 and np.array_equal(tables.positions[0, 1], positions[1])


def test_a_constant_action_that_always_replaces_wins_few_frames():
    """Softly along the potting line, "replace" after every foul: it won 77 of 100 frames, while "ghost_ball" struck at random."""
    options = {"task": "frame", "aim": "target", "decision": True, "miss": "clear_path", "opponent": "ghost_ball"}
    tables = sn.SnookerVectorEnv(100, threads=1, **options)
    tables.reset(seed=0)
    action, won, over = np.tile([-0.7, 0.0, 0.0, 0.0, 1.0], (100, 1)), 0, np.zeros(100, bool)
    while not over.all():
        _, _, terminated, truncated, info = tables.step(action)
        fresh = (terminated | truncated) & ~over
        won += int((info["winner"][fresh] == 0).sum())
        over |= fresh
    assert won < 25


def test_the_fouls_that_it_counts_are_fouls():
    """The measure above is not blind: a stroke at nothing is a foul."""
    tables = dealt(1, layout="snookered")
    buffers, out = ShotBuffers(1), tables.output()
    tables.address(np.zeros(1, np.int64), np.array([[-0.9, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]]), buffers)
    tables.complete(np.zeros(1, np.int64), out, buffers, Crew(buffers), own=True)
    assert out.counts[0, I_FOULS] & (Foul.WRONG_FIRST | Foul.NO_CONTACT)
