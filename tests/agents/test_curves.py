"""Do the curves of agents.curves hold what was trained, go on after a kill, and are they shown as they are?"""

import ast
import json
from collections import Counter

import gymnasium
import numpy as np
import pytest
import stable_baselines3
from sb3_contrib import MaskablePPO

import snooker_env as sn
from agents import baseline, curves, report
from agents.evaluation import curve_report
from agents.evaluation.curve_file import NAME
from agents.evaluation.curve_rows import PLACES, ROWS, Row, play, play_nothing
from snooker_env.benchmark import Agent, count_shots, faults, judge
from snooker_env.benchmark.tasks import TASKS, tables_of
from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy, StrokesQPolicy
from tests.docs.pages import DOCS, blocks
from tests.pictures import saved_figures, unreadable
from tests.processes import ROOT

TINY = ["--visits", "3", "--threads", "1", "--seeds", "7"]


def run(file, *options):
    assert curves.main([*TINY, "--out", str(file), *options]) == 0
    return json.loads(file.read_text())


@pytest.fixture
def small(monkeypatch):
    """Rows that learn in no time."""
    short = {"n_steps": 4, "batch_size": 8, "n_epochs": 1}
    monkeypatch.setitem(ROWS, "pot_ppo", Row("pot", stable_baselines3.PPO, 2, short))
    monkeypatch.setitem(ROWS, "strokes_maskable", Row("strokes", MaskablePPO, 2, short, StrokesPolicy))


def test_a_point_is_what_the_trained_policy_makes_and_what_it_cost(tmp_path, small):
    made = run(tmp_path / "c.json", "--rows", "pot_ppo", "strokes_maskable", "--shots", "8", "20")
    places = [(one["row"], one["seed"], one["shots"], one["played"]) for one in made["points"]]
    assert places == [
        (row, 7, *at) for row in ("pot_ppo", "strokes_maskable") for at in ((0, 0), (8, 8), (20, 24))
    ]
    for one in made["points"]:
        assert one["visits"] == 3 and one["error"] >= 0 and (one["seconds"] > 0) == (one["shots"] > 0)
        assert made["made"][one["made"]]["software"]["stable_baselines3"] == stable_baselines3.__version__
    agent, tables = ROWS["pot_ppo"].agent(7, 1)
    agent.learn(24)
    sums = ROWS["pot_ppo"].judge(agent, 3, 1)
    tables.close()
    assert made["points"][2]["points"] == pytest.approx(sums.mean())
    assert made["points"][2]["error"] == pytest.approx(sums.std(ddof=1) / 3**0.5)
    assert Counter(one["player"] for one in made["levels"]) == Counter(
        ["zero action", "random", "ghost_ball"]
    )


def test_a_killed_run_goes_on_and_leaves_what_is_there(tmp_path, small, monkeypatch, capsys):
    whole = run(tmp_path / "whole.json", "--rows", "pot_ppo", "--shots", "8", "20")
    file = tmp_path / "killed.json"
    judge, judged = Row.judge, []

    def interrupted(self, *given):
        judged.append(1)
        if len(judged) == 3:
            raise KeyboardInterrupt
        return judge(self, *given)

    options = [*TINY, "--out", str(file), "--rows", "pot_ppo", "--shots", "8", "20"]
    monkeypatch.setattr(Row, "judge", interrupted)
    assert curves.main(options) == 130
    kept = json.loads(file.read_text())
    assert [one["shots"] for one in kept["points"]] == [0, 8]
    assert curves.main(options) == 0 and len(judged) == 4
    done = json.loads(file.read_text())
    assert done["points"][:2] == kept["points"] and done["levels"] == kept["levels"]
    outcomes = lambda made: [(one["shots"], one["points"]) for one in made["points"]]  # noqa: E731
    assert outcomes(done) == outcomes(whole)
    capsys.readouterr()
    before = file.read_bytes()
    assert curves.main(options) == 0 and file.read_bytes() == before and not capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--rows", "pot_a2c"], "rows = 'pot_a2c': must be one of 'pot_ppo', "),
        (["--shots", "0"], "shots = 0: must be"),
        (["--seeds", "1000"], "seeds = 1000: must be"),
        (["--visits", "1"], "visits = 1: must be"),
        (["--rows", "pot_ppo", "--visits", "5000"], "visits = 5000: must be at most"),
        (["--threads", "0"], "threads = 0: must be"),
        (["--page", "nowhere.md"], "page = "),
    ],
)
def test_what_is_wrong_is_refused_before_the_work(tmp_path, refused, options, words):
    line = refused(curves.main, "--out", tmp_path / "c.json", *options)
    assert words in line and not (tmp_path / "c.json").exists()


