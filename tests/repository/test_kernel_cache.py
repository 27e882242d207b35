"""Is kept machine code loaded only where nobody else can write, and is a damaged or full cache harmless?"""

import os
import pickle
import stat
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from snooker_env._lib import cache
from snooker_env._lib.seal import seal
from tests.processes import ROOT, python

TOY = """
from snooker_env._lib.jit import entry

@entry(what="a toy", seconds=3)
def double(x):
    return 2.0 * x

@entry
def half(x):
    return 0.5 * x
"""
RUN = """
import toy
print(toy.double(1.5), toy.half(3.0), *(sum(kernel.stats.cache_hits.values()) for kernel in (toy.double, toy.half)))
"""
FRESH, LOADED, MIXED = "3.0 1.5 0 0", "3.0 1.5 1 1", "3.0 1.5 0 1"
root_only = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give files away"
)


@pytest.fixture
def toy(tmp_path):
    """Runs two small entry kernels in a fresh process: what it prints (results, cache hits), and stderr."""
    (tmp_path / "toy").mkdir()
    (tmp_path / "toy/toy.py").write_text(TOY)

    def run(before="", **variables):
        paths = os.pathsep.join([str(tmp_path / "toy"), str(ROOT)])
        variables = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": paths} | variables
        out, err = python(before + RUN, warn="error,default::RuntimeWarning", **variables)
        return out.strip(), err

    run.cache, run.folder = tmp_path / "cache", tmp_path / "cache" / "snooker_env" / cache.kernel_hash()
    return run


def files(toy, pattern):
    return sorted(toy.folder.rglob(pattern))


def name_of(toy, file):
    """Under which its checksum is made."""
    return file.relative_to(toy.folder.parent).as_posix()


# Folders of others


def test_folders_are_made_for_the_user_alone_whatever_the_umask(toy):
    assert toy("import os; os.umask(0)\n", NUMBA_CACHE_DIR=str(toy.cache / "deep")) == (FRESH, "")
    made = [toy.cache, *toy.cache.rglob("*")]
    assert len(made) > 6
    for path in made:
        assert stat.S_IMODE(path.stat().st_mode) == (0o700 if path.is_dir() else 0o600), path
    assert not list(toy.cache.rglob("*tmp*"))


def unsafe(monkeypatch, home, match):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(home))
    with pytest.warns(RuntimeWarning, match=match) as seen:
        assert cache.cache_folder() is None
    assert len(seen) == 1 and "set NUMBA_CACHE_DIR to a folder of your own" in str(seen[0].message)
    return str(seen[0].message)


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """The chosen folder and those that are made in it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "home"))
    folder = cache.cache_folder()
    return {"home": folder.parents[1], "snooker_env": folder.parent, "hash": folder}


MODES = {"home": (0o777, 0o702), "snooker_env": (0o777, 0o1777, 0o720), "hash": (0o702, 0o770)}


@pytest.mark.parametrize("which", MODES)
def test_a_folder_that_others_can_write_to_is_not_used(folders, monkeypatch, which):
    for mode in MODES[which]:
        folders[which].chmod(mode)
        message = unsafe(monkeypatch, folders["home"], "others can write to")
        assert f"others can write to {folders[which]} (mode {mode:04o}): no machine code is loaded" in message
    folders[which].chmod(0o700)
    assert cache.cache_folder() == folders["hash"]


@root_only
def test_a_folder_of_another_user_is_not_used(folders, monkeypatch):
    for folder in reversed(folders.values()):
        os.chown(folder, 12345, -1)
        said = unsafe(monkeypatch, folders["home"], "belongs to")
        assert f"{folder} belongs to another user (uid 12345)" in said


def test_a_shared_home_is_good_and_without_owners_none_are_checked(folders, monkeypatch):
    for mode in (0o1777, 0o775, 0o755):  # /tmp; a home of the user's own group; readable by others
        folders["home"].chmod(mode)
        assert cache.cache_folder() == folders["hash"]
    folders["snooker_env"].chmod(0o777)
    monkeypatch.delattr(os, "geteuid")
    assert cache.cache_folder() == folders["hash"]


def test_a_user_without_a_home_has_no_folder(monkeypatch, tmp_path):
    """A folder called ~ may lie in whatever folder the program runs, made by anybody."""
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    monkeypatch.chdir(tmp_path)
    says = "no home folder: .*every process compiles for itself; set NUMBA_CACHE_DIR"
    with pytest.warns(RuntimeWarning, match=says):
        assert cache.cache_folder() is None
    assert not list(tmp_path.iterdir())


class Planted:
    """Unpickled, it leaves a mark."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return Path.touch, (self.mark,)


