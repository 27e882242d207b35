"""Does a run's folder belong to one run at a time, and does one that stopped while it imitated go on exactly?"""

import os
import pickle
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import train
from agents.learning import callback
from agents.learning.imitation import Imitation
from agents.learning.models import CHECKPOINT
from agents.learning.run_folder import read_checkpoint
from agents.players.trained import load_player
from commands import lock
from commands.files import write_atomic
from commands.lifecycle import python
from snooker_env.progress import Progress
from tests.agents import training
from tests.agents.training import TINY, results, resume, weights
from tests.flips import flipped
from tests.processes import ROOT

CONTINUE = f"Continue with:  {python()} train.py --resume --out"
NO_SPACE = (28, "No space left on device")


def run(out, *options):
    """With few shots, after some imitation."""
    return training.run(out, "--steps", "256", "--imitate", "64", *options)


@pytest.fixture
def other(tmp_path):
    """Another process that holds the folder, as train.py does; its output ends once it does."""
    code = f"""
import time
from pathlib import Path
from commands.lock import Lock
held = Lock(Path({str(tmp_path)!r}))
print("held", flush=True)
time.sleep(600)
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


@pytest.mark.parametrize("more", [[], ["--resume"]])
@pytest.mark.parametrize("holds", [[], ["checkpoint.pkl"]], ids=["imitating", "saved"])
def test_a_folder_in_use_is_refused_by_the_name_of_the_process(
    other, tmp_path, refused, monkeypatch, more, holds
):
    monkeypatch.setattr(train.snooker_env, "warmup", None)  # nothing is compiled before
    for name in holds:
        (tmp_path / name).write_bytes(b"of the other")
    error = refused(train.main, *TINY, "--out", tmp_path, *more)
    why = f"out = {str(tmp_path)!r}: must be a folder that no other process uses: process {other.pid} on "
    assert why in error
    assert " since 20" in error and f"(kill -INT {other.pid})" in error and "another --out" in error
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


def test_what_a_killed_run_left_is_no_other_run(tmp_path, refused):
    left = ("train.lock", f".checkpoint.{16 * '0'}.tmp.pkl", f".model.{16 * 'f'}.tmp.zip")
    for name in left:
        (tmp_path / name).write_text("half")
    (tmp_path / "tb").mkdir()
    assert training.run(tmp_path) == 0
    assert {p.name for p in tmp_path.iterdir()} == {"checkpoint.pkl", "model.zip", "results.json", "tb"}
    (tmp_path / "checkpoint.tmp.pkl").write_text("mine")
    assert "is not empty" in refused(train.main, *TINY, "--out", tmp_path)
    assert (tmp_path / "checkpoint.tmp.pkl").exists() and not (tmp_path / "train.lock").exists()


def after(rounds, monkeypatch, act):
    """Let ``act`` happen once, when so many rounds of imitation are over."""
    original, done = Imitation.round, []

    def counted(self):
        original(self)
        done.append(self.done)
        if len(done) == rounds:
            act()

    monkeypatch.setattr(Imitation, "round", counted)


def interrupt():
    raise KeyboardInterrupt


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An uninterrupted run."""
    out = tmp_path_factory.mktemp("runs") / "whole"
    assert run(out) == 0
    return out


def untimed(out):
    """The results but for what the clock says."""
    found = results(out)
    imitation = [{key: at[key] for key in ("states", "loss")} for at in found["imitation"]]
    return [imitation, *(found[name] for name in ("settings", "steps", "curve", "evaluation", "learned"))]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_saves_what_was_imitated_and_resume_goes_on_exactly(
    whole, tmp_path, capsys, monkeypatch, number
):
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        after(20, patch, lambda: signal.raise_signal(number))
        assert run(out) == 128 + number
    assert f"Saved at 40 of 64 positions. {CONTINUE} {out}" in capsys.readouterr().out
    assert {p.name for p in out.iterdir()} == {"checkpoint.pkl"}
    assert signal.getsignal(number) in (signal.default_int_handler, signal.SIG_DFL)
    assert resume(out) == 0
    assert "imitation, 40 of 64 positions" in capsys.readouterr().out
    assert np.array_equal(weights(out), weights(whole)) and untimed(out) == untimed(whole)
    assert len(untimed(out)[0]) == 20 and load_player(out).model.imitated == 64


