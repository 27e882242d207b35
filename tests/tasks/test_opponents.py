"""Who may play against the agent, and how well? Players by name, saved models."""

import copy
import pickle
import random
import zipfile

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

from snooker_env import SnookerEnv, SnookerVectorEnv
from snooker_env.players.saved_models import SavedModel
from tests.bombs import bombed
from tests.tables import PLACES, acting, frame_env, frame_state
from tests.torch_threads import deciding_on_one_thread


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_after_an_error_of_the_opponent_nobody_plays_for_them(error):
    """The opponent's turn was cut short: the agent's next action is its own, and the next episode begins as ever."""

    def opponent(observation, rng):
        if failing:
            raise error("no turn")
        return np.zeros(7)

    env, miss, failing = frame_env(opponent=acting(opponent)), [-0.9, 0, 0, 1.0, 0, 0, 0], False
    frame_state(env, PLACES, {})
    failing = True
    with pytest.raises(error, match=r"no turn$"):
        env.step(miss)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(miss)
    with pytest.raises(error, match="no turn"):
        [env.reset(seed=seed) for seed in range(10)]  # the opponent breaks off
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(miss)
    failing = False
    env.reset(seed=0)
    env.step(miss)
    assert env.frame.striker == 0


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Files of untrained models: of a visit, of choices, with another view, of another environment."""
    sb3, contrib = pytest.importorskip("stable_baselines3"), pytest.importorskip("sb3_contrib")
    folder = tmp_path_factory.mktemp("saved")
    for name, learner, policy, env in (
        ("visit", sb3.PPO, "MlpPolicy", SnookerEnv()),
        ("balls", sb3.PPO, "MultiInputPolicy", SnookerEnv(observation="balls")),
        ("elevation", sb3.PPO, "MlpPolicy", SnookerEnv(elevation=True)),
        ("pendulum", sb3.PPO, "MlpPolicy", "Pendulum-v1"),
        ("choices", contrib.MaskablePPO, "MlpPolicy", SnookerEnv(action="discrete")),
        ("recurrent", contrib.RecurrentPPO, "MlpLstmPolicy", SnookerEnv(placement=True)),
    ):
        learner(policy, env, seed=1, device="cpu").save(folder / f"{name}.zip")
    return folder


@pytest.mark.parametrize("name", ["DDPG", "TQC", "CrossQ"])
def test_who_saved_a_model_is_read_from_it(tmp_path, name):
    library = pytest.importorskip("stable_baselines3" if name == "DDPG" else "sb3_contrib")
    getattr(library, name)("MlpPolicy", SnookerEnv(), device="cpu").save(tmp_path / "model.zip")
    found = SavedModel.of(tmp_path / "model.zip", "opponent")
    assert issubclass(getattr(library, name), getattr(library, found.algorithm[1]))  # DDPG is a TD3
    assert found.network(True) is not None


@pytest.mark.parametrize(("task", "name"), [("visit", "PPO"), ("frame", "SAC")])
def test_a_saved_model_may_play(tmp_path, task, name):
    sb3 = pytest.importorskip("stable_baselines3")
    options = {"aim": "target", "placement": True, "layout": "random:2"}
    trained = getattr(sb3, name)("MlpPolicy", SnookerEnv(task=task, **options), seed=1, device="cpu")
    path = str(tmp_path / "model.zip")
    trained.save(path)
    for says in ([], ["decision"]):
        env = SnookerEnv(task="frame", opponent=path, trust=True, says=says, **options)
        network = env.tables.seats[1].player.player.seen._network
        pairs = zip(network.parameters(), trained.policy.parameters(), strict=True)
        assert all((a == b).all() for a, b in pairs)
        runs = []
        for one in (env, copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
            one.reset(seed=2)
            runs.append([one.step(np.zeros(one.action_space.shape)) for _ in range(3) if not one.over])
        assert all(data_equivalence(runs[0], run, exact=True) for run in runs[1:])


@pytest.mark.parametrize("own", [{}, {"task": "frame", "says": ["nominate"]}])
def test_a_saved_model_that_sees_masks_may_play(tmp_path, own):
    """A model of visits, with 540 choices, plays in a frame with more as it does on what it sees."""
    contrib = pytest.importorskip("sb3_contrib")
    masked = {"action": "discrete", "observation": "masked"}
    made = contrib.MaskablePPO("MultiInputPolicy", SnookerEnv(**masked, **own), seed=1, device="cpu")
    made.save(tmp_path / "model.zip")
    options = {"task": "frame", "layout": "random:2", "says": own.get("says", ["concede"]), **masked}
    env = SnookerVectorEnv(5, threads=1, opponent=str(tmp_path / "model.zip"), trust=True, **options)
    seen = env.tables.seats[1].player.player.seen
    rows = SnookerVectorEnv(5, threads=1, **masked, **own).reset(seed=3)[0]
    want = made.predict(rows, deterministic=True, action_masks=rows["action_mask"])[0]
    with deciding_on_one_thread(seen._network):
        assert np.array_equal(seen.act(rows, rows["action_mask"].astype(bool), np.arange(5)), want)
    env.reset(seed=2)
    assert sum(env.step(env.action_masks().argmax(axis=1))[4]["opponent_strokes"].sum() for _ in range(4)) > 4


CONSENT = "holds pickled Python code, which runs when it is loaded: must be a file that you trust, and come "
CONSENT += "with trust=True, or --trust on the command line"


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("balls", "must be a model whose actions are Box(-1.0, 1.0, (6,), float32)"),
        ("pendulum", "must be a model trained on the observation of a visit or a frame"),
        ("elevation", "must be a model whose actions are Box(-1.0, 1.0, (6,), float32)"),
        ("choices", "must be a model whose actions are Box"),
        ("recurrent", "must be a model of MaskablePPO, TQC, TRPO, "),
    ],
)
@pytest.mark.parametrize("trust", [False, True])
def test_a_model_that_does_not_fit_is_refused_when_made_and_none_of_it_runs(
    saved, tmp_path, name, says, trust
):
    file = bombed(saved / f"{name}.zip", tmp_path / "model.zip", tmp_path / "mark")
    with pytest.raises(ValueError) as info:
        SnookerEnv(task="frame", opponent=str(file), trust=trust, placement=True, says=["decision"])
    assert str(info.value).startswith(f"opponent = {str(file)!r}: {says}")
    assert not (tmp_path / "mark").exists()


@pytest.mark.parametrize("weights", [False, True])
def test_nothing_of_a_model_runs_without_consent(saved, tmp_path, weights):
    file = bombed(saved / "visit.zip", tmp_path / "model.zip", tmp_path / "mark", weights)
    for options in ({}, {"trust": False}):
        with pytest.raises(ValueError) as info:
            gymnasium.make("Snooker-v0", task="frame", opponent=str(file), **options)
        assert str(info.value) == f"opponent = {str(file)!r}: {CONSENT}"
    assert not (tmp_path / "mark").exists()
    with pytest.raises(ValueError, match=r"opponent = .*: must be a model that PPO can load"):
        SnookerEnv(task="frame", opponent=str(file), trust=True)
    assert (tmp_path / "mark").exists()  # these bombs are sharp


@pytest.mark.parametrize(
    "change",
    [
        lambda found: found.clear(),
        lambda found: found.pop("action_space"),
        lambda found: found.update(observation_space=3),
        lambda found: found.update(observation_space={}),
        lambda found: found["action_space"].update({":type:": 3}),
        lambda found: found["action_space"].update(_shape=None),
        lambda found: found.update(action_space=None),
    ],
)
def test_a_file_that_holds_nothing_sound_is_refused(saved, tmp_path, change):
    file = bombed(saved / "visit.zip", tmp_path / "model.zip", tmp_path / "mark", change=change)
    with pytest.raises(ValueError, match=r"^opponent = '.*model.zip': must be a model saved by Stable-Base"):
        SnookerEnv(task="frame", opponent=str(file), trust=True)
    assert not (tmp_path / "mark").exists()


def test_a_small_file_that_unpacks_to_gigabytes_is_not_unpacked(tmp_path):
    with zipfile.ZipFile(tmp_path / "model.zip", "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("data", b"{}" + b" " * 2**26)
    says = r"^opponent = '.*model.zip': must be a model saved by Stable-Baselines3 \(.*data is larger than 67,108,864"
    with pytest.raises(ValueError, match=says):
        SnookerEnv(task="frame", opponent=str(tmp_path / "model.zip"))


def test_consent_is_a_plain_option_of_the_frame_task(saved):
    env = gymnasium.make("Snooker-v0", task="frame", opponent=str(saved / "visit.zip"), trust=True)
    spec = gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())
    assert gymnasium.make(spec).unwrapped.tables.seats[1].player.name == str(saved / "visit.zip")
    state = random.getstate()
    one = copy.deepcopy(env.unwrapped)
    [one.reset(seed=seed) for seed in range(4)]
    assert random.getstate() == state  # loading takes no seed from the file
