"""Are the annotations true?"""

import inspect
import json
import os
import shutil
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import snooker_env as sn
from snooker_env import checks, game, geometry, planning, render, tasks
from tests.processes import ROOT

LEAST = 0.965
CALLS = """
import numpy as np
import snooker_env as sn
from snooker_env.tasks import Noise
v, w = sn.strike(2.0, 0, side=np.float32(0.1), elevation=0.1, physics={'e_c': 0.9})
v1, w1, v2, w2 = sn.collide_balls((1, 0, 0), [0.0, 0.0, 0.0], np.zeros(3), (0, 0, 0), (1, 0, 0), fidelity='euler:200')
shot = sn.simulate([(0.0, 0.0)], np.ones((1, 2), np.float32), [[0, 0, 0]], 'tight', sn.Physics(), on_table=[True])
moved = shot.at(0.5)[0], shot.at([0.1, 0.2])[0], shot.at(np.linspace(0.0, 1.0, 5))[0]
law: tuple[float, float, float] = sn.Physics(mu_bb=(0.01, 0.1, 1.0), e_j=0.9).friction_law
tables = [sn.Table.of('uk8'), sn.Table.of(None), sn.Table.rectangular(2.0, 1, pockets=4)]
env = sn.SnookerEnv(noise='club', aim='target', render_mode='rgb_array')
best: float = env.step(np.zeros(4, np.float32))[1]
options = sn.Options(task='frame', opponent='ghost_ball', noise={'aim_deg': 0.1}, layout='random:3')
envs = sn.SnookerVectorEnv(4, sn.Options(noise=Noise(aim_deg=0.1)), autoreset_mode='SameStep', threads=1)
rows, infos = envs.reset(seed=[1, 2, 3, None], options={'reset_mask': np.ones(4, np.bool_)})
position = sn.Position(cue=(0.0, 0.0), reds=[(0.5, 0.8)], on='red', table='tight')
planner = sn.Planner({'action': 'discrete', 'noise': 'club'}, threads=2)
outcomes = planner.play(env, np.zeros(3, int), [(0.0, 0.0, 0.0, 0.5)] * 3, keys=np.arange(3, dtype=np.uint64))
# Each call below is wrong.
sn.strike(1.0, 'north')
sn.simulate('x', [(0.0, 0.0)], [(0.0, 0.0, 0.0)])
sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], 'pool')
sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], fidelity=3)
shot.position
sn.Physics.preset('pape')
sn.Physics(mu_z=0.1)
sn.Table.rectangular(2.0, 1.0, pockets=5)
sn.Options(noise='novice')
sn.SnookerEnv(render_mode='film')
sn.SnookerVectorEnv('4')
env.reset(seed='one')
sn.Position(cue='D')
planner.play(position, [0], 'x')
sn.planning.pots('x')
"""


def pyright(*arguments, cwd=ROOT):
    """What pyright says, as JSON; skips where it is not installed or cannot be started."""
    # --verifytypes reads no --pythonpath: it takes the first Python of PATH, and without its libraries half
    # the types are unknown
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    program = shutil.which("pyright", path=path)
    if program is None:
        pytest.skip("pyright is not installed")
    env = os.environ | {"PYTHONPATH": str(ROOT), "PATH": path}
    command = [program, "--outputjson", "--pythonpath", sys.executable, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, cwd=cwd, env=env, timeout=600, check=False)
    try:
        return json.loads(done.stdout)
    except ValueError:
        pytest.skip(f"pyright does not run here: {(done.stderr or done.stdout)[-300:]}")


def test_the_checker_takes_right_calls_and_sees_wrong_ones(tmp_path):
    (tmp_path / "calls.py").write_text(CALLS)
    settings = {"typeCheckingMode": "basic", "pythonVersion": "3.10", "reportUnusedExpression": "none"}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings | {"extraPaths": [str(ROOT)]}))
    found = pyright("calls.py", cwd=tmp_path)["generalDiagnostics"]
    errors = {one["range"]["start"]["line"] for one in found}
    first = CALLS[: CALLS.index("# Each")].count("\n") + 1
    assert errors == set(range(first, CALLS.count("\n")))


def test_the_checker_finds_the_types_of_public_names():
    report = pyright("--verifytypes", "snooker_env", "--ignoreexternal")["typeCompleteness"]
    assert Path(report["packageRootDirectory"]).parent == ROOT
    unknown = [one["name"] for one in report["symbols"] if one["isExported"] and not one["isTypeKnown"]]
    assert report["completenessScore"] >= LEAST, unknown


def functions(thing):
    """A function, or the public ones that a class defines."""
    inside = [m for name, m in vars(thing).items() if name[0] != "_"] if inspect.isclass(thing) else [thing]
    inside = [getattr(m, "fget", None) or getattr(m, "__func__", m) for m in inside]
    return filter(inspect.isfunction, map(inspect.unwrap, inside))


def test_annotations_can_be_resolved_when_the_program_runs():
    for module in (sn, planning, tasks, game, geometry, checks, render):
        for thing in (getattr(module, name) for name in module.__all__):
            for function in functions(thing) if callable(thing) else ():
                names = {*inspect.signature(function).parameters, "return"} - {"self", "cls"}
                assert names <= set(typing.get_type_hints(function)), function
