"""Is a model's file read without running anything of it, and refused with one sentence if it is wrong?"""

import importlib
import io
import json
import pickle
import re
import subprocess
import sys
import zipfile
from contextlib import nullcontext
from functools import partial

import numpy as np
import pytest
import torch
from sb3_contrib import MaskablePPO
from stable_baselines3 import SAC

import train
from agents import evaluate
from agents.evaluation.entrants import Entrant
from agents.features.observed import training_tables
from agents.learning.hyperparameters import Recipe, names
from agents.learning.model_files import KEPT, pack_model, read
from agents.learning.models import POLICY, load_weights
from agents.learning.policy_files import packed_policy, read_policy, write_policy
from agents.players.trained import PolicyPlayer, load_player
from snooker_env import SnookerVectorEnv
from snooker_env.planning import Planner, Positions
from snooker_env.planning.learned.dense_layers import Layers
from tests.bombs import Bomb, bombed, edited, rezipped
from tests.processes import ROOT


def made(name, file=None, seed=3):
    """An untrained model of that recipe, saved as train.py does if there is a file."""
    recipe = Recipe.of(name, n_envs=2)
    tables = training_tables(2, threads=1, **recipe.env_kwargs)
    model = recipe.new_model(tables, seed)
    model.imitated, model.num_timesteps = 300, 77
    if file is not None:
        model.save(file)
    tables.close()
    return model


@pytest.fixture(scope="module")
def mask(tmp_path_factory):
    """The file of an untrained ``ppo_value``."""
    file = tmp_path_factory.mktemp("kept") / "model.zip"
    made("ppo_value", file)
    return file


@pytest.fixture
def plain(mask, tmp_path):
    """The same as those of results/weights are written."""
    (tmp_path / "plain.zip").write_bytes(pack_model(read(mask, "agent")))
    return tmp_path / "plain.zip"


@pytest.mark.parametrize("name", names())
def test_every_recipe_is_read_from_its_file_and_no_pickle_of_it_runs(name, tmp_path):
    """What comes out of it and of the published file is what went in; the caller's random numbers stay."""
    model = made(name, tmp_path / "model.zip")
    file = bombed(tmp_path / "model.zip", tmp_path / "bomb.zip", tmp_path / "mark")
    before = torch.get_rng_state()
    trained = read(file, "agent")
    assert torch.equal(torch.get_rng_state(), before) and not (tmp_path / "mark").exists()
    (tmp_path / "plain.zip").write_bytes(pack_model(trained))
    seen = np.random.default_rng(0).uniform(-1, 1, (16, *model.observation_space.shape)).astype(np.float32)
    wanted = {"recipe": name, "num_timesteps": 77, "gamma": model.gamma}
    wanted |= {"seed": 3, "imitated": 300, "start": None}
    for one in (trained, read(tmp_path / "plain.zip", "agent")):
        assert {key: getattr(one, key) for key in wanted} == wanted
        assert one.env_options == model.env_options and one.action_space == model.action_space
        assert type(one.policy) is type(model.policy)
        assert one.policy.observation_space == model.observation_space
        played, wanted_play = (m.predict(seen, deterministic=True)[0] for m in (one.policy, model))
        assert np.array_equal(played, wanted_play)
    with pytest.raises(Exception):  # noqa: B017 - whatever its pickles do
        type(model).load(file, device="cpu")
    assert (tmp_path / "mark").exists()  # these bombs are sharp


@pytest.mark.parametrize("weights", [False, True])
def test_no_command_runs_what_a_file_holds(mask, tmp_path, weights, refused):
    """Evaluation and --start, of our and another's model, with and without a sound policy.pth."""
    (tmp_path / "run").mkdir()
    ours, foreign, mark = tmp_path / "run" / "model.zip", tmp_path / "foreign.zip", tmp_path / "mark"
    bombed(mask, ours, mark, weights)
    bombed(mask, foreign, mark, weights, change=lambda found: found.pop("recipe"))
    for file in (ours, foreign, ours.parent):
        for call in (lambda file: Entrant.of(str(file)).trained(), load_player):
            wrong = weights or file == foreign
            with pytest.raises(ValueError, match=r"^agent = '.*': must be") if wrong else nullcontext():
                call(file)
    for arguments in ([foreign], [ours, "--agent", "ppo_target"]):
        new = ["--out", tmp_path / "new", "--envs", "2", "--no-progress"]
        assert "start = " in refused(train.main, "--start", *arguments, *new)
    assert not mark.exists()


