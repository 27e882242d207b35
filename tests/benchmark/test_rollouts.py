"""Is every stroke of a visit kept and counted as it was, on the same tables for everyone?"""

import numpy as np
import pytest

import snooker_env as sn
from agents import evaluate
from snooker_env.benchmark import HELD_OUT_SEED, play_visits, rollouts
from snooker_env.benchmark.rollouts import FIGURES, PlayedStrokes, counts, summary
from snooker_env.benchmark.tasks import tables_of
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.game.balls import BallOn
from snooker_env.game.banks import HELD_OUT


class Watched:
    """A player that keeps how the tables stood before its first stroke."""

    def __init__(self, name):
        self.player, self.start = sn.player(name), []

    def at(self, rules):
        self.player = self.player.at(rules)
        return self

    def play(self, positions, seeds):
        self.start.append((positions.positions, positions.on_table))
        return self.player.play(positions, seeds)


def strokes(**columns):
    """``PlayedStrokes`` of these columns, with nothing in the others."""
    n = len(columns["visit"])
    usual = {"cleared": np.zeros(n, bool), "cue": np.zeros((n, 2)), "tolerance": np.zeros(n)}
    arrays = {name: np.array(column) for name, column in columns.items()}
    return PlayedStrokes(visits=max(columns["visit"]) + 1, decision_seconds=0.0, **usual | arrays)


def test_counts_of_a_visit_by_hand():
    """Two visits: red, black, red with nothing after; then a miss."""
    s = strokes(
        visit=[0, 1, 0, 0, 0],
        number=[0, 0, 1, 2, 3],
        points=[1.0, 0, 7, 1, 0],
        foul=[False, False, False, False, True],
        ball_on=[BallOn.RED, BallOn.RED, BallOn.ANY_COLOUR, BallOn.RED, 0],
        tolerance=[1e-2, 0, 1e-3, 1e-2, 0],
    )
    assert s.following.tolist() == [2, -1, 3, 4, -1]
    first = {"points": 9, "pots": 3, "strokes": 4, "fouls": 1, "goes_on": 3, "followed": 2, "easy": 2}
    first |= {"colours": 1, "colour_points": 7, "high": 1, "reds": 2, "high_after_red": 1, "visits": 1}
    wanted = {name: [first.get(name, 0), int(name in ("strokes", "visits"))] for name in counts(s)}
    assert {name: values.tolist() for name, values in counts(s).items()} == wanted
    assert set(wanted) == {*first, "clearances", "centuries", "maximums"}
    means = {"points_a_visit": 4.5, "pots_a_visit": 1.5, "next_pot_after_a_pot": 2 / 3, "high_colours": 1.0}
    assert {name: summary(s)[name] for name in means} == pytest.approx(means)


def a_clearance_a_foul_and_a_miss():
    """The last ball goes in for a century (points as no shot brings them); it goes in by a foul; it stays."""
    return strokes(
        visit=[0, 1, 2, 0],
        number=[0, 0, 0, 1],
        points=[95.0, 0, 0, 7],
        foul=[False, True, False, False],
        ball_on=[BallOn.ANY_COLOUR, BallOn.BLACK, BallOn.BLACK, BallOn.BLACK],
        cleared=[False, True, False, True],
    )


def test_a_foul_clears_no_table():
    c, f = counts(a_clearance_a_foul_and_a_miss()), summary(a_clearance_a_foul_and_a_miss())
    assert c["clearances"].tolist() == c["centuries"].tolist() == [1, 0, 0]
    assert f["clearances"] == f["centuries"] == pytest.approx(1 / 3)


def test_centuries_and_maximums():
    s = a_clearance_a_foul_and_a_miss()
    for points, century, maximum in ((99, 0, 0), (100, 1, 0), (146, 1, 0), (147, 1, 1)):
        s.points[0] = points - s.points[-1]
        c = counts(s)
        assert c["centuries"].tolist() == [century, 0, 0] and c["maximums"].tolist() == [maximum, 0, 0]


