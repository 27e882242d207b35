"""Does ``check`` find what no run writes? Each field out of range, rows against the rules of snooker, and what a page must not repeat."""

import copy
import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from snooker_env.benchmark import COLUMNS, TASKS, Agent, faults, figures_of, judge, page, replayed
from snooker_env.benchmark.leaderboard import markdown_table, plain, profile
from snooker_env.benchmark.possible import FEWEST_IF_STOPPED, faults_of_row
from snooker_env.benchmark.schema import RANGES

SOUND = json.loads((Path(__file__).parents[2] / "leaderboard/SnookerColours-v0.random.json").read_text(encoding="utf-8"))
HUGE = 10**400


def changed(**fields):
    """The sound file with other values, ``part__name=value``."""
    found = copy.deepcopy(SOUND)
    for name, value in fields.items():
        inner = found
        *parts, last = name.split("__")
        for part in parts:
            inner = inner[part]
        inner[last] = value
    return found


def test_the_file_itself_is_sound_and_official():
    assert faults(SOUND) == [] and SOUND["protocol"]["official"] is True


def test_an_empty_file_is_not_official():
    said = faults(changed(agent__sources=[], rows=[], figures=None))
    assert said == ["agent.sources: must be texts, one for each training seed"]


@pytest.mark.parametrize("sources", [[], [""], [7], ["a", None], [["a"]]])
def test_sources_are_texts(sources):
    assert "agent.sources: must be texts, one for each training seed" in faults(changed(agent__sources=sources))


def test_the_same_source_five_times_makes_nothing_surer():
    found = changed(agent__sources=["model.zip"] * 5, agent__kind="model")
    found["rows"] = [[run, *row[1:]] for run in range(5) for row in SOUND["rows"]]
    found["timing"]["decisions"] *= 5
    found["figures"] = figures_of(TASKS[found["task"]], "random", found["rows"])
    assert faults(found) == ["agent.sources: must be different: the same one twice makes nothing surer"]
    found["agent"]["sources"] = [f"{k}.zip" for k in range(5)]
    assert faults(found) == []
    found["agent"]["kind"] = "class"
    assert faults(found) == ["agent.sources: must be one for an agent of kind class"]


WRONG = [
    ("agent__label", "x | y |\n\n# h <script>", "agent.label = 'x | y"),
    ("agent__label", "", "agent.label = '': must be 1 to 20 letters"),
    ("agent__label", "a" * 200, "agent.label = 'aaaa"),
    ("agent__label", "random\n", "agent.label = 'random"),
    ("agent__kind", "human", "agent.kind = 'human': must be one of built_in"),
    ("machine__cpu", "evil\n\n## injected", "machine.cpu = 'evil"),
    ("machine__platform", "", "machine.platform = ''"),
    ("software__snooker_env", "999 | x", "software.snooker_env = '999 | x': must be a version"),
    ("software__torch", "<b>", "software.torch = '<b>': must be a version"),
    ("commit", "a commit", "commit = 'a commit': must be a commit's hash"),
    ("date", "whenever", "date = 'whenever': must be a time in UTC"),
    ("date", "2026-13-01T00:00:00Z", "date = "),
    ("agent__options", {"noise": "none"}, "agent.options: key of options = 'noise': must be one of action, aim"),
    ("agent__options", {"aim": "at the pub"}, "agent.options: aim = "),
    ("agent__training_shots", -5, "agent.training_shots = -5: must be between 0"),
    ("agent__simulated_shots", -1, "agent.simulated_shots = -1: must be between 0"),
    ("agent__simulated_shots", None, "agent.simulated_shots = None: must be a number for an agent of kind built_in"),
    ("agent__simulated_shots", 7, "agent.simulated_shots = 7: must be 0, as timing counts them, or declared"),
    ("agent__kind", "program", "agent.declared = False: must be True"),
    ("machine__cores", 0, "machine.cores = 0: must be between 1"),
    ("machine__load", -1.0, "machine.load = -1.0: must be between 0"),
    ("timing__seconds", float("inf"), "timing.seconds = inf: must be between 0"),
    ("timing__seconds", float("nan"), "timing.seconds = nan: must be between 0"),
    ("timing__seconds", -1, "timing.seconds = -1: must be between 0"),
    ("timing__simulated_shots", -1, "timing.simulated_shots = -1: must be between 0"),
    ("timing__tables_at_once", 0, "timing.tables_at_once = 0: must be between 1"),
    ("timing__tables_at_once", -3, "timing.tables_at_once = -3: must be between 1"),
    ("timing__one_table_ms", -1.0, "timing.one_table_ms = -1.0: must be between 0"),
    ("timing__one_table_ms", None, "timing.one_table_ms: must be null if one_table_decisions is 0, and only then"),
    ("timing__one_table_decisions", -1, "timing.one_table_decisions = -1: must be between 0"),
    ("protocol__episodes", 0, "protocol.episodes = 0: must be between 1"),
    ("protocol__episodes", -1, "protocol.episodes = -1: must be between 1"),
    ("protocol__episodes", 2**21, "protocol.episodes = 2097152: must be between 1"),
    ("protocol__episodes", 200_000, "protocol.episodes = 200000: must be at most 500 on SnookerColours-v0"),
]


