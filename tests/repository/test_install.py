"""Does ``gymnasium.make("Snooker-v0")`` work once installed, without an import and at no cost for others?"""

import compileall
import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import time
import venv
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

import snooker_env
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

    def run(self, code, *flags, **variables):
        env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        env |= {"PYTHONWARNINGS": "error", "SNOOKER_ENV_QUIET": "1"}
        command, cwd = [self.python, *flags, "-c", code], getattr(self, "cwd", "/")
        options = {"capture_output": True, "text": True, "timeout": 280}
        done = subprocess.run(command, cwd=cwd, env=env | variables, **options)
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


MAKE = """
import sys, gymnasium
assert "snooker_env" not in sys.modules and "numba" not in sys.modules
print(gymnasium.spec("Snooker-v0").entry_point)
assert "snooker_env" not in sys.modules and "numba" not in sys.modules
env = gymnasium.make("Snooker-v0", layout="random:2")
print(type(env.unwrapped).__name__, env.reset(seed=0)[0].shape)
env = gymnasium.make_vec("Snooker-v0", 3, vectorization_mode="vector_entry_point", layout="random:2")
print(type(env).__name__, env.reset(seed=0)[0].shape)
import snooker_env, importlib
importlib.reload(snooker_env)
print(type(gymnasium.make("snooker_env:Snooker-v0").unwrapped).__name__, [f for f in sys.meta_path if "snooker" in repr(f)])
"""


@pytest.mark.parametrize("flags", [(), ("-I",), ("-E", "-s")], ids=["", "isolated", "without variables"])
def test_the_environment_is_made_without_an_import(installed, flags):
    out, err = installed.run(MAKE, *flags)
    assert err == ""
    made = ["SnookerEnv (121,)", "SnookerVectorEnv (3, 121)", "SnookerEnv []"]
    assert out.splitlines() == ["snooker_env.envs.snooker:SnookerEnv", *made]


WORKERS = """
import multiprocessing, sys, gymnasium

def made(spec):
    return "snooker_env" in sys.modules, gymnasium.make(spec).spec.id

if __name__ == "__main__":
    with multiprocessing.get_context({method!r}).Pool(1) as pool:
        print(pool.map(made, ["Snooker-v0", gymnasium.spec("Snooker-v0")]))
"""


@pytest.mark.parametrize("method", ["spawn", "forkserver", "fork"])
def test_workers_make_it_too(installed, method):
    (installed.cwd / "workers.py").write_text(WORKERS.format(method=method))
    out, err = installed.run(
        "import runpy; runpy.run_path('workers.py', run_name='__main__')" if method == "fork" else RUN_FILE
    )
    assert out == "[(False, 'Snooker-v0'), (True, 'Snooker-v0')]\n" and err == ""


RUN_FILE = "import subprocess, sys; sys.exit(subprocess.run([sys.executable, 'workers.py']).returncode)"


def test_it_is_registered_by_the_site_and_can_be_switched_off(installed):
    """The control: neither Gymnasium nor anything else here has the id by itself."""
    paths = [str(installed.site), str(installed.cwd.parent / "libraries"), str(ROOT)]
    code = f"import sys; sys.path += {paths!r}\nimport gymnasium\nprint('Snooker-v0' in gymnasium.registry)"
    assert installed.run(code, "-S")[0] == "False\n"
    code = "import gymnasium, sys; print('Snooker-v0' in gymnasium.registry, [f for f in sys.meta_path if 'snooker' in repr(f)])"
    assert installed.run(code, SNOOKER_ENV_AUTOREGISTER="0")[0] == "False []\n"
    assert installed.run(code)[0] == "True []\n"


def test_other_programs_pay_nothing_that_can_be_felt(installed):
    code = "import sys; print(sorted(m for m in sys.modules if 'snooker' in m or m in ('numpy', 'numba', 'gymnasium', 'importlib.util')))"
    assert installed.run(code)[0] == "['_snooker_env_autoregister']\n"
    code = (
        "import sys, time\nsys.modules.pop('_snooker_env_autoregister')\n"
        "line = open({!r}).read()\nt = time.perf_counter()\nexec(line)\nprint(time.perf_counter() - t)"
    ).format(str(installed.site / "snooker_env_autoregister.pth"))
    assert min(float(installed.run(code)[0]) for _ in range(5)) < 1e-3


