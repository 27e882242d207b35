"""Can models be evaluated that train.py did not make, and does nothing of such a file run before its user
consents?"""

import base64
import json
import re
import sys
import zipfile
from types import ModuleType

import numpy as np
import pytest
from sb3_contrib import TQC, MaskablePPO, RecurrentPPO
from stable_baselines3 import A2C, DQN, PPO, SAC

from agents.evaluation import protocol
from agents.evaluation.entrants import Entrant
from agents.learning.models import PRETRAINED
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.planning import Planner, Positions
from snooker_env.players.saved import saved_player
from tests.bombs import bombed
from tests.torch_threads import deciding_on_one_thread

QUICK = ["--visits", "4", "--layouts", "held_out", "--noise", "professional", "--resamples", "100"]


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
    ("name", "options", "read"),
    [
        ("ppo", {"aim": "target"}, {"aim": "target"}),
        ("balls", {}, {}),
        ("sac", {"elevation": True}, {"elevation": True}),
        ("dqn", {}, {"action": "discrete"}),
        ("mask", {}, {"action": "discrete"}),
        ("masked", {}, {"action": "discrete"}),
    ],
)
def test_a_foreign_model_plays_what_it_would_play_itself(foreign, name, options, read):
    maker = {"ppo": PPO, "balls": PPO, "sac": SAC, "dqn": DQN, "mask": MaskablePPO, "masked": MaskablePPO}[
        name
    ]
    model, player = (
        maker.load(foreign / f"{name}.zip", device="cpu"),
        saved_player(foreign / f"{name}.zip", options, True),
    )
    assert player.sees == read | {"observation": name if name in ("balls", "masked") else "flat"}
    tables = SnookerVectorEnv(3, layout="held_out", threads=1, **read)
    seen_by_it = SnookerVectorEnv(
        3, layout="held_out", threads=1, observation=name if name in ("balls", "masked") else "flat", **read
    )
    tables.reset(seed=0)
    its, _ = seen_by_it.reset(seed=0)
    masks = {"action_masks": tables.action_masks()} if name in ("mask", "masked") else {}
    at, bound = Positions.of(tables), player.at(tables)
    with deciding_on_one_thread(player.seen._network):
        strokes = bound.play(at, np.arange(3))
    chosen = model.predict(its, deterministic=True, **masks)[0]
    assert np.allclose(strokes.values, Planner(tables).strokes_of(at, np.arange(3), chosen)[0], atol=1e-5)


@pytest.mark.parametrize("maker", [PPO, MaskablePPO, SAC, TQC, DQN, A2C])
def test_a_model_plays_where_the_package_of_its_schedules_is_missing(tmp_path, monkeypatch, maker):
    """As one of RL Baselines3 Zoo does, whose files name classes of ``rl_zoo3``: playing needs no schedule
    and no callback."""
    zoo = ModuleType("rl_zoo3")
    schedule = type(
        "SimpleLinearSchedule", (), {"__module__": "rl_zoo3", "__call__": lambda self, left: 1e-3 * left}
    )
    zoo.SimpleLinearSchedule = schedule
    options = {"action": "discrete"} if maker in (MaskablePPO, DQN) else {"aim": "target"}
    more = {"clip_range": schedule(), "n_steps": 8, "batch_size": 8} if maker in (PPO, MaskablePPO) else {}
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "rl_zoo3", zoo)
        model = maker(
            "MlpPolicy", SnookerEnv(**options), seed=4, device="cpu", learning_rate=schedule(), **more
        )
        model.of_the_zoo = schedule()
        model.save(tmp_path / "model.zip")
    monkeypatch.setitem(sys.modules, "rl_zoo3", None)  # missing, also where it is installed
    with zipfile.ZipFile(tmp_path / "model.zip") as file:
        assert b"rl_zoo3" in b"".join(
            base64.b64decode(one)
            for one in re.findall(r'":serialized:": "([^"]*)"', file.read("data").decode())
        )
    player = saved_player(tmp_path / "model.zip", {} if "action" in options else options, True)
    tables = SnookerVectorEnv(3, layout="held_out", threads=1, **options)
    observations, _ = tables.reset(seed=0)
    masks = {"action_masks": tables.action_masks()} if maker is MaskablePPO else {}
    at, chosen = Positions.of(tables), model.predict(observations, deterministic=True, **masks)[0]
    expected = Planner(tables).strokes_of(at, np.arange(3), chosen)[0]
    assert np.allclose(player.at(tables).play(at, np.arange(3)).values, expected, atol=1e-5)


