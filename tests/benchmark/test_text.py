"""Are programs that read words judged as the rules of the track say: budgets, second tries, forfeits, going on?"""

import json
import sys

from snooker_env.benchmark import TASKS, Agent
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.text import COUNTS, STROKES, TRIES, judge_text
from tests.processes import ROOT

EXAMPLE = f"program:{sys.executable} {ROOT / 'examples/text_player.py'}"
BREAK = TASKS["SnookerBreak-v0"]


def program(tmp_path, body):
    """A program that answers each ``state`` with what ``body`` prints."""
    file = tmp_path / "player.py"
    lines = [f" {line}" for line in ("state = json.loads(line)", *body.splitlines())]
    file.write_text(
        "import json, sys, time\nfor n, line in enumerate(sys.stdin):\n" + "\n".join(lines) + "\n"
    )
    return f"program:{sys.executable} {file}"


def test_the_example_reads_the_table_in_words_and_is_never_refused(tmp_path, capsys):
    out = tmp_path / "one.json"
    assert main(["text", "--agent", EXAMPLE, "--visits", "12", "--out", str(out)]) == 0
    result = json.loads(out.read_text())
    assert "text  text_player: " in capsys.readouterr().out
    assert [row["table"] for row in result["rows"]] == BREAK.seeds(12)
    assert result["figures"]["points"]["value"] > 1.0 and result["budget"]["strokes"] == STROKES
    for row in result["rows"]:
        assert set(row) == {"table", *COUNTS} and row["refused"] == row["forfeited"] == 0
        assert row["answers"] == row["strokes"] >= 1 and row["read"] > 500 * row["strokes"]


SECOND = """stroke = '{"speed": 2.0, "aim": 0.0}'
print(stroke if state["error"] else '{"speed": 99, "aim": 0}', flush=True)"""
NEVER = """print('I would pot the black', flush=True)"""
ERROR = "speed = 99: must be a finite number in [0.2, 7]"


def test_a_wrong_answer_comes_back_with_what_was_wrong(tmp_path):
    said = (
        f"{SECOND}\nif state['error']: open({str(tmp_path / 'said')!r}, 'a').write(state['error'] + chr(10))"
    )
    rows = judge_text(Agent.of(program(tmp_path, said)), visits=3, out=tmp_path / "a.json")["rows"]
    assert all(
        row["refused"] == row["strokes"] == row["answers"] / 2 and not row["forfeited"] for row in rows
    )
    lines = (tmp_path / "said").read_text().splitlines()
    assert len(lines) == sum(row["strokes"] for row in rows) and all(line.endswith(ERROR) for line in lines)


def test_after_the_last_try_the_visit_is_forfeited_and_the_next_one_begins(tmp_path):
    result = judge_text(Agent.of(program(tmp_path, NEVER)), visits=3, out=tmp_path / "a.json")
    expected = {"points": 0, "strokes": 0, "forfeited": 1, "answers": TRIES, "refused": TRIES}
    for row in result["rows"]:
        assert {name: row[name] for name in expected} == expected
    assert result["figures"]["forfeited"] == 1.0


def test_a_program_that_dies_is_said_and_its_result_gone_on_with(tmp_path, capsys):
    out, body = (
        tmp_path / "a.json",
        'if n == 5: sys.exit(3)\nprint(\'{"speed": 0.5, "aim": 0.0}\', flush=True)',
    )
    command = [
        "text",
        "--agent",
        program(tmp_path, body),
        "--label",
        "mine",
        "--visits",
        "8",
        "--out",
        str(out),
    ]
    assert main(command) == 1 and "ended with exit code 3" in capsys.readouterr().err
    kept = json.loads(out.read_text())
    assert kept["figures"] is None and 0 < len(kept["rows"]) < 8
    assert main(command) == 2 and "must be a new file; --resume goes on" in capsys.readouterr().err
    program(tmp_path, 'print(\'{"speed": 0.5, "aim": 0.0}\', flush=True)')
    assert main([*command, "--resume"]) == 0
    result = json.loads(out.read_text())
    assert result["rows"][: len(kept["rows"])] == kept["rows"] and len(result["rows"]) == 8
    other = [*command[:2], "random", "--visits", "8", "--out", str(out), "--resume"]
    assert main(other) == 2 and "must be of the same agent" in capsys.readouterr().err