def test_imitation_is_saved_at_intervals(whole, tmp_path, capsys, monkeypatch):
    """What comes without warning, as a kill does, loses only what was imitated since the last save."""
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        patch.setattr(callback, "LEAST", -1.0)
        patch.setattr(callback, "SHARE", np.inf)
        after(13, patch, interrupt)
        assert run(out) == 130
    assert f"Interrupted. The last checkpoint is complete. {CONTINUE} {out}" in capsys.readouterr().err
    assert pickle.loads((out / "checkpoint.pkl").read_bytes())["imitating"]["done"] == 24
    assert resume(out) == 0
    assert np.array_equal(weights(out), weights(whole)) and untimed(out) == untimed(whole)


def test_no_flipped_bit_of_a_checkpoint_is_used(whole, tmp_path):
    shutil.copy(whole / CHECKPOINT, tmp_path)
    for _ in flipped(tmp_path / CHECKPOINT):
        with pytest.raises(ValueError, match=rf"^resume = '{tmp_path / CHECKPOINT}': must be a complete"):
            read_checkpoint(tmp_path, train.Settings)
    assert read_checkpoint(tmp_path, train.Settings)[1].steps == 256


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("second", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_acts_at_once_whichever_it_is(first, second):
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    with callback.Stop() as stop:
        signal.raise_signal(first)
        assert stop.signal == first
        plain = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
        assert signal.getsignal(second) == plain[second]
    assert before == [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]


def test_saves_are_rare(tmp_path, monkeypatch):
    """By the clock, and rarer where they are slow."""
    saves, now = [], [0.0]
    monkeypatch.setattr(callback.time, "perf_counter", lambda: now[0])

    def save(out, settings, model, seconds, curve, imitation, state):
        saves.append(now[0])
        now[0] += 5.0

    class Lessons:
        states, done, curve, figures = 2000, 0, [{"states": 2000}], ""

        def round(self):
            self.done += 1
            now[0] += 1.0

        def get_state(self):
            return None

    monkeypatch.setattr(callback, "save_checkpoint", save)
    silent = Progress("", 2000, "", quiet=True)
    assert callback.imitate(Lessons(), tmp_path, train.Settings(), Lessons(), callback.Stop(), silent)
    assert saves[0] == 31.0 and np.array_equal(np.diff(saves), [506.0] * 3)


def test_an_interruption_before_the_first_save_is_reported(tmp_path, capsys, monkeypatch):
    after(3, monkeypatch, interrupt)
    assert run(tmp_path / "run") == 130
    assert capsys.readouterr().err == "Interrupted. Nothing was saved yet: start the run again.\n"
    assert not list((tmp_path / "run").iterdir())


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


def test_a_link_is_followed_and_a_device_written(tmp_path):
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    write_atomic(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").read_bytes() == b"new"
    write_atomic(Path(os.devnull), b"gone")
    assert not Path(os.devnull).is_file()


@pytest.mark.parametrize("full", ["checkpoint.pkl", "model.zip", "results.json"])
def test_a_full_disk_ends_it_in_one_line(tmp_path, monkeypatch, full):
    """The checkpoint before stays, whole; no unfinished file does."""
    out, original = tmp_path / "run", os.replace

    def replace(source, target):
        if Path(target).name == full and (full != "checkpoint.pkl" or Path(target).exists()):
            raise OSError(*NO_SPACE)
        original(source, target)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", replace)
        with pytest.raises(SystemExit) as stop:
            run(out, "--imitate", "0", "--checkpoint-every", "1")
    why = f"train.py: {out / full} cannot be written: No space left on device"
    assert stop.value.code == f"{why}. The last checkpoint is complete. {CONTINUE} {out}"
    assert not [p.name for p in out.iterdir() if ".tmp" in p.name or p.suffix == ".lock"]
    assert resume(out) == 0


@pytest.mark.slow
def test_the_systems_own_limit_is_reported_in_one_line(tmp_path):
    """A process that may write 50 kB a file: no traceback, nothing left."""
    code = f"""
import resource, runpy, sys
import train
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
sys.exit(train.main({[*TINY, "--out", str(tmp_path / "run")]!r}))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, timeout=300)
    file = tmp_path / "run" / "checkpoint.pkl"
    why = f"train.py: {file} cannot be written: File too large"
    assert done.stderr == f"{why}. Nothing was saved yet: start the run again.\n" and done.returncode == 1
    assert {p.name for p in file.parent.iterdir()} <= {"tb"}


def test_a_folder_that_was_moved_leaves_the_lock_of_another_run_alone(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    first = lock.Lock(folder)
    folder.rename(tmp_path / "moved")
    folder.mkdir()
    with lock.Lock(folder):
        first.release()
        with pytest.raises(ValueError, match="no other process"):
            lock.Lock(folder)
