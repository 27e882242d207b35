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

from agents import evaluate
from agents.evaluation.entrants import Entrant
from agents.features.observed import training_tables
from agents.learning.hyperparameters import Recipe, names
from agents.learning.model_files import KEPT, pack_model, read
from agents.learning.models import POLICY
from agents.learning.policy_files import read_policy, write_policy
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
    wanted |= {"seed": 3, "imitated": 300}
    for one in (trained, read(tmp_path / "plain.zip", "agent")):
        assert {key: getattr(one, key) for key in wanted} == wanted
        assert one.env_options == model.env_options and one.action_space == model.action_space
        assert type(one.policy) is type(model.policy)
        assert one.policy.observation_space == model.observation_space
        played, wanted_play = (m.predict(seen, deterministic=True)[0] for m in (one.policy, model))
        assert np.array_equal(played, wanted_play)
        its, weights = one.policy.state_dict(), model.policy.state_dict()  # a learned value of positions, too
        assert its.keys() == weights.keys() and all(torch.equal(its[name], weights[name]) for name in its)
    with pytest.raises(Exception):  # noqa: B017 - whatever its pickles do
        type(model).load(file, device="cpu")
    assert (tmp_path / "mark").exists()  # these bombs are sharp


@pytest.mark.parametrize("weights", [False, True])
def test_no_command_runs_what_a_file_holds(mask, tmp_path, weights):
    """Evaluation of our and another's model, with and without a sound policy.pth."""
    (tmp_path / "run").mkdir()
    ours, foreign, mark = tmp_path / "run" / "model.zip", tmp_path / "foreign.zip", tmp_path / "mark"
    bombed(mask, ours, mark, weights)
    bombed(mask, foreign, mark, weights, change=lambda found: found.pop("recipe"))
    for file in (ours, foreign, ours.parent):
        for call in (lambda file: Entrant.of(str(file)).trained(), load_player):
            wrong = weights or file == foreign
            with pytest.raises(ValueError, match=r"^agent = '.*': must be") if wrong else nullcontext():
                call(file)
    assert not mark.exists()


WRONG = ([1], "x" * 9, {"a": 1}, -1, True, float("nan"))
OTHERS = {key: WRONG for key in KEPT}
OTHERS |= {key: (*WRONG, None) for key in ("num_timesteps", "gamma")}
OTHERS["recipe"] += (None, "../../etc/passwd", "x" * 10**6)
OPTIONS = {"opponent": "x.zip", "aim": ["target"], "action": "box", "physics": {"R": 1}, "layout": 3}
OTHERS["env_options"] += (None, {"noise": {"aim": 1}}, *({name: value} for name, value in OPTIONS.items()))
OTHERS |= {"gamma": (*OTHERS["gamma"], 2), "num_timesteps": (*OTHERS["num_timesteps"], 1.5), "seen": (7, "x")}


@pytest.mark.parametrize("key", OTHERS)
def test_a_figure_that_is_changed_to_another_kind_or_missing_is_refused_by_its_name(plain, tmp_path, key):
    changes = [lambda found, value=value: found.update({key: value}) for value in OTHERS[key]]
    if key not in ("seed", "imitated", "recipe", "seen"):
        changes.append(lambda found: found.pop(key))
    for change in changes:
        file = rezipped(plain, tmp_path / "wrong.zip", model_json=edited(change))
        says = r"must be a model (that train.py saved|of the current ppo_value)"
        with pytest.raises(ValueError, match=rf"^agent = {str(file)!r}: {says}") as info:
            load_player(file)
        assert type(info.value) is ValueError and len(str(info.value)) < 600
        assert key in str(info.value) or "older" in str(info.value) or "NaN is no number" in str(info.value)


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


OLDER = "must be a model of the current ppo_value, but this one is older"
OTHER = r"must be a model that train.py saved \(its policy.pth must hold only weights"


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
    tables = SnookerVectorEnv(9, threads=1, action="discrete", observation="flat", layout="random:2")
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


def test_what_needs_more_than_plain_weights_refuses_it_by_name(tmp_path, refused):
    """A planner wants a value: by the file and by its folder."""
    file = tmp_path / POLICY
    write_policy(file, WEIGHTS, **ABOUT)
    both = "must name a model with policy and value: none, professional, amateur, club or its file"
    for path in (file, tmp_path):
        name = f"planner@{path}"
        error = refused(evaluate.main, *QUICK, "--agent", name)
        assert error.endswith(f"error: player = {name!r}: {both}")


def about(**changes):
    return {"about": np.array(json.dumps(ABOUT | changes))}


WRONG_ARRAYS = """
about=None | about
about=np.array("[]") | about must have exactly the keys
about=np.array("?") | Expecting value
**about(more=1) | about must have exactly the keys
**about(shots=-1) | about.shots = -1
**about(activation="sin") | about.activation = 'sin': must be one of 'tanh', 'relu'
**about(env_options={"aim": "target"}) | key of about.env_options = 'aim'
**about(trainer=3) | about.trainer is not text
weight_0=None | the last layer gives 121 numbers, not 540
weight_1=None | the last layer gives 32 numbers
bias_1=None | bias_1
bias_0=np.zeros(7, np.float32) | weight_0 float32 (32, 121), bias_0 float32 (7,)
weight_0=np.zeros((32, 120), np.float32) | after 121 numbers
weight_0=np.zeros((32, 121)) | weight_0 float64
bias_1=np.full(540, np.nan, np.float32) | layer 1 is not finite
"""


def test_an_array_that_is_changed_or_missing_is_refused_in_one_line(tmp_path):
    file = tmp_path / "p.npz"
    for line in WRONG_ARRAYS.strip().splitlines():
        changes, _, says = line.partition(" | ")
        np.savez(file, **eval(f"arrays({changes})"))
        for reader in (
            read_policy,
            lambda path, _: Entrant.of(path).trained(),
            lambda path, _: load_player(path),
        ):
            with pytest.raises(ValueError) as info:
                reader(str(file), "agent")
            text = str(info.value)
            assert text.startswith(f"agent = {str(file)!r}: must be a policy's .npz: ") and says in text, line
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