def test_another_file_and_other_visits_are_refused(tmp_path, refused):
    file = tmp_path / "c.json"
    file.write_text(json.dumps(CONTENT))
    assert "visits = 9: must be 10, as in" in refused(curves.main, "--out", file, "--visits", 9)
    page = tmp_path / "page.md"
    page.write_text("no marks")
    assert "must hold the lines <!-- curves -->" in refused(
        curves.main, "--out", file, "--visits", 10, "--page", page
    )
    other = CONTENT["rows"]["pot_ppo"] | {"code": "PPO()"}
    file.write_text(json.dumps(CONTENT | {"rows": CONTENT["rows"] | {"pot_ppo": other}}))
    assert "rows = 'pot_ppo': must train what" in refused(curves.main, "--out", file, "--visits", 10)
    file.write_text("{}")
    assert "must be a file that agents.curves wrote" in refused(curves.main, "--out", file)


MADE = {
    "command": "python -m agents.curves",
    "commit": "abc",
    "machine": "a machine",
    "software": {"snooker_env": "1.0.0", "python": "3.11"},
}


def point(row, seed, shots, points, error=0.5):
    cost = {"seconds": shots / 100, "processor_seconds": shots / 200}
    return {
        "row": row,
        "seed": seed,
        "shots": shots,
        "played": shots,
        "points": points,
        "error": error,
    } | cost


CONTENT = {
    "schema": {"name": NAME, "version": 1},
    "visits": 10,
    "rows": {name: row.describe() for name, row in ROWS.items()},
    "made": [MADE],
    "levels": [
        {"place": "visit", "player": "zero action", "points": 4.3, "error": 0.25},
        {"place": "visit", "player": "random", "points": 1.1, "error": 0.05},
        {"place": "visit", "player": "ghost_ball", "points": 5.9, "error": 0.1},
        {"place": "escape", "player": "zero action", "points": 0.4, "error": 0.02},
    ],
    "points": [
        *(point("pot_ppo", seed, 0, 4.0) for seed in range(3)),
        *(point("pot_ppo", seed, 1000, points) for seed, points in enumerate((7.0, 5.0, 5.5))),
        *(point("strokes_dqn_policy", 0, shots, shots / 200, 1.0) for shots in (0, 1000, 2000)),
        point("escape_sac", 0, 3000, 0.61, 0.01),
    ],
}


def test_the_tables_hold_median_range_and_error():
    visit, escape = curve_report.tables_of(CONTENT)
    assert visit.title == (
        "Visit: points a visit. For comparison: zero action 4.3 ± 0.5, random 1.1 ± 0.1, ghost_ball 5.9 ± 0.2"
    )
    assert visit.header == ["row", "algorithm", "untrained", "1,000 shots", "2,000 shots", "shots/s", "seeds"]
    assert visit.rows == [
        ["pot_ppo", "PPO", "4.0 [4.0, 4.0] ± 1.0", "5.5 [5.0, 7.0] ± 1.0", "", "200", "3"],
        ["strokes_dqn_policy", "DQN, StrokesQPolicy", "0.0 ± 2.0", "5.0 ± 2.0", "10.0 ± 2.0", "200", "1"],
    ]
    assert escape.title == "Escape: share of fair strokes. For comparison: zero action 0.40 ± 0.04"
    assert escape.rows == [["escape_sac", "SAC", "", "0.61 ± 0.02", "200", "1"]]


