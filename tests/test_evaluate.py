"""Are the figures of ``agents.evaluate`` as sure as they say, and does its command do and refuse what it should?"""

import json
import re
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from agents import evaluate, report
from agents.recipes import Recipe
from agents.statistics import Resamples, interval, iqm
from agents.tables import training_tables
from agents.world import text_of, world
from snooker_env.physics.parameters import Physics

# statistics ----------------------------------------------------------------------------------------------------------------------


def test_iqm_is_scipys_trimmed_mean():
    rng = np.random.default_rng(0)
    for n in (4, 8, 400):
        for values in (rng.normal(size=n), rng.integers(0, 6, n).astype(float)):
            assert iqm(values) == pytest.approx(stats.trim_mean(values, 0.25))
    assert iqm([1, 2, 10]) == pytest.approx((0.25 * 1 + 2 + 0.25 * 10) / 1.5)  # edges count with the part that is inside
    assert iqm([3.0]) == 3.0


def test_samples_are_those_of_a_plain_bootstrap():
    """Sums, ratios and inter-quartile means against the matrix drawn row by row."""
    rng = np.random.default_rng(1)
    x, y = rng.integers(0, 9, (3, 40)).astype(float), rng.integers(1, 5, (3, 40)).astype(float)
    samples = Resamples(3, 40, 50, seed=2)
    sums, ratios, iqms = samples.sums(x), samples.ratios(x, y), samples.iqms(x)
    for k in range(50):
        runs = np.repeat(np.arange(3), samples._runs[k].astype(int))
        tables = np.repeat(np.arange(40), samples._visits[k].astype(int))
        assert len(runs) == 2 and len(tables) == 40
        drawn = x[np.ix_(runs, tables)]
        assert sums[k] == pytest.approx(drawn.sum())
        assert ratios[k] == pytest.approx(drawn.sum() / y[np.ix_(runs, tables)].sum())
        assert iqms[k] == pytest.approx(stats.trim_mean(drawn.ravel(), 0.25))


def test_one_runs_interval_is_scipys():
    x = np.random.default_rng(3).exponential(size=(1, 300))
    ours = interval(Resamples(1, 300, 9000).sums(x) / 300)
    its = stats.bootstrap((x[0],), np.mean, n_resamples=9000, method="percentile", rng=np.random.default_rng(0)).confidence_interval
    assert ours == pytest.approx(tuple(its), abs=0.01)


def test_an_interval_without_news_is_none():
    assert all(np.isnan(interval(np.zeros(100))))
    assert all(np.isnan(interval(np.append(np.arange(99.0), np.nan))))
    assert np.isnan(Resamples(1, 5, 100).ratios(np.ones((1, 5)), np.zeros((1, 5)))).all()


def coverage(runs, spreads, of_iqm=False, trials=300, tables=200):
    """How often the interval holds the true mean 0, scores being sums of normal parts: the run's, the table's, the visit's own."""
    rng, hits = np.random.default_rng(4), 0
    of_run, of_table, own = spreads
    samples = Resamples(runs, tables, 400)
    for _ in range(trials):
        x = rng.normal(0, of_run, (runs, 1)) + rng.normal(0, of_table, (1, tables)) + rng.normal(0, own, (runs, tables))
        low, high = interval(samples.iqms(x.round(1)) if of_iqm else samples.sums(x))
        hits += low <= 0 <= high
    return hits / trials


@pytest.mark.parametrize(
    ("runs", "spreads", "least", "most"),
    [
        (1, (0, 0.3, 1), 0.91, 0.98),  # only visits differ: as it says
        (5, (0.1, 0.3, 1), 0.92, 1.0),  # all three of a size, as in play: rather too wide
        (5, (0, 0, 1), 0.97, 1.0),  # luck alone: too wide
        (5, (1, 0, 0.01), 0.8, 0.92),  # nothing but seeds: five are few
    ],
)
def test_coverage_is_what_the_docstring_says(runs, spreads, least, most):
    assert least <= coverage(runs, spreads) <= most


def test_coverage_of_the_inter_quartile_mean():
    assert 0.9 <= coverage(1, (0, 0.3, 1), of_iqm=True, trials=200, tables=100) <= 0.99


def played(label, points):
    """A ``Played`` with these points (runs, visits) and nothing else."""
    return evaluate.Played(evaluate.Agent(label, ("x",) * len(points)), {"points": points, "pots": points}, [], 1000)