HOSTILE = [(key, value) for key in KEPT for value in ([1], "x" * 9, {"a": 1}, -1, True, float("nan"))]
HOSTILE.remove(("start", {"a": 1}))
HOSTILE += [(key, None) for key in ("env_options", "num_timesteps", "gamma", "recipe")]
HOSTILE += [("recipe", "../../etc/passwd"), ("recipe", "x" * 10**6), ("gamma", 2)]
HOSTILE += [("num_timesteps", 1.5), ("seen", 7), ("seen", "x")]
OPTIONS = {"opponent": "x.zip", "aim": ["target"], "action": "box", "physics": {"R": 1}, "layout": 3}
OPTIONS["noise"] = {"aim": 1}
HOSTILE += [("env_options", {name: value}) for name, value in OPTIONS.items()]


@pytest.mark.parametrize(("key", "value"), HOSTILE)
def test_wrong_figures_are_refused(plain, tmp_path, key, value):
    change = edited(lambda found: found.update({key: value}))
    file = rezipped(plain, tmp_path / "wrong.zip", model_json=change)
    says = r"must be a model (that train.py saved|of the current ppo_value)"
    with pytest.raises(ValueError, match=rf"^agent = {str(file)!r}: {says}") as info:
        load_player(file)
    assert type(info.value) is ValueError and len(str(info.value)) < 600
    assert key in str(info.value) or "older" in str(info.value) or "NaN is no number" in str(info.value)


@pytest.mark.parametrize("key", [key for key in KEPT if key not in ("seed", "imitated", "start", "recipe")])
def test_missing_figures_are_refused(plain, tmp_path, key):
    file = rezipped(plain, tmp_path / "wrong.zip", model_json=edited(lambda found: found.pop(key)))
    with pytest.raises(ValueError, match=rf"must be a model that train.py saved \({key} = None: must be"):
        load_player(file)


def other_weights(change):
    """A change of the bytes of a file of weights by a change of the weights in it."""

    def changed(data):
        file = io.BytesIO()
        torch.save(change(torch.load(io.BytesIO(data), weights_only=True)), file)
        return file.getvalue()

    return changed


def of_each(change):
    return other_weights(lambda weights: {key: change(value) for key, value in weights.items()})


def swollen(data):
    """The same weights, packed so that they unpack to much more."""
    file = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            new.writestr(name, old.read(name) + bytes(2**26 if name.endswith("/data/0") else 0))
    return file.getvalue()


OLDER = "must be a model of the current ppo_value: this one is older"
OTHER = r"must be a model that train.py saved \(its policy.pth must hold weights and nothing else"


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (other_weights(lambda weights: weights | {"more": torch.zeros(3)}), OLDER),
        (other_weights(lambda weights: dict(list(weights.items())[1:])), OLDER),
        (of_each(lambda value: value[:1]), OLDER),
        (of_each(lambda value: value.half()), OLDER),
        (of_each(lambda value: torch.zeros_like(value).to_sparse()), OLDER),
        (of_each(lambda value: value * float("nan")), OTHER),
        (other_weights(lambda weights: weights | {"more": 3}), OTHER),
        (other_weights(lambda weights: list(weights.values())), OTHER),
        (other_weights(lambda weights: {"a": re.compile("x")}), OTHER),
        (other_weights(lambda weights: {"a": np.zeros(3)}), OTHER),
        (None, OTHER),
        (lambda data: b"", OTHER),
        (lambda data: b"junk", OTHER),
        (lambda data: data[: len(data) // 2], OTHER),
        (lambda data: bytes(2**24), OLDER),
        (swollen, OLDER),
    ],
)
def test_wrong_weights_are_refused(plain, tmp_path, change, says):
    file = rezipped(plain, tmp_path / "wrong.zip", policy_pth=change)
    with pytest.raises(ValueError, match=rf"^agent = {str(file)!r}: {says}"):
        load_player(file)


def test_a_file_says_only_once_what_it_is(plain, tmp_path):
    """The published form is read even beside ``data``: nothing of the latter counts."""
    with zipfile.ZipFile(plain) as file, zipfile.ZipFile(tmp_path / "both.zip", "w") as both:
        for name in file.namelist():
            both.writestr(name, file.read(name))
        both.writestr("data", json.dumps({"recipe": "ppo_target"}))
    assert read(tmp_path / "both.zip", "agent").recipe == "ppo_value"


