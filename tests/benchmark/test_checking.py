"""Does ``check`` find what no run writes: fields out of range, wrong sources, and markup for the page?"""

import copy
from datetime import datetime, timedelta, timezone
from functools import cache

import pytest

import snooker_env as sn
from snooker_env.benchmark import TASKS, Agent, faults, judge
from snooker_env.benchmark.leaderboard import BEGIN, END, page
from snooker_env.benchmark.results import figures_of, pack_strokes, strokes_of
from snooker_env.benchmark.schema import DATE
from tests.benchmark.records import put


@cache
def sound():
    """All episodes of random with a club player's errors, by a name that ``check`` does not ask again."""
    agent = Agent(label="any", sources=(sn.player("random"),), training_shots=0)
    return judge(TASKS["SnookerBreakClub-v0"], agent)


def changed(**fields):
    """The sound file with other values, ``part__name=value``."""
    record = copy.deepcopy(sound())
    for name, value in fields.items():
        record = put(record, name.split("__"), value)
    return record


def test_the_same_source_five_times_makes_nothing_surer():
    record, strokes = changed(agent__sources=["model.zip"] * 5), strokes_of(sound())
    record["rows"] = [[run, *row[1:]] for run in range(5) for row in sound()["rows"]]
    record["strokes"] = pack_strokes(strokes * 5)
    record["figures"] = figures_of(TASKS[record["task"]], "any", record["rows"])
    assert faults(record) == ["agent.sources: must be different: the same one twice makes nothing surer"]
    for alike in (["search", "search_120"], ["planner_30@club", "planner_030@club"]):
        assert faults(record | {"agent": record["agent"] | {"sources": [*alike, "a", "b", "c"]}}) == faults(
            record
        )
    record["agent"]["sources"] = [f"{k}.zip" for k in range(5)]
    equal = "agent.sources: 0 and 1 must be different training seeds: their strokes are equal"
    assert faults(record) == [equal]


OTHER = "must not be the name of another player"
BEGINS = "strokes: run 0, table 10"
ALIKE = ["r\u0430ndom", "RANDOM", "Random", "random.", "ghost-ball", "ghost__ball"]
"""Labels that a reader would take for a built-in player."""
TEXTS = ["two\nlines", "\x1b[2J", "\ud800", "x" * 2001]
TOMORROW = (datetime.now(timezone.utc) + timedelta(days=1)).strftime(DATE)
DATES = ["2999-01-01T00:00:00Z", "2026-11-20T23:59:59Z", "1970-01-01T00:00:00Z", TOMORROW]
"""In the future, or before the project."""
WRONG = [
    ("timing.seconds", float("nan"), "timing.seconds = nan: must be between 0"),
    ("machine.cores", 0, "machine.cores = 0: must be between 1"),
    ("agent.label", "x | y |\n\n# h <script>", "agent.label = 'x | y"),
    ("agent.label", "", "agent.label = '': must be 1 to 20 letters"),
    ("agent.label", "random\n", "agent.label = 'random"),
    ("machine.cpu", "evil\n\n## injected", "machine.cpu = 'evil"),
    ("machine.platform", "", "machine.platform = ''"),
    ("software.snooker_env", "999 | x", "software.snooker_env = '999 | x': must be a version"),
    ("software.torch", "<b>", "software.torch = '<b>': must be a version"),
    ("commit", "a commit", "commit = 'a commit': must be a commit's hash"),
    ("date", "whenever", "date = 'whenever': must be a time in UTC"),
    ("date", "2026-13-01T00:00:00Z", "date = "),
    ("agent.simulated_shots", None, "agent.simulated_shots = None: must be 0.0"),
    ("agent.simulated_shots", 7, "agent.simulated_shots = 7: must be 0.0"),
    ("timing.simulated_shots", 7, "agent.simulated_shots = 0.0: must be 0.01"),
    ("agent.sources", ["program:a"], "agent.class = 'model_free': must be 'undeclared'"),
    ("agent.sources", ["search_60"], BEGINS),
    ("agent.label", "random", f"agent.label = 'random': {OTHER}"),
    ("protocol.episodes", 200_000, "protocol.episodes = 200000: must be at most 500 on SnookerBreakClub-v0"),
    *(("agent.label", name, "agent.label = ") for name in ALIKE),
    *(("command", text, "command = ") for text in TEXTS),
    *(("agent.sources", [text], "agent.sources: must be texts, one for each") for text in TEXTS),
    *(("date", date, f"date = '{date}': must be between 2026-11-21") for date in DATES),
]


@pytest.mark.parametrize(
    ("name", "value", "line"), WRONG, ids=[f"{name}-{k}" for k, (name, _, _) in enumerate(WRONG)]
)
def test_a_wrong_value_is_one_line_that_names_its_field(name, value, line):
    refused = faults(put(sound(), name, value))
    assert any(one.startswith(line) for one in refused), refused
    assert all("\n" not in one and len(one) < 200 for one in refused)


def test_what_is_not_known_is_not_official():
    """Training shots, and the simulated shots of a program."""
    refused = faults(changed(agent__training_shots=None, agent__budget="unknown"))
    assert len(refused) == 1 and refused[0].startswith("protocol.official = True: must be False")
    program = {"agent__sources": ["program:a"]}
    assert "agent.simulated_shots = 0.0: must be None by the other fields" in faults(changed(**program))
    program["agent__declared"] = True
    assert faults(changed(**program)) == []
    refused = faults(changed(**program, agent__simulated_shots=None, **{"agent__class": "undeclared"}))
    assert len(refused) == 1 and refused[0].startswith("protocol.official = True: must be False")


def test_no_free_text_of_a_file_is_on_the_page():
    evil = "evil [a](b)"
    free = dict.fromkeys(("command", "commit", "machine__cpu", "software__snooker_env"), evil)
    assert "evil" not in page(f"{BEGIN}\n{END}", [changed(**free)])
