"""Does a stroke tried on a copy of a frame lead to what the frame itself would, by the same referee?"""

import numpy as np
import pytest

from snooker_env.game import frame_columns as columns
from snooker_env.planning import Planner, Positions
from snooker_env.planning.trials import FrameTrials, turn_to_striker
from snooker_env.players import Strokes
from snooker_env.tasks.frames import Frames, Seat
from snooker_env.tasks.options import Options
from snooker_env.tasks.threads import Threads
from tests.kernels import from_python

GAME = {"task": "frame", "miss": "clear_path", "fidelity": "fast", "elevation": True, "placement": True}
choose = from_python(columns.choose)


def frames_in_play(n, options, strokes, seed=0):
    """n frames after some random strokes of both, each with a stroke to play."""
    rules = Options(**options).rules
    tables, crew, rng = Frames(rules, n, seats=[Seat.of(rules)] * 2), Threads(1), np.random.default_rng(seed)
    for k in range(n):
        tables.seed(k, np.random.default_rng(seed + k))
    tables.deal(np.arange(n), drawn=True, breakers=np.arange(n) % 2)
    for _ in range(strokes):
        play(tables, random_strokes(n, rng), crew)
    tables.game[:, columns.PHASE] = np.minimum(tables.game[:, columns.PHASE], columns.CHOICE)
    for k in np.flatnonzero(tables.game[:, columns.PHASE] == columns.CHOICE):
        choose(tables.game[k], columns.PLAY)
    return tables


def play(tables, values, crew):
    """One turn of the strikers with these strokes (n, 5)."""
    parts = Strokes(values).parts
    tables.turn(lambda which, b: tables.carry_out(which, parts, b, 0), tables.output(), crew)


def random_strokes(n, rng):
    strokes = np.zeros((n, 5))
    strokes[:, 0], strokes[:, 3] = rng.uniform(0.5, 6.0, n), rng.uniform(-np.pi, np.pi, n)
    strokes[:, 1:3] = rng.uniform(-0.3, 0.3, (n, 2))
    return strokes


def positions_of(tables):
    return Positions(
        tables.positions.copy(),
        tables.on_table.copy(),
        np.ascontiguousarray(turn_to_striker(Positions(tables.positions, tables.on_table, tables.game)).game),
        columns.Layouts(tables.layouts_before.positions.copy(), tables.layouts_before.on_table.copy()),
    )


@pytest.mark.parametrize(("miss", "cue"), [("off", "free"), ("clear_path", "real"), ("attempt", "free")])
def test_a_trial_leads_to_what_the_frame_itself_would(miss, cue):
    options = GAME | {"miss": miss, "cue": cue}
    tables = frames_in_play(40, options, strokes=7)
    at, striker = positions_of(tables), tables.game[:, columns.STRIKER].copy()
    strokes = random_strokes(40, np.random.default_rng(5))
    trials = FrameTrials(Options(**options).rules, Threads(1))
    before = at.copy()
    after = trials.play(at, np.arange(40), strokes, np.zeros((40, 5)))
    for name in ("positions", "on_table", "game"):
        assert np.array_equal(getattr(at, name), getattr(before, name)), "the positions tried on have changed"
    going = tables.game[:, columns.OVER] == 0
    play(tables, strokes, Threads(1))
    assert np.array_equal(after.positions, tables.positions)
    assert np.array_equal(after.on_table, tables.on_table)
    # seen by the striker, who was player 0 in the trial
    real = turned_to(tables.game, striker)
    real[:, [columns.STROKES, columns.STEPS]] = after.game[:, [columns.STROKES, columns.STEPS]]
    assert np.array_equal(after.game[going], real[going])
    assert (after.game[:, columns.SCORE_1] > before.game[:, columns.SCORE_1]).any(), "no foul among them"


def turned_to(game, striker):
    """Rows of frames with ``striker`` (n,) as player 0."""
    return np.where(striker[:, None] == 1, columns.swap_sides(game), game)


def test_in_a_visit_it_scores_as_the_planner_says():
    options = {"noise": "club", "fidelity": "fast"}
    tables = frames_in_play(30, GAME, strokes=3, seed=3)
    at, rng = positions_of(tables), np.random.default_rng(1)
    strokes, errors = random_strokes(30, rng), rng.standard_normal((30, 5))
    outcomes = Planner(options, threads=1).play_strokes(at.as_visits(), np.arange(30), strokes, errors=errors)
    trials = FrameTrials(Options(**GAME | {"noise": "club"}).rules, Threads(1))
    after = trials.play(at, np.arange(30), strokes, errors)
    scored = after.game[:, columns.SCORE_0] - at.game[:, columns.SCORE_0]
    assert np.array_equal(scored, outcomes.points)
    goes_on = (after.game[:, columns.STRIKER] == 0) & (after.game[:, columns.PHASE] == columns.STROKE)
    assert np.array_equal(goes_on, outcomes.goes_on)
    still = outcomes.goes_on
    assert np.array_equal(after.positions[still], outcomes.afterstates.positions[still])
