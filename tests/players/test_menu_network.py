"""Does the package's agent of the menu play as the trained model does, without PyTorch?"""

import numpy as np
import pytest

import snooker_env as sn
from agents.evaluation.visit_figures import summary
from snooker_env.benchmark import play_visits
from snooker_env.players import VISITS
from snooker_env.players.seen import MenuNetwork
from snooker_env.players.weights import learned_menu
from tests.processes import python

OPTIONS = {"noise": "professional", "cue": "real", "layout": "opened"}


def test_it_chooses_as_the_model_that_was_trained():
    torch = pytest.importorskip("torch")
    from agents.learning.models import PRETRAINED, load_trained

    env = sn.SnookerVectorEnv(60, action="strokes", observation="strokes", **OPTIONS)
    observed, _ = env.reset(seed=5)
    net = load_trained(PRETRAINED / "strokes.zip", "agent").policy.mlp_extractor
    with torch.no_grad():
        wanted = net.forward_actor(torch.as_tensor(observed)).argmax(dim=1).numpy()
    masks = env.action_masks()
    chosen = MenuNetwork(learned_menu("visits"), "visit").act(observed, masks, np.arange(60))
    assert np.array_equal(chosen, wanted) and masks[np.arange(60), chosen].all() and len(set(chosen)) > 10


@pytest.mark.slow
def test_it_makes_more_than_the_widest_pot():
    """On 96 tables; the means have errors of about 2 and 0.7 points."""
    mine, other = (summary(play_visits(name, 96, layout="opened")) for name in ("strokes", "ghost_ball"))
    assert mine["points_a_visit"] > 2.0 * other["points_a_visit"]


def test_a_model_that_saw_another_menu_is_read_by_its_size(tmp_path):
    PPO = pytest.importorskip("stable_baselines3").PPO
    from snooker_env.sb3 import SnookerVecEnv

    for frame in ({}, {"task": "frame"}):
        tables = SnookerVecEnv(2, observation="strokes", speeds=5, threads=1, **frame)
        PPO("MlpPolicy", tables, n_steps=4, batch_size=8, device="cpu").save(tmp_path / "box.zip")
        sees = sn.player(tmp_path / "box.zip", trust=True).sees
        assert (sees["observation"], sees["speeds"]) == ("strokes", 5)


def test_it_plays_frames_without_pytorch():
    code = """
import sys
sys.modules["torch"] = None
import snooker_env as sn
env = sn.match_env(seats=({}, {}), noise="none", aim="absolute")
env.reset(seed=1)
strokes = sn.player("strokes").at({"task": "frame"}).play(env, [1])
print(strokes.values.shape)
"""
    assert "(1, 5)" in python(code)[0]


def test_one_position_or_many_are_the_same_bits():
    env = sn.SnookerVectorEnv(12, **OPTIONS, **VISITS)
    env.reset(seed=2)
    at, player = sn.planning.Positions.of(env), sn.player("strokes").at(env)
    together = player.play(at, np.arange(12)).values
    alone = [player.play(at[[k]], [k]).values[0] for k in range(12)]
    assert np.array_equal(together, alone)
