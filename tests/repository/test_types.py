"""Are the annotations true?"""

import inspect
import json
import os
import shutil
import subprocess
import sys
import typing
from contextlib import suppress
from pathlib import Path

import pytest

import snooker_env as sn
from snooker_env import checks, game, geometry, planning, render, tasks
from tests.processes import ROOT, python

LEAST = 0.965

HEAD = """
import gymnasium
import numpy as np
import snooker_env as sn
from snooker_env.game import BallOn
from snooker_env.tasks import Noise, observation_space
"""

GOOD = (
    # impacts, strikes and shots: lists, tuples, arrays of floats and integers
    "v, w = sn.strike(2.0, 0, side=np.float32(0.1), elevation=0.1, physics='match')",
    "v1, w1, v2, w2 = sn.collide_balls((1, 0, 0), [0.0, 0.0, 0.0], np.zeros(3), (0, 0, 0), (1, 0, 0), fidelity='euler:200')",
    "n, m = sn.collide_cushion((1.0, 0, 0), np.zeros(3, int), np.array([1.0, 0.0, 0.0]), physics={'e_c': 0.9}, fidelity='fast')",
    "shot = sn.simulate([(0.0, 0.0), (0.0, 0.5)], [v[:2], (0.0, 0.0)], [w, (0.0, 0.0, 0.0)], 'tight', on_table=[True, False])",
    "cloth = sn.simulate(np.zeros((1, 2)), np.ones((1, 2), np.float32), [[0, 0, 0]], None, sn.Physics(), 'reference')",
    "places: tuple[int, ...] = shot.positions.shape",
    "moved = shot.at(0.5)[0], shot.at([0.1, 0.2])[0], shot.at(np.linspace(0.0, 1.0, 5))[0]",
    "kinds = [sn.EventKind(kind).name for kind in shot.events['kind']]",
    "batch = sn.simulate_batch(np.zeros((3, 1, 2)), [[(1.0, 0.0)]] * 3, np.zeros((3, 1, 3)), events=True, threads=2)",
    "logs: int = 0 if batch.events is None else len(batch.events)",
    # physics and tables
    "physics = sn.Physics.preset('match', mu_s=0.2)",
    "law: tuple[float, float, float] = sn.Physics(mu_bb=(0.01, 0.1, 1.0), e_j=0.9).friction_law",
    "pocket = sn.Pocket.corner(mouth=0.115, shelf=0.03, fall_radius=0.07, cut=142.0)",
    "table = sn.Table.rectangular(2.0, 1, pockets=4, corner=pocket, ball_radius=0.025)",
    "wall = sn.Table('wall', np.array([(0, 1, 0.5, -1.0, 1.0)]), np.empty((0, 6)), np.empty((0, 3)))",
    "sn.Table.preset('carom').check([(0.0, 0.0)], 0.03075)",
    "tables = [sn.Table.of('uk8'), sn.Table.of(None), sn.Table.of(table)]",
    # environments
    "env = sn.SnookerEnv(noise='club', aim='target', render_mode='rgb_array')",
    "observation, info = env.reset(seed=1)",
    "observation, reward, terminated, truncated, info = env.step([0.1, 0.0, 0.0, 0.0])",
    "env.reset(options={'state': env.get_state()})",
    "best: float = env.step(np.zeros(4, np.float32))[1]",
    "is_red: bool = env.ball_on == BallOn.RED and not env.in_hand",
    "options = sn.Options(task='frame', opponent='ghost_ball', noise={'aim_deg': 0.1}, layout='random:3')",
    "played = sn.SnookerEnv(options.but(miss='clear_path'))",
    "choosing = sn.SnookerEnv(action='discrete')",
    "masks = choosing.action_masks() if choosing.reset(seed=1) else None",
    "points: float = choosing.step(7)[1]",
    "envs = sn.SnookerVectorEnv(4, sn.Options(noise=Noise(aim_deg=0.1)), autoreset_mode='SameStep', threads=1)",
    "rows, infos = envs.reset(seed=[1, 2, 3, None], options={'reset_mask': np.ones(4, np.bool_)})",
    "rows, rewards, ends, cuts, infos = envs.step(np.zeros((4, 4)))",
    "total: float = rewards.sum()",
    "match = sn.match_env(max_strokes=None, render_mode='ansi')",
    "match.reset(seed=1)",
    "match.step(match.action_space(match.agent_selection).sample())",
    # planning
    "position = sn.Position(cue=(0.0, 0.0), reds=[(0.5, 0.8)], black=(0.0, 1.46), on='red', table='tight')",
    "planner = sn.Planner({'action': 'discrete', 'noise': 'club'}, threads=2)",
    "outcomes = planner.play(position, [0, 0], [67, 67], keys=[1, 2])",
    "at, now = env.reset(seed=2)",
    "made = planner.play(env, np.zeros(3, int), np.arange(3), np.arange(3, dtype=np.uint64)).points.mean()",
    "wrapped = sn.Planner(gymnasium.make('Snooker-v0')).play(position, [0], [(0.0, 0.0, 0.0, 0.5)], [[1, 2]])",
    "left: np.ndarray = outcomes.afterstates.positions",
    "states = sn.Positions.of([env.get_state(), env.get_state()])[:1]",
    "blue = sn.Positions.of([position, position])[1].blue",
    "aims = sn.planning.pot_aim(states, [0], [1], [(0.8, 0.8)], [[2.3, 0.1, 0.0, 0.0, 0.1]], physics='match')",
    "strokes = sn.planning.Strokes(np.array([[3.6, 0.0, 0.25, aims[0], 0.0]]))",
    "acts: np.ndarray = strokes.actions(sn.Options(), states)",
    "apart = planner.play_strokes(states, [0], strokes.values, errors=np.zeros((1, 5))).places[0]",
    "speeds: np.ndarray = sn.planning.Search(sn.planning.VisitJudge({'noise': 'club'}), 30).rank(states, [1])[0].strokes.speed",
    "found = sn.planning.pots(envs, most=2).cut[0, 0] + sn.planning.clear_paths(position).full_ball[0]",
    "space = observation_space('balls', frame=True)",
    "sn.warmup()",
)

