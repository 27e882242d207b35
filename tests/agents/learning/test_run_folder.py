"""Does a run's folder belong to one run at a time, and are its files whole whatever happens?"""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import snooker_env as sn
import train
from agents._lib import lock
from agents._lib.files import write_atomic
from agents._lib.lifecycle import python
from agents.learning import loop
from agents.learning.models import CHECKPOINT
from agents.learning.run_folder import SETTINGS, kept_settings, read_checkpoint
from agents.learning.settings import Settings
from tests.agents.test_train import FILES
from tests.agents.training import TINY, resume, run
from tests.flips import flipped
from tests.processes import ROOT

CONTINUE = f"Continue with:  {python()} train.py --resume --out"
NO_SPACE = (28, "No space left on device")


@pytest.fixture
def other(tmp_path):
    """Another process that holds the folder, as train.py does; its output ends once it does."""
    code = f"""
import time
from pathlib import Path
from agents._lib.lock import Lock
held = Lock(Path({str(tmp_path)!r}))
print("held", flush=True)
time.sleep(600)
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


@pytest.mark.parametrize(
    ("more", "holds"), [([], []), (["--resume"], ["checkpoint.pkl", "settings.json"])], ids=["begun", "saved"]
)
def test_a_folder_in_use_is_refused_by_the_name_of_the_process(
    other, tmp_path, refused, monkeypatch, more, holds
):
    monkeypatch.setattr(sn, "warmup", None)  # nothing is compiled before
    for name in holds:
        (tmp_path / name).write_bytes(b"of the other")
    error = refused(train.main, *TINY, "--out", tmp_path, *more)
    why = f"out = {str(tmp_path)!r}: must be a folder that no other process uses: process {other.pid} on "
    assert why in error
    assert " since 20" in error and f"kill -INT {other.pid} (it saves" in error and "another --out" in error
    assert sorted(p.name for p in tmp_path.iterdir()) == [*holds, "train.lock"]
    assert all((tmp_path / name).read_bytes() == b"of the other" for name in holds)


def test_a_lock_ends_with_its_process(other, tmp_path):
    with pytest.raises(ValueError, match=f"process {other.pid} on"):
        lock.Lock(tmp_path)
    other.kill()
    other.wait()
    assert (tmp_path / "train.lock").exists()
    with lock.Lock(tmp_path):
        assert f"process {os.getpid()} on" in (tmp_path / "train.lock").read_text()
        with pytest.raises(ValueError, match=f"process {os.getpid()} on"):
            lock.Lock(tmp_path)
    assert not list(tmp_path.iterdir())
    lock.Lock(tmp_path).release()


@pytest.mark.slow
def test_what_a_killed_run_left_is_no_other_run(tmp_path, refused):
    left = ("train.lock", f".checkpoint.{16 * '0'}.tmp.pkl", f".model.{16 * 'f'}.tmp.zip")
    for name in left:
        (tmp_path / name).write_text("half")
    (tmp_path / "tb").mkdir()
    assert run(tmp_path) == 0
    assert {p.name for p in tmp_path.iterdir()} == FILES
    (tmp_path / "checkpoint.tmp.pkl").write_text("mine")
    assert "is not empty" in refused(train.main, *TINY, "--out", tmp_path)
    assert (tmp_path / "checkpoint.tmp.pkl").exists() and not (tmp_path / "train.lock").exists()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An uninterrupted run."""
    out = tmp_path_factory.mktemp("runs") / "whole"
    assert run(out, "--steps", "128") == 0
    return out


def test_no_flipped_bit_of_a_checkpoint_or_of_settings_is_used(whole, tmp_path):
    for name in (CHECKPOINT, SETTINGS):
        shutil.copy(whole / name, tmp_path)
    for _ in flipped(tmp_path / CHECKPOINT):
        with pytest.raises(ValueError, match=rf"^resume = '{tmp_path / CHECKPOINT}': must be a complete"):
            read_checkpoint(tmp_path)
    for _ in flipped(tmp_path / SETTINGS):
        with pytest.raises(
            ValueError, match=rf"^out = '{tmp_path / SETTINGS}': must be complete and written"
        ):
            kept_settings(tmp_path, Settings)
    assert read_checkpoint(tmp_path)["parts"] and kept_settings(tmp_path, Settings).steps == 128


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_acts_at_once_whichever_it_is(first):
    plain = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    with loop.Stop() as stop:
        signal.raise_signal(first)
        assert stop.signal == first and all(signal.getsignal(second) == its for second, its in plain.items())


@pytest.mark.parametrize("broken", ["fsync", "replace"])
def test_failed_write_leaves_the_old_file_alone(tmp_path, monkeypatch, broken):
    path = tmp_path / "file"
    write_atomic(path, b"old")

    def fail(*_):
        raise OSError(*NO_SPACE)

    with monkeypatch.context() as patch:
        patch.setattr(os, broken, fail)
        with pytest.raises(OSError, match="No space left") as stop:
            write_atomic(path, b"new, and longer")
    assert stop.value.filename == str(path)
    assert path.read_bytes() == b"old" and [p.name for p in tmp_path.iterdir()] == ["file"]
    write_atomic(path, b"new")
    assert path.read_bytes() == b"new" and [p.name for p in tmp_path.iterdir()] == ["file"]


RARE = [pytest.param(name, marks=pytest.mark.slow) for name in ("checkpoint.pkl", "model.zip")]


@pytest.mark.parametrize("full", [*RARE, "results.json"])
def test_a_full_disk_ends_it_in_one_line(tmp_path, monkeypatch, capsys, full):
    """No unfinished file stays, and the run can go on."""
    out, original = tmp_path / "run", os.replace

    def replace(source, target):
        if Path(target).name == full:
            raise OSError(*NO_SPACE)
        original(source, target)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", replace)
        assert run(out, "--steps", "128") == 1
    why = f"train.py: {out / full} cannot be written: No space left on device"
    assert capsys.readouterr().err.splitlines() == [f"{CONTINUE} {out}", why]
    assert not [p.name for p in out.iterdir() if ".tmp" in p.name or p.suffix == ".lock"]
    assert resume(out) == 0


def test_a_link_is_followed(tmp_path):
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    write_atomic(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").read_bytes() == b"new"
