"""Are policies that look at nothing judged as such, asked again, and found where one stands above players that look?"""

from dataclasses import replace

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import COLUMNS, TASKS, Agent, __main__, faults, judge
from snooker_env.benchmark.degenerate_check import ABOVE, winners
from snooker_env.benchmark.playing import play_episodes
from snooker_env.players.degenerate import MODULE, SILLY

ESCAPE, SAFETY = TASKS["SnookerEscape-v0"], TASKS["SnookerSafety-v0"]


def result(label, mean):
    """As much of a result as is compared."""
    return {"task": ESCAPE.id, "agent": {"label": label}, "figures": {"score": {"value": mean}}}


@pytest.mark.parametrize("name", [*SILLY, "constant_67"])
def test_each_is_a_class_of_its_own_and_asked_again(name):
    record = judge(ESCAPE, Agent.of(MODULE + name, label=name), episodes=8)
    assert record["agent"]["class"] == "degenerate" and record["agent"]["budget"] == "none"
    assert faults(record) == []
    record["agent"]["sources"] = [MODULE + ("hardest" if name != "hardest" else "away")]
    assert any("plays another stroke than number 0 of the file" in line for line in faults(record))


def test_strokes_are_what_their_names_say():
    at = sn.Positions.of(sn.Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)], blue=(0.0, -0.4), on="red"))
    played = {name: maker().at({}).play(at, [0]).values[0] for name, maker in SILLY.items()}
    assert played["softest"][0] == played["softest_away"][0] == 0.2 and played["hardest"][0] == 7.0
    assert np.allclose(played["hardest"][3], np.pi / 4)  # at the red, though the blue is nearer
    assert np.allclose(np.cos(played["softest_away"][3] - np.pi / 2), 1.0)  # away from the blue


@pytest.mark.slow
def test_a_foul_on_purpose_is_worse_than_any_try():
    """It was worth as much as the best player's safety, while the episode ended with it."""
    training, seeds = replace(SAFETY, judged_layout="safety"), list(range(30))
    lead = COLUMNS.index("score")
    foul, plain = (
        np.array(play_episodes(training, one, seeds).rows)[:, lead].mean()
        for one in (f"{MODULE}softest_away", "ghost_ball")
    )
    assert foul < plain - 10.0


def test_who_wins_is_named_and_the_command_fails(monkeypatch, tmp_path, capsys):
    good = [result(name, 0.9) for name in ABOVE] + [result("random", 0.5)]
    assert winners([*good, result("constant", 0.9)]) == []
    line = f"{ESCAPE.id}: constant (0.95) stands above {ABOVE[0]} (0.9)"
    assert winners([*good, result("constant", 0.95)])[0] == line
    monkeypatch.setattr(__main__, "warmup", lambda: None)
    monkeypatch.setattr(__main__, "board", lambda some, task: (["agent"], []))
    for mean, code in ((0.95, 1), (0.1, 0)):
        monkeypatch.setattr(__main__, "results", lambda *_, mean=mean: [*good, result("constant", mean)])
        assert __main__.main(["degenerate", ESCAPE.id, "--out", str(tmp_path)]) == code
        assert (line in capsys.readouterr().out) is bool(code)
