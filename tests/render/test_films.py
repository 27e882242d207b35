"""Does a film show the shot?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import CUE, SPOTS
from snooker_env.geometry import BALL_RADIUS
from snooker_env.render.pygame_view import View, rgb_array
from snooker_env.render.scene import LEAD, TURN_STEP, Film, find_contacts, scene, turns_of


@pytest.fixture(scope="module")
def pot():
    """The cue ball from the middle of the table pots the one red in the middle right pocket."""
    return sn.simulate([(0.2, 0.0), (0.7, 0.0)], [(1.2, 0.0), (0.0, 0.0)], np.zeros((2, 3)))


def test_film_of_a_shot(pot):
    assert pot.potted[1] == sn.POCKETS.index("middle right")
    film = list(Film("match", pot, text="pot").scenes(50, 2.0))
    assert len(film) == int(np.ceil(pot.duration * 25)) + 1
    assert [len(s.ids) for s in film] == sorted([len(s.ids) for s in film], reverse=True)
    drop = pot.events["time"][pot.events["kind"] == sn.EventKind.POT][0]
    for k, s in enumerate(film[:-1]):
        assert s.ids.tolist() == ([CUE, 1] if k * 0.04 < drop else [CUE]) and s.text == "pot"
        assert np.array_equal(s.positions[0], pot.at(k * 0.04)[0][0])
        assert not s.paths or np.array_equal(s.paths[CUE][-1], s.positions[0])
    assert np.array_equal(film[-1].positions[0], pot.positions[0])
    assert film[0].paths == {} and film[-1].paths.keys() == {CUE, 1}


def test_a_cue_comes_to_the_ball_goes_through_it_and_fades(pot):
    strike = {"speed": 1.2, "aim": 0.0, "elevation": 0.1}
    film = Film("match", pot, strike=strike)
    shown = list(film.scenes(50, 2.0))
    lead = round(LEAD / 0.04)
    assert len(shown) == int(np.ceil(pot.duration * 25)) + 1 + lead
    assert all(np.array_equal(s.positions, shown[lead].positions) for s in shown[:lead])
    pulls = [s.cue.pull for s in shown[: lead + 1]]
    assert max(pulls[1:-2]) > 0.08 > pulls[-2] and pulls[-1] == 0.0
    after = [s.cue for s in shown if s.cue][lead:]
    assert [cue.alpha for cue in after] == sorted((cue.alpha for cue in after), reverse=True)
    assert after[-1].pull < 0.0 and shown[lead + len(after)].cue is None
    assert all(s.cue is None for s in Film("match", pot).scenes(10))
    view = View.of(sn.Table.preset("match"), (960, 540))
    column, row = np.rint(view(np.array([0.2 - 0.6, 0.0]))).astype(int)  # on the shaft
    red, green, _ = rgb_array(film.at(0.0), size=(960, 540))[row, column]
    assert red > green > rgb_array(film.at(1.0), size=(960, 540))[row, column][0]


def test_the_film_of_a_shot_shows_the_balls_of_the_shot():
    pool = sn.Table.preset("pool9")
    end = sn.simulate([(0.0, 0.0)], [(0.5, 0.0)], [(0.0, 0.0, 0.0)], pool, {"R": pool.ball_radius})
    assert {one.ball_radius for one in Film(pool, end).scenes(5)} == {pool.ball_radius}
    small = sn.simulate([(0.0, 0.0)], [(0.5, 0.0)], [(0.0, 0.0, 0.0)], None, {"R": 0.02})
    assert {one.ball_radius for one in Film(None, small).scenes(5)} == {0.02}
    assert scene("match", SPOTS).ball_radius == scene(None, SPOTS).ball_radius == BALL_RADIUS


def test_contacts_and_ghosts_are_where_the_cue_ball_met_others(pot):
    (places, times), (others, _) = find_contacts(pot), find_contacts(pot, 1)
    assert places == pytest.approx(np.array([(0.7 - 2 * BALL_RADIUS, 0.0)]), abs=1e-6)
    assert others == pytest.approx(np.array([(0.7, 0.0)]), abs=1e-6)
    alone = sn.simulate([(0.0, 0.0)], [(0.5, 0.0)], [(0.0, 0.0, 0.0)])
    assert find_contacts(alone)[0].shape == (0, 2)
    film = Film("match", pot)
    assert times == pot.events["time"][pot.events["kind"] == sn.EventKind.BALL_BALL][:1]
    for t, count in [(0.0, 0), (times[0] - 1e-6, 0), (times[0], 1), (pot.duration, 1)]:
        assert np.array_equal(film.at(t).ghosts, places[:count])


@pytest.mark.slow
def test_a_ball_that_rolls_and_spins_turns_about_both():
    """Against a marked point of it, carried along in tiny steps: p' = w x p."""
    R = BALL_RADIUS
    shot = sn.simulate([(0.0, 0.0)], [(0.5, 0.3)], [(-0.3 / R, 0.5 / R, 25.0)], None)
    end, steps = 1.2, 60_000
    spins = shot.at((np.arange(steps) + 0.5) * end / steps)[2][:, CUE] * end / steps
    point = np.array([0.0, 0.0, 1.0])
    for w in spins:
        middle = point + np.cross(w, point) / 2
        point = point + np.cross(w, middle)
    assert turns_of(shot)[round(end / TURN_STEP)] @ (0.0, 0.0, 1.0) == pytest.approx(point, abs=2e-4)
