"""Does the command print what ``advise`` says, and name what is wrong?"""

import json

from cases import ENDGAME, OPEN

import snooker_env as sn
from snooker_env.advice.__main__ import main


def test_the_command_prints_advice(tmp_path, capsys):
    file = tmp_path / "one.json"
    OPEN.save(file)
    few = ["--position", str(file), "--agent", "ghost_ball", "--n", "2", "--samples", "30", "--visits", "2"]
    assert main(few) == 0
    printed = capsys.readouterr().out.splitlines()
    advice = sn.advise(OPEN, agent="ghost_ball", n=2, samples=30, visits=2)
    assert [line for line in printed if not line.startswith("   ")] == str(advice).splitlines()
    assert "(95 %); cue ball stops at (" in printed[2] and len(printed) == 1 + 2 * len(advice)
    assert main([*few, "--json"]) == 0 and json.loads(capsys.readouterr().out) == advice.to_dict()


def test_what_is_wrong_is_said_in_a_line(tmp_path, capsys):
    file = tmp_path / "one.json"
    ENDGAME.save(file)
    for wrong, said in (
        (["--agent", "nobody"], "player = 'nobody'"),
        (["--n", "0"], "n = 0: must be"),
        (["--noise", "x"], "noise = 'x'"),
    ):
        assert main(["--position", str(file), *wrong]) == 2
        out, error = capsys.readouterr()
        assert not out and error.startswith(f"error: {said}") and error.count("\n") == 1
    assert main(["--position", str(tmp_path / "none.json")]) == 2 and "none.json" in capsys.readouterr().err
