"""What does an installation hold, and are the environments made from it, in worker processes too?"""

import compileall
import os
import subprocess
import sysconfig
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from snooker_env._lib.registration import ENTRY_POINTS
from tests.processes import ROOT

hatchling = pytest.importorskip("hatchling.build")
pytest.importorskip("editables")

HERE = Path(sysconfig.get_paths()["purelib"])


class Environment:
    """A virtual environment with the libraries of this one, and what is unpacked into it."""

    def __init__(self, folder):
        venv.create(folder, with_pip=False, symlinks=True)
        self.python = folder / "bin" / "python"
        self.site = Path(self.run("import sysconfig; print(sysconfig.get_paths()['purelib'])")[0].strip())
        self.cwd = folder / "cwd"
        self.cwd.mkdir()

    def unpack(self, wheel):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(self.site)
        compileall.compile_dir(self.site, maxlevels=0, quiet=1)  # as pip does
        libraries = self.cwd.parent / "libraries"
        libraries.mkdir()
        for found in HERE.iterdir():  # not the package's own files, where it is installed here
            if "snooker_env" not in found.name:
                (libraries / found.name).symlink_to(found)
        (self.site / "libraries.pth").write_text(str(libraries))
        return self

    def run(self, code):
        env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        env |= {"PYTHONWARNINGS": "error", "SNOOKER_ENV_QUIET": "1"}
        command, cwd = [self.python, "-c", code], getattr(self, "cwd", "/")
        options = {"capture_output": True, "text": True, "timeout": 280}
        done = subprocess.run(command, cwd=cwd, env=env, **options)
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stdout, done.stderr


@pytest.fixture(scope="module", params=["wheel", "editable"])
def installed(request, tmp_path_factory):
    """An environment in which the package is installed."""
    folder = tmp_path_factory.mktemp(request.param)
    build = hatchling.build_wheel if request.param == "wheel" else hatchling.build_editable
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        name = build(str(folder))
    return Environment(folder / "venv").unpack(folder / name)


IDS = """
import sys, gymnasium
assert not [name for name in sys.modules if "snooker" in name or name == "numba"]  # nothing runs as Python starts
assert "Snooker-v0" not in gymnasium.registry
{how}
print(type(env.unwrapped).__name__, env.reset(seed=0)[0].shape)
many = gymnasium.make_vec("Snooker-v0", 3, vectorization_mode="vector_entry_point", layout="random:2")
print(type(many).__name__, many.reset(seed=0)[0].shape)
import importlib, snooker_env
importlib.reload(snooker_env)
print(sorted(name for name in gymnasium.registry if "Snooker" in name))
"""
HOW = {
    "imported": 'import snooker_env\nenv = gymnasium.make("Snooker-v0", layout="random:2")',
    "named": 'env = gymnasium.make("snooker_env:Snooker-v0", layout="random:2")',
}


@pytest.mark.parametrize("how", [pytest.param("imported", marks=pytest.mark.slow), "named"])
def test_the_environments_are_made_by_either_name(installed, how):
    out, err = installed.run(IDS.format(how=HOW[how]))
    made = ["SnookerEnv (61,)", "SnookerVectorEnv (3, 61)", str(sorted(ENTRY_POINTS))]
    assert out.splitlines() == made and err == ""


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="only a clone can say what belongs to it")
def test_the_source_distribution_is_the_package_alone_and_gives_the_same_wheel(tmp_path, monkeypatch):
    """No pictures, results or agents; nor what git ignores."""
    monkeypatch.chdir(ROOT)
    with tarfile.open(tmp_path / hatchling.build_sdist(str(tmp_path))) as source:
        source.extractall(tmp_path)
    (tree,) = (path for path in tmp_path.iterdir() if path.is_dir())
    there = {path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file()}
    command = ["git", "ls-files", "-z", "-co", "--exclude-standard", "snooker_env"]
    listed = subprocess.check_output(command, cwd=ROOT, text=True)
    package = {name for name in listed.split("\0") if name and (ROOT / name).is_file()}
    assert {name for name in there if name.startswith("snooker_env/")} == package
    beside = "PKG-INFO pyproject.toml hatch_build.py README.md LICENSE CHANGELOG.md CITATION.cff .gitignore"
    assert there - package == set(beside.split())
    wheels = []
    for folder in (ROOT, tree):
        monkeypatch.chdir(folder)
        with zipfile.ZipFile(tmp_path / hatchling.build_wheel(str(tmp_path))) as wheel:
            wheels.append({one.filename: one.CRC for one in wheel.infolist()})
            del wheels[-1][next(name for name in wheels[-1] if name.endswith("RECORD"))]
    assert wheels[0] == wheels[1] and package <= set(wheels[0])
    assert {name.split("/")[0] for name in wheels[0] if ".dist-info" not in name} == {"snooker_env"}
    licences = {"LICENSE", "snooker_env/render/fonts/OFL.txt"}
    assert all(any(name.endswith(f"licenses/{one}") for name in wheels[0]) for one in licences)