def test_a_foreign_model_is_compared_with_consent(foreign, tmp_path, capsys):
    """Of its training only what the model itself says is reported."""
    agents = ["--agent", str(foreign / "ppo.zip"), "ppo_mask", "random", "--trust", "--options", "aim=target"]
    assert protocol.main([*agents, *QUICK, "--json", str(tmp_path / "r.json")]) == 0
    (run,) = json.loads((tmp_path / "r.json").read_text())["agents"][0]["runs"]
    assert run == {
        "from": str(foreign / "ppo.zip"),
        "recipe": "PPO",
        "shots": 0,
        "imitated": None,
        "seconds": None,
        "seed": 4,
        "gamma": 0.99,
        "layout": "unknown",
        "noise": "unknown",
        "fidelity": "unknown",
        "physics": "unknown",
    }
    assert "unknown" in capsys.readouterr().out


CONSENT = "holds pickled Python code, which runs when it is loaded: must be a file that you trust, and come with trust=True"
OTHER_ACTIONS = (
    "must be a model whose actions are {}: give the options of its training, for example placement=True"
)


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("ppo", [], CONSENT),
        (
            "ppo",
            ["--trust", "--options", "placement=True"],
            OTHER_ACTIONS.format("Box(-1.0, 1.0, (6,), float32)"),
        ),
        ("sac", ["--trust"], OTHER_ACTIONS.format("Box(-1.0, 1.0, (4,), float32)")),
        (
            "dqn",
            ["--trust", "--options", "action=box"],
            OTHER_ACTIONS.format("Box(-1.0, 1.0, (4,), float32)"),
        ),
        ("recurrent", ["--trust"], "must be a model of MaskablePPO, TQC"),
        ("recurrent", [], "must be a model of MaskablePPO, TQC"),
    ],
)
def test_nothing_of_a_foreign_model_runs_without_consent_or_if_it_does_not_fit(
    foreign, tmp_path, name, options, says, capsys
):
    file = bombed(foreign / f"{name}.zip", tmp_path / "model.zip", tmp_path / "mark")
    with pytest.raises(SystemExit) as stop:
        protocol.main(["--agent", str(file), *options, *QUICK])
    assert stop.value.code == 2 and not (tmp_path / "mark").exists()
    assert f"agent = {str(file)!r}: {says}" in capsys.readouterr().err.strip().splitlines()[-1]


@pytest.mark.parametrize(
    "change", [{"gamma": None}, {"gamma": "1"}, {"num_timesteps": -1}, {"seed": [1]}, {"action_space": None}]
)
def test_wrong_figures_of_a_foreign_model_are_refused(foreign, tmp_path, change):
    file = bombed(
        foreign / "ppo.zip",
        tmp_path / "model.zip",
        tmp_path / "mark",
        change=lambda found: found.update(change),
    )
    with pytest.raises(
        ValueError, match=r"^agent = '.*model.zip': must be a model saved by Stable-Baselines3 \("
    ):
        Entrant.of(str(file), True, (("aim", "target"),)).trained()
    assert not (tmp_path / "mark").exists()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            ["aim=target"],
            "options = 'aim=target': must be left out: it is for models that train.py did not make",
        ),
        (["aim"], "options = 'aim': must be KEY=VALUE, KEY once each of action, aim, elevation, placement"),
        (
            ["noise=club"],
            "options = 'noise=club': must be KEY=VALUE, KEY once each of action, aim, elevation, placement",
        ),
        (
            ["aim=target", "aim=target"],
            "options = 'aim=target': must be KEY=VALUE, KEY once each of action, aim, elevation, placement",
        ),
        (["aim=up"], "aim = 'up': must be one of 'absolute', 'target'"),
        (["elevation=1"], "elevation = 1: must be True or False"),
    ],
)
def test_options_are_checked_before_anything_is_played(options, says, capsys):
    for agent in ("ppo_target", str(PRETRAINED / "ppo_mask.zip"), "random"):
        with pytest.raises(SystemExit):
            protocol.main(["--agent", agent, "--trust", "--options", *options, *QUICK])
        assert capsys.readouterr().err.strip().splitlines()[-1].endswith(says)
