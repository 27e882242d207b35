"""Does a user hear of a long compile before it starts, once and on stderr, and of nothing else?"""

import importlib
import os

import pytest
from numba.core import event

from snooker_env._lib import cache, jit
from tests.processes import ROOT, python

HIDES = "SNOOKER_ENV_QUIET=1 hides this)"
AHEAD = f"python -m snooker_env warmup compiles everything ahead; {HIDES}\n"
TOY = """
from snooker_env._lib.jit import entry, kernel

@kernel
def inner(x):
    return 2.0 * x

@entry(what="one toy", seconds=9)
def one(x):
    return inner(x) + 1.0

@entry
def small(x):
    return x

another = entry(inner, what="another toy", seconds=3)
"""


@pytest.fixture
def toys(tmp_path):
    """What a fresh process that runs this code prints on stderr."""
    (tmp_path / "toys.py").write_text(TOY)

    def run(code, **variables):
        variables = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "SNOOKER_ENV_QUIET": None} | variables
        paths = os.pathsep.join([str(tmp_path), str(ROOT)])
        out, err = python("from toys import *\n" + code, PYTHONPATH=paths, **variables)
        assert out == ""
        return err

    run.kept = f"(kept in {tmp_path / 'cache' / 'snooker_env' / cache.kernel_hash()}; "
    return run


def test_one_line_before_each_long_compile_and_none_when_it_is_loaded(toys):
    code = "small(1.0); one(1.0); one(2.0); another(1.0)"
    costs = ("one toy", 9), ("another toy", 3)
    lines = [
        f"snooker_env: compiling {what} to machine code, once, up to {s} s {toys.kept}{AHEAD}"
        for what, s in costs
    ]
    assert toys(code) == "".join(lines)
    assert toys(code) == ""


@pytest.mark.slow
def test_it_can_be_silenced_and_says_that_it_is_not_kept(toys):
    for quiet in ("1", "yes"):
        assert toys("one(1.0)", SNOOKER_ENV_QUIET=quiet) == ""
    hidden = f"(for this process only; {AHEAD}"
    line = toys("one(1.0)", NUMBA_CACHE_DIR="/dev/null", warn="ignore")
    assert line == f"snooker_env: compiling one toy to machine code, up to 9 s {hidden}"


@pytest.mark.parametrize(
    "without", ["sys.stderr = None", pytest.param("sys.stderr.close()", marks=pytest.mark.slow)]
)
def test_without_stderr_it_works_all_the_same(toys, without):
    assert toys(f"import sys; {without}; assert one(1.0) == 3.0") == ""


@pytest.mark.slow
def test_a_warm_up_that_no_terminal_shows_says_each_kernel(toys):
    code = (
        "from snooker_env._lib.jit import warming_up\nsmall(1.0)\n"
        "with warming_up([small, one, another], print): one(1.0); another(1.0)"
    )
    costs = ("one toy", 9), ("another toy", 3)
    told = (f"compiling {what} to machine code, once, up to {s} s {toys.kept}{HIDES}" for what, s in costs)
    assert toys(code).splitlines() == [f"snooker_env: {line}" for line in told]
    assert toys(code) == ""
    assert toys(code, NUMBA_CACHE_DIR="/dev/null", SNOOKER_ENV_QUIET="1", warn="ignore") == ""


def test_on_a_terminal_a_warm_up_is_a_bar(capsys, monkeypatch):
    monkeypatch.delenv("SNOOKER_ENV_QUIET", raising=False)
    seen, kernel = [], jit.entry(what="a toy", seconds=3)(lambda x: x)
    with jit.warming_up([kernel], lambda ready, many: seen.append((ready, many))):
        monkeypatch.setattr(jit.sys.stderr, "isatty", lambda: True, raising=False)
        event.start_event("numba:compile", data={"dispatcher": kernel})
        assert capsys.readouterr().err == "" and seen == [(0, 1)]
        kernel(1.0)
    assert capsys.readouterr().err == "" and seen[-1] == (1, 1)
    jit.ENTRIES.remove(kernel)


LONG = """
physics.engine run_batch; simulation.impacts _collide_balls _collide_cushion; tasks.stroke address; planning.aims solve_aims
tasks.visit _conclude _begin; tasks.frame_kernels decide conclude observe finish begin show remember; game.layouts deal_tables
planning.ghost_ball geometric_strokes; game.apply_ruling settle_one; game.paths best_paths; game.snookered _find_snooker
planning.learned.stroke_policy _add_pots; planning.trials _strike; planning.pot_geometry _pots _clear_paths
"""
"""The kernels that were seen to take over a second, each compiled first in a fresh process."""


def test_each_long_kernel_announces_itself_and_what_others_compile_is_not_told(capsys, monkeypatch):
    monkeypatch.delenv("SNOOKER_ENV_QUIET")
    for module, *names in (line.split() for line in LONG.replace("\n", ";").split(";") if line):
        for name in names:
            kernel = getattr(importlib.import_module(f"snooker_env.{module}"), name)
            event.start_event("numba:compile", data={"dispatcher": kernel})
            err = capsys.readouterr().err
            assert err.count("\n") == 1 and f"compiling {kernel.notice[0]} to machine code, " in err
            assert kernel in jit.ENTRIES
    event.start_event("numba:compile", data={"dispatcher": sorted})
    event.start_event("numba:compile")
    assert capsys.readouterr().err == ""