def test_weights_are_handed_on(mask, plain):
    """From a run's file and from the published one, as ``--start`` does."""
    its = MaskablePPO.load(mask, device="cpu").policy.state_dict()
    for file in (mask, plain):
        model = made("ppo_value", seed=9)
        load_weights(model, file)
        assert model.start == {
            "model": str(file),
            "shots": 77,
            "imitated": 300,
            "start": None,
            "simulated_shots": None,
        }
        weights = model.policy.state_dict()
        assert its.keys() == weights.keys() and all(torch.equal(its[name], weights[name]) for name in its)


def test_a_model_of_another_maker_is_recognised(tmp_path):
    SAC("MlpPolicy", "Pendulum-v1", device="cpu").save(tmp_path / "sac.zip")
    assert read(tmp_path / "sac.zip", "agent") is None
    with pytest.raises(ValueError, match=r"^agent = '.*sac.zip': must be a model that train.py saved$"):
        load_player(tmp_path / "sac.zip")


def test_a_missing_library_is_not_called_an_old_model(mask, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "torch", None)
        with pytest.raises(ImportError, match="torch"):
            load_player(mask)
    missing = partial(importlib.import_module, "no_such_library")
    monkeypatch.setattr("agents.learning.hyperparameters.policy", lambda name: missing())
    with pytest.raises(ImportError, match="no_such_library"):
        load_player(mask)


def test_whoever_plays_no_model_waits_for_no_torch():
    code = "import sys, agents.evaluate; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0


ABOUT = {"trainer": "mine", "activation": "tanh", "shots": 12, "seed": 3, "gamma": 0.9}
ABOUT |= {"env_options": {"noise": "club"}}
QUICK = str.split("--visits 4 --layouts held_out --noise club --resamples 100")
RNG = np.random.default_rng(0)
WEIGHTS = [
    (RNG.normal(size=(b, a)).astype(np.float32), RNG.normal(size=b).astype(np.float32))
    for a, b in ((121, 32), (32, 540))
]


def arrays(**changes):
    """The arrays of a sound file with some changed; None leaves one out."""
    found = {"about": np.array(json.dumps(ABOUT))}
    for k, (weight, bias) in enumerate(WEIGHTS):
        found |= {f"weight_{k}": weight, f"bias_{k}": bias}
    found |= changes
    return {name: part for name, part in found.items() if part is not None}


def test_a_policy_plays_the_available_choice_that_scores_highest(tmp_path):
    write_policy(tmp_path / "p.npz", WEIGHTS, **ABOUT)
    player = load_player(tmp_path / "p.npz")
    assert isinstance(player, PolicyPlayer) and player.learned is None
    tables = SnookerVectorEnv(9, threads=1, action="discrete", layout="random:2")
    rows, _ = tables.reset(seed=1)
    (first, shift), (last, end) = WEIGHTS
    scores = np.tanh(rows @ first.T + shift) @ last.T + end
    masks, at = tables.action_masks(), Positions.of(tables)
    want = np.where(masks, scores, -np.inf).argmax(axis=1)
    expected, bound = Planner(tables).strokes_of(at, np.arange(9), want)[0], player.at(tables)
    assert np.array_equal(bound.play(at, np.arange(9)).values, expected) and not masks.all()
    assert len(set(want)) > 2
    for one, mask in zip(bound.rank(at, np.arange(9)), masks, strict=True):
        assert len(one.scores) == min(100, mask.sum()) and (np.diff(one.scores) <= 0).all()
        assert one.scores.sum() <= 1.0 + 1e-9
    other = Layers(WEIGHTS, "relu")(rows)
    expected = np.maximum(rows @ first.T + shift, 0) @ last.T + end
    assert np.allclose(other, expected, atol=1e-4)  # sums of numbers up to 30, in another order
    assert not np.allclose(other, scores, atol=1.0)


def test_it_plays_frames_as_an_opponent(tmp_path):
    """By what a frame's observation has in common with a visit's."""
    file = tmp_path / "p.npz"
    write_policy(file, WEIGHTS, **ABOUT)
    frames = {"task": "frame", "layout": "random:1", "action": "discrete", "opponent": str(file)}
    tables, played = SnookerVectorEnv(3, threads=1, **frames), 0
    tables.reset(seed=1)
    for _ in range(5):
        played += tables.step(tables.action_masks().argmax(axis=1))[-1]["opponent_strokes"].sum()
    assert played > 3


