"""What if a player's code fails, ends the program, or changes its options later? What was played is kept, and the task stays frozen."""

from typing import ClassVar

import numpy as np
import pytest

from snooker_env.benchmark import TASKS, Agent, faults, judge, play_episodes, read_result, task_of
from snooker_env.benchmark.playing import BATCH

SEEN = []


class Careless:
    """Soft strokes; in its third batch it fails as ``error`` says."""

    options: ClassVar[dict] = {}
    error = RuntimeError("no more")

    def __init__(self):
        self._batches = 0

    def begin(self, batch):
        self._batches += 1
        if self._batches == 3:
            raise self.error

    def act(self, tables, observations, going):
        return np.full((len(going), 4), -0.5, np.float32)


class Quitter(Careless):
    """The same, but it ends the program."""

    error = SystemExit(0)


class Changeling:
    """Says one thing when it is checked, and another when its tables are made."""

    def __init__(self):
        self._asked = 0

    @property
    def options(self):
        self._asked += 1
        return {} if self._asked <= 3 else {"physics": "match", "fidelity": "fast", "table": "tight"}

    def act(self, tables, observations, going):
        SEEN.append((tables.options.physics, tables.options.fidelity, tables.options.table))
        return np.full((len(going), 4), -0.5, np.float32)


@pytest.mark.parametrize("maker", [Careless, Quitter])
def test_what_was_played_before_a_failure_is_kept(maker, tmp_path):
    out, task = tmp_path / "one.json", task_of("SnookerPotHard-v0")
    with pytest.raises(RuntimeError, match="no more" if maker is Careless else "ended the program"):
        judge(task, Agent.of(f"{__name__}:{maker.__name__}", training_shots=0), episodes=2 * BATCH + 30, out=out)
    found = read_result(out)
    assert len(found["rows"]) == 2 * BATCH and faults(found) == [] and type(maker.error).__name__ in found["incomplete"]


def test_a_player_that_changes_its_options_later_changes_nothing():
    SEEN.clear()
    player, task = Changeling(), TASKS["SnookerPotHard-v0"]
    for _ in range(3):
        assert player.options == {}
    assert player.options["fidelity"] == "fast"
    play_episodes(task, player, task.seeds(2))
    expected = task.judged()
    assert SEEN and set(SEEN) == {(expected.physics, expected.fidelity, expected.table)}
