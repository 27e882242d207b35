"""Does ``pip install`` of the wheel alone give everything that the documentation says it does?"""

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from tests.processes import ROOT

hatchling = pytest.importorskip("hatchling.build")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a process is ended as POSIX does")
def test_the_wheel_alone_plays_simulates_advises_serves_and_judges(tmp_path, monkeypatch):
    """In an environment with the wheel's own requirements, from the index; the parts are in wheel_alone.py."""
    monkeypatch.chdir(ROOT)
    wheel = tmp_path / hatchling.build_wheel(str(tmp_path))
    python = tmp_path / "venv" / "bin" / "python"
    venv.create(tmp_path / "venv", with_pip=True)
    env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    (tmp_path / "empty").mkdir()
    where = {"cwd": tmp_path / "empty", "env": env}
    for words in (["-m", "pip", "install", "--quiet", wheel], [Path(__file__).with_name("wheel_alone.py")]):
        done = subprocess.run([python, *words], **where, capture_output=True, text=True, timeout=1200)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-3000:]
    assert "missing extras" in done.stdout
