"""Is a result what was played? Rows, figures, counted shots, and a check that finds whatever was changed."""

import json

import numpy as np
import pytest
from scipy import stats

import snooker_env as sn
from snooker_env._lib.files import with_checksum
from snooker_env.benchmark import COLUMNS, TASKS, Agent, faults, interval, judge, page
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.leaderboard import LEGEND, board, lines
from snooker_env.benchmark.playing import play_episodes
from snooker_env.benchmark.results import budget_of, figures_of, read_result
from snooker_env.benchmark.schema import FIELDS
from snooker_env.benchmark.statistics import bound_if_none
from snooker_env.benchmark.tasks import HELD_OUT_SEED
from snooker_env.planning import Planner
from snooker_env.players import VISITS, BoundPlayer, Strokes, decision_seeds
from tests.benchmark.records import at, put

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


@pytest.mark.parametrize("name", TASKS)
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
    assert (f["score"]["low"], f["score"]["high"]) == pytest.approx(interval(drawn), rel=0.08)
    for entry in f["profile"]:
        assert entry["value"] == pytest.approx(np.mean(scores >= entry["at_least"]))
    never = f["profile"][-1]
    assert (never["at_least"], never["value"], never["low"], never["exact"]) == (147, 0.0, 0.0, True)
    assert never["high"] == pytest.approx(1 - 0.05 ** (1 / EPISODES)) == bound_if_none(EPISODES)


def test_several_training_seeds_are_drawn_too():
    rng = np.random.default_rng(0)
    points = [rng.integers(0, 40, 50) + 20 * run for run in range(3)]
    rows = [[k, table, x, 1, x, 0, 0, 0, 0, 1] for k in range(3) for table, x in enumerate(points[k])]
    record, alone, part = (
        figures_of(TASKS["SnookerBreak-v0"], "a", some) for some in (rows, rows[:50], rows[:-1])
    )
    widths = [one["score"]["high"] - one["score"]["low"] for one in (record, alone)]
    assert widths[0] > 2 * widths[1] and part is None
    assert record["by_run"] == pytest.approx([one.mean() for one in points])


OTHER = HELD_OUT_SEED + 999


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("figures.score.value", 99.0, "figures.score.value = 99.0: must be "),
        ("figures.profile.1.high", 0.9, "figures.profile[1].high = 0.9: must be "),
        ("rows.3.2", 147, "rows[3].score = 147: must be "),
        ("rows.5.1", OTHER, f"rows[5]: run 0, table {OTHER}: must be run 0, table "),
        ("rows.5.1", HELD_OUT_SEED, "rows[5]: run 0, table 1000000: must be run 0, table 1000005"),
        ("rows.2.3", 1001, "rows[2].strokes = 1001: must be between 0 and 1000"),
        ("rows.2", [1, 2], "rows[2] = [1, 2]: must be 10 whole numbers"),
        ("rows.2.6", 2, "rows[2].fouls = 2: must be "),
        ("protocol.episodes", 25, "rows: must be 25 episodes, 25 for each training seed, not 24"),
        ("protocol.version", 7, "protocol.version = 7: must be 2"),
        ("protocol.official", True, "protocol.official = True: must be False by the other fields"),
        ("task", "SnookerBreak-v1", "task = 'SnookerBreak-v1': must be one of SnookerBreak-v0"),
        ("agent.class", "planning", "agent.class = 'planning': must be 'model_free'"),
        ("agent.budget", "1M", "agent.budget = '1M': must be 'none'"),
        ("software.numpy", 2, "software.numpy = 2: must be a text or null"),
        ("machine.colour", 2, "machine.colour: is no field of version 3"),
        ("extra", 2, "extra: is no field of version 3"),
        ("incomplete", False, "incomplete = False: must be a text or null"),
    ],
)
def test_a_tampered_file_fails_at_the_right_field(made, path, value, line):
    refused = faults(put(result(made), path, value))
    assert any(one.startswith(line) for one in refused), refused


@pytest.mark.parametrize("field", FIELDS)
def test_a_missing_field_is_named(made, field):
    record = result(made)
    *parts, last = field.split(".")
    del at(record, parts)[last]
    assert f"{field}: is missing" in faults(record)


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


