"""Does ``stroke_value`` choose well without a simulated shot, the same for one position or many?"""

import json
import shlex

import numpy as np
import pytest

import snooker_env as sn
import train
from agents.evaluation.visit_figures import summary
from agents.learning import learn_strokes
from snooker_env.benchmark import play_visits
from snooker_env.planning import Position, Positions
from snooker_env.planning.learned.frame_strokes import SIZE as FRAME_SIZE
from snooker_env.planning.learned.stroke_value import SIZE
from snooker_env.players import VISITS
from snooker_env.players.search_player import StrokeValuePlayer
from snooker_env.players.weights import FOLDER, STROKES, learned_strokes


def opened(n, **options):
    tables = sn.SnookerVectorEnv(n, layout="opened", noise="professional", **VISITS, **options)
    tables.reset(seed=list(range(25_000_000, 25_000_000 + n)))
    return tables


def test_without_a_pot_it_plays_as_ghost_ball():
    at = Position(cue=(-0.8, -1.7), reds=[(-0.8, 0.0)], green=(-0.8, -0.8), on="red")
    wanted = sn.player("ghost_ball").at({}).play(at, [3]).values
    player = sn.player("stroke_value").at({})
    assert np.array_equal(player.play(at, [3]).values, wanted)
    assert np.array_equal(player.rank(at, [3])[0].strokes.values, wanted)


@pytest.mark.slow
def test_it_makes_more_than_players_that_see_no_position():
    """On 96 tables that no training has met; the means have errors of about 2 and 0.7 points."""
    mine, other = (summary(play_visits(name, 96, layout="opened")) for name in ("stroke_value", "ghost_ball"))
    assert mine["points_a_visit"] > 3.0 * other["points_a_visit"]


@pytest.mark.slow
@pytest.mark.parametrize("frame_rounds", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_network_is_learned(tmp_path, capsys, frame_rounds):
    whole = tmp_path / "whole"
    settings = ["rounds=2", "tables=10", f"frame_rounds={frame_rounds}", "frames=10"]
    short = ["--agent", "stroke_value", "--set", *settings, "--eval-visits", "20"]
    assert train.main([*short, "--seed", "3", "--out", str(whole)]) == 0
    said = capsys.readouterr().out
    assert f"python -m snooker_env.watch --agent stroke_value@{whole / 'strokes.npz'}" in said
    results = json.loads((whole / "results.json").read_text())
    assert set(results["evaluation"]) == {"trained", "ghost_ball", "random"}
    # the strokes that were tried, those that were played, and decisions of the planner, of best_pot and of tactician_60
    assert results["steps"] < results["simulated_shots"] <= 3 * results["steps"]
    assert [len(results["curve"][of]) for of in ("visits", "frames")] == [2, frame_rounds]
    assert f"its teachers, the planner and the tactician: {results['simulated_shots']:,}." in said
    repeated = ["--agent", "stroke_value", "--seed", "3", "--set", *settings]
    assert shlex.split(results["command"]) == ["python", "train.py", *repeated]
    learned = learned_strokes(whole / "strokes.npz")
    at = Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    named = sn.player(f"stroke_value@{whole / 'strokes.npz'}").at({}).play(at, [3]).values
    assert np.array_equal(named, StrokeValuePlayer(learned).at({}).play(at, [3]).values)
    for layers, size in zip(learned, (SIZE, FRAME_SIZE), strict=True):
        assert layers[0][0].shape == (128, size) and layers[-1][0].shape == (1, 64)
    tables = opened(8)
    assert len(StrokeValuePlayer(learned).at(tables).play(tables, np.arange(8))) == 8


@pytest.mark.slow
def test_the_network_is_fitted_to_what_strokes_are_worth():
    rng = np.random.default_rng(1)
    seen = rng.normal(2.0, 3.0, (600, 6, SIZE)).astype(np.float32)
    worth = 4.0 * seen[..., 3] - 6.0 * np.maximum(seen[..., 5], 0.0)
    layers, figures = learn_strokes.fit_strokes(seen, worth, np.arange(600), 0, 60)
    assert figures["explained"] > 0.9 and figures["positions"] == 600
    from snooker_env.planning.learned.dense_layers import Layers

    seems = worth + 6.0 * seen[..., 7]
    more, figures = learn_strokes.fit_strokes(seen, worth, np.arange(600), 0, 60, seems)
    assert figures["explained"] > 0.9 and figures["worth_chosen"] > figures["worth_chosen_unlearned"] + 1.0
    added = learn_strokes.POINTS * Layers(more, "relu")(seen.reshape(-1, SIZE))[:, 0]
    assert np.corrcoef(added, -seen[..., 7].reshape(-1))[0, 1] > 0.9
    said = learn_strokes.POINTS * Layers(layers, "relu")(seen.reshape(-1, SIZE))[:, 0]
    assert np.corrcoef(said, worth.reshape(-1))[0, 1] > 0.95


def frames(n, **options):
    made = sn.SnookerVectorEnv(n, task="frame", **{"noise": "professional"} | options, **sn.players.FRAMES)
    made.reset(seed=3)
    return made


@pytest.mark.parametrize(
    "options",
    [
        {"game": "six_red", "miss": "attempt"},
        {"game": "shoot_out"},
        {"conditions": "drawn", "cue": "real"},
        {"noise": "none", "miss": "clear_path"},
    ],
    ids=str,
)
def test_it_plays_frames_under_all_options(options):
    frame = frames(12, **options)
    player, met = sn.player("stroke_value").at(frame), dict.fromkeys(("choice", "in_hand", "anywhere"), 0)
    assert len(player.play(Positions.of(frame)[[]], [])) == 0
    for k in range(20):
        at, keys = Positions.of(frame), np.arange(12) + 50 * k
        if at.over.any():
            break
        strokes, half = player.play(at, keys), [1, 4, 11]
        for part, whole in zip(player.play(at[half], keys[half]).parts, strokes.parts, strict=True):
            assert np.array_equal(part, whole[half], equal_nan=True)
        met = {name: many + int(getattr(at, name).sum()) for name, many in met.items()}
        frame.step(strokes.actions(frame.options, at))
    assert k > 10 and met["in_hand"] > 0
    assert (met["anywhere"] > 0) == (options.get("game") == "shoot_out")


def test_networks_that_are_none_are_refused(tmp_path):
    with np.load(FOLDER / STROKES) as kept:
        arrays = dict(kept)
    w = arrays["visits/0/weight"]
    cut = w[..., :-1], w[: len(w) // 2]
    for damaged in (w * np.nan, *cut, w.astype(np.int8), np.float32(1.0), np.array(["x"])):
        np.savez(tmp_path / "mine.npz", **arrays | {"visits/0/weight": damaged})
        with pytest.raises(ValueError, match=r"mine\.npz.*visits/0 = "):
            sn.player(f"stroke_value@{tmp_path / 'mine.npz'}")


@pytest.mark.parametrize("name", ["stroke_value@missing.npz", "stroke_value@README.md", "stroke_value_500"])
def test_a_network_that_is_not_there_is_refused(name):
    with pytest.raises(ValueError, match=rf"player = '{name}': must (name a strokes.npz|not name a number)"):
        sn.player(name)
