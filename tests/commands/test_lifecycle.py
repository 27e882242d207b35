"""Do the commands help, name what is missing, and read the errors of a level?"""

import os
import subprocess
import sys

import pytest

from agents._lib import lifecycle
from agents._lib.noise_option import noise_option
from snooker_env.tasks import LEVELS, Noise
from tests.processes import ROOT


def python(*arguments, stdout=subprocess.PIPE, **variables):
    """What a python process does in the repository."""
    pipes = {"stdout": stdout, "stderr": subprocess.PIPE, "encoding": "utf-8"}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, env=os.environ | variables, timeout=300, **pipes)


@pytest.mark.parametrize("below", [True, False])
def test_a_command_to_paste_starts_the_python_that_runs(tmp_path, monkeypatch, below):
    """As "python" if that is it, else by its path."""
    mine, other = (tmp_path / name / "bin" for name in (".venv", "other"))
    for folder in (mine, other):
        folder.mkdir(parents=True)
        (folder / "python").symlink_to(sys.executable)  # as in virtual environments of one installation
    monkeypatch.setattr(sys, "executable", str(mine / "python"))
    monkeypatch.chdir(tmp_path if below else other)
    for first, said in ((mine, "python"), (other, ".venv/bin/python" if below else str(mine / "python"))):
        monkeypatch.setenv("PATH", f"{first}{os.pathsep}{os.environ['PATH']}")
        assert lifecycle.python() == said
    monkeypatch.setenv("PATH", "")
    assert lifecycle.python().endswith(".venv/bin/python")


def without(package, target, *arguments):
    """A command where a package is not installed: train.py, or a module of agents."""
    start = "run_path('train.py'" if target == "train.py" else f"run_module({target!r}"
    code = f"""
import runpy, sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == {package!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
sys.argv = {[target, *arguments]!r}
runpy.{start}, run_name="__main__")
"""
    return python("-c", code)


@pytest.mark.parametrize(
    ("package", "extra", "command"),
    [
        ("torch", "train", "train.py"),
        pytest.param("sb3_contrib", "train", "train.py", marks=pytest.mark.slow),
        ("numpy", "train", "train.py"),
        pytest.param("yaml", "train", "agents.evaluate --agent random", marks=pytest.mark.slow),
        ("torch", "train", "agents.evaluate --agent ppo_value"),
        ("yaml", "train", "snooker_env.watch --agent ppo_value"),
        ("numba", "train", "agents.calibrate x"),
        ("sb3_contrib", "train", "agents.curves"),
    ],
)
def test_a_command_says_what_is_missing(package, extra, command):
    target, *arguments = command.split()
    done = without(package, target, *arguments)
    where = f'in a clone of the repository:  pip install -c constraints.txt -e ".[{extra}]"'
    assert done.stderr == f"{target}: {package} is missing; {where}\n" and done.returncode == 1


@pytest.mark.parametrize("module", [f"agents.{name}" for name in ("curves", "evaluate")])
def test_help_is_of_the_command_as_it_is_called(module, tmp_path):
    """And compiles nothing: the cache stays empty."""
    done = python("-m", module, "--help", NUMBA_CACHE_DIR=str(tmp_path), COLUMNS="120")
    assert done.returncode == 0 and not done.stderr
    assert done.stdout.startswith(f"usage: python -m {module} [-h]")
    assert not [file for file in tmp_path.rglob("*") if file.suffix in (".nbi", ".nbc")]


def test_ctrl_c_is_one_line(capsys):
    @lifecycle.command("agents.x")
    def main(argv):
        raise KeyboardInterrupt

    assert main() == 130 and capsys.readouterr().err == "agents.x: interrupted\n"
    with pytest.raises(SystemExit) as stop, lifecycle.needs("agents.x"):
        raise KeyboardInterrupt
    assert stop.value.code == 130


def test_a_level_is_its_name_and_a_scale_multiplies_its_errors():
    assert noise_option("club") == "club"
    twice, one = Noise.of(noise_option("professional*2")), LEVELS["professional"]
    errors = twice.aim_deg, twice.offset_mm, twice.elevation_deg, twice.speed_rel
    assert errors == (0.028, 0.17, 0.22, 0.034)
    assert (twice.growth, twice.lapse, twice.lapse_factor) == (one.growth, one.lapse, one.lapse_factor)
    assert one.scale(1.0) == one
    assert Noise(speed_abs=0.1).scale(3.0).speed_abs == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("wrong", ["loud", "club*", "club*x", "club*0", "club*nan"])
def test_anything_else_is_refused(wrong):
    with pytest.raises(ValueError, match="noise"):
        noise_option(wrong)