def test_what_needs_more_than_plain_weights_refuses_it_by_name(tmp_path, refused):
    """A planner wants a value, a training the whole network: by the file and by its folder."""
    file = tmp_path / POLICY
    write_policy(file, WEIGHTS, **ABOUT)
    whole = (
        "must be a model that train.py saved, its .zip or a run's folder: an .npz holds plain weights alone"
    )
    both = "must name a model with policy and value: none, professional, amateur, club or its file"
    for path in (file, tmp_path):
        name = f"planner@{path}"
        error = refused(evaluate.main, *QUICK, "--agent", name)
        assert error.endswith(f"error: player = {name!r}: {both}")
        error = refused(train.main, "--start", path, "--out", tmp_path / "run")
        assert error.endswith(f"error: start = {str(file)!r}: {whole}")


def test_the_help_of_evaluations_names_it(capsys):
    with pytest.raises(SystemExit):
        evaluate.main(["--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert "MODEL (a .zip, an .npz of plain weights, or a run's folder)" in printed


def test_it_is_evaluated_like_any_other_agent(tmp_path):
    """As a file and as a run's folder, with what its file says of its training."""
    folder = tmp_path / "mine-0"
    folder.mkdir()
    write_policy(folder / POLICY, WEIGHTS, **ABOUT)
    assert load_player(folder).model.num_timesteps == 12
    more = [*QUICK, "--json", str(tmp_path / "r.json")]
    assert evaluate.main(["--agent", str(folder), f"same={folder / POLICY}", *more]) == 0
    report = json.loads((tmp_path / "r.json").read_text())
    (run,) = report["agents"][0]["runs"]
    wanted = {"recipe": "mine", "shots": 12, "seed": 3, "gamma": 0.9, "noise": "club", "physics": "paper"}
    wanted["imitated"] = None
    assert report["agents"][0]["label"] == "mine-0" and {key: run[key] for key in wanted} == wanted
    first, second = report["results"][:2]
    assert first["agent"] == "mine-0" and second["agent"] == "same"
    assert first["figures"]["points_a_visit"] == second["figures"]["points_a_visit"]


def about(**changes):
    return {"about": np.array(json.dumps(ABOUT | changes))}


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"about": None}, "about"),
        ({"about": np.array("[]")}, "about has not the keys"),
        ({"about": np.array("?")}, "Expecting value"),
        (about(more=1), "about has not the keys"),
        (about(shots=-1), "about.shots = -1"),
        (about(activation="sin"), "about.activation = 'sin': must be one of 'tanh', 'relu'"),
        (about(env_options={"aim": "target"}), "key of about.env_options = 'aim'"),
        (about(trainer=3), "about.trainer is no text"),
        ({"weight_0": None}, "the last layer gives 121 numbers and not 540"),
        ({"weight_1": None}, "the last layer gives 32 numbers"),
        ({"bias_1": None}, "bias_1"),
        ({"bias_0": np.zeros(7, np.float32)}, "weight_0 float32 (32, 121), bias_0 float32 (7,)"),
        ({"weight_0": np.zeros((32, 120), np.float32)}, "after 121 numbers"),
        ({"weight_0": np.zeros((32, 121))}, "weight_0 float64"),
        ({"bias_1": np.full(540, np.nan, np.float32)}, "layer 1 is not finite"),
    ],
)
def test_what_is_no_policy_is_refused_in_one_line(tmp_path, changes, says):
    file = tmp_path / "p.npz"
    np.savez(file, **arrays(**changes))
    for reader in (
        lambda path: read_policy(file, "agent"),
        lambda path: Entrant.of(path).trained(),
        load_player,
    ):
        with pytest.raises(ValueError) as info:
            reader(str(file))
        text = str(info.value)
        assert text.startswith(f"agent = {str(file)!r}: must be a policy's .npz: ") and says in text
        assert "\n" not in text


def test_nothing_in_a_file_is_unpickled(tmp_path):
    bomb, hidden = Bomb(tmp_path / "mark"), np.empty(1, object)
    hidden[0] = bomb
    for name in ("weight_0", "about"):
        np.savez(tmp_path / "p.npz", **arrays(**{name: hidden}))
        with pytest.raises(ValueError, match=r"^agent = .*must be a policy's \.npz"):
            read_policy(tmp_path / "p.npz", "agent")
    (tmp_path / "q.npz").write_bytes(pickle.dumps(bomb))
    with pytest.raises(ValueError, match=r"^agent = "):
        read_policy(tmp_path / "q.npz", "agent")
    assert not (tmp_path / "mark").exists()


def test_what_is_written_must_be_described():
    with pytest.raises(ValueError, match=r"^about = .*must have the keys trainer, activation"):
        packed_policy(WEIGHTS, trainer="mine")
