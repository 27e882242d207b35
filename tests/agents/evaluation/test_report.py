"""Do the words of an evaluation follow from its figures? Invented agents, exact sentences and cells."""

import json
import re

import pytest
from scipy import stats

from agents import report
from agents._lib.tables import WIDTH, TextTable
from agents.evaluation.training_summary import conclusion
from agents.evaluation.visit_figures import most_points
from snooker_env.benchmark.statistics import bound_if_none
from tests.processes import ROOT

GHOST = {"from": "ghost_ball"}


def run(seed, **changes):
    """A training run as agents/evaluate.py keeps it."""
    trained = {"from": f"m-{seed}", "recipe": "r", "seed": seed, "shots": 1000, "imitated": 0, "gamma": 0.95}
    under = {"layout": "opened", "noise": "none", "fidelity": "fast", "physics": "paper", "cue": "real"}
    return trained | under | {"seconds": 10.0} | changes


def agent(label, seeds=(0, 1, 2, 3, 4), **changes):
    return {"label": label, "runs": [run(seed, **changes) for seed in seeds]}


def report_of(*agents, layouts=("held_out",)):
    """A report of these agents before anything was played."""
    axes = {"noise": ["none", "club"], "fidelity": ["standard"], "physics": ["paper"], "cue": ["real"]}
    played = {"layouts": dict.fromkeys(layouts, 10), **axes, "against": ["b"]}
    return {"agents": list(agents), "protocol": played, "results": []}


def said(*agents, **more):
    return report.fairness(report_of(*agents, **more))


UNKNOWN = "Whether the trained agents had equal {} is not known: no record for b."


@pytest.mark.parametrize(
    ("changes", "which", "sentence"),
    [
        ({}, 0, "The trained agents had equal positions imitated (0)."),
        ({"shots": 2000}, 1, "The trained agents had unequal shots (1,000 to 2,000)."),
        ({"imitated": 300}, 0, "The trained agents had unequal positions imitated (0 to 300)."),
        ({"seconds": 12.0}, 2, "The trained agents had unequal seconds of training (10 to 12)."),
        ({"seconds": 10.9}, 2, "The trained agents had equal seconds of training (10 to 11)."),
        ({"seconds": None}, 2, UNKNOWN.format("seconds of training")),
        ({"imitated": None}, 0, UNKNOWN.format("positions imitated")),
    ],
)
def test_what_agents_were_given(changes, which, sentence):
    amounts = ("positions imitated (0)", "shots (1,000)", "seconds of training (10)")
    wanted = [f"The trained agents had equal {amount}." for amount in amounts]
    wanted[which] = sentence
    assert said(agent("a"), agent("b", **changes)) == wanted


def test_copies_of_one_model_are_one_seed():
    assert said(agent("a")) == []
    alone = "a has 1 training seed: its intervals do not cover other seeds."
    assert said(agent("a", (0, 0, 0, 0, 0))) == [alone]
    assert said(agent("a", (0, 1, 1, 1, 1))) == ["a has 2 training seeds, fewer than 5."]
    assert report.agents_table(report_of(agent("a", (0, 1, 1))))[0].rows[0][7] == "2"


def test_who_was_trained_on_what_is_played_is_named():
    known = "a was trained on layout {}: its tables are not new to it."
    assert said(agent("a", layout="held_out"), layouts=("colours",)) == [known.format("held_out")]
    assert said(agent("a", layout="colours"), layouts=("held_out", "colours")) == [known.format("colours")]
    assert said(agent("a", layout="colours"), layouts=("held_out",)) == []


def test_the_agents():
    names = {"g": "ghost_ball", "s": "stroke_value", "p": "planner_500", "m": "planner_mine:Mine"}
    others = [{"label": label, "runs": [{"from": name}]} for label, name in names.items()]
    trained, *said = report.agents_table(report_of(agent("a", imitated=300, seconds=None), *others))
    amounts = ["gamma", "seeds", "imitated", "shots", "seconds"]
    assert trained.header == ["agent", "recipe", "trained: noise", "fidelity", "physics", "cue", *amounts]
    assert trained.rows == [["a", "r", "none", "fast", "paper", "real", "0.95", "5", "300", "1,000", ""]]
    assert said == ["Pre-trained, by the noise played: s, p.", "Not trained: g, m."]
    (table,) = report.agents_table(report_of(agent("a")))
    assert table.rows[0][-2:] == ["1,000", "10"]


PLAYED = {
    "layout": "held_out",
    "noise": "none",
    "fidelity": "standard",
    "physics": "paper",
    "cue": "real",
    "runs": 1,
}


def figure(value, low=None, high=None):
    return {"value": value, "low": low, "high": high}


def row(label, noise, points):
    """What an agent did: points a visit."""
    return PLAYED | {"agent": label, "noise": noise, "figures": {"points_a_visit": figure(points)}}