def test_counts_agree_with_the_summary():
    s = play_visits("ghost_ball", 60, noise="professional")
    for strokes in (s, a_clearance_a_foul_and_a_miss()):
        c, f = counts(strokes), summary(strokes)
        for name in str.split(
            "points_a_visit pots_a_visit fouls_a_visit pot_rate next_pot_after_a_pot colour_value "
            "high_colours centuries clearances"
        ):
            above, below = FIGURES[name]
            assert c[above].sum() / c[below].sum() == pytest.approx(f[name])
    c, f = counts(s), summary(s)
    # a visit ends with its first miss
    assert f["next_pot_after_a_pot"] > 0.4 and np.all(c["strokes"] - c["pots"] == 1 - c["clearances"])


def test_the_cue_balls_place_is_kept_unless_it_was_potted(monkeypatch):
    after = []

    class Kept(SnookerVectorEnv):
        def step(self, actions):
            outcome = super().step(actions)
            after.append((self.tables.positions[:, 0].copy(), self.tables.on_table[:, 0].copy()))
            return outcome

    monkeypatch.setattr(rollouts, "SnookerVectorEnv", Kept)
    s = play_visits("random", 200, noise="club")
    places, stayed = (np.stack(column)[s.number, s.visit] for column in zip(*after, strict=True))
    assert 0 < (~stayed).sum() < s.foul.sum()
    assert np.isnan(s.cue[~stayed]).all() and np.array_equal(s.cue[stayed], places[stayed])


USUAL = {"layout": "held_out", "noise": "professional", "fidelity": "standard", "physics": "paper"}


@pytest.mark.parametrize(
    "change",
    [{}, {"layout": "colours"}, {"noise": "club"}, {"fidelity": "fast"}, {"physics": "match"}, {"seeds": 7}],
)
def test_an_agent_is_played_under_its_condition(change):
    """Stroke by stroke as ``play_visits`` plays it there; and what is changed changes the play."""
    condition, seeds = USUAL | change, list(range(change.get("seeds", 3), 33))[:20]
    condition.pop("seeds", None)
    outcome = evaluate.play_agent(evaluate.Entrant("a", ("ghost_ball",)), condition, seeds, 100)
    wanted = play_visits("ghost_ball", 20, first_seed=seeds, **condition)
    usual = play_visits("ghost_ball", 20, first_seed=list(range(3, 23)), **USUAL)
    (strokes,) = outcome.strokes
    for name in ("visit", "number", "points", "foul", "ball_on", "cleared", "cue", "tolerance"):
        assert np.array_equal(getattr(strokes, name), getattr(wanted, name), equal_nan=name == "cue"), name
    assert outcome.counted["points"].tolist() == [wanted.a_visit(wanted.points).tolist()]
    assert np.array_equal(strokes.cue, usual.cue, equal_nan=True) == (not change)


@pytest.mark.parametrize("layout", ["held_out", "line_up", "colours"])
def test_everyone_starts_from_the_same_tables(layout):
    seeds, starts = tables_of(layout, 12), []
    for name, noise, fidelity in (("ghost_ball", "none", "fast"), ("random", "club", "standard")):
        watched = Watched(name)
        play_visits(watched, 12, layout=layout, noise=noise, fidelity=fidelity, first_seed=seeds)
        starts.append(watched.start[0])
    for positions, on_table in starts[1:]:
        assert np.array_equal(positions, starts[0][0]) and np.array_equal(on_table, starts[0][1])


def test_no_table_comes_twice_or_mirrored():
    seeds = tables_of("held_out", 300)
    assert seeds == sorted(set(seeds)) and seeds[0] == HELD_OUT_SEED
    tables = SnookerVectorEnv(300, layout="held_out")
    tables.reset(seed=seeds)
    reds = np.sort(np.abs(tables.tables.positions[:, 1:16, 0]), axis=1)
    apart = np.abs(reds[:, None] - reds[None]).max(axis=2) + np.eye(300)
    assert apart.min() > 1e-6
    with pytest.raises(ValueError, match=f"visits = {100 * HELD_OUT}: must be at most {HELD_OUT} "):
        tables_of("held_out", 100 * HELD_OUT)
