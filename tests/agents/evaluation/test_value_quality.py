"""Does the command compare a value with what really followed?"""

import json

import numpy as np
import pytest

import snooker_env as sn
from agents import value_quality
from snooker_env.benchmark import play_visits
from snooker_env.benchmark.tasks import tables_of


def test_every_position_is_compared_with_what_followed(monkeypatch):
    """By a value that knows the points of the visit so far: with what followed they are the visit's."""
    player = sn.player("search_30")
    seen = []
    original = value_quality.play_visits

    def watched(recording, *args, **options):
        strokes = original(recording, *args, **options)
        seen.append((strokes, np.concatenate(recording.rows)))
        return strokes

    monkeypatch.setattr(value_quality, "play_visits", watched)
    found = value_quality.quality(player, 120, "colours", "professional")
    ((strokes, rows),) = seen
    assert found["positions"] == len(strokes.points) == len(rows)
    followed = []
    for visit, so_far in zip(strokes.visit, rows[:, 0], strict=True):
        own = strokes.points[strokes.visit == visit]
        assert so_far in np.concatenate([[0], np.cumsum(own)])
        followed.append(own.sum() - so_far)
    assert found["followed"] == pytest.approx(np.mean(followed))
    assert found["rule"]["correlation"] == pytest.approx(np.corrcoef(rows[:, 2], followed)[0, 1])
    assert np.array_equal(rows[:, 1], rows[:, 2])  # its value is the rule of thumb
    assert np.mean([g["followed"] for g in found["groups"]]) == pytest.approx(np.mean(followed), rel=0.1)
    assert (np.diff([g["value"] for g in found["groups"]]) >= 0).all() and len(found["groups"]) == 10


def test_the_planner_plays_as_without_being_watched():
    player, seeds = sn.player("search_30"), tables_of("held_out", 4)
    plain = play_visits(player, 4, first_seed=seeds)
    watched = play_visits(value_quality.Recording(player), 4, first_seed=seeds)
    assert np.array_equal(plain.points, watched.points)


def test_the_command_writes_its_figures(tmp_path, capsys):
    files = [tmp_path / "q.json", tmp_path / "q.md"]
    options = str.split("--agent planner_30 --visits 3 --layouts colours --noise club professional")
    assert value_quality.main([*options, "--json", str(files[0]), "--markdown", str(files[1])]) == 0
    report = json.loads(files[0].read_text())
    assert [one["noise"] for one in report["results"]] == ["club", "professional"]
    assert all("rule of thumb" in text for text in (files[1].read_text(), capsys.readouterr().out))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--agent", "ghost_ball"], "agent = 'ghost_ball': must be a planner"),
        (["--visits", "1"], "visits = 1"),
        (["--noise", "x"], "noise = 'x'"),
        (["--layouts", "x"], "layout = 'x'"),
    ],
)
def test_bad_input_is_one_clear_error(refused, options, said):
    assert said in refused(value_quality.main, *options)
