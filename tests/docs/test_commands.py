"""Does each command of the documentation run? In a short form, or in the test named beside it."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT, commands

SHORT = {
    "benchmarks.tradeoff": "--impacts 30 --shots 12 --repeats 1 --out {tmp}",
    "benchmarks.scene": "--shots 12 --repeats 1 --models 'spin decay' 'jaw arcs' --out {tmp}",
    "benchmarks.pockets": "--out {tmp}",
    "benchmarks.stability": "--fuzz 2000 --out {tmp}",
    "benchmarks.speed": "--shots 20 --repeats 1 --parts impacts shots --out {tmp}",
    "benchmarks.make_tables": "safety --tables 2 --out {tmp}",
    "benchmarks.execution": "--strokes 40 --visits 4 --levels professional robot",
    "benchmarks.coach": "--players 2 --strokes 10 --pool 10 --levels club",
    "benchmarks.page": "--frames 2",
    "benchmarks.fuzz": "--shots 300 --threads 1",
    "snooker_env.watch": "--agent ghost_ball --out {tmp}/visit.html",
    "tests.rules_cases": "tests/data/rules_cases.json",
    "tests/advice/coach.py": "stroke_value",
    "tests.oracles.frame_oracle": "--frames 2 --kind tables",
    "results/make_pictures.py": "pot_easy --out {tmp}",
}
"""Module or file -> arguments of a run of a few seconds; "{tmp}" is a folder that is thrown away."""

SLOW = {"results/make_pictures.py", "tests/advice/coach.py"} | {
    f"benchmarks.{name}"
    for name in [
        "coach",
        "make_tables",
        "page",
        "pockets",
        "scene",
        "speed",
        "stability",
        "tradeoff",
    ]
}
"""Those of ``SHORT`` that compile, train or draw much."""

ELSEWHERE = {
    "pytest": ".ci/run",
    "sphinx": ".ci/run",
    "venv": ".ci/run",
    "train.py": "tests/agents/test_train.py",
    "tests.golden": "tests/test_golden.py",
    "snooker_env": "tests/commands/test_names.py",
    "snooker_env.play": "tests/play/test_server.py",
    "snooker_env.advice": "tests/advice/test_coaching.py",
    "snooker_env.benchmark": "tests/benchmark/test_results.py",
    "benchmarks.paper": "tests/benchmarks/test_benchmark_commands.py",
    "benchmarks.real_shots": "tests/benchmarks/test_real_shots.py",
    "agents.evaluate": "tests/commands/test_lifecycle.py",
    "agents.report": "tests/commands/test_lifecycle.py",
    "agents.curves": "tests/agents/test_curves.py",
    "agents.croissant": "tests/agents/test_croissant.py",
    "agents.dataset": "tests/agents/evaluation/test_dataset.py",
    "agents.tournament": "tests/agents/evaluation/test_tournament.py",
    "agents.learn_worth": "tests/agents/learning/test_frame_worth.py",
    "agents.calibrate": "tests/agents/evaluation/test_calibrate.py",
    "paper/build.py": "tests/repository/test_release.py",
    "examples/fit_your_data.py": "tests/examples/test_fit.py",
    "examples.self_play": "tests/examples/test_self_play.py",
    "examples.ppo_single_file": "tests/examples/test_ppo_single_file.py",
    "examples.behaviour_cloning": "tests/agents/evaluation/test_dataset.py",
    "examples.ppo_torchrl": "tests/examples/test_ppo_torchrl.py",
    "examples.ppo_rllib": "tests/examples/test_ppo_rllib.py",
    "rl_zoo3.train": "tests/agents/trainers/test_rl_zoo.py",
}
"""Module or file -> the test that runs it."""

DECLARED = {
    "train.py": ["agents/train.py", "agents/learning/settings.py"],
    "agents.evaluate": ["agents/cluster.py", "snooker_env/players/saved_models.py"],
    "agents.tournament": ["agents/cluster.py", "snooker_env/players/saved_models.py"],
    "agents.learn_worth": ["agents/cluster.py"],
    "benchmarks.": ["benchmarks/_common/command.py"],
    "snooker_env.": ["snooker_env/players/saved_models.py"],
}
"""How a command's name begins -> other files that declare options of it."""

GIVEN = {name: set() for page in PAGES for name, _ in commands(page.read_text(encoding="utf-8"))}
"""Module or file -> the options that some page gives it."""
for _page in PAGES:
    for _name, _words in commands(_page.read_text(encoding="utf-8")):
        GIVEN[_name].update(found[0] for word in _words if (found := re.match(r"--[a-z][\w-]*", word)))


def test_every_command_is_known():
    known = [*SHORT, *ELSEWHERE]
    assert len(GIVEN) > 20 and not set(GIVEN) - set(known)
    assert len(set(known)) == len(known)


@pytest.mark.parametrize("name", sorted(set(GIVEN) - {"pytest", "sphinx", "venv", "rl_zoo3.train"}))
def test_commands_have_the_options_that_are_given(name):
    """They stand in the source of the command itself, or in one of the files that declare options for several."""
    path = Path(name) if name.endswith(".py") else Path(*name.split("."))
    mine = [*(ROOT / path).rglob("*.py"), ROOT / path.with_suffix(".py")]
    files = [file for file in mine if file.is_file()]
    assert files, f"{name}: no such command"
    for top, shared in DECLARED.items():
        files += [ROOT / file for file in shared] if name.startswith(top) else []
    source = "\n".join(file.read_text(encoding="utf-8") for file in files)
    for option in GIVEN[name]:
        field = option[2:].replace("-", "_")
        assert re.search(rf'"{option}"|^    {field}: ', source, re.MULTILINE), option


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow if name in SLOW else [])
        for name in sorted(set(GIVEN) & set(SHORT))
    ],
)
def test_commands_run(name, tmp_path):
    arguments = shlex.split(SHORT[name].format(tmp=tmp_path))
    command = [sys.executable, name] if name.endswith(".py") else [sys.executable, "-m", name]
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"SDL_VIDEODRIVER": "dummy", "PYTHONPATH": path}
    printed = subprocess.check_output([*command, *arguments], cwd=ROOT, timeout=300, text=True, env=env)
    assert printed.strip()
    if name == "tests.rules_cases":
        assert printed.splitlines()[-1].endswith(", 0 failed")
    if name == "results/make_pictures.py":
        assert (tmp_path / "pot_easy.mp4").stat().st_size > 5_000


def test_the_tests_that_are_named_exist():
    """Of ``python -m pytest tests/...``."""
    named = [
        word
        for page in PAGES
        for name, words in commands(page.read_text(encoding="utf-8"))
        for word in words
        if name == "pytest" and word.startswith("tests/")
    ]
    assert len(named) > 3 and not [word for word in named if not (ROOT / word).exists()]