def test_paired_ratio():
    rng = np.random.default_rng(5)
    base = rng.exponential(10.0, (1, 400))
    exact = played("twice", 2 * base).ratios(played("base", base))["points_a_visit"]
    assert exact["value"] == pytest.approx(2) and (exact["low"], exact["high"]) in ((None, None), pytest.approx((2, 2)))
    near = played("near", 2 * base + rng.normal(0, 1, base.shape)).ratios(played("base", base))["points_a_visit"]
    apart = played("apart", 2 * rng.permuted(base, axis=1)).ratios(played("base", base))["points_a_visit"]
    assert near["low"] < 2 < near["high"] and near["high"] - near["low"] < 0.1 * (apart["high"] - apart["low"])
    # the delta method for independent ones: the relative variances add
    spread = base.std() / base.mean() / np.sqrt(400)
    assert apart["high"] - apart["low"] == pytest.approx(2 * 3.92 * np.sqrt(2) * spread, rel=0.2)


# the command ---------------------------------------------------------------------------------------------------------------------

QUICK = ["--visits", "12", "--layouts", "held_out", "--noise", "professional", "--resamples", "200"]


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """Two untrained models of one recipe, as run folders."""
    folder = tmp_path_factory.mktemp("runs")
    tables = training_tables(2, action="discrete")
    for seed in (0, 1):
        (folder / f"m-{seed}").mkdir()
        model = Recipe.of("ppo_mask").new_model(tables, seed)
        model.imitated = 300 * seed
        model.save(folder / f"m-{seed}" / "model.zip")
    (folder / "m-0" / "results.json").write_text('{"seconds": 2.0}')
    tables.close()
    return folder


def test_json_markdown_and_picture(models, tmp_path, capsys):
    options = ["--visits", "12", "--layouts", "held_out=20", "colours", "--noise", "none", "club", "--physics", "paper,mu_bb=marlow"]
    options += ["--resamples", "200", "--json", str(tmp_path / "a" / "r.json"), "--markdown", str(tmp_path / "r.md")]
    agents = ["--agent", f"model={models / 'm-*'}", "random", "--against", "ghost_ball", "random"]
    assert evaluate.main([*agents, *options, "--picture", str(tmp_path / "p.png")]) == 0
    found = json.loads((tmp_path / "a" / "r.json").read_text(), parse_constant=lambda text: pytest.fail(f"{text} is not JSON"))
    assert set(found) == {"command", "commit", "machine", "python", "numpy", "protocol", "agents", "results"}
    assert found["protocol"]["layouts"] == {"held_out": 12, "colours": 12}
    assert [a["label"] for a in found["agents"]] == ["model", "random", "ghost_ball"]
    first, second = found["agents"][0]["runs"]
    assert (first["seconds"], first["imitated"], second["seconds"], second["imitated"]) == (2.0, 0, None, 300)
    assert first["layout"] == "opened" and first["recipe"] == "ppo_mask" and first["gamma"] == 0.95
    assert len(found["results"]) == 3 * 2 * 2
    for row in found["results"]:
        assert set(row) == {
            "agent", "layout", "noise", "fidelity", "physics", "visits", "runs", "figures", "ratios", "longest_break", "by_run", "strokes",
            "ms_a_decision",
        }  # fmt: skip
        assert set(row["figures"]) == {*evaluate.FIGURES, "points_a_visit_iqm", "pots_a_visit_iqm"}
        assert set(row["ratios"]) == {"ghost_ball", "random"} - {row["agent"]}
        assert len(row["by_run"]["points_a_visit"]) == row["runs"] == (2 if row["agent"] == "model" else 1)
        for f in [*row["figures"].values(), *(r for ratio in row["ratios"].values() for r in ratio.values())]:
            assert set(f) == {"value", "low", "high"}
            assert f["low"] is None or f["low"] <= f["high"]
        assert np.mean(row["by_run"]["points_a_visit"]) == pytest.approx(row["figures"]["points_a_visit"]["value"])
    text, printed = (tmp_path / "r.md").read_text(), capsys.readouterr().out
    assert (
        found["command"] in text
        and found["machine"] in text
        and "](p.png)" in text
        and found["command"].startswith("python -m agents.evaluate --agent")
    )
    lines = text.splitlines()
    for k, line in enumerate(lines):
        if set(line) <= set("|:- ") and line:  # under each table's head
            width = line.count("|")
            assert lines[k - 1].count("|") == width == lines[k + 1].count("|")
    points = report._pm(found["results"][0]["figures"]["points_a_visit"])
    assert points in text and points in printed and "2 training seeds, fewer than 5" in printed
    assert (tmp_path / "p.png").read_bytes()[:4] == b"\x89PNG"