@pytest.mark.parametrize("log", [2, 512])
def test_a_shot_that_is_played_twice_counts_once(monkeypatch, log):
    from snooker_env import simulation
    from snooker_env.simulation.count import count_shots
    from snooker_env.tasks import stroke

    monkeypatch.setattr(simulation, "_FIRST_LOG", log)
    monkeypatch.setattr(stroke.ShotBuffers.__init__, "__defaults__", (log,))
    before = count_shots()
    shot = sn.simulate([(0.0, -1.0), (0.0, 0.5)], [(0.0, 3.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
    assert count_shots() - before == 1 and len(shot.events) > 2
    env = sn.SnookerEnv()
    env.reset(seed=1)
    before = count_shots()
    env.step([0.3, 0.0, 0.0, 0.5])
    assert count_shots() - before == 1


def test_budgets_are_limits_with_room_for_a_rollout():
    shots = (None, 0, 1, 51_000, 51_001, 1_020_000, 5_100_000, 5_100_001)
    assert list(map(budget_of, shots)) == ["unknown", "none", "50k", "50k", "1M", "1M", "5M", "open"]


def test_randomness_is_repeated():
    task = TASKS["SnookerBreakClub-v0"]
    first, second = (judge(task, Agent.of("random"), episodes=12)["rows"] for _ in range(2))
    assert first == second == play_episodes(task, "random", task.seeds(12)).rows
    assert play_episodes(task, "random", task.seeds(12), run=1).rows != [[1, *row[1:]] for row in first]


def test_bounds_of_what_was_always_or_never_seen():
    """Several runs on the same tables are no more trials than one."""
    task, bound = TASKS["SnookerBreakClub-v0"], bound_if_none(30)
    always = [[run, table, 27, 6, 27, 6, 0, 1, 0, 1] for run in range(3) for table in range(30)]
    never = [[run, table, 0, 1, 0, 0, 0, 0, 0, 1] for run in range(3) for table in range(30)]
    assert bound == pytest.approx(1 - 0.05 ** (1 / 30))
    one = {"value": 1.0, "low": pytest.approx(1 - bound), "high": 1.0, "exact": True}
    none = {"value": 0.0, "low": 0.0, "high": pytest.approx(bound), "exact": True}
    assert figures_of(task, "a", always)["cleared"] == one and figures_of(task, "a", never)["cleared"] == none


def test_agents_draw_their_runs_apart():
    """With another label other training seeds are drawn; with the same label the same."""
    task, points = TASKS["SnookerBreakClub-v0"], np.random.default_rng(0).integers(0, 9, 40)
    rows = [[k, table, x, 1, x, 0, 0, 0, 0, 1] for k in range(5) for table, x in enumerate(points + 5 * k)]
    one, same, other = (figures_of(task, label, rows)["score"] for label in ("a", "a", "b"))
    assert one == same and one["value"] == other["value"]
    assert (one["low"], one["high"]) != (other["low"], other["high"])
    alone = [figures_of(task, label, rows[:40])["score"] for label in ("a", "b")]
    assert alone[0] == alone[1]  # of one run only the tables are drawn, the same for all agents


def test_tables_fit_100_columns(made, capsys):
    files = [str(file) for file in made.glob("*.json")]
    assert main(["table", *files]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 100 and out.count("ghost_ball *") == len(TASKS)
    results = [result(made, name) for name in TASKS]
    for one in results:  # as wide as can be
        one["agent"] |= {"label": "a" * 20, "simulated_shots": 99_999.0, "declared": True}
        one["agent"] |= {"class": "undeclared", "budget": "unknown", "sources": ["x"] * 10}
        for figure in (one["figures"]["score"], one["figures"]["iqm"]):
            if figure is not None:
                figure.update(value=130.0, low=120.0, high=140.0)
        one["figures"]["best"] = 147
        one["timing"] |= {"seconds": 99.9 * sum(row[3] for row in one["rows"]), "one_table_ms": 99999.0}
    assert max(map(len, lines(results))) <= 100
    assert main(["tasks"]) == 0 and max(map(len, capsys.readouterr().out.splitlines())) <= 100
    assert page(results).startswith("# Leaderboard\n") and LEGEND[:40] in page(results)


def test_the_order_of_the_table_is_class_budget_score(made):
    rows = []
    for label, shots, training, value in (
        ("d", 10, 0, 99.0),
        ("b", 0, 0, 5.0),
        ("a", 0, 0, 6.0),
        ("c", 0, 10**6, 1.0),
        ("e", 10, 50_000, 1.0),
    ):
        one = result(made)
        one["agent"] |= {"label": label, "simulated_shots": float(shots), "training_shots": training}
        one["agent"] |= {"budget": budget_of(training), "class": "planning" if shots else "model_free"}
        one["figures"]["score"]["value"] = value
        rows.append(one)
    assert [row[1][0] for row in board(rows, TASKS["SnookerBreak-v0"])[1]] == list("abcde")


def test_the_page_shows_the_best_agent_that_looks_at_nothing_and_thresholds_that_were_reached(made):
    rows = []
    for label, kind, value in (
        ("seeing", "model_free", 1.0),
        ("softest", "degenerate", 2.0),
        ("hardest", "degenerate", 3.0),
    ):
        one = result(made)
        one["agent"] |= {"label": label, "class": kind}
        one["figures"]["score"]["value"] = value
        one["figures"]["profile"] = [
            {"at_least": 1, "value": 0.5, "low": 0.4, "high": 0.6, "exact": False},
            *(
                {"at_least": t, "value": 0.0, "low": 0.0, "high": 0.1, "exact": True}
                for t in (10, 25, 50, 75, 100, 147)
            ),
        ]
        rows.append(one)
    shown = page(rows).splitlines()
    assert [sum(label in line for line in shown) for label in ("seeing", "softest", "hardest")] == [2, 0, 1]
    assert [line for line in shown if line.startswith("| agent")] == ["| agent | >= 1 | best |"]
    assert all(any(label in line for line in lines(rows)) for label in ("seeing", "softest", "hardest"))
