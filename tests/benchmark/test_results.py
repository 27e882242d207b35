"""Is a result what was played? Rows, figures, counted shots, and a check that finds whatever was changed."""

import json

import numpy as np
import pytest
from scipy import stats

import snooker_env as sn
from snooker_env._lib.files import with_checksum
from snooker_env.benchmark import COLUMNS, TASKS, Agent, faults, judge
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.leaderboard import BEGIN, END, lines, page
from snooker_env.benchmark.results import read_result
from snooker_env.benchmark.statistics import bound_if_none, figure
from snooker_env.planning import Planner
from snooker_env.players import VISITS, BoundPlayer, Strokes, decision_seeds

EPISODES = 24


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A result of each task by ghost_ball."""
    folder = tmp_path_factory.mktemp("results")
    for name, task in TASKS.items():
        more = {"episodes": 4 if task.frame else EPISODES, "out": folder / f"{name}.json"}
        judge(task, Agent.of("ghost_ball"), command="a test", **more)
    return folder


def result(made, name="SnookerBreak-v0"):
    return read_result(made / f"{name}.json")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n == "SnookerFrame-v0")) for n in TASKS]
)
def test_what_is_written_is_sound(made, name):
    record = result(made, name)
    assert faults(record) == []
    assert record["protocol"]["official"] is False and record["incomplete"] is None
    assert record["agent"]["class"] == "model_free"
    assert [row[1] for row in record["rows"]] == TASKS[name].seeds(len(record["rows"]))
    assert record["timing"]["one_table_ms"] > 0
    written = (made / f"{name}.json").read_text(encoding="utf-8")
    assert json.loads(written) == with_checksum(record)
    assert all(len(line) < 140 for line in written.splitlines() if '"data"' not in line)


def test_rows_are_the_visits_that_the_environment_plays(made):
    """Stroke by stroke on one table with the same seeds, by nobody's rollout code."""
    record = result(made)
    env = sn.SnookerEnv(layout="held_out", noise="professional", cue="real", **VISITS)
    player = sn.player("ghost_ball").at(env)
    for row in record["rows"][:6]:
        env.reset(seed=row[1])
        points = pots = strokes = fouls = 0
        over = False
        while not over:
            at = sn.Positions.of(env)
            seeds = decision_seeds(0, np.array([row[1]]), strokes)
            action = player.play(at, seeds).actions(env.options, at).astype(np.float32)
            _, reward, over, _, info = env.step(action[0])
            points += info["points"]
            pots += reward > 0
            fouls += info["foul"]
            strokes += 1
        assert row[2:7] == [points, strokes, points, pots, fouls]


def test_figures_are_those_of_the_rows(made):
    record = result(made)
    scores = np.array([row[COLUMNS.index("score")] for row in record["rows"]], float)
    f = record["figures"]
    assert f["score"]["value"] == pytest.approx(scores.mean())
    assert f["iqm"]["value"] == pytest.approx(stats.trim_mean(scores, 0.25))
    assert f["best"] == scores.max() and f["by_run"] == [pytest.approx(scores.mean())]
    rng = np.random.default_rng(5)
    drawn = scores[rng.integers(len(scores), size=(20_000, len(scores)))].mean(axis=1)
    again = figure(scores.mean(), drawn)
    assert [f["score"][end] for end in ("low", "high")] == pytest.approx(
        [again["low"], again["high"]], rel=0.08
    )
    for entry in f["profile"]:
        assert entry["value"] == pytest.approx(np.mean(scores >= entry["at_least"]))
    never = f["profile"][-1]
    assert (never["at_least"], never["value"], never["low"], never["exact"]) == (147, 0.0, 0.0, True)
    assert never["high"] == pytest.approx(1 - 0.05 ** (1 / EPISODES)) == bound_if_none(EPISODES)