def test_code_that_somebody_could_have_planted_is_not_run(toy, tmp_path):
    """Where the folders are the user's own it would be: so this test can fail."""
    assert toy() == (FRESH, "")
    mark, (index, *_) = tmp_path / "mark", files(toy, "*.nbi")
    planted = pickle.dumps("another version") + pickle.dumps(0)

    folder = index.parent
    index.write_bytes(seal(pickle.dumps(Planted(mark)) + planted, name_of(toy, index)))
    folder.chmod(0o777)
    out, err = toy()
    assert out == FRESH and not mark.exists()
    assert err.count("RuntimeWarning") == 1 and f"others can write to {folder} (mode 0777)" in err
    folder.chmod(0o700)
    toy()
    assert mark.exists()


# Broken files, full disks


DAMAGED = {
    "empty": lambda data: b"",
    "cut": lambda data: data[: len(data) // 2],
    "garbage": lambda data: b"garbage" * 99,
    "one bit": lambda data: data[:40] + bytes([data[40] ^ 4]) + data[41:],
}
OFTEN = [("*double*.nbc", "one bit")]
CASES = [(what, how) for what in ("*double*.nbi", "*double*.nbc") for how in DAMAGED]


@pytest.mark.parametrize(
    ("what", "how"), [pytest.param(*case, marks=[] if case in OFTEN else pytest.mark.slow) for case in CASES]
)
def test_a_damaged_file_is_compiled_and_kept_anew(toy, what, how):
    toy()
    (path,) = files(toy, what)
    path.write_bytes(DAMAGED[how](path.read_bytes()))
    out, err = toy()
    assert out == MIXED and err.count("RuntimeWarning") == 1
    assert f"machine code kept in {path.parent} cannot be used" in err
    assert toy() == (LOADED, "")


def test_another_kernels_machine_code_is_not_run_under_this_ones_name(toy):
    """Each file is whole; a double would be halved."""
    toy()
    double, half = (files(toy, f"*{name}*.nbc")[0] for name in ("double", "half"))
    a, b = double.read_bytes(), half.read_bytes()
    double.write_bytes(b), half.write_bytes(a)
    out, err = toy()
    assert out == FRESH and "or was written under another name" in err
    assert toy() == (LOADED, "")


FULL = """
import os
import tempfile
real = tempfile.mkstemp
def full(*args, dir=None, **options):
    if dir and "snooker_env" in str(dir):
        raise OSError(28, "No space left on device")
    return real(*args, dir=dir, **options)
tempfile.mkstemp = full
"""


@pytest.mark.slow
def test_on_a_full_disk_it_works_from_memory(toy):
    out, err = toy(FULL)
    assert out == FRESH and not files(toy, "*.nb?")
    assert err.count("RuntimeWarning") == 1
    assert "cannot be kept" in err and "No space left on device" in err
    assert "every process compiles for itself" in err
    assert toy() == (FRESH, "") and toy() == (LOADED, "")


@pytest.mark.slow
def test_processes_that_compile_at_the_same_time_do_not_disturb_each_other(toy):
    with ThreadPoolExecutor(4) as pool:
        for out, err in pool.map(lambda _: toy(), range(4)):
            assert out.startswith("3.0 1.5 ") and err == ""
    assert toy() == (LOADED, "")


def test_a_kernel_that_is_in_no_file_is_not_kept(tmp_path):
    """Two versions have the same bytecode and place: the second would run the code of the first."""
    for factor in ("2.0", "3.0"):
        code = TOY.replace("2.0", factor) + "print(double(1.0))"
        out, err = python(code, NUMBA_CACHE_DIR=str(tmp_path / "cache"), SNOOKER_ENV_QUIET="0")
        assert out.strip() == factor
        assert "compiling a toy to machine code, up to 3 s (for this process only;" in err
