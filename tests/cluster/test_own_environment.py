"""Do the tests of the cluster pass where Ray is installed? In a virtual environment made for them.

``.ci/run`` runs the short form; the whole takes ten minutes."""

import os
import re
import subprocess
import sysconfig
import venv
from pathlib import Path

import pytest

from tests.processes import ROOT

SHORT = ["tests/cluster/test_ray.py", "-k", "two_nodes_play or amid or imitation or one_line"]
WHOLE = ["tests/cluster", "-m", "slow or not slow", "--deselect", "tests/cluster/test_own_environment.py"]


def required():
    """What the extra ``cluster`` needs beside this package."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    line = re.search(r"^cluster = \[(.*)\]$", text, re.MULTILINE)
    assert line is not None
    return [one for one in re.findall(r'"([^"]+)"', line[1]) if not one.startswith("snooker-env")]


@pytest.mark.slow
@pytest.mark.parametrize("tests", [SHORT, WHOLE], ids=["short", "whole"])
def test_the_tests_of_the_cluster_pass(tests, tmp_path):
    folder = tmp_path / "environment"
    venv.create(folder, with_pip=True, symlinks=True)
    python = str(folder / "bin" / "python")
    env, texts = os.environ | {"PYTHONPATH": str(ROOT)}, {"capture_output": True, "text": True}
    code = "import sysconfig; print(sysconfig.get_paths()['purelib'])"
    site = subprocess.run([python, "-c", code], check=True, **texts).stdout.strip()
    Path(site, "libraries.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    install = [python, "-m", "pip", "install", "--quiet", *required()]
    done = subprocess.run(install, env=env, timeout=600, **texts)
    if done.returncode:
        pytest.skip(f"Ray cannot be installed here: {done.stderr.strip().splitlines()[-1]}")
    command = [python, "-m", "pytest", "-n", "0", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(command, cwd=ROOT, env=env, timeout=1800, **texts)
    assert done.returncode == 0, done.stdout[-6000:]
    assert " skipped" not in done.stdout.splitlines()[-1] and " passed" in done.stdout, done.stdout[-500:]
