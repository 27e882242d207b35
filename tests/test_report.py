"""Do the words of an evaluation follow from its figures? Invented agents, and the exact sentences and cells."""

import pytest

from agents import report

GHOST = {"from": "ghost_ball"}


def run(seed, **changes):
    """A training run as agents/evaluate.py keeps it."""
    usual = {
        "from": f"m-{seed}", "recipe": "r", "seed": seed, "shots": 1000, "imitated": 0, "seconds": 10.0, "gamma": 0.95, "layout": "opened",
        "noise": "none", "fidelity": "fast", "physics": "paper",
    }  # fmt: skip
    return usual | changes


def agent(label, seeds=(0, 1, 2, 3, 4), **changes):
    return {"label": label, "runs": [run(seed, **changes) for seed in seeds]}


def told(*agents, layouts=("held_out",)):
    """A report of these agents before anything was played."""
    axes = {"noise": ["none", "club"], "fidelity": ["standard"], "physics": ["paper"]}
    return {"agents": list(agents), "protocol": {"layouts": dict.fromkeys(layouts, 10), **axes, "against": ["b"]}, "results": []}


def said(*agents, **more):
    return report.fairness(told(*agents, **more))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"shots": 2000}, "The trained agents had unequal shots (1,000 to 2,000)."),
        ({"imitated": 300}, "The trained agents had unequal positions taught (0 to 300)."),
        ({"seconds": 12.0}, "The trained agents had unequal seconds of training (10 to 12)."),
        ({"seconds": None}, "Whether the trained agents had equal seconds of training cannot be said: not known of b."),
        ({"imitated": None}, "Whether the trained agents had equal positions taught cannot be said: not known of b."),
    ],
)
def test_what_agents_were_given(changes, sentence):
    equal = [
        "The trained agents had equal positions taught (0).", "The trained agents had equal shots (1,000).",
        "The trained agents had equal seconds of training (10).",
    ]  # fmt: skip
    assert said(agent("a"), agent("b")) == equal
    words = sentence.split("equal ")[1].split(" (")[0].split(" cannot")[0]
    assert said(agent("a"), agent("b", **changes)) == [sentence if f"equal {words} (" in line else line for line in equal]


def test_times_that_hardly_differ_are_equal():
    assert "The trained agents had equal seconds of training (100 to 109)." in said(agent("a", seconds=100.0), agent("b", seconds=109.0))


def test_copies_of_one_model_are_one_seed():
    assert said(agent("a")) == []
    assert said(agent("a", (0, 0, 0, 0, 0))) == ["a has 1 training seed: its intervals say nothing about other seeds."]
    assert said(agent("a", (0, 1, 1, 1, 1))) == ["a has 2 training seeds, fewer than 5."]
    assert report.agents_table(told(agent("a", (0, 1, 1)))).rows[0][5] == "2"


def test_who_was_trained_on_what_is_played_is_named():
    known = "a was trained on layout {}: its tables are not new to it."
    assert said(agent("a", layout="held_out"), layouts=("colours",)) == [known.format("held_out")]
    assert said(agent("a", layout="colours"), layouts=("held_out", "colours")) == [known.format("colours")]
    assert said(agent("a", layout="colours"), layouts=("held_out",)) == []


def test_the_agents():
    table = report.agents_table(told(agent("a", imitated=300, seconds=None), {"label": "ghost_ball", "runs": [GHOST]}))
    assert table.header == [
        "agent", "recipe", "trained: noise", "fidelity", "physics", "seeds", "gamma", "taught", "shots", "seconds", "shots/s",
    ]  # fmt: skip
    assert table.rows[0] == ["a", "r", "none", "fast", "paper", "5", "0.95", "300", "1,000", "", ""]
    assert table.rows[1] == ["ghost_ball", "not trained", "", "", "", "1", "", "", "", "", ""]
    assert report.agents_table(told(agent("a"))).rows[0][-3:] == ["1,000", "10", "100"]


def figure(value, low=None, high=None):
    return {"value": value, "low": low, "high": high}


def row(label, noise, points, shares, ratios):
    """What an agent did: points a visit, three shares, ratios of points."""
    names = ("next_pot_after_a_pot", "easy_pot_left_by_a_pot", "high_colour_after_a_red")
    figures = {"points_a_visit": figure(points)} | {name: figure(share) for name, share in zip(names, shares, strict=True)}
    return {
        "agent": label, "layout": "held_out", "noise": noise, "fidelity": "standard", "physics": "paper", "visits": 2000, "runs": 1,
        "figures": figures, "ratios": {other: {"points_a_visit": ratio} for other, ratio in ratios.items()},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("ratio", "words"),
    [
        ((2.0, 1.8, 2.2), "2.00 [1.80, 2.20] times the points of b"),
        ((0.5, 0.4, 0.6), "0.50 [0.40, 0.60] times the points of b"),
        ((1.1, 0.9, 1.3), "1.10 [0.90, 1.30] times the points of b, a difference that 2,000 visits do not show"),
    ],
)
def test_the_comparison_says_whose_is_which(ratio, words):
    made = told(agent("a"), agent("b"))
    made["results"] = [
        row("a", "none", 20.0, (0.9, 0.5, 0.4), {"b": figure(*ratio)}),
        row("b", "none", 10.0, (0.6, 0.2, None), {"a": figure(9.0, 8.0, 10.0)}),
    ]
    assert report.comparison(made) == [  # the other way round is not told again
        "On layout held_out, noise none, fidelity standard, physics paper:",
        f"a makes {words}; after a pot it pots again: 90.0 against 60.0 %; an easy pot is left: 50.0 against 20.0 %.",
    ]


def test_a_under_b():
    made = told(agent("a"), agent("b", noise="club"))
    points = {("a", "none"): 4.0, ("a", "club"): 1.0, ("b", "none"): 3.0, ("b", "club"): 2.0}
    made["results"] = [row(label, noise, value, (None,) * 3, {}) for (label, noise), value in points.items()]
    (table,) = report.crossed(made)
    assert table.title == "held_out: points a visit, fidelity standard, physics paper"
    assert table.header == ["agent", "trained under noise", "played under none", "played under club"]
    assert table.rows == [["a", "none", "4.00", "1.00"], ["b", "club", "3.00", "2.00"]]
