"""Do the commands help, name what is missing, and print on any terminal?"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from commands import lifecycle

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("evaluate", "publish", "curves", "noise_samples", "report")


def python(*arguments, **variables):
    """What a python process does in the repository."""
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        cwd=ROOT,
        env=os.environ | variables,
        timeout=300,
        encoding="utf-8",
    )


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


@pytest.mark.parametrize("package", ["torch", "sb3_contrib", "numpy"])
def test_train_says_what_is_missing(package):
    done = without(package, "train.py")
    assert done.returncode == 1
    assert (
        done.stderr
        == f'train.py: {package} is missing; in a clone of the repository:  pip install -e ".[train]"\n'
    )


@pytest.mark.parametrize(
    ("package", "extra", "module", "arguments"),
    [
        ("yaml", "train", "evaluate", ["--agent", "random"]),
        ("torch", "train", "evaluate", ["--agent", "ppo_mask"]),
        ("matplotlib", "test", "curves", ["runs/x"]),
        ("numba", "train", "noise_samples", []),
        ("yaml", "train", "publish", ["runs/x", "--limits", "none"]),
    ],
)
def test_a_command_says_what_is_missing(package, extra, module, arguments):
    done = without(package, f"agents.{module}", *arguments)
    assert done.returncode == 1
    assert (
        done.stderr
        == f'agents.{module}: {package} is missing; in a clone of the repository:  pip install -e ".[{extra}]"\n'
    )


@pytest.mark.parametrize("module", [f"agents.{name}" for name in MODULES])
def test_help_is_of_the_command_as_it_is_called(module, tmp_path):
    """And compiles nothing: the cache stays empty."""
    done = python("-m", module, "--help", NUMBA_CACHE_DIR=str(tmp_path), COLUMNS="120")
    assert done.returncode == 0 and not done.stderr
    assert done.stdout.startswith(f"usage: python -m {module} [-h]")
    assert not [file for file in tmp_path.rglob("*") if file.suffix in (".nbi", ".nbc")]


QUICK = str.split("--agent random --visits 4 --layouts held_out --noise professional --resamples 100")
TINY = str.split("--agent ppo_mask --envs 2 --eval-visits 4 --parallel one --steps 1 --imitate 0")


def test_any_terminal_will_do(tmp_path):
    """One with few letters shows "?" for the others; the files are whole."""
    encoding, name = "ascii", str(tmp_path / "r\u00e9sum\u00e9 \u2192.json")
    done = python("-m", "agents.evaluate", *QUICK, "--json", name, PYTHONIOENCODING=encoding)
    assert done.returncode == 0 and not done.stderr.strip().startswith("Traceback"), done.stderr
    assert json.loads(Path(name).read_text())["results"]
    assert python("-m", "agents.report", "--show", name, PYTHONIOENCODING=encoding).returncode == 0
    done = python("train.py", *TINY, "--out", str(tmp_path / "\u2192"), PYTHONIOENCODING=encoding)
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
    assert "Means of 4 held-out visits" in done.stdout
    assert (
        python(
            "-m",
            "agents.curves",
            str(tmp_path / "\u2192"),
            "--out",
            str(tmp_path / "\u2192.png"),
            PYTHONIOENCODING=encoding,
        ).returncode
        == 0
    )


def test_ctrl_c_is_one_line(capsys):
    @lifecycle.command("agents.x")
    def main(argv):
        raise KeyboardInterrupt

    assert main() == 130 and capsys.readouterr().err == "agents.x: interrupted\n"
    with pytest.raises(SystemExit) as stop, lifecycle.needs("agents.x"):
        raise KeyboardInterrupt
    assert stop.value.code == 130


@pytest.mark.parametrize("arguments", [["-m", "agents.noise_samples"], ["train.py", *TINY]])
def test_a_reader_that_leaves_ends_a_command_in_one_line_at_most(arguments, tmp_path):
    out = [] if "-m" in arguments else ["--out", str(tmp_path / "run")]
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "w") as nobody:
        done = subprocess.run(
            [sys.executable, *arguments, *out],
            cwd=ROOT,
            stdout=nobody,
            stderr=subprocess.PIPE,
            text=True,
            timeout=300,
        )
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert done.stderr == (
        "train.py: its output was closed. Nothing was saved yet: start the run again.\n" if out else ""
    )