@pytest.mark.parametrize(("name", "value", "line"), WRONG, ids=[f"{name}-{k}" for k, (name, _, _) in enumerate(WRONG)])
def test_a_wrong_value_is_one_line_that_names_its_field(name, value, line):
    said = faults(changed(**{name: value}))
    assert any(one.startswith(line) for one in said), said
    assert all("\n" not in one and len(one) < 200 for one in said)


@pytest.mark.parametrize("name", [*RANGES, "figures.score.value", "figures.best", "figures.profile"])
@pytest.mark.parametrize("value", [HUGE, -HUGE, 1e999, 10**5000], ids=["huge", "-huge", "inf", "too long"])
def test_numbers_without_measure_are_lines_too(name, value):
    said = faults(changed(**{name.replace(".", "__"): value}))
    assert any(line.startswith(name) for line in said), said


@pytest.mark.parametrize("column", range(len(COLUMNS)))
@pytest.mark.parametrize("value", [HUGE, 10**5000, -1], ids=["huge", "too long", "-1"])
def test_numbers_without_measure_in_a_row(column, value):
    found = changed()
    found["rows"][3][column] = value
    said = faults(found)
    assert said and all(line.startswith("rows[3]") for line in said), said


def test_what_is_not_known_is_not_official():
    """Training shots, and the simulated shots of a program."""
    said = faults(changed(agent__training_shots=None, agent__budget="unknown"))
    assert len(said) == 1 and said[0].startswith("protocol.official = True: must be False")
    program = {"agent__kind": "program", "agent__declared": True, "timing__tables_at_once": 1}
    assert faults(changed(**program)) == []
    said = faults(changed(**program, agent__simulated_shots=None, **{"agent__class": "undeclared"}))
    assert len(said) == 1 and said[0].startswith("protocol.official = True: must be False")
    assert faults(changed(agent__kind="program", agent__declared=True)) == ["timing.tables_at_once = 100: must be 1 for a program"]


def row(task, **given):
    """The faulty columns of a row; what is not given follows from the rest."""
    r = dict.fromkeys(COLUMNS, 0) | {"ended": 1} | given
    task = TASKS[f"Snooker{task}-v0"]
    r.setdefault("strokes", 1)
    r["strokes"] = given.get("strokes", 1 if task.changes.get("one_stroke") else r["pots"] + 1 - r["cleared"])
    follows = {"points": r["points"], "pots": r["pots"], "legal": 1 - r["fouls"], "won": int(r["points"] > r["opponent_points"])}
    r["score"] = given.get("score", follows[task.score])
    return [line.split(" = ")[0].partition(".")[2] for line in faults_of_row(0, r, task)]


ROWS = [
    ("Colours", {"pots": 1, "points": 13}, ["points"]),
    ("Colours", {"pots": 1, "points": 2, "cleared": 1}, ["cleared"]),
    ("Colours", {"pots": 6, "points": 27}, ["cleared"]),
    ("Colours", {"pots": 6, "points": 27, "cleared": 1}, []),
    ("Colours", {"pots": 5, "points": 20}, []),
    ("Colours", {"pots": 5, "points": 20, "fouls": 1}, []),
    ("Break", {"pots": 10, "points": 147}, ["points"]),
    ("Break", {"pots": 36, "points": 147, "cleared": 1}, []),
    ("Break", {"pots": 36, "points": 148, "cleared": 1}, ["points"]),
    ("Break", {"pots": 35, "points": 140, "cleared": 0}, []),
    ("Break", {"pots": 35, "points": 140, "cleared": 1}, ["cleared"]),
    ("Break", {"pots": 8, "points": 44, "cleared": 1}, []),  # 15 reds with one stroke
    ("Break", {"pots": 2, "points": 2}, ["points"]),
    ("Break", {"pots": 3, "points": 10}, []),
    ("LineUp", {"pots": 37, "points": 147}, ["cleared"]),
    ("PotHard", {"pots": 1, "points": 1, "cleared": 1}, []),
    ("PotHard", {"pots": 1, "points": 1, "strokes": 2}, ["cleared"]),
    ("PotHard", {"pots": 2, "points": 2}, ["cleared"]),
    ("Escape", {"pots": 1, "points": 2}, []),
    ("Escape", {"pots": 1, "points": 1, "cleared": 1}, ["cleared"]),
    ("Frame", {"strokes": 30, "pots": 12, "fouls": 3, "points": 80, "opponent_points": 30}, []),
    ("Frame", {"strokes": 30, "pots": 0, "fouls": 3, "points": 8, "opponent_points": 63}, []),  # points by fouls alone
    ("Frame", {"strokes": 30, "pots": 12, "points": 100_000}, ["points"]),
    ("Frame", {"strokes": 5000, "pots": 12, "points": 80}, ["strokes"]),
    ("Frame", {"strokes": 30, "pots": 30, "fouls": 30, "points": 100, "opponent_points": 130}, ["fouls"]),
    ("Frame", {"strokes": 30, "pots": 2, "fouls": 3, "points": 40, "opponent_points": 7}, ["opponent_points"]),
    ("Frame", {"strokes": 30, "pots": 2, "fouls": 0, "points": 40, "opponent_points": 200}, ["opponent_points"]),
    ("Frame", {"strokes": 30, "pots": 2, "points": 40, "opponent_points": 40}, ["ended"]),
    ("Frame", {"strokes": FEWEST_IF_STOPPED - 1, "pots": 2, "points": 8, "ended": 0, "score": 0}, ["ended"]),
    ("Frame", {"strokes": 400, "pots": 2, "points": 8, "ended": 0, "score": 0}, []),
    ("Frame", {"strokes": 400, "pots": 2, "points": 8, "ended": 0, "score": 1}, ["score"]),
]


