"""Can the commands behind results/agents/*.md be run as results/make.sh writes them, by their programs?"""

import json
import os
import shlex
import subprocess
from pathlib import Path

import snooker_env.players.resolver as resolver
from agents import tournament
from agents.evaluate import parser
from agents.learning.agent_training import recipe_of
from agents.learning.settings import Settings, parse
from examples import self_play
from snooker_env.players.weights import levels
from tests.processes import ROOT


def make(folder, **variables):
    """A part of ``make.sh``, ended."""
    command = ["bash", str(ROOT / "results/make.sh"), "agents"]
    return subprocess.run(
        command,
        env=os.environ | {"FOLDER": str(folder)} | variables,
        capture_output=True,
        text=True,
        timeout=60,
    )


def listed(folder):
    """The words of the commands that would run."""
    done = make(folder, LIST="1")
    assert done.returncode == 0, done.stderr
    return [shlex.split(line) for line in done.stdout.splitlines()]


def test_every_command_is_one_that_its_program_takes(tmp_path):
    lines = listed(tmp_path)
    runs = [line[2:] for line in lines if line[1] == "train.py"]
    comparisons = [line[3:] for line in lines if line[2] == "agents.evaluate"]
    (played,) = [line[3:] for line in lines if line[2] == "examples.self_play"]
    assert self_play.parse(played).out == tmp_path / "self_play"
    assert len(runs) == 9 and len(comparisons) == 1 and len(runs) + 3 == len(lines)
    recipes = {recipe_of(Settings(**parse(run)[1])).name for run in runs}
    assert recipes == {"ppo_value", "strokes"}
    for comparison in comparisons:
        parsed = parser().parse_args(comparison)
        assert parsed.json.suffix == ".json" and parsed.markdown.with_suffix(".json") == parsed.json
        for agent in parsed.agent:
            label, equals, paths = agent.partition("=")
            for path in (paths if equals else label).split(","):
                player, at, model = path.partition("@")
                assert resolver.is_name(player) and (not at or (equals and model in levels()))


def test_the_command_of_the_ladder_is_the_one_that_made_the_file():
    """That of the page; and a tournament takes it."""
    file = Path("results/agents/ladder.json")
    made = json.loads((ROOT / file).read_text(encoding="utf-8"))["command"]
    page = (ROOT / "docs/agents/tournament.md").read_text(encoding="utf-8")
    assert made in " ".join(page.replace("\\\n", "").split())
    parsed = tournament.parser().parse_intermixed_args(shlex.split(made)[3:])
    assert parsed.resume and parsed.out == file and parsed.markdown == file.with_suffix(".md")