def test_a_under_b():
    made = report_of(agent("a"), agent("b", noise="club"))
    points = {("a", "none"): 4.0, ("a", "club"): 1.0, ("b", "none"): 3.0, ("b", "club"): 2.0}
    made["results"] = [row(label, noise, value) for (label, noise), value in points.items()]
    (table,) = report.cross(made)
    assert (
        table.title
        == "held_out: points a visit, played under noise ..., fidelity standard, physics paper, cue real"
    )
    assert table.header == ["agent", "trained under", "none", "club"]
    assert table.rows == [["a", "none", "4.00", "1.00"], ["b", "club", "3.00", "2.00"]]


def result(layout="held_out", runs=1, counted=None, **figures):
    """What an agent did: only what is given."""
    points = ("points_a_visit", "adjusted_a_visit", "points_a_visit_iqm", "pots_a_visit_iqm", "colour_value")
    nothing = dict.fromkeys([*report.SHARES, *points], figure(None))
    amounts = {"visits": 30, "runs": runs, "strokes": 60, "ms_a_decision": 1.0, "longest_break": 7}
    shown = {name: figure(value) for name, value in figures.items()}
    found = nothing | {"pots_a_visit": figure(1.0, 0.9, 1.1)} | shown
    known = {"counted": counted} if counted else {}
    return PLAYED | amounts | known | {"agent": "a", "layout": layout, "ratios": {}, "figures": found}


def test_the_bound_of_what_was_never_seen_is_clopper_and_pearsons():
    for n in (1, 30, 2000):
        exact = stats.binomtest(0, n, alternative="less").proportion_ci(0.95, "exact")
        assert bound_if_none(n) == pytest.approx(exact.high)
    assert bound_if_none(30) == pytest.approx(0.0950, abs=1e-4) and bound_if_none(2000) == pytest.approx(
        3 / 2000, rel=5e-3
    )


@pytest.mark.parametrize(
    ("name", "value", "more", "cell"),
    [
        ("centuries", 0.0, {}, "0.0 [0.0, 9.5]"),
        ("centuries", 0.0, {"runs": 5}, "0.0 [0.0, 9.5]"),  # each table counts once
        ("clearances", 1.0, {}, "100.0 [90.5, 100.0]"),
        ("pot_rate", 1.0, {}, "100.0 [95.1, 100.0]"),
        ("pot_rate", 1.0, {"runs": 2}, "100.0 [90.5, 100.0]"),
        ("next_pot_after_a_pot", 0.0, {"clearances": 0.5}, "0.0 [0.0, 18.1]"),  # half were the last ball
        ("high_colours", 0.0, {}, "0.0"),  # how many colours there were is not known
        ("high_colours", 0.0, {"counted": {"colours": 30.0}}, "0.0 [0.0, 9.5]"),
        ("centuries", 0.5, {}, "50.0"),
    ],
)
def test_where_nothing_or_everything_was_seen_the_bound_is_exact(name, value, more, cell):
    assert report._share(result(**{"clearances": 0.0, **more, name: value}), name) == cell


def tables_of(*results, layouts):
    """The tables of an evaluation with these results: title -> ``TextTable``."""
    made = report_of({"label": "a", "runs": [GHOST]}) | {"results": list(results)}
    made["protocol"] |= {"layouts": layouts, "noise": ["none"]}
    return {part.title: part for part in report.parts(made) if isinstance(part, TextTable)}


def test_what_cannot_be_on_a_layout_is_left_out():
    """Pink or black without colours, a next pot of one ball, centuries of 27 points."""
    shares = {"centuries": 0.0, "maximums": 0.0, "clearances": 0.5, "pot_rate": 0.5, "fouls_a_visit": 0.1}
    layouts = {"pots:easy": 30, "colours": 30, "random:10": 30, "opened": 30}
    tables = tables_of(*(result(layout, **shares) for layout in layouts), layouts=layouts)
    where = "{}, 30 visits, noise none, physics paper, fidelity standard, real cue"
    for layout, breaks in (
        ("pots:easy", ["clearances %"]),
        ("colours", ["clearances %"]),
        ("random:10", ["centuries %", "clearances %"]),
        ("opened", ["centuries %", "147s %", "clearances %"]),
    ):
        shown = tables[where.format(layout)].header
        assert shown == ["agent", *breaks, "best", "pot rate %", "fouls a visit", "ms"]
    assert most_points("held_out") == 147 and most_points("pots:hard") == 1


def test_rows_and_columns_without_a_figure_are_left_out():
    rows = [["1", "x", "", "5", ""], ["2", "y", "", "", ""]]
    table = TextTable("t", ["k", "l", "a", "b", "c"], rows, 2, 3).tidy()
    assert (table.header, table.rows, table.left) == (["k", "l", "b"], [["1", "x", "5"]], 2)
    assert list(TextTable("t", ["k", "a"], [["1", ""]], 1, 1).tidy().narrow()) == []


