"""Does a planner say where every ball stopped?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import POCKET_PLACES
from snooker_env.planning import Planner, Position, actions_of
from snooker_env.tasks import stroke

REDS = [(0.3, 0.5), (-0.3, 0.7), (0.1, 1.0)]
POSITION = Position(cue=(0.25, -0.4), reds=REDS, blue=(0.0, 0.0), black=(0.0, 1.4605))
AIMS = np.linspace(-3.0, 3.0, 60)
ACTIONS = actions_of(np.linspace(1.0, 6.0, 60), AIMS)


def test_stops_agree_with_outcomes():
    planner = Planner({"noise": "club"})
    keys = np.arange(60)
    asked = POSITION, np.zeros(60, int), ACTIONS, keys
    outcomes, stops = planner.play(*asked), planner.stops(*asked)
    assert planner.shots == 120
    assert np.array_equal(outcomes.points, stops.points) and np.array_equal(outcomes.goes_on, stops.goes_on)
    for name in ("positions", "on_table", "game"):
        assert np.array_equal(getattr(outcomes.afterstates, name), getattr(stops.afterstates, name))
    assert ((stops.penalty > 0) & (stops.points == 0)).any() and (stops.penalty == 0).any()
    assert not stops.points[stops.penalty > 0].any()
    present = POSITION.arrays()[1]
    moved = present[None] & (stops.potted < 0)
    reds = moved[:, 1:16]
    # colours may be respotted, reds not
    assert np.array_equal(stops.places[:, 1:16][reds], stops.afterstates.positions[:, 1:16][reds])
    assert np.array_equal(moved[:, 0], stops.afterstates.on_table[:, 0]) and (~moved[:, 0]).any()


def test_a_colour_that_was_potted_lies_in_its_pocket_and_not_on_its_spot():
    position = Position(cue=(0.3, 1.1), reds=[(-0.5, 0.0)], black=(0.0, 1.4605), on="any_colour")
    planner = Planner({"action": "discrete"})
    stops = planner.stops(position, [0], [67])
    pocket = int(stops.potted[0, 21])
    assert stops.points[0] == 7 and stops.first[0] == 21 and stops.goes_on[0]
    assert np.hypot(*(stops.places[0, 21] - POCKET_PLACES[pocket])) < 0.1
    assert stops.afterstates.positions[0, 21].tolist() == [0.0, 1.4605]


def test_stops_are_those_of_the_shot_simulated_by_itself():
    stops = Planner({}).stops(POSITION, np.zeros(60, int), ACTIONS)
    places, present, _ = POSITION.arrays()
    balls = np.flatnonzero(present)
    for k in range(0, 60, 7):
        speed = 0.2 + 0.5 * (float(ACTIONS[k, 0]) + 1.0) * 6.8
        v, w = sn.strike(speed, np.pi * float(ACTIONS[k, 3]))
        velocities, spins = np.zeros((len(balls), 2)), np.zeros((len(balls), 3))
        velocities[0], spins[0] = v[:2], w
        shot = sn.simulate(places[balls], velocities, spins)
        assert np.array_equal(shot.potted, stops.potted[k, balls])
        assert np.allclose(shot.positions, stops.places[k, balls], atol=1e-9)
        hits = shot.events[(shot.events["kind"] == sn.EventKind.BALL_BALL) & (shot.events["i"] == 0)]
        assert stops.first[k] == (balls[hits["j"][0]] if len(hits) else -1)


def test_a_log_that_is_too_short_is_enlarged(monkeypatch):
    """The same stops with room for three events at first as with room for 512."""
    original, runs = stroke.ShotBuffers.__init__, []
    for log in (512, 3):
        with monkeypatch.context() as patch:
            first = lambda self, m, n=log, **more: original(self, m, n, **more)  # noqa: E731
            patch.setattr(stroke.ShotBuffers, "__init__", first)
            runs.append(Planner({}).stops(POSITION, np.zeros(60, int), ACTIONS))
    assert np.array_equal(runs[0].places, runs[1].places) and np.array_equal(runs[0].potted, runs[1].potted)


@pytest.mark.parametrize("threads", [1, 3])
def test_any_number_of_threads_gives_the_same(threads):
    asked = POSITION, np.zeros(60, int), ACTIONS, np.arange(60)
    mine, other = (Planner({"noise": "club"}, threads=t).stops(*asked) for t in (2, threads))
    assert np.array_equal(mine.places, other.places) and np.array_equal(mine.first, other.first)