BAD = (
    "sn.strike(1.0, 'north')",
    "sn.strike(speed='hard', aim=0.0)",
    "sn.collide_balls('v', (0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0))",
    "sn.simulate('x', [(0.0, 0.0)], [(0.0, 0.0, 0.0)])",
    "sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], 'pool')",
    "sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], fidelity=3)",
    "sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], on_table=[1.0])",
    "sn.simulate_batch([(0.0, 0.0)], np.zeros((1, 1, 2)), np.zeros((1, 1, 3)))",
    "shot.at('end')",
    "shot.position",
    "sn.Physics.preset(3)",
    "sn.Physics.preset('pape')",
    "sn.Physics(mu_bb='marlowe')",
    "sn.Physics(mu_z=0.1)",
    "sn.Table.preset(3)",
    "sn.Table.rectangular(2.0, 1.0, pockets=5)",
    "sn.Table.of(3)",
    "sn.Options(task='frames')",
    "sn.Options(noise='novice')",
    "sn.SnookerEnv(options='frame')",
    "sn.SnookerEnv(render_mode='film')",
    "sn.SnookerVectorEnv('4')",
    "env.reset(seed='one')",
    "sn.Position(cue='D')",
    "sn.Planner('noise')",
    "planner.play('x', [0], [67])",
    "planner.play(position, 'x', [67])",
    "planner.play(position, [0], 'x')",
    "sn.planning.pots('x')",
    "sn.planning.pot_aim(position, [0], [1], [(0.8, 0.8)], 'hard')",
    "observation_space('flats')",
    "sn.warmup(1)",
)


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


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """Pyright on all the calls: {line: its first message}, and the line of the first bad one."""
    folder = tmp_path_factory.mktemp("typed")
    lines = [*HEAD.strip().splitlines(), *GOOD, *BAD]
    (folder / "calls.py").write_text("\n".join(lines) + "\n", encoding="utf-8")
    settings = {"typeCheckingMode": "basic", "pythonVersion": "3.10", "reportUnusedExpression": "none"}
    settings["extraPaths"] = [str(ROOT)]
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    errors: dict = {}
    for one in pyright("calls.py", cwd=folder)["generalDiagnostics"]:
        errors.setdefault(one["range"]["start"]["line"], one["message"])
    return lines, errors


def test_the_checker_takes_right_calls_and_sees_wrong_ones(report):
    lines, errors = report
    first_bad = len(lines) - len(BAD)
    assert {lines[k]: message for k, message in errors.items() if k < first_bad} == {}
    lines, errors = report
    assert [line for k, line in enumerate(lines) if line in BAD and k not in errors] == []


@pytest.mark.slow
def test_calls_of_each_documented_kind_run():
    """The calls that the checker is shown do what they say: an annotation is no promise by itself."""
    pytest.importorskip("pettingzoo")
    python(HEAD + "\n".join(GOOD[:-1]))


def test_the_checker_finds_the_types_of_public_names():
    report = pyright("--verifytypes", "snooker_env", "--ignoreexternal")["typeCompleteness"]
    assert Path(report["packageRootDirectory"]).parent == ROOT
    unknown = [one["name"] for one in report["symbols"] if one["isExported"] and not one["isTypeKnown"]]
    assert report["completenessScore"] >= LEAST, unknown


MODULES = (sn, planning, tasks, game, geometry, checks, render)
PUBLIC = {f"{module.__name__}.{name}": getattr(module, name) for module in MODULES for name in module.__all__}
with suppress(ImportError):
    from snooker_env.envs.match import MatchEnv

    PUBLIC["MatchEnv"] = MatchEnv
with suppress(ImportError):
    from snooker_env.sb3 import SnookerVecEnv

    PUBLIC["SnookerVecEnv"] = SnookerVecEnv


def annotated(thing):
    """A function; of a class its annotations, none that it inherits, and the public functions that it defines."""
    if not inspect.isclass(thing):
        return [thing]
    names = {"__module__": thing.__module__, "__annotations__": vars(thing).get("__annotations__", {})}
    public = [member for name, member in vars(thing).items() if not name.startswith("_")]
    inside = [getattr(m, "fget", None) or getattr(m, "__func__", m) for m in public]
    return [type(thing.__name__, (), names), *filter(inspect.isfunction, map(inspect.unwrap, inside))]


@pytest.mark.parametrize("name", [name for name, thing in PUBLIC.items() if callable(thing)])
def test_annotations_can_be_resolved_when_the_program_runs(name):
    for thing in annotated(PUBLIC[name]):
        hints = typing.get_type_hints(thing)
        if inspect.isfunction(thing):
            parameters = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls")]
            assert set(parameters) | {"return"} <= set(hints), thing