def test_report_writes_them_and_a_page_takes_them(tmp_path, capsys):
    file, page = tmp_path / "c.json", tmp_path / "page.md"
    file.write_text(json.dumps(CONTENT))
    assert report.main([str(file)]) == 0
    text = file.with_suffix(".md").read_text()
    assert "python -m agents.curves\n" in text and "commit" not in text and "abc on a machine" in text
    for name in ("pot_ppo", "strokes_dqn_policy", "escape_sac"):
        assert f"* {name}: `{ROWS[name].code()}`" in text
    assert report.main(["--show", str(file)]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 100
    page.write_text("before\n\n<!-- curves -->\nold\n<!-- /curves -->\n\nafter\n")
    filled = curve_report.fill(page.read_text(), CONTENT, page)
    assert filled.startswith("before\n\n<!-- curves -->\n") and filled.endswith("<!-- /curves -->\n\nafter\n")
    assert "| pot_ppo | 5.5 [5.0, 7.0] |  |\n| strokes_dqn_policy | 5.0 | 10.0 |\n" in filled
    assert "old" not in filled and curve_report.fill(filled, CONTENT, page) == filled


def test_the_picture_can_be_read():
    content = CONTENT | {
        "points": [
            point(name, seed, shots, 2.0 + seed + shots / 10**5)
            for name in ROWS
            for seed in range(2)
            for shots in PLACES[ROWS[name].place].shots
        ]
    }
    with saved_figures() as figures:
        curve_report.draw(content, ROOT / "c.png")
    (figure,) = figures
    assert unreadable(figure) == []
    drawn = [line.get_label() for axes in figure.axes for line in axes.lines]
    assert {name for name, row in ROWS.items() if row.place == "visit"} <= set(drawn)
    assert drawn.count("ghost_ball 5.9") == 2


@pytest.mark.parametrize("name", ROWS)
def test_the_code_of_a_row_makes_its_agent(name):
    known = {"gymnasium": gymnasium, "SnookerVecEnv": SnookerVecEnv}
    known |= {"StrokesPolicy": StrokesPolicy, "StrokesQPolicy": StrokesQPolicy}
    row = ROWS[name]
    known[row.algorithm.__name__] = row.algorithm
    code = row.code()
    if "buffer_size" not in code and row.algorithm.__name__ in ("SAC", "TQC"):
        code = code[:-1] + ", buffer_size=100)"  # a million places take a second each
    written = eval(code, known)
    mine, tables = row.agent(0, 1)
    for key in (
        "gamma",
        "n_steps",
        "batch_size",
        "learning_rate",
        "gradient_steps",
        "train_freq",
        "ent_coef",
    ):
        assert getattr(written, key, None) == getattr(mine, key, None), key
    assert type(written.policy) is type(mine.policy) and written.n_envs == mine.n_envs
    assert written.observation_space == mine.observation_space and written.action_space == mine.action_space
    tables.close()
    written.get_env().close()


@pytest.mark.parametrize(("place", "task"), [("escape", "SnookerEscape-v0"), ("safety", "SnookerSafety-v0")])
def test_tasks_are_judged_by_the_rules_of_the_benchmark(place, task):
    assert list(curve_report.PLACES) == list(PLACES)
    assert sn.Options(**PLACES[place].judged_options) == TASKS[task].judged_options()


@pytest.mark.parametrize("place", ["visit", "safety"])
def test_tables_that_leave_change_nothing_for_the_others(place):
    """The zero action on tables that stay, as ``SnookerVectorEnv`` plays them."""
    options = PLACES[place].judged_options
    options |= {"opponent": "ghost_ball"} if place == "safety" else {}
    visits = 40
    tables = sn.SnookerVectorEnv(visits, threads=1, **options)
    tables.reset(seed=tables_of(options["layout"], visits))
    sums, going = np.zeros(visits), np.ones(visits, bool)
    while going.any():
        _, rewards, terminated, truncated, _ = tables.step(np.zeros((visits, 4)))
        sums += np.where(going, rewards, 0.0)
        going &= ~(terminated | truncated)
    tables.close()
    assert np.array_equal(play(options, lambda seen, _: np.zeros((len(seen), 4)), visits, 1), sums)
    if place == "visit":
        assert np.array_equal(play_nothing(place, visits, 1), sums)


PAGE = (DOCS / "agents/curves.md").read_text(encoding="utf-8")


def test_the_code_of_the_page_is_that_of_rows():
    shown = [
        ast.unparse(node.value)
        for block in blocks(PAGE)
        for node in ast.parse(block).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "agent"
    ]
    written = {ast.unparse(ast.parse(row.code())) for row in ROWS.values()}
    assert len(shown) >= 3 and set(shown) <= written


KEPT = ROOT / "results/agents/curves.json"


@pytest.mark.skipif(not KEPT.exists(), reason="no curves are kept")
def test_the_tables_of_the_page_are_those_of_the_kept_points():
    assert curve_report.fill(PAGE, report.read(KEPT), KEPT) == PAGE


@pytest.mark.parametrize(
    ("task", "form", "kind"),
    [("SnookerBreak-v0", "pot", "model_free"), ("SnookerSafety-v0", "strokes", "foresight")],
)
def test_a_baseline_keeps_its_budget_and_is_judged(tmp_path, small, monkeypatch, task, form, kind):
    monkeypatch.setitem(baseline.FORMS, form, ROWS["pot_ppo" if form == "pot" else "strokes_maskable"])
    before = count_shots()
    arguments = [task, "--form", form, "--shots", "100", "--seeds", "1", "--out", str(tmp_path)]
    baseline.main(arguments)
    file = tmp_path / f"{task}.{form}.100.0.zip"
    assert 50 < count_shots() - before <= 100
    made = file.read_bytes()
    baseline.main(arguments)
    assert file.read_bytes() == made  # it is left as it is
    result = judge(TASKS[task], Agent.of(str(file), label="x", trust=True, training_shots=100), episodes=2)
    assert (result["agent"]["class"], result["agent"]["budget"]) == (kind, "50k") and faults(result) == []