@pytest.mark.parametrize("many", [3, 20, 60])
def test_no_table_is_too_wide(many, capsys):
    """Every column is there once, beside the keys; nothing wraps."""
    header = ["noise", "agent", *(f"column {k}" for k in range(many))]
    rows = [[f"level {i}", "a|b", *(f"{i}.{k} [low, high]" for k in range(many))] for i in range(3)]
    parts = list(TextTable("wide", header, rows, 2, 2, True).narrow())
    assert [name for part in parts for name in part.header[2:]] == header[2:]
    assert all(part.header[:2] == header[:2] for part in parts)
    report.show(parts)
    pattern = "wide" if len(parts) == 1 else rf"wide \(\d+ of {len(parts)}\)"
    assert all(re.fullmatch(pattern, part.title) for part in parts)
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= WIDTH == 100
    assert all(f"{i}.{k} [low, high]" in printed for i in range(3) for k in range(many))
    cells = [row.split(" | ") for part in parts for row in part.markdown().splitlines()[2:]]
    assert all(row[1] == "a\\|b" for row in cells if row[0].startswith("| level"))


def test_an_incomplete_evaluation_says_so(capsys):
    made = report_of({"label": "a", "runs": [GHOST]})
    made |= {"results": [result(centuries=0.0)], "incomplete": "interrupted at once"}
    made["protocol"]["noise"] = ["none", "club"]
    assert next(report.parts(made)) == "INCOMPLETE: interrupted at once."
    report.show(report.parts(made))
    assert "INCOMPLETE" in capsys.readouterr().out


KEPT = sorted((ROOT / "results" / "agents").glob("*.json"))


def test_the_markdown_of_kept_figures_is_that_of_today(tmp_path, capsys):
    """``python -m agents.report results/agents/*.json`` was run since report.py changed; no table is wide."""
    for file in KEPT:
        made = report.read(file)
        written = report.markdown(made)
        assert file.with_suffix(".md").read_text() == written, file
        report.show(report.parts(made))
        assert max(len(line.rstrip()) for line in capsys.readouterr().out.splitlines()) <= 100


def test_the_command_writes_the_markdown_beside(tmp_path, capsys, refused):
    file = tmp_path / "r.json"
    file.write_bytes((ROOT / "results" / "agents" / "visits.json").read_bytes())
    assert report.main([str(file)]) == 0 and capsys.readouterr().out == f"{tmp_path / 'r.md'}\n"
    read = report.read(file)
    assert (tmp_path / "r.md").read_text() == report.markdown(read)
    assert report.main(["--show", str(file)]) == 0 and "IQM" in capsys.readouterr().out
    for text in ("{}", "[", json.dumps(json.loads(file.read_text()) | {"results": [{}]})):
        file.write_text(text)
        assert "must be a file written by agents.evaluate" in refused(report.main, file)


def concluded(*players):
    """The conclusion from (points, error, share of next pots) of the trained agent, ghost_ball and random."""
    figures = {}
    for name, (points, se, *share) in zip(("trained", "ghost_ball", "random"), players, strict=True):
        means = {"pots_a_visit": points / 3, "points_a_visit": points, "points_a_visit_se": se}
        figures[name] = means | {"visits": 100, "next_pot_after_a_pot": share[0] if share else 0.9}
    return conclusion("ppo_value", 1000, 0, figures)


POOR = (0.5, 0.1)
ALIKE = "100 visits are too few to show that ppo_value, with 1,000 shots of training, is better than"
WORSE = "0.03 pots and 0.10 points a visit against 0.67 pots"


@pytest.mark.parametrize(
    ("trained", "ghost", "random", "words"),
    [
        ((1.0, 0.3), (0.9, 0.3), (0.5, 0.3), f"{ALIKE} random strokes: 0.33 pots"),
        ((0.1, 0.1), (0.9, 0.3), (2.0, 0.1), f"plays worse than random strokes: {WORSE}"),
        ((3.0, 0.3), (2.9, 0.3), POOR, f"{ALIKE} ghost_ball"),
        ((2.8, 0.3), (2.9, 0.3), POOR, f"{ALIKE} ghost_ball"),
        ((2.0, 0.1), (9.0, 0.3), POOR, "better than random strokes but worse than ghost_ball"),
        ((9.0, 0.3), (2.9, 0.3), POOR, "ppo_value is better than ghost_ball"),
        # each player's own share of next pots, whichever is greater
        ((9.0, 0.3, 0.6), (2.9, 0.3, 0.661), POOR, "follows in 60.0 % against 66.1 %."),
        ((9.0, 0.3, 0.898), (2.9, 0.3, 0.661), POOR, "follows in 89.8 % against 66.1 %."),
    ],
)
def test_the_conclusion_claims_only_what_the_figures_show(trained, ghost, random, words):
    assert words in concluded(trained, ghost, random)
