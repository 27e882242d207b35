"""Can models of others be evaluated, and does nothing of such a file run before its user consents?"""

import base64
import json
import re
import sys
import zipfile
from types import ModuleType

import numpy as np
import pytest
from sb3_contrib import TQC, MaskablePPO, RecurrentPPO
from stable_baselines3 import DQN, PPO, SAC

from agents import evaluate
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.planning import Planner, Positions
from snooker_env.players.saved_models import saved_player
from tests.bombs import bombed
from tests.torch_threads import deciding_on_one_thread

QUICK = str.split("--visits 4 --layouts held_out --noise professional --resamples 100")


@pytest.fixture(scope="module")
def foreign(tmp_path_factory):
    """Files of untrained models of plain Stable-Baselines3 and sb3-contrib."""
    folder = tmp_path_factory.mktemp("foreign")
    for maker, policy, name, options in (
        (PPO, "MlpPolicy", "ppo", {"aim": "target"}),
        (PPO, "MultiInputPolicy", "balls", {"observation": "balls"}),
        (SAC, "MlpPolicy", "sac", {"elevation": True}),
        (DQN, "MlpPolicy", "dqn", {"action": "discrete"}),
        (MaskablePPO, "MlpPolicy", "mask", {"action": "discrete"}),
        (RecurrentPPO, "MlpLstmPolicy", "recurrent", {}),
        (PPO, "MlpPolicy", "frame", {"task": "frame"}),
        (MaskablePPO, "MultiInputPolicy", "masked", {"action": "discrete", "observation": "masked"}),
    ):
        maker(policy, SnookerEnv(**options), seed=4, device="cpu").save(folder / f"{name}.zip")
    return folder


@pytest.mark.parametrize(
    ("name", "maker", "options", "read"),
    [
        ("ppo", PPO, {"aim": "target"}, {"aim": "target"}),
        ("balls", PPO, {}, {}),
        ("sac", SAC, {"elevation": True}, {"elevation": True}),
        ("dqn", DQN, {}, {"action": "discrete"}),
        ("mask", MaskablePPO, {}, {"action": "discrete"}),
        ("masked", MaskablePPO, {}, {"action": "discrete"}),
    ],
)
def test_a_foreign_model_plays_what_it_would_play_itself(foreign, name, maker, options, read):
    file, kind = foreign / f"{name}.zip", name if name in ("balls", "masked") else "pots"
    model, player = maker.load(file, device="cpu"), saved_player(file, options, True)
    assert player.sees == read | {"observation": kind}
    at_work = {"layout": "held_out", "threads": 1, **read}
    tables, seen_by_it = SnookerVectorEnv(3, **at_work), SnookerVectorEnv(3, observation=kind, **at_work)
    tables.reset(seed=0)
    its, _ = seen_by_it.reset(seed=0)
    masks = {"action_masks": tables.action_masks()} if name in ("mask", "masked") else {}
    at, bound = Positions.of(tables), player.at(tables)
    with deciding_on_one_thread(player.seen._network):
        strokes = bound.play(at, np.arange(3))
    chosen = model.predict(its, deterministic=True, **masks)[0]
    assert np.allclose(strokes.values, Planner(tables).strokes_of(at, np.arange(3), chosen)[0], atol=1e-5)


@pytest.mark.parametrize("maker", [MaskablePPO, TQC, DQN])
def test_a_model_plays_where_the_package_of_its_schedules_is_missing(tmp_path, monkeypatch, maker):
    """As one of RL Baselines3 Zoo does, whose files name classes of ``rl_zoo3``, which play does not need."""
    zoo, body = ModuleType("rl_zoo3"), {"__module__": "rl_zoo3", "__call__": lambda self, left: 1e-3 * left}
    zoo.SimpleLinearSchedule = schedule = type("SimpleLinearSchedule", (), body)
    options = {"action": "discrete"} if maker in (MaskablePPO, DQN) else {"aim": "target"}
    more = {"clip_range": schedule(), "n_steps": 8, "batch_size": 8} if maker in (PPO, MaskablePPO) else {}
    more |= {"seed": 4, "device": "cpu", "learning_rate": schedule()}
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "rl_zoo3", zoo)
        model = maker("MlpPolicy", SnookerEnv(**options), **more)
        model.of_the_zoo = schedule()
        model.save(tmp_path / "model.zip")
    monkeypatch.setitem(sys.modules, "rl_zoo3", None)  # missing, also where it is installed
    with zipfile.ZipFile(tmp_path / "model.zip") as file:
        pickles = re.findall(r'":serialized:": "([^"]*)"', file.read("data").decode())
    assert b"rl_zoo3" in b"".join(map(base64.b64decode, pickles))
    player = saved_player(tmp_path / "model.zip", {} if "action" in options else options, True)
    tables = SnookerVectorEnv(3, layout="held_out", threads=1, **options)
    observations, _ = tables.reset(seed=0)
    masks = {"action_masks": tables.action_masks()} if maker is MaskablePPO else {}
    at, chosen = Positions.of(tables), model.predict(observations, deterministic=True, **masks)[0]
    expected = Planner(tables).strokes_of(at, np.arange(3), chosen)[0]
    assert np.allclose(player.at(tables).play(at, np.arange(3)).values, expected, atol=1e-5)


def test_a_foreign_model_is_compared_with_consent(foreign, tmp_path, capsys):
    """Of its training only what the model itself says is reported."""
    agents = ["--agent", str(foreign / "ppo.zip"), "random", "--trust", "--options", "aim=target"]
    assert evaluate.main([*agents, *QUICK, "--json", str(tmp_path / "r.json")]) == 0
    (run,) = json.loads((tmp_path / "r.json").read_text())["agents"][0]["runs"]
    its = {"from": str(foreign / "ppo.zip"), "recipe": "PPO", "shots": 0, "seed": 4, "gamma": 0.99}
    under = dict.fromkeys(("layout", "noise", "fidelity", "physics", "cue"), "unknown")
    assert run == {**its, **under, "imitated": None, "seconds": None}
    assert "unknown" in capsys.readouterr().out


CONSENT = "holds pickled Python code, which runs when it is loaded: must be a file that you trust, and come "
ACTIONS = (
    "must be a model whose actions are Box(-1.0, 1.0, ({},), float32): give the options of its training, "
)
ACTIONS += "for example placement=True"


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("ppo", [], CONSENT + "with trust=True, or --trust on the command line"),
        ("ppo", ["--trust", "--options", "placement=True"], ACTIONS.format(6)),
        ("sac", ["--trust"], ACTIONS.format(4)),
        ("dqn", ["--trust", "--options", "action=box"], ACTIONS.format(4)),
        ("recurrent", ["--trust"], "must be a model of MaskablePPO, TQC"),
        ("recurrent", [], "must be a model of MaskablePPO, TQC"),
    ],
)
def test_nothing_of_a_foreign_model_runs_without_consent_or_if_it_does_not_fit(
    foreign, tmp_path, name, options, says, refused
):
    file = bombed(foreign / f"{name}.zip", tmp_path / "model.zip", tmp_path / "mark")
    error = refused(evaluate.main, "--agent", file, *options, *QUICK)
    assert f"agent = {str(file)!r}: {says}" in error and not (tmp_path / "mark").exists()
