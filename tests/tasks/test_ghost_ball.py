"""Does the opponent "ghost_ball" play sensibly where it has no pot?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import frame_columns as columns
from snooker_env.game.balls import CUE
from snooker_env.game.pots import pots
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, HALF_WIDTH
from snooker_env.players.opponents import opponent_of
from snooker_env.tasks.escapes import _REBOUND
from snooker_env.tasks.frames import AGENT, Frames, Seat
from snooker_env.tasks.options import Options
from snooker_env.tasks.stroke import AIM, CUE_SPEED, ShotBuffers
from snooker_env.tasks.tables import I_FOULS, I_POINTS, Crew
from tests.tables import begun


def dealt(n, **options):
    """New frames at which player 0 is to play."""
    game = Options(task="frame", aim="target", placement=True, says=["decision"], **options)
    seats = [Seat.of(game.rules, opponent_of("ghost_ball", game)), Seat.of(game.rules)]
    tables = Frames(game.rules, n, seats=seats)
    for k in range(n):
        tables.seed(k, np.random.default_rng(k))
    tables.deal(np.arange(n), drawn=False)
    return tables


def turn(tables, which=None):
    """One stroke of "ghost_ball" on each of the tables: its fouls and points (n,), and the buffers."""
    which = np.arange(tables.n) if which is None else which
    buffers, out = ShotBuffers(len(which)), tables.output()
    crew = Crew(buffers)
    asked = tables.seats[AGENT].player.strokes(tables, which, crew)
    struck = tables.carry_out(which, asked, buffers, AGENT)
    tables.complete(struck, out, buffers, crew, reported=True)
    return out.counts[which, I_FOULS], out.reals[which, I_POINTS], buffers


@pytest.mark.parametrize(
    ("noise", "fouled", "back"), [("none", 0.02, 0.8), ("professional", 0.04, 0.8), ("amateur", 0.07, 0.65)]
)
def test_it_breaks_off_without_a_foul_and_brings_the_cue_ball_back(noise, fouled, back):
    tables = dealt(1000, noise=noise)
    fouls, *_ = turn(tables)
    assert (fouls != 0).mean() < fouled
    assert (tables.positions[:, CUE, 1] < BAULK_Y).mean() > back
    assert 0.35 < (tables.positions[:, CUE, 0] < 0.0).mean() < 0.65 or noise == "none"


def test_it_rarely_fouls_where_no_pot_is_on():
    tables, which, fouls, many = dealt(120, noise="professional"), np.arange(120), 0, 0
    while len(which):
        lies = ((tables.positions[k], tables.on_table[k], tables.on(k)) for k in which)
        without = (tables.game[which, columns.IN_HAND] == 0) & [len(pots(*each)) == 0 for each in lies]
        found, *_ = turn(tables, which)
        fouls, many = fouls + np.sum(found[without] != 0), many + without.sum()
        which = which[~tables.are_over()[which]]
    assert many > 400 and fouls / many < 0.1


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
    for rows in (tables.positions, tables.on_table, tables.game):
        rows[:] = rows[0]
    tables.game[:, columns.SAVED], tables.game[:, columns.FAILURES] = failures > 0, failures
    return tables


def test_its_strokes_from_one_position_differ():
    """Otherwise two exact players could repeat one failing stroke for ever."""
    for failures in (0, 1):
        *_, buffers = turn(snookered_again(20, failures))
        assert np.ptp(buffers.shots[:, CUE_SPEED]) > 0.1 and len(set(buffers.shots[:, AIM].tolist())) == 20
    first, again = (turn(snookered_again(100, failures))[2].shots[:, AIM] for failures in (0, 1))
    assert np.ptp(again) > 2.0 * np.ptp(first)  # after a failure, other windows as well


@pytest.mark.parametrize(("speed", "most", "decision"), [(-0.7, 10, 1.0), (-0.4, 45, -1.0)])
def test_a_constant_action_wins_few_frames(speed, most, decision):
    """Softly along the target line it won 77 of 100 frames, while "ghost_ball" struck at random; harder
    strokes along that line pot balls and win 18 to 35."""
    options = {"task": "frame", "aim": "target", "says": ["decision"], "miss": "clear_path"}
    tables = begun(sn.SnookerVectorEnv(100, threads=1, opponent="ghost_ball", **options), 0)
    action, won, over = np.tile([speed, 0.0, 0.0, 0.0, decision], (100, 1)), 0, np.zeros(100, bool)
    while not over.all():
        _, _, terminated, truncated, info = tables.step(action)
        fresh = (terminated | truncated) & ~over
        won += int((info["winner"][fresh] == 0).sum())
        over |= fresh
    assert won < most


@pytest.mark.parametrize(
    ("options", "most"), [({"game": "shoot_out"}, 0.06), ({"game": "six_red", "miss": "clear_path"}, 0.05)]
)
def test_other_games_are_played_to_the_end_with_few_fouls(options, most):
    tables, which, fouls, placed, bad = dealt(60, noise="professional", **options), np.arange(60), [], 0, 0
    for _ in range(150):
        anywhere = (tables.game[which, columns.ANYWHERE] != 0) & (tables.game[which, columns.IN_HAND] != 0)
        found, *_ = turn(tables, which)
        fouls, placed = [*fouls, *found.tolist()], placed + anywhere.sum()
        bad += np.sum(found[anywhere] != 0)
        which = which[~tables.are_over()[which]]
        if not len(which):
            break
    assert not len(which) and np.mean(np.array(fouls) != 0) < most
    if options["game"] == "shoot_out":
        assert placed > 40 and bad / placed < 0.05  # from a place of its choice it hardly ever fouls


@pytest.mark.parametrize("layout", ["opened", "random:3", "random:15"])
def test_anywhere_it_stands_behind_an_easy_pot(layout):
    """It stood in the D, however far the reds were."""
    tables = dealt(100, layout=layout, game="shoot_out", noise="professional")
    tables.game[:, [columns.IN_HAND, columns.ANYWHERE]] = 1
    fouls, points, _ = turn(tables)
    assert (fouls != 0).mean() < 0.06 and (points > 0).mean() > 0.6


@pytest.mark.parametrize("opponent", ["ghost_ball", "random"])
def test_the_shot_clock_holds_for_every_opponent(opponent):
    """ "ghost_ball" struck whatever the time was."""
    env = sn.SnookerEnv(task="frame", game="shoot_out", time_to_play=12.0, opponent=opponent)
    env.reset(seed=1, options={"breaker": 0})
    env.tables.game[0, columns.CLOCK] = 400_000  # the second half: 10 s a stroke
    before = env.positions.copy()
    env.step([-1.0, 0.0, 0.0, -0.5])
    # nobody has struck anything
    assert env.frame.scores != (0, 0) and np.array_equal(env.positions[1:], before[1:])
