"""Is the worth of frames learned from what its targets say, and does an interrupted training go on?"""

from types import SimpleNamespace

import numpy as np
import pytest

import snooker_env as sn
from agents import learn_worth
from agents.learn_worth import main
from agents.learning import frame_self_play
from agents.learning.frame_self_play import frames
from agents.learning.frame_worth import TRACE, calibration, fit_network, fitted_chance, targets
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Positions, Ranked, Strokes
from snooker_env.planning.learned.dense_layers import Layers
from snooker_env.planning.learned.learned_worth import POINTS, SIZE, worth_of
from snooker_env.planning.trials import turn_to_striker
from snooker_env.planning.worth import SPREAD, Chance
from snooker_env.players import FRAMES
from snooker_env.players.search_player import Tactician
from snooker_env.tasks import LEVELS

SHARED = {"options": {"cue": "real", "miss": "clear_path", "max_strokes": 8}, "layers": None, "chance": None}
SHARED |= {"budget": 30, "explore": 0.2, "replies": False}
PART = {"noise": LEVELS["professional"].scale(2.0), "seed": 3, "many": 4, "other": None}


def test_a_target_is_the_search_and_what_followed():
    rows = {
        "worth": np.array([10.0, 6.0, -4.0]),
        "next": np.array([1, 2, -1]),
        "same": np.array([1, -1, 0]),
        "swing": np.array([1.0, 0.0, -4.0]),
        "explored": np.array([False, False, False]),
    }
    last = (1 - TRACE) * -4.0 + TRACE * -4.0
    middle = (1 - TRACE) * 6.0 + TRACE * (0.0 - last)
    first = (1 - TRACE) * 10.0 + TRACE * (1.0 + middle)
    assert targets(rows) == pytest.approx([first, middle, last])
    rows["explored"] = np.array([False, True, False])
    assert targets(rows)[1] == 6.0


def test_rows_of_a_frame_follow_each_other():
    rows = frames(SHARED, PART, 1)
    n = len(rows["worth"])
    assert rows["seen"].shape == rows["hand"].shape == (n, SIZE) and n > 20
    after, linked = rows["next"], rows["next"] >= 0
    assert (after[linked] > np.flatnonzero(linked)).all() and len(set(after[linked].tolist())) == linked.sum()
    assert (rows["frame"][after[linked]] == rows["frame"][linked]).all()
    same = rows["striker"][after[linked]] == rows["striker"][linked]
    assert np.array_equal(rows["same"][linked], np.where(same, 1, -1))
    sign = np.where(same, 1.0, -1.0)  # the lead goes on from stroke to stroke
    assert np.allclose(rows["lead"][linked] + rows["swing"][linked], sign * rows["lead"][after[linked]])
    again = frames(SHARED, PART, 1)
    assert all(np.array_equal(rows[name], again[name]) for name in rows)


@pytest.mark.slow
def test_what_strokes_may_leave_is_judged_beside_the_frames():
    rows, alone = frames(SHARED | {"replies": True}, PART, 1), frames(SHARED, PART, 1)
    played = rows["striker"] >= 0
    assert (~played).sum() > played.sum() > 20 and not played[played.sum() :].any()
    beside = {name: part[~played] for name, part in rows.items()}
    assert (beside["next"] == -1).all() and not beside["decided"].any()
    assert set(beside["frame"].tolist()) == {0, 1, 2, 3}
    assert np.array_equal(targets(rows)[~played], beside["worth"])  # nothing followed
    first = np.unique(rows["frame"][played], return_index=True)[1]
    assert np.array_equal(rows["seen"][first], alone["seen"][np.unique(alone["frame"], return_index=True)[1]])


def decided_at_the_break(noise):
    """A tactician, and what it does at a break-off."""
    env = sn.SnookerEnv(task="frame", noise=noise, **FRAMES)
    env.reset(seed=4)
    player = Tactician(30, (None, None)).at(env)
    return player, player.decide_frames(Positions.of(env), np.array([5]))


def test_a_case_that_a_stroke_may_leave_is_what_the_next_player_sees(monkeypatch):
    """Without errors a stroke leaves one position: that one is judged, as often as is asked."""
    player, decided = decided_at_the_break("none")
    tried = decided.tried[0]
    many = len(tried.strokes)
    left = player.judge.outcomes(
        decided.start, np.zeros(many, int), tried.strokes.values, np.zeros((many, 5))
    )
    k = np.flatnonzero(left.game[:, columns.STRIKER] == 1)[:1]  # a stroke after which the other comes
    decided.tried[0] = tried._replace(strokes=tried.strokes[k])
    left = turn_to_striker(left[k])
    judged, seen = frame_self_play._judge_strokes, []
    monkeypatch.setattr(
        frame_self_play, "_judge_strokes", lambda *args: seen.append(args[1]) or judged(*args)
    )
    replies, first = frame_self_play._replies(player, decided, np.array([0]), np.random.default_rng(0))
    hard = bool((tried.kinds > 0).any())
    assert hard and first.tolist() == [0] * frame_self_play.REPLIES[hard] and len(seen) == 1
    assert np.array_equal(seen[0].game, np.repeat(left.game, len(first), 0))
    assert np.array_equal(seen[0].positions, np.repeat(left.positions, len(first), 0))
    again = player.judge.worth.features_of(player.decide_frames(left, np.array([6])).start)
    assert np.array_equal(replies["seen"], np.repeat(again, len(first), 0))


