"""Does ``python -m snooker_env NAME`` run each command, say what there is, and refuse others in one line?"""

import pytest

from snooker_env.__main__ import COMMANDS, main
from snooker_env._lib.cache import CACHE_FOLDER
from snooker_env.benchmark import warmup
from tests.processes import python


def test_every_name_is_listed_and_hands_on_its_arguments(capsys):
    assert main([]) == main(["--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert all(sum(line.split()[:1] == [name] for line in lines) == 2 for name in COMMANDS)
    for name in COMMANDS:
        with pytest.raises(SystemExit) as ended:
            main([name, "--help"])
        said = capsys.readouterr().out
        assert (
            ended.value.code == 0 and "usage: python -m snooker_env" in said and name in said.split("\n")[0]
        )


def test_another_name_is_one_clear_error():
    out, err = python("import sys; from snooker_env.__main__ import main; sys.exit(main(['pla']) - 2)")
    assert out == "" and err == f"error: NAME = 'pla': must be one of {', '.join(COMMANDS)}\n"


def test_a_warm_up_says_where_the_machine_code_is_kept(capsys, monkeypatch):
    called = []
    monkeypatch.setattr(warmup, "warmup", lambda: called.append(1))
    assert main(["warmup"]) == 0 and called == [1]
    said = capsys.readouterr().out
    assert said == f"Everything is ready after 0 s. The machine code is kept in {CACHE_FOLDER}.\n"