@pytest.mark.parametrize("broken", ["syntax error", "import no_such_module"])
def test_a_broken_copy_stops_no_interpreter(installed, broken):
    module = installed.site / "_snooker_env_autoregister.py"
    sound = module.read_text()
    try:
        module.write_text(broken)
        later = time.time() + 10
        os.utime(module, (later, later))
        assert installed.run("import gymnasium; print('Snooker-v0' in gymnasium.registry)") == ("False\n", "")
        module.unlink()
        assert installed.run("import gymnasium; print('Snooker-v0' in gymnasium.registry)") == ("False\n", "")
    finally:
        module.write_text(sound)


def test_gymnasium_is_imported_whatever_happens_to_the_id(installed):
    """A package without that file, as of another version."""
    (installed.cwd / "snooker_env").mkdir()
    (installed.cwd / "snooker_env/__init__.py").touch()
    try:
        out, err = installed.run("import gymnasium\nprint(gymnasium.make('CartPole-v1').spec.id)")
    finally:
        shutil.rmtree(installed.cwd / "snooker_env")
    assert out == "CartPole-v1\n" and err.count("\n") == 1
    assert err.startswith("snooker_env: its environments are not registered: FileNotFoundError: ")


def test_a_gymnasium_that_is_there_already_has_the_id_at_once():
    """A ``.pth`` file that sorts before ours may have imported it."""
    code = (
        "import gymnasium, sys; sys.path.insert(0, 'snooker_env'); import _autoregister\n"
        "_autoregister.wait(); print('Snooker-v0' in gymnasium.registry, 'snooker_env' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "True False\n"


def test_the_wheel_holds_what_belongs_there_and_says_who_may_use_it(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    with zipfile.ZipFile(tmp_path / hatchling.build_wheel(str(tmp_path))) as wheel:
        names = wheel.namelist()
        direct = (ROOT / "snooker_env/_autoregister.py").read_bytes()
        assert wheel.read("_snooker_env_autoregister.py") == direct
        assert wheel.read("snooker_env_autoregister.pth").count(b"\n") == 1  # one line: each is run by itself
        wheel.extractall(tmp_path)
    tops = {"snooker_env", "_snooker_env_autoregister.py", "snooker_env_autoregister.pth"}
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == tops
    assert "snooker_env/_registration.py" in names and len(names) == len(set(names))
    assert [name for name in names if name.endswith(".pth")] == ["snooker_env_autoregister.pth"]
    built = metadata.Distribution.at(*tmp_path.glob("*.dist-info"))
    assert built.metadata["License-Expression"] == "MIT" and built.version == snooker_env.__version__
    for name in ("LICENSE", "snooker_env/render/fonts/OFL.txt"):
        assert built.read_text(f"licenses/{name}") == (ROOT / name).read_text()


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="only a clone can say what belongs to it")
def test_the_source_distribution_is_a_clone_and_gives_the_same_wheel(tmp_path, monkeypatch):
    """Tests, agents, weights and documents come with it; what git ignores does not."""
    monkeypatch.chdir(ROOT)
    with tarfile.open(tmp_path / hatchling.build_sdist(str(tmp_path))) as source:
        source.extractall(tmp_path)
    (tree,) = (path for path in tmp_path.iterdir() if path.is_dir())
    there = {path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file()}
    command = ["git", "ls-files", "-z", "-co", "--exclude-standard"]
    listed = subprocess.check_output(command, cwd=ROOT, text=True)
    here = {name for name in listed.split("\0") if name and (ROOT / name).is_file()}
    assert there - here == {"PKG-INFO"} and here <= there, sorted(here ^ there)[:20]
    wheels = []
    for folder in (ROOT, tree):
        monkeypatch.chdir(folder)
        with zipfile.ZipFile(tmp_path / hatchling.build_wheel(str(tmp_path))) as wheel:
            wheels.append({one.filename: one.CRC for one in wheel.infolist()})
            del wheels[-1][next(name for name in wheels[-1] if name.endswith("RECORD"))]
    assert wheels[0] == wheels[1]
    data = {name for name in here if name.startswith("snooker_env/") and not name.endswith(".py")}
    assert data - {"snooker_env/_autoregister.pth"} <= set(wheels[0])
    assert {"snooker_env/py.typed", "snooker_env/game/opened.npz"} <= data