def test_figures_do_not_depend_on_the_company(models, tmp_path):
    rows = []
    for company in ([], ["random", f"other={models / 'm-0'}"]):
        file = tmp_path / f"{len(company)}.json"
        evaluate.main(["--agent", *company, f"m={models / 'm-0'},{models / 'm-1'}", *QUICK, "--json", str(file)])
        found = json.loads(file.read_text())["results"]
        rows.append([{key: r[key] for key in r if key != "ms_a_decision"} for r in found if r["agent"] in ("m", "ghost_ball")])
    assert rows[0] == rows[1] and len(rows[0]) == 2


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--agent", "nobody"], "agent = 'nobody': must be random, "),
        (["--agent", str(Path(__file__))], "agent = .*test_evaluate.py': must be a model's .zip"),
        (["--agent", "x=nowhere-*"], "agent = 'nowhere-\\*': must be"),
        (["--agent", "random", "random"], "agent = 'random': must be another"),
        (["--agent", "random", "--against", "me"], "against = 'me': must be one of random, ghost_ball"),
        (["--agent", "random", "--layouts", "moon=3"], "layout = 'moon': must be one of"),
        (["--agent", "random", "--layouts", "colours=x"], "layouts = 'colours=x': must be LAYOUT or"),
        (["--agent", "random", "--visits", "1"], "visits = 1: must be an integer in \\[2"),
        (["--agent", "random", "--noise", "loud"], "noise = 'loud': must be one of"),
        (["--agent", "random", "--fidelity", "true"], "fidelity = 'true': must be"),
        (["--agent", "random", "--physics", "mars"], "physics = 'mars': must be one of"),
        (["--agent", "random", "--physics", "paper,mu_bb"], "physics = 'paper,mu_bb': must be PRESET"),
        (["--agent", "random", "--physics", "paper,mu_bb=-1"], "mu_bb"),
        (["--agent", "random", "--physics", "paper,R=0.03"], "physics = 'paper,R=0.03': must leave R"),
        (["--agent", "random", "--physics", "paper,mu_s=0"], "physics.mu_s = 0.0: must be > 0"),
        (["--agent", "random", "--physics", "paper,mu_r=0"], "physics.mu_r = 0.0: must be > 0"),
        (["--agent", "random", "--budget", "1"], "budget = 1: must be an integer in \\[2"),
        (["--agent", "random", "--json", "tests"], "json = 'tests': must be a file"),
        (["--agent", "random", "--json", "pyproject.toml/r.json"], "json = 'pyproject.toml/r.json': must be a file"),
        (["--agent", "random", "--markdown", "/proc/none/r.md"], "markdown = '/proc/none/r.md': must be a file"),
        (["--agent", "random", "--picture", "tests"], "picture = '': must be one of .*'.png'"),
        (["--agent", "random", "--picture", "p.md"], "picture = '.md': must be one of .*'.png'"),
        (["--agent", "random", "--resamples", "5"], "resamples = 5: must be an integer in"),
        (["--agent", "random", "--layouts", "colours", "--picture", "p.png"], "layouts = 'colours': must hold held_out"),
    ],
)
def test_bad_input_ends_with_one_clear_line(options, says, capsys):
    with pytest.raises(SystemExit) as stop:
        evaluate.main(options)
    assert stop.value.code == 2
    assert re.search(says, capsys.readouterr().err.strip().splitlines()[-1])


OWN = """
class Soft:
    options = {"action": "discrete"}
    def act(self, tables, observations, going):
        return [30] * len(going)

class Mute:
    options, act = {}, None

class Worldly(Soft):
    options = {"noise": "none"}

class Discreet(Soft):
    options = {"action": "discreet"}

silent = 3
"""


