"""Is each frame of a tournament played and counted as it should be, from both sides of the table?"""

from functools import partial

import pytest

import snooker_env as sn
from agents.evaluation import tournament_play
from agents.evaluation.tournament_figures import COLUMNS
from agents.evaluation.tournament_play import TimedPlayer, play_pair
from snooker_env import SnookerVectorEnv
from snooker_env.players import SeenPlayer
from snooker_env.tasks.stroke import FOULS, PLAYER, SCORED
from tests.agents.user_players import Softly

GAME = {"noise": "professional", "max_strokes": 1000}


softly, ghost_ball = partial(SeenPlayer, Softly()), partial(sn.player, "ghost_ball")


def frames(rows):
    """Each row by column."""
    return [dict(zip(COLUMNS, row, strict=True)) for row in rows]


def exchanged(row):
    """Whether the second player was the agent: it opens on even seeds."""
    return row["opener"] != row["seed"] % 2


def in_order(rows):
    """The rows as they are played on one table."""
    return sorted(rows, key=lambda r: (exchanged(r), r["seed"], r["frame"]))


def play(first, second, seeds, *, best_of=1, threads=1, **game):
    """The rows of two players who are made anew."""
    players = TimedPlayer(first), TimedPlayer(second)
    return play_pair((0, 1), players, GAME | game, list(seeds), best_of, threads)


@pytest.fixture
def strokes(monkeypatch):
    """All strokes on one table: (player, points, fouls) each, as the referee judged them."""
    seen = []

    class SeenTables(SnookerVectorEnv):
        def __init__(self, *arguments, **more):
            super().__init__(*arguments, **more)
            self._crew.watch = lambda k, b, j, own: seen.append(b.seen[j, [PLAYER, SCORED, FOULS]].tolist())

    monkeypatch.setattr(tournament_play, "SnookerVectorEnv", SeenTables)
    monkeypatch.setattr(tournament_play, "TABLES", 1)
    return seen


@pytest.mark.parametrize("miss", ["off", "clear_path"])
def test_what_is_counted_is_what_the_referee_saw(strokes, miss):
    rows = frames(play(ghost_ball(), softly(), [3, 4, 5], miss=miss))
    assert len(rows) == 6 and [r["opener"] for r in rows] == [0, 1] * 3
    for r in in_order(rows):
        many = r["strokes_first"] + r["strokes_second"]
        mine, strokes[:] = strokes[:many], strokes[many:]
        names = ("second", "first") if exchanged(r) else ("first", "second")
        assert names[mine[0][0]] == ("first", "second")[r["opener"]]  # who breaks
        for side, name in enumerate(names):
            visits, before = [], None
            for player, points, _ in mine:
                if player == side and (before is None or before[0] != side or before[1] == 0):
                    visits.append(0)
                if player == side:
                    visits[-1] += points
                before = player, points
            assert r[f"scored_{name}"] == sum(visits) and r[f"visits_{name}"] == len(visits)
            assert r[f"best_{name}"] == max(visits)
            assert r[f"strokes_{name}"] == sum(player == side for player, _, _ in mine)
            assert r[f"fouls_{name}"] == sum(player == side and fouls != 0 for player, _, fouls in mine)
        if miss == "off":
            assert r["winner"] == int(r["points_second"] > r["points_first"])
    assert not strokes and sum(r["fouls_first"] for r in rows) > 0 < sum(r["best_second"] for r in rows)


@pytest.mark.slow
def test_rows_depend_neither_on_threads_nor_on_how_many_tables_there_are(monkeypatch):
    seeds = range(20, 28)
    want = play(ghost_ball(), softly(), seeds)
    for tables, threads in ((5, 1), (16, 2)):
        monkeypatch.setattr(tournament_play, "TABLES", tables)
        assert play(ghost_ball(), softly(), seeds, threads=threads) == want
    assert play(ghost_ball(), softly(), list(seeds)[3:5]) == want[6:10]


@pytest.mark.slow
@pytest.mark.parametrize("second", [ghost_ball, softly, partial(sn.player, "best_pot_8")])
def test_the_order_of_the_players_does_not_matter(second):
    """Both are the agent in one frame on each seed."""
    one = frames(play(ghost_ball(), second(), range(4)))
    other = frames(play(second(), ghost_ball(), range(4)))
    turned = sorted(other, key=lambda r: (r["seed"], 1 - r["opener"]))
    for a, b in zip(one, turned, strict=True):
        assert (a["seed"], a["opener"], a["winner"]) == (b["seed"], 1 - b["opener"], 1 - b["winner"])
        for name in COLUMNS[6:]:
            if name == "luck":
                assert a[name] == -b[name]
                continue
            side = {"first": "second", "second": "first"}[name.rpartition("_")[2]]
            assert a[name] == b[f"{name.rpartition('_')[0]}_{side}"], name
    assert len({(r["points_first"], r["points_second"]) for r in one}) > 4


@pytest.mark.slow
def test_the_frames_of_a_match_are_broken_in_turn(strokes):
    rows = frames(play(ghost_ball(), softly(), [0, 1, 2], best_of=3))
    matches = {}
    for r in in_order(rows):
        first, strokes[:] = strokes[0], strokes[r["strokes_first"] + r["strokes_second"] :]
        assert (first[0] + exchanged(r)) % 2 == (r["opener"] + r["frame"]) % 2
        matches.setdefault((r["seed"], r["opener"]), []).append(r["winner"])
    assert len(matches) == 6 and {len(won) for won in matches.values()} <= {2, 3}
    for won in matches.values():
        assert max(won.count(0), won.count(1)) == 2 and won.count(won[-1]) == 2  # it ends when it is decided
    alone = frames(play(ghost_ball(), softly(), [0, 1, 2]))
    assert [r for r in rows if r["frame"] == 0] == alone
