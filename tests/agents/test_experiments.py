"""Can the commands behind agents/results/*.md be run as agents/experiments.sh writes them, by their programs?"""

import json
import os
import shlex
import subprocess
from pathlib import Path

import pytest

import snooker_env.players.resolver as resolver
import train
from agents.evaluation import tournament
from agents.evaluation.protocol import parser
from tests.processes import ROOT


def script(name, *arguments, **variables):
    """A script of agents/, ended."""
    command = ["bash", str(ROOT / "agents" / name), *map(str, arguments)]
    return subprocess.run(command, env=os.environ | variables, capture_output=True, text=True, timeout=60)


def listed(name, *arguments):
    """The words of the commands that a script would run."""
    done = script(name, *arguments, LIST="1")
    assert done.returncode == 0, done.stderr
    return [shlex.split(line) for line in done.stdout.splitlines()]


def test_every_command_is_one_that_its_program_takes(tmp_path):
    lines = listed("experiments.sh", tmp_path)
    runs = [line[2:] for line in lines if line[1] == "train.py"]
    comparisons, curves = (
        [line[3:] for line in lines if line[2] == f"agents.{name}"] for name in ("evaluate", "curves")
    )
    assert len(runs) > 25 and len(comparisons) == 16 and len(curves) == 1 and len(runs) + 18 == len(lines)
    assert all(agent.partition("=")[2].startswith(f"{tmp_path}/") for agent in curves[0])
    starts = [run[run.index("--start") + 1] for run in runs if "--start" in run]
    assert [Path(start).name for start in starts] == str.split("value-0 lineup-0 lineup-1 lineup-2 taught-0")
    assert 'echo "lineup-$k ' in (ROOT / "agents/experiments.sh").read_text()
    recipes = {train.recipe_of(train.Settings(**train.parse(run)[1])).name for run in runs}
    assert recipes == {f"ppo_{name}" for name in str.split("value foresight mask absolute target")} | {
        "tqc_target"
    }
    for comparison in comparisons:
        parsed = parser().parse_args(comparison)
        assert parsed.json.suffix == ".json" and parsed.markdown.with_suffix(".json") == parsed.json
        for agent in parsed.agent:
            label, equals, paths = agent.partition("=")
            for path in (paths if equals else label).split(","):
                player, at, folder = path.partition("@")
                if at:
                    assert resolver.is_name(player) and folder.startswith(f"{tmp_path}/")
                else:
                    assert resolver.is_name(path) or (equals and path.startswith(f"{tmp_path}/"))


def test_a_run_that_fails_stops_the_whole(tmp_path):
    """And its log says why."""
    fake = tmp_path / "python"
    fake.write_text("#!/bin/sh\necho no memory\nexit 3\n")
    fake.chmod(0o755)
    done = script("experiments.sh", tmp_path / "runs", ONLY="tqc-", PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode != 0 and "tqc-0 failed" in done.stderr
    assert (tmp_path / "runs/tqc-0.txt").read_text() == "no memory\n"


@pytest.mark.parametrize("only", ["nothing-", "mask-(0"])
def test_a_choice_of_no_run_is_an_error(tmp_path, only):
    done = script("experiments.sh", tmp_path / "runs", ONLY=only, LIST="")
    assert done.returncode == 2 and f"ONLY='{only}' names no run" in done.stderr


def test_the_command_of_the_ladder_is_the_one_that_made_the_file():
    """And a tournament takes it."""
    (words,) = listed("ladder.sh")
    file = Path("agents/results/ladder.json")
    made = shlex.split(json.loads((ROOT / file).read_text(encoding="utf-8"))["command"])
    # the file is of a version with other names of players
    assert words[:3] == made[:3] == ["python", "-m", "agents.tournament"]
    parsed = tournament.parser().parse_intermixed_args(words[3:])
    assert parsed.resume and parsed.out == file and parsed.markdown == file.with_suffix(".md")