def test_a_player_of_ones_own_is_compared(tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text(OWN)
    monkeypatch.syspath_prepend(tmp_path)
    assert evaluate.main(["--agent", "mine:Soft", "me=mine:Soft", *QUICK, "--json", str(tmp_path / "r.json")]) == 0
    found = json.loads((tmp_path / "r.json").read_text())
    rows = {row["agent"]: row["figures"]["pots_a_visit"]["value"] for row in found["results"]}
    assert rows.keys() == {"Soft", "me", "ghost_ball"} and rows["Soft"] == rows["me"] != rows["ghost_ball"]
    for name, why in (
        ("Mute", "TypeError: act cannot"),
        ("silent", "TypeError"),
        ("Nobody", "AttributeError"),
        ("Worldly", "'noise'"),
        ("Discreet", "'discreet'"),
    ):
        with pytest.raises(ValueError, match=f"agent = 'mine:{name}': must be MODULE:CLASS of a player .*{why}"):
            evaluate.Agent.of(f"mine:{name}").trained()
    with pytest.raises(ValueError, match=r"agent = 'nothere:Soft': .*ModuleNotFoundError"):
        evaluate.Agent.of("nothere:Soft").trained()


def test_a_path_with_a_colon_is_a_path(models, tmp_path):
    (tmp_path / "10:00").symlink_to(models)
    assert len(evaluate.Agent.of(f"x={tmp_path}/10:00/m-?").runs) == 2
    for path in (r"C:\runs\m-0\model.zip", "a/b:c", "10:00"):
        with pytest.raises(ValueError, match="or name models that are there"):
            evaluate.Agent.of(f"x={path}")


@pytest.mark.parametrize("which", ["x={0},random", "x=random,{0}", "x={0},agents.players:GhostBall"])
def test_players_and_models_under_one_label_are_refused(which, models):
    with pytest.raises(ValueError, match=r"agent = 'x=.*: must be players or trained models, not both"):
        evaluate.Agent.of(which.format(models / "m-0"))


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        ("model.zip", "junk", "agent = '.*': must be a model's .zip"),
        ("model.zip", {"data": "junk"}, "agent = '.*': must be a model that train.py saved"),
        ("model.zip", {}, "agent = '.*': must be a model that train.py saved"),
        ("results.json", '{"seconds": 2.0', "agent = '.*results.json': must be JSON"),
        ("results.json", "[2.0]", "agent = '.*results.json': must hold seconds"),
        ("results.json", '{"seconds": "2 h"}', "results.json: seconds = '2 h': must be a finite number"),
        ("model.json", '{"imitated": [1]}', "model.json: imitated = \\[1\\]: must be a finite number"),
        ("model.json", "{", "agent = '.*model.json': must be JSON"),
    ],
)
def test_a_broken_file_is_named(file, text, says, models, tmp_path):
    shutil.copy(models / "m-0" / "model.zip", tmp_path)
    if isinstance(text, dict):
        with zipfile.ZipFile(tmp_path / file, "w") as made:
            for name, content in text.items():
                made.writestr(name, content)
    else:
        (tmp_path / file).write_text(text)
    with pytest.raises(ValueError, match=says):
        evaluate.Agent.of(str(tmp_path / "model.zip" if file == "model.json" else tmp_path)).trained()


def test_a_picture_that_fails_loses_no_figures(tmp_path, monkeypatch):
    def draw(report, strokes, file):
        raise RuntimeError("no ink")

    monkeypatch.setattr("agents.destinations.draw", draw)
    outputs = ["--json", str(tmp_path / "r.json"), "--markdown", str(tmp_path / "r.md"), "--picture", str(tmp_path / "p.png")]
    with pytest.raises(RuntimeError, match="no ink"):
        evaluate.main(["--agent", "random", *QUICK, *outputs])
    assert json.loads((tmp_path / "r.json").read_text())["results"] and (tmp_path / "r.md").read_text()


def test_a_world_is_named_as_it_was_called():
    for text in ("paper", "match", "paper,mu_bb=marlow", "match,mu_bb=0.06"):
        assert text_of(world(text)) == text
        assert Physics.of(world(text)) == Physics.of(world(text_of(world(text))))
    assert text_of("match") == "match" and Physics.of(world("match,mu_bb=0.06")).mu_bb == 0.06
    for wrong in ("nothing", "paper,mu_bb", "paper,colour=1"):
        with pytest.raises(ValueError):
            world(wrong)