@pytest.mark.slow
def test_simulated_shots_are_counted():
    class Thinks(BoundPlayer):
        """Before each stroke: 7 shots on copies of each table, 3 by ``simulate``, and one batch of 5."""

        def play(self, positions, seeds):
            at, rng = sn.Positions.of(positions), np.random.default_rng(0)
            planner = Planner({"action": "discrete"})
            for k in range(len(at)):
                planner.play(at.as_visits(), np.full(7, k), np.arange(7))
                for _ in range(3):
                    sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)])
                sn.simulate_batch(np.zeros((5, 1, 2)), np.zeros((5, 1, 2)), np.zeros((5, 1, 3)))
            still = np.zeros(len(at))
            return Strokes(np.column_stack([still + 2.0, still, still, rng.uniform(-3, 3, len(at)), still]))

    agent = Agent(label="thinks", sources=(Thinks(),), training_shots=40_000)
    record = judge(TASKS["SnookerEscape-v0"], agent, episodes=9)
    assert sum(row[3] for row in record["rows"]) == 9 and record["timing"]["simulated_shots"] == 9 * 15
    wanted = {"simulated_shots": 15.0, "class": "planning", "budget": "50k"}
    assert {name: record["agent"][name] for name in wanted} == wanted
    # the opponent's strokes and the agent's own are not counted
    frames = judge(TASKS["SnookerFrame-v0"], agent, episodes=3)
    assert frames["timing"]["simulated_shots"] == 15 * sum(row[3] for row in frames["rows"]) > 15
    assert faults(record) == faults(frames) == []


@pytest.mark.slow
def test_tables_fit_100_columns(made, capsys):
    files = [str(file) for file in made.glob("*.json")]
    assert main(["table", *files]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 100 and out.count("ghost_ball *") == len(TASKS)
    results = [result(made, name) for name in TASKS]
    for one in results:  # as wide as can be
        one["agent"] |= {
            "label": "a" * 20,
            "simulated_shots": 99_999.0,
            "declared": True,
            "class": "model_free",
        }
        one["agent"] |= {"training_shots": 46_101_376, "sources": ["x"] * 10}
        scale = 1.0 if TASKS[one["task"]].counts else 0.01
        one["figures"]["adjusted"].update(value=130.0 * scale, low=120.0 * scale, high=140.0 * scale)
    assert max(map(len, lines(results))) <= 100
    assert main(["tasks"]) == 0 and max(map(len, capsys.readouterr().out.splitlines())) <= 100


def test_the_page_ranks_agents_and_shows_anchors_without_a_rank(made):
    rows = []
    for label, kind, value in (
        ("last", "model_free", 1.0),
        ("softest", "degenerate", 2.5),
        ("first", "planning", 3.0),
        ("random", "model_free", 2.0),
    ):
        one = result(made)
        one["agent"] |= {"label": label, "class": kind, "simulated_shots": 7.4, "training_shots": 18_403_328}
        one["figures"]["adjusted"] = {"value": value, "low": value - 0.5, "high": value + 0.5}
        one["figures"]["score"]["value"], one["date"] = 10 * value, "2026-11-30T09:16:10Z"
        one["protocol"]["official"] = label != "last"
        rows.append(one)
    text = page(f"Words.\n\n{BEGIN}\n\nolder\n{END}\nMore.\n", rows)
    assert text.startswith(f"Words.\n\n{BEGIN}\n\n## ") and text.endswith(f"|\n\n{END}\nMore.\n")
    shown = [line.split(" | ")[:5] for line in text.splitlines() if "](../results" in line]
    assert shown == [
        ["| 1", "`first`", "planning", "3.0 [2.5, 3.5]", "30.0"],
        ["| ", "`softest`", "anchor", "2.5 [2.0, 3.0]", "25.0"],
        ["| ", "`random`", "anchor", "2.0 [1.5, 2.5]", "20.0"],
        ["| 2", "`last` *", "model_free", "1.0 [0.5, 1.5]", "10.0"],
    ]
    link = "[2026-11-30](../results/leaderboard/SnookerBreak-v0.first.json)"
    assert f"| 18.4 M | 7 | {link} |" in text
