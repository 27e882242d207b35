"""Are the actions of a model of Stable-Baselines3 read as its options say, wherever it is named?"""

import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import watch
from snooker_env.benchmark import HELD_OUT_SEED
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.players import saved_models

TARGET = {"aim": "target"}
WORDS = ["--trust", "--options", "aim=target"]


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """The file of an untrained model of ``aim="target"``."""
    sb3 = pytest.importorskip("stable_baselines3")
    file = tmp_path_factory.mktemp("models") / "ppo.zip"
    sb3.PPO("MlpPolicy", SnookerEnv(**TARGET), seed=4, device="cpu").save(file)
    return str(file)


@pytest.fixture
def nothing_said(monkeypatch):
    monkeypatch.delenv("SNOOKER_ENV_QUIET", raising=False)
    monkeypatch.setattr(saved_models, "_SAID", [])


def tables(n=3):
    env = sn.SnookerVectorEnv(n, layout="held_out", threads=1, **TARGET)
    env.reset(seed=HELD_OUT_SEED)
    return env


def test_what_is_assumed_of_the_aim_is_said_once(model, capsys, nothing_said):
    sn.player(model, trust=True, options=TARGET)
    assert capsys.readouterr().err == ""
    for _ in range(2):
        sn.player(model, trust=True)
    said = capsys.readouterr().err
    assert (
        said.count("\n") == 1 and f"{model}: aim=pot is assumed" in said and "--options aim=absolute" in said
    )


class Sees:
    def act(self, observations, masks, seeds):
        return np.zeros((len(seeds), 3))


@pytest.mark.parametrize("name", ["random", "planner_30", "examples.own_player:Softly", Sees()])
def test_options_of_who_is_no_model_are_refused(name):
    with pytest.raises(ValueError, match=r"^options = \{'aim': 'target'\}: must be left out"):
        sn.player(name, options=TARGET)


def test_a_model_of_the_repository_says_itself_how_its_actions_are_read():
    pytest.importorskip("sb3_contrib")
    from agents.learning.models import PRETRAINED

    with pytest.raises(ValueError, match=r"must be left out: .*ppo_value.zip says itself"):
        sn.player(PRETRAINED / "ppo_value.zip", options=TARGET)


def test_a_visit_of_a_model_is_watched(model, tmp_path, capsys):
    out = tmp_path / "visit.json"
    assert watch.main(["--agent", model, *WORDS, "--noise", "none", "--out", str(out)]) == 0
    told = sn.player(model, trust=True, options=TARGET)
    env = watch.play_episode(told, HELD_OUT_SEED, layout="held_out", noise="none", cue="real")
    assert env.points > 0  # read otherwise it has none
    assert sum(stroke["points"] for stroke in json.loads(out.read_text())["strokes"]) == env.points


@pytest.mark.parametrize("both", [False, True])
def test_a_frame_of_a_model_is_watched_on_either_side(model, both):
    """It plays as it was trained to, also opposite, where the table's actions hold more."""
    names = ["--agent", model if both else "ghost_ball", "--opponent", model]
    args = watch.parser().parse_args(["--frame", *names, *WORDS, "--seed", "3"])
    env, _, _ = watch.find_episode(args)
    opposite = env.tables.seats[1].player.player
    assert opposite.sees["aim"] == "target" and "placement" not in opposite.sees
    assert {stroke.player for stroke in env.history} == {0, 1}


# What acts on observations


def test_actions_of_another_shape_name_act():
    player = sn.player(Sees()).at({})
    says = r"^player Sees: act\(\.\.\.\) returned actions = array of shape \(1, 3\): must have shape \(1, 4\)"
    with pytest.raises(ValueError, match=says):
        player.play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0])


def test_who_only_predicts_is_told_of_act():
    class Predicts:
        def predict(self, observation, deterministic=False):
            return np.zeros(4), None

    with pytest.raises(ValueError, match=r"wrap its predict in act\(observations, masks, seeds\)$"):
        sn.player(Predicts())
