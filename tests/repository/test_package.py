"""Is the package light to import, whole, and the same everywhere?"""

import inspect
import json
import os

import pytest

import snooker_env as sn
from snooker_env._lib import cache
from tests.processes import CACHE, ROOT, copy_of_package, python

# Imports and names

HEAVY = {"torch", "stable_baselines3", "sb3_contrib", "pygame", "matplotlib", "scipy", "hypothesis"}
HEAVY |= {"pettingzoo", "moviepy", "agents"}


def test_the_import_is_light():
    out, _ = python(
        "import sys, json\n"
        "import gymnasium, numba, numpy\n"
        "needed = set(sys.modules)\n"  # numba imports scipy where there is one
        "import snooker_env\n"
        "print(json.dumps(sorted(set(sys.modules) - needed)))\n"
    )
    new = json.loads(out)
    assert "snooker_env.simulation" in new and "snooker_env.physics.engine" in new
    assert not {name.split(".")[0] for name in new} & HEAVY
    # only when an environment is made
    assert not [name for name in new if name.startswith(("snooker_env.envs", "snooker_env.render"))]


WITHOUT = f"""
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {HEAVY!r}:
            raise ModuleNotFoundError("No module named " + name, name=name)

sys.meta_path.insert(0, Missing())
"""


def test_with_the_core_dependencies_alone_everything_but_pictures_works():
    out, err = python(
        WITHOUT + "import gymnasium, numpy as np, snooker_env as sn\n"
        "sn.warmup()\n"
        "env = gymnasium.make('Snooker-v0', layout='random:2', render_mode='ansi', noise='club', observation='balls')\n"
        "env.reset(seed=1); env.step(np.zeros(4, np.float32)); print('Y=yellow' in env.render()); env.close()\n"
        "env = gymnasium.make('Snooker-v0', render_mode='rgb_array')\n"
        "env.reset(seed=1)\n"
        "try: env.render()\n"
        "except ImportError as error: print(error)\n"
    )
    wanted = f'pictures need pygame-ce; install it, in the clone {ROOT}, with: pip install -c constraints.txt -e ".[render]"'
    assert out.splitlines() == ["True", wanted]
    assert err == ""


def test_what_is_missing_is_installed_as_the_package_was(tmp_path):
    """In a clone by its project file; the package alone, as a wheel leaves it, by its name."""
    code = "from snooker_env._lib.install import missing\nprint(missing('pictures need pygame-ce', 'render'))"
    out, _ = python(code, at=copy_of_package(tmp_path))
    assert out == 'pictures need pygame-ce; install it with: pip install "snooker-env[render]"\n'
    (tmp_path / "pyproject.toml").touch()
    out, _ = python(code, at=tmp_path)
    assert (
        f'install it, in the clone {tmp_path}, with: pip install -c constraints.txt -e ".[render]"\n' in out
    )


@pytest.mark.parametrize(
    ("name", "promised"),
    [
        ("collide_balls", "v1 w1 v2 w2 normal physics=None fidelity=standard"),
        ("collide_cushion", "v w normal physics=None fidelity=standard"),
        ("strike", "speed aim side=0.0 top=0.0 elevation=0.0 physics=None"),
        ("simulate", "positions velocities spins table=match physics=None fidelity=standard"),
        ("simulate_batch", "positions velocities spins table=match physics=None fidelity=standard"),
        ("warmup", ""),
    ],
)
def test_options_keep_the_order_and_the_defaults_that_were_promised(name, promised):
    """Users call these with positional arguments, and docs/develop/versions.md promises that their calls go on working."""
    parameters = inspect.signature(getattr(sn, name)).parameters.values()
    ordered = [p for p in parameters if p.kind is not p.KEYWORD_ONLY]
    assert " ".join(p.name if p.default is p.empty else f"{p.name}={p.default}" for p in ordered) == promised


# The cache of machine code


def test_the_cache_folder_depends_on_every_source_file_that_kernels_are_made_from(tmp_path):
    root = copy_of_package(tmp_path) / "snooker_env"
    first = cache.kernel_hash(root)
    assert first == cache.kernel_hash(root) == cache.kernel_hash(ROOT / "snooker_env")
    seen = {first}
    files = sorted(p for p in root.rglob("*.py") if p.relative_to(root).parts[0] in cache.KERNEL_ROOMS)
    assert len(files) > 25
    for path in files:
        text = path.read_bytes()
        # same size, other content
        path.write_bytes(text.replace(b"e", b"f", 1) if b"e" in text else text + b"#")
        seen.add(cache.kernel_hash(root))
        path.write_bytes(text)
        os.utime(path, (1e9, 1e9))  # its age does not matter
    assert len(seen) == len(files) + 1
    (root / "physics/new.py").write_text("")
    seen.add(cache.kernel_hash(root))
    (root / "physics/new.py").rename(root / "physics/newer.py")
    seen.add(cache.kernel_hash(root))
    (root / "physics/newer.py").unlink()
    assert len(seen) == len(files) + 3
    assert cache.kernel_hash(root) == first
    (root / "physics/notes.txt").write_text("no source")
    (root / "replays/page.py").write_text("no kernel")
    assert cache.kernel_hash(root) == first


def test_the_cache_is_where_it_is_said_to_be(tmp_path, monkeypatch):
    for name in CACHE:
        monkeypatch.delenv(name, raising=False)
    key = cache.kernel_hash()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert cache.cache_folder() == tmp_path / "home" / ".cache" / "snooker_env" / key
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.cache_folder() == tmp_path / "xdg" / "snooker_env" / key
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "numba"))
    assert cache.cache_folder() == tmp_path / "numba" / "snooker_env" / key
    # the trial file is gone
    assert cache.cache_folder().is_dir() and not list(cache.cache_folder().iterdir())
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    with pytest.warns(RuntimeWarning, match="is not writable"):
        assert cache.cache_folder() is None