@pytest.mark.parametrize(("task", "given", "columns"), ROWS, ids=[f"{task}-{k}" for k, (task, _, _) in enumerate(ROWS)])
def test_rows_that_the_rules_allow_and_others(task, given, columns):
    assert row(task, **given) == columns


def test_every_break_of_a_random_referee_is_possible():
    """Breaks drawn by the rules: reds together or one by one, any colour after each, then the colours in order."""
    rng = np.random.default_rng(0)
    for _ in range(500):
        reds, points, pots, misses = 15, 0, 0, rng.choice([0.0, 0.02, 0.2])
        strokes = itertools.chain(*itertools.repeat(("red", "colour"), 15))
        for what in strokes:
            if (what == "red" and reds == 0) or rng.random() < misses:
                break
            n = int(rng.integers(1, min(reds, 3) + 1)) if what == "red" else 0
            reds, points, pots = reds - n, points + (n or int(rng.integers(2, 8))), pots + 1
            assert row("Break", pots=pots, points=points) == []
        if reds == 0 and pots % 2 == 0:
            for value in range(2, 8):
                points, pots = points + value, pots + 1
                assert row("Break", pots=pots, points=points, cleared=int(value == 7)) == []


class Still:
    options = {"action": "discrete"}  # noqa: RUF012
    shift = 0

    def act(self, tables, observations, going):
        return np.full(len(going), 67 + self.shift)


def still(kind="object", sources=("here",), **options):
    made = iter(range(99))

    def maker():
        player = Still()
        player.options, player.shift = {"action": "discrete"} | options, 5 * next(made)
        return player

    return Agent(label="still", kind=kind, sources=sources, maker=maker, training_shots=0)


def test_a_replay_is_of_every_training_seed_by_the_same_agent():
    two = ("a.zip", "b.zip")
    found = judge(TASKS["SnookerPotHard-v0"], still("model", two), episodes=6)
    assert faults(found) == [] and replayed(found, still("model", two), 6) == []
    other = copy.deepcopy(found)
    k = next(k for k, r in enumerate(found["rows"]) if r[0] == 1)
    other["rows"][k][6] ^= 1
    said = replayed(other, still("model", two), 6)
    assert len(said) == 1 and said[0].startswith(f"run 1, table {found['rows'][k][1]}: played again")
    with pytest.raises(ValueError, match="must be of the kind that the file says: model"):
        replayed(found, still("object", two), 6)
    with pytest.raises(ValueError, match="must have the 2 training seeds of the file"):
        replayed(found, still("model", ("a.zip",)), 6)
    with pytest.raises(ValueError, match="must be those of the file"):
        replayed(found, still("model", two, observation="flat"), 6)


def test_no_text_of_a_file_is_markup_of_the_page():
    found = changed(agent__label="x | y |\n\n# h <script>", machine__cpu="evil\n\n## injected [a](b)", software__snooker_env="999 | <x>")
    text = page([found])
    assert not any(line.startswith(("# h", "## injected")) for line in text.splitlines())
    assert "<script>" not in text and "<x>" not in text and "[a]" not in text and "| x \\| y \\| # h &lt;script&gt; |" not in page([SOUND])
    cells = [line for line in text.splitlines() if "script" in line]
    assert len(cells) == 2 and all("x \\| y \\| # h &lt;script&gt;" in line for line in cells)
    assert plain("ghost_ball *") == "ghost_ball *" and markdown_table(["a|b"], [["c\\"]])[0] == "| a\\|b |"


def test_a_share_that_was_always_or_never_seen_stands_as_its_bound():
    """In the profile: at least the lower bound if always, at most the upper one if never."""
    task = TASKS["SnookerColours-v0"]
    rows = [[0, seed, 27, 6, 27, 6, 0, 1, 0, 1] for seed in task.seeds(30)]
    always = changed(rows=rows, figures=figures_of(task, "random", rows))
    rows = [[0, seed, 0, 1, 0, 0, 0, 0, 0, 1] for seed in task.seeds(30)]
    never = changed(rows=rows, figures=figures_of(task, "random", rows))
    assert profile([always], task)[1][0][1:] == [">= 90.5"] * 6 + ["27"]
    assert profile([never], task)[1][0][1:] == ["<= 9.5"] * 6 + ["0"]
