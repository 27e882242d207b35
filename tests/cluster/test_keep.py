"""Does the folder in which a job keeps its parts belong to one job at a time? With processes of their own;
without Ray."""

import subprocess
import sys
from pathlib import Path

import pytest

from agents.cluster.keep import Keep
from tests.processes import ROOT

ABOUT = {"command": "agents.evaluate", "noise": ["club"]}
HOLDS = f"""
import sys
from agents.cluster.keep import Keep
with Keep(None, "local", {ABOUT!r}) as keep:
    keep.store.write("parts/a.npz", b"a")
    print(keep.store, flush=True)
    if sys.stdin.readline() == "complete\\n":
        keep.done()
"""


@pytest.fixture
def holder(tmp_path, monkeypatch):
    """Another process with the same job, in whose folder is a part; and that folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    yield process, tmp_path / process.stdout.readline().strip()
    process.kill()
    process.communicate()


def test_a_job_that_another_process_plays_is_refused_by_its_name(holder):
    process, folder = holder
    with pytest.raises(
        ValueError,
        match=rf"keep = '.*{folder.name}'.*: process {process.pid} on .* does.*give another --keep",
    ) as error:
        Keep(None, "10.0.0.1:6379", ABOUT)  # wherever it is played
    assert "\n" not in str(error.value) and (folder / "parts" / "a.npz").read_bytes() == b"a"
    for url, address, about in (
        ("other", "local", ABOUT),
        (None, "local", ABOUT | {"noise": ["none"]}),
        (None, None, ABOUT),
    ):
        with Keep(url, address, about) as keep:
            assert keep.store is None or Path(keep.store.url).resolve() != folder.resolve()


def test_its_folder_is_free_and_gone_when_it_is_complete(holder):
    process, folder = holder
    process.communicate("complete\n")
    assert process.returncode == 0 and not list(folder.parent.iterdir())
    with Keep(None, "local", ABOUT) as keep:
        assert keep.store.names("parts") == set()


@pytest.mark.parametrize("end", ["stopped", "killed"])
def test_the_same_job_goes_on_with_what_was_kept(holder, end):
    process, folder = holder
    if end == "killed":
        process.kill()
    process.communicate("no\n")
    with Keep(None, "local", ABOUT) as keep:
        assert Path(keep.store.url).resolve() == folder.resolve() and keep.store.names("parts") == {"a.npz"}
        keep.done()
    assert not list(folder.parent.iterdir())


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs").write_text("a file")
    with pytest.raises(ValueError, match=r"keep = .*must be a folder or URL that can be written"):
        Keep(None, "local", ABOUT)
