"""What the other tests of the benchmark let pass: bounds, bootstrap seeds, batches, mirror images, and the scores that a program sees."""

import json
import sys

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import TASKS, Agent, ProgramPlayer, figures_of, judge, run, tasks, unseen
from snooker_env.benchmark.program import OPTIONS
from snooker_env.game.frame_columns import POINTS

COLOURS = TASKS["SnookerColours-v0"]


def test_bounds_of_what_was_always_or_never_seen():
    """Several runs on the same tables are no more trials than one."""
    always = [[run, table, 27, 6, 27, 6, 0, 1, 0, 1] for run in range(3) for table in range(30)]
    never = [[run, table, 0, 1, 0, 0, 0, 0, 0, 1] for run in range(3) for table in range(30)]
    bound = unseen(30)
    assert bound == pytest.approx(1 - 0.05 ** (1 / 30))
    assert figures_of(COLOURS, "a", always)["cleared"] == {"value": 1.0, "low": pytest.approx(1 - bound), "high": 1.0, "exact": True}
    assert figures_of(COLOURS, "a", never)["cleared"] == {"value": 0.0, "low": 0.0, "high": pytest.approx(bound), "exact": True}


def test_agents_draw_their_runs_apart():
    """With another label other training seeds are drawn; with the same label the same."""
    rng = np.random.default_rng(0)
    rows = [[run, table, x, 1, x, 0, 0, 0, 0, 1] for run in range(5) for table, x in enumerate(rng.integers(0, 9, 40) + 5 * run)]
    one, same, other = (figures_of(COLOURS, label, rows)["score"] for label in ("a", "a", "b"))
    assert one == same and one["value"] == other["value"] and (one["low"], one["high"]) != (other["low"], other["high"])
    alone = [figures_of(COLOURS, label, rows[:40])["score"] for label in ("a", "b")]
    assert alone[0] == alone[1]  # of one run only the tables are drawn, the same for all agents


class Begins:
    options = {"action": "discrete"}  # noqa: RUF012

    def __init__(self):
        self.batches = []

    def begin(self, batch):
        self.batches.append(batch)

    def act(self, tables, observations, going):
        return np.full(len(going), 67)


def test_each_batch_has_random_numbers_of_its_own(monkeypatch):
    monkeypatch.setattr(run, "BATCH", 4)
    player = Begins()
    agent = Agent(label="begins", kind="object", sources=("here",), maker=lambda: player, training_shots=0)
    judge(TASKS["SnookerPotHard-v0"], agent, episodes=10)
    assert player.batches == [0, 1, 2, 0]  # then one table, timed


def test_a_mirrored_table_is_no_other_table(monkeypatch):
    """Each table is dealt twice, the second time mirrored at the long axis."""

    def deal(plan, rng):
        seed = rng.bit_generator.seed_seq.entropy - tasks.HELD_OUT_SEED
        return (1 - 2 * (seed % 2)) * np.random.default_rng(seed // 2).uniform(-1, 1, (22, 2)) * [1, 1], np.ones(22, bool)

    monkeypatch.setattr(tasks, "deal", deal)
    monkeypatch.setattr(tasks, "plan_of", lambda name: None)
    assert tasks._tables_of.__wrapped__("made here", 5) == tuple(tasks.HELD_OUT_SEED + 2 * k for k in range(5))


def test_a_program_sees_the_points_as_its_own(tmp_path):
    tables = sn.SnookerVectorEnv(1, TASKS["SnookerColours-v0"].judged(**OPTIONS), threads=1)
    tables.reset(seed=1)
    tables.tables.game[0, POINTS] = 5
    seen = tmp_path / "seen.jsonl"
    file = tmp_path / "player.py"
    keeps, plays = f"open({str(seen)!r}, 'a').write(line)", """print('{"speed": 1.0, "aim": 0.0}', flush=True)"""
    file.write_text(f"import sys\nfor line in sys.stdin:\n {keeps}\n {plays}\n")
    player = ProgramPlayer(f"{sys.executable} {file}")
    try:
        player.act(tables, None, np.ones(1, bool))
    finally:
        player.close()
    state = json.loads(seen.read_text(encoding="utf-8"))
    assert state["scores"] == [5, 0] and state["break"] == 5
