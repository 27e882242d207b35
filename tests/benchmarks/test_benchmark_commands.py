"""Do the benchmarks behave as commands, with help, Ctrl-C, missing libraries and what cannot be written?"""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from tests.processes import ROOT

NAMES = [file.stem for file in (ROOT / "benchmarks").glob("*.py")]
NAMES += [file.parent.name for file in (ROOT / "benchmarks").glob("*/__main__.py")]
COMMANDS = sorted(name for name in NAMES if not name.startswith("_"))
WITHOUT_CHANCE = ("paper", "pockets")


def started(name, *arguments, **environment):
    """``python -m benchmarks.NAME``, running."""
    command = [sys.executable, "-m", f"benchmarks.{name}", *map(str, arguments)]
    texts = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, cwd=ROOT, env=os.environ | environment, **texts)


def ended(process, timeout=300):
    """Exit code, stdout, stderr."""
    try:
        out, err = process.communicate(timeout=timeout)
    finally:
        process.kill()
    return process.returncode, out, err


HELP = """
import contextlib, io, json, runpy, sys

shown = {}
for name in sys.argv[1:]:
    sys.argv[1:] = ["--help"]
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
        runpy.run_module(f"benchmarks.{name}", run_name="__main__", alter_sys=True)
    shown[name] = printed.getvalue()
print(json.dumps(shown))
"""


def test_help_is_printed_and_nothing_is_compiled(tmp_path):
    """In one process: most of the time goes into imports."""
    command = [sys.executable, "-c", HELP, *COMMANDS]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and done.stderr == ""
    shown = json.loads(done.stdout)
    assert list(shown) == COMMANDS
    for name, out in shown.items():
        assert out.startswith(f"usage: python -m benchmarks.{name} [-h]"), (name, out[:80])
        assert "show this help message" in out and "--out FOLDER" in out and "--json FILE" in out
        assert ("--seed N" in out) == (name not in WITHOUT_CHANCE), name
    assert not list(tmp_path.rglob("*.nb?"))


def interrupted(process, seconds):
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    return ended(process, 60)


STOPPED = "benchmarks.make_tables: interrupted"


@pytest.mark.slow
def test_ctrl_c_is_one_line_and_leaves_no_file(tmp_path):
    (made := tmp_path / "made").mkdir()
    # compiled first: a signal inside LLVM can end the process by a fault of its own
    assert ended(started("make_tables", "opened", "--tables", 2, "--out", made))[0] == 0
    (stopped := tmp_path / "stopped").mkdir()
    code, out, err = interrupted(
        started("make_tables", "opened", "--tables", 1_000_000, "--out", stopped), 4.0
    )
    assert (code, out, err.strip()) == (130, "", STOPPED)
    assert list(made.iterdir()) and not list(stopped.iterdir())


def test_ctrl_c_while_libraries_are_loaded_is_one_line_too(tmp_path):
    """A numpy that takes long to load and says that it does."""
    begins = f"open({str(tmp_path / 'loading')!r}, 'w').close()"
    (tmp_path / "numpy.py").write_text(f"import time\n{begins}\ntime.sleep(60)")
    process = started("make_tables", "opened", PYTHONPATH=os.pathsep.join([str(tmp_path), str(ROOT)]))
    give_up = time.monotonic() + 60
    while not (tmp_path / "loading").exists() and time.monotonic() < give_up:
        time.sleep(0.05)
    code, out, err = interrupted(process, 0)
    assert (code, out, err.strip()) == (130, "", "interrupted")


@pytest.mark.parametrize("where", ["a folder", "under a file"])
def test_a_file_that_cannot_be_written_is_refused_before_the_work(tmp_path, where):
    (tmp_path / "file").write_text("")
    place = {"a folder": tmp_path, "under a file": tmp_path / "file" / "x.json"}[where]
    start = time.perf_counter()
    code, out, err = ended(started("paper", "--no-pictures", "--json", place))
    assert code == 2 and out == "" and time.perf_counter() - start < 120
    says = re.escape(f"error: json = {str(place)!r}: must be a file that can be written (")
    assert re.search(says + r"\S.*\)\n$", err), err


@pytest.mark.slow
def test_what_is_printed_is_written_beside_the_pictures(tmp_path):
    new = tmp_path / "new"
    code, out, err = ended(started("paper", "--out", new, "--json", new / "figures.json"))
    assert (code, err) == (0, "") and (new / "paper.txt").read_text() == out
    files = sorted(file.name for file in new.iterdir())
    assert files == ["figures.json", "paper.png", "paper.txt", "paper_data.png"]


def test_a_library_that_is_missing_is_named_and_how_to_install_it(tmp_path):
    (tmp_path / "scipy.py").write_text("raise ModuleNotFoundError('No module named scipy', name='scipy')")
    code, out, err = ended(started("paper", PYTHONPATH=os.pathsep.join([str(tmp_path), str(ROOT)])))
    said = 'scipy is missing; in a clone of the repository:  pip install -c constraints.txt -e ".[test]"'
    assert (code, out, err) == (1, "", f"{said}\n")
