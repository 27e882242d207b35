"""Does the comparison over tables pair the visits, count seeds of a training as seeds, and refuse what it cannot play?"""

import json
import shutil
import sys

import numpy as np
import pytest

from agents.learning.models import PRETRAINED
from benchmarks import conditions
from snooker_env.benchmark import interval, play_visits


@pytest.fixture
def command(monkeypatch, capsys):
    """Called with words: exit code and lines of ``benchmarks.conditions``."""

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["conditions", *map(str, words)])
        code = conditions.main()
        return code, capsys.readouterr().out.splitlines()

    return run


def test_seeds_of_a_training_are_taken_together_and_compared_visit_by_visit(command, tmp_path):
    for seed in (0, 1):
        shutil.copy(PRETRAINED / "ppo_value.zip", tmp_path / f"mine-{seed}.zip")
    file = tmp_path / "figures.json"
    players = ["--players", "ghost_ball", f"mine={tmp_path}/mine-?.zip"]
    code, lines = command(*players, "--ways", "fixed", "known", "--visits", 3, "--json", file)
    assert code == 0 and len(lines) == 5 and "more than ghost_ball" in lines[0]
    found = json.loads(file.read_text())
    assert list(found) == [
        f"{name}, {says}" for says in ("fixed", "drawn, knows the table") for name in ("ghost_ball", "mine")
    ]
    for says, way in (("fixed", "fixed"), ("drawn, knows the table", "drawn")):
        same = {"layout": "opened", "noise": "professional", "physics": "match", "conditions": way}
        played = play_visits("ghost_ball", 3, first_seed=conditions.FIRST_SEED, **same)
        ghost, mine = found[f"ghost_ball, {says}"], found[f"mine, {says}"]
        assert ghost == played.a_visit(played.points).tolist()
        assert np.shape(mine) == (2, 3) and mine[0] == mine[1]
        line = next(line for line in lines if line.startswith("mine ") and f"  {says}  " in f"  {line}  ")
        assert f"{np.mean(mine) - np.mean(ghost):.1f} [" in line


def test_an_interval_covers_seeds_and_visits():
    rng = np.random.default_rng(2)
    visits = rng.normal(0.0, 1.0, 400)
    made = np.stack([visits + 10.0, visits + 20.0])
    one, both = (conditions.resampled(some, np.random.default_rng(0)) for some in (made[:1], made))
    assert one.mean() == pytest.approx(made[0].mean(), abs=0.02) and one.std() == pytest.approx(
        0.05, rel=0.15
    )
    low, high = interval(both)
    assert low < 10.2 and high > 19.8 and both.mean() == pytest.approx(made.mean(), abs=0.5)
    # the same visits for everybody: what differs by a constant has no interval
    other = conditions.resampled(made[:1] + 3.0, np.random.default_rng(0))
    assert np.allclose(other - one, 3.0)


def test_who_does_not_know_the_table_aims_for_another():
    options = {"name": "ghost_ball", "noise": "none", "physics": "match", "visits": 20, "seed": 0}
    player = conditions.entrants([options.pop("name")])["ghost_ball"][0]
    made = {way: conditions.points(player, way, **options) for way in conditions.NAMES}
    assert not np.array_equal(made["fixed"], made["known"])
    assert not np.array_equal(made["known"], made["average"])
    # it strikes in the middle, where no cue squirts
    assert np.array_equal(made["cue"], made["average"]) and not np.array_equal(
        made["average"], made["preset"]
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--players", "mine=nowhere"], "agent = 'nowhere': must be"),
        (["--players", "best_pot_8", "best_pot_8"], "players = 'best_pot_8': must have a label of its own"),
        (["--ways", "guessed"], "invalid choice: 'guessed'"),
    ],
)
def test_bad_options_are_refused(command, capsys, words, said):
    with pytest.raises(SystemExit) as stop:
        command(*words)
    assert stop.value.code == 2 and said in capsys.readouterr().err
