"""Does the real code pass every case of the file, and would it show if it did not?"""

import json
from pathlib import Path

import pytest

from tests import rules_cases

DATA = Path(__file__).parents[1] / "data"
FILE = DATA / "rules_cases.json"
CASES = json.loads(FILE.read_text(encoding="utf-8"))["cases"]
MORE = json.loads((DATA / "more_rules_cases.json").read_text(encoding="utf-8"))["cases"]


@pytest.mark.parametrize("case", CASES + MORE, ids=[case["id"] for case in CASES + MORE])
def test_case(case):
    assert rules_cases.run(case) is None


@pytest.mark.parametrize("case", CASES + MORE, ids=[case["id"] for case in CASES + MORE])
def test_a_wrong_expectation_fails(case):
    expect = case["expect"]
    if isinstance(expect, bool):
        assert rules_cases.run(case | {"expect": not expect})
        return
    for key, value in expect.items():
        wrong = [*value, "red"] if isinstance(value, list) else "1"
        assert rules_cases.run(case | {"expect": expect | {key: wrong}}), key


def test_command_line(tmp_path, capsys):
    assert rules_cases.main([str(FILE)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"{len(CASES)} passed, 0 failed"
    bad = dict(CASES[0], expect=CASES[0]["expect"] | {"foul": True})
    file = tmp_path / "bad.json"
    file.write_text(json.dumps({"cases": [CASES[0], bad]}), encoding="utf-8")
    assert rules_cases.main([str(file)]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "1 passed, 1 failed"