@pytest.mark.parametrize("other", ["ghost_ball", (None, None)])
def test_of_a_frame_against_another_only_ones_own_strokes_are_learned_from(other):
    rows, alone = frames(SHARED, PART | {"other": other}, 1), frames(SHARED, PART, 1)
    assert (rows["striker"] == 0).all() and set(rows["frame"].tolist()) == {0, 1, 2, 3}
    linked = rows["next"] >= 0
    assert (rows["same"][linked] == 1).all()  # what the other scored lies between: the lead goes on
    assert np.allclose((rows["lead"] + rows["swing"])[linked], rows["lead"][rows["next"][linked]])
    first, mine = rows["frame"] == 0, alone["frame"] == 0  # nobody but oneself has played there yet
    assert rows["worth"][first][0] == alone["worth"][mine][0]


@pytest.mark.slow
def test_a_network_learns_what_it_is_told_beside_the_value():
    rng = np.random.default_rng(0)
    seen = rng.standard_normal((16_000, SIZE)).astype(np.float32)
    wanted = POINTS * (seen[:, -1] + 0.3 * seen[:, 3] - 0.2)
    layers = fit_network(seen, wanted, 0, 30)
    said = worth_of(Layers(layers, "relu"), seen)
    assert np.sqrt(np.mean((said - wanted) ** 2)) < 0.15 * np.std(wanted - POINTS * seen[:, -1])


def test_the_chance_to_win_is_that_of_the_frames():
    rng, n, law = np.random.default_rng(1), 80_000, Chance(5.0, 0.25, 0.2, 2.0, -0.5)
    now, left, worth = rng.normal(0.0, 40.0, n).round(), rng.uniform(1.0, 147.0, n), rng.normal(0.0, 15.0, n)
    spread, last = SPREAD * rng.choice([0.5, 1.0, 2.0], n), rng.random(n) < 0.1
    said = law(now, worth, left, last, spread)
    won = rng.random(n) < said
    chance = fitted_chance(now, worth, left, last, spread, won)
    assert chance.far == pytest.approx(0.25, rel=0.1) and chance.near == pytest.approx(5.0, rel=0.2)
    assert chance.needs == pytest.approx(2.0, rel=0.1) and chance.snookers == pytest.approx(0.2, rel=0.2)
    assert chance.errors == pytest.approx(-0.5, abs=0.05)
    table, error = calibration(chance(now, worth, left, last, spread), won)
    assert error < 0.01 and len(table) == 10
    out = np.abs(now) > left
    never = fitted_chance(now, worth, left, last, spread, np.where(out, now > 0.0, won))
    assert 2.0 < never.needs < 12.0 and never.snookers < 3.0  # the priors keep them finite
    assert calibration(np.full(n, 0.9), won)[1] > 0.2


@pytest.mark.slow
def test_frames_of_which_none_ends_are_refused(tmp_path, monkeypatch):
    """Nothing says who wins them."""
    short = {"cue": "real", "miss": "clear_path", "layout": "colours", "max_strokes": 3}
    monkeypatch.setattr(learn_worth, "FRAME", short)
    with pytest.raises(SystemExit):
        main(["--rounds", "2", "--frames", "16", "--budget", "30", "--out", str(tmp_path / "none")])


def test_a_teacher_is_heard_only_where_its_stroke_is_clearly_better():
    """What strokes bring: their speed, and as much of the error as their side; both meet the same errors."""
    mine, theirs = np.zeros((4, 5)), np.zeros((4, 5))
    mine[:, 0] = 2.0
    theirs[:, 0] = 2.1, 1.9, 2.1, 2.1  # better, worse, better by luck if at all, and not asked
    theirs[2, 1] = 0.5

    class Judge:
        chance, noise = None, LEVELS["none"]

        def gains(self, at, rows, strokes, errors):
            points = strokes[:, 0] + (1.0 + 10.0 * strokes[:, 1]) * errors[:, 0]
            return np.column_stack([np.zeros_like(points), points])

    class Teacher:
        def rank(self, at, seeds):
            return [Ranked(Strokes(theirs[[k]]), None) for k in at.tolist()]

    teacher, decided = (
        SimpleNamespace(search=Teacher()),
        SimpleNamespace(start=np.arange(4), strokes=Strokes(mine.copy())),
    )
    frame_self_play._teach(Judge(), teacher, decided, np.array([0, 1, 2]), np.random.default_rng(1))
    assert decided.strokes.values[:, 0].tolist() == [2.1, 2.0, 2.0, 2.0]


@pytest.mark.slow
def test_a_player_wins_all_frames_against_one_that_hardly_scores():
    share, error = frame_self_play.win_share(Tactician(30, (None, None)), sn.player("random"), 5, 4)
    assert share == 1.0 and error == 0.0


@pytest.mark.parametrize(("share", "shipped"), [(0.5, True), (0.4, False)])
def test_weights_that_lose_clearly_are_not_exported(share, shipped, tmp_path, monkeypatch):
    """The standard error is 0.04: at 0.4 an equal would be more than two of them away."""
    monkeypatch.setattr(learn_worth, "FOLDER", tmp_path)
    monkeypatch.setattr(learn_worth, "Loop", lambda *_: SimpleNamespace(run=lambda: None))
    monkeypatch.setattr(learn_worth.WorthRounds, "pack_weights", lambda self: b"weights")
    monkeypatch.setattr(learn_worth, "win_share", lambda *_: (share, 0.04))
    assert main(["--out", str(tmp_path / "run"), "--export"]) == (0 if shipped else 1)
    assert (tmp_path / learn_worth.WORTH).is_file() == shipped
    assert (tmp_path / "run" / learn_worth.WORTH).read_bytes() == b"weights"


@pytest.mark.parametrize(
    "wrong", [["--judged", "-1"], ["--against", "nobody"], ["--against", "planner", "--export"]]
)
def test_what_is_judged_against_whom_is_checked_before_the_work(wrong, tmp_path):
    with pytest.raises(SystemExit):
        main(["--out", str(tmp_path), *wrong])
