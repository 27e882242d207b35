"""Are published models those that play today, and are only sound runs published?"""

import hashlib
import io
import json
import pickle
import pickletools
import zipfile

import cloudpickle
import numpy as np
import pytest
import torch

from agents.evaluation import publish
from agents.evaluation.entrants import Entrant
from agents.features.observed import training_tables
from agents.learning import models
from agents.learning.hyperparameters import Recipe
from agents.learning.model_files import KEPT
from agents.learning.models import load_trained, pretrained
from agents.players.trained import load_player
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.planning import Positions

FIGURES = {"learned": "In 4 shots nothing.", "versions": {}, "evaluation": {}, "seconds": 36.0, "steps": 4}
FIGURES |= {"git_commit": "abc", "imitation": []}
SETTINGS = {"agent": "ppo_mask", "seed": 3, "set": [], "imitate": 100}
SETTINGS |= dict.fromkeys(("layout", "noise", "fidelity", "physics", "start"), "")


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """An untrained model's file."""
    file = tmp_path_factory.mktemp("model") / "model.zip"
    tables = training_tables(2, action="discrete")
    Recipe.of("ppo_mask").new_model(tables, 0).save(file)
    tables.close()
    return file


@pytest.fixture
def run(model, tmp_path, monkeypatch):
    """A finished run's folder, and a place of its own for what is published."""
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "model.zip").write_bytes(model.read_bytes())
    write(folder)
    monkeypatch.setattr(publish, "PRETRAINED", tmp_path / "pretrained")
    return folder


def write(folder, settings=None, **figures):
    found = {"command": "python train.py", **FIGURES, "settings": SETTINGS | (settings or {}), **figures}
    (folder / "results.json").write_text(json.dumps(found))


def published(folder):
    return sorted(p.name for p in (folder.parent / "pretrained").glob("*"))


WEIGHTS = {
    "ppo_value": "13ca8f8b324f42d39756c2e08f4fd37a13e743fe0b1d0dfdc01211e3c4b0947a",
    "ppo_value_amateur": "81b63d740602f4ec12de1ee6a4d65c30061abd0c3711a4e72dcf02a70c6246e5",
    "ppo_value_club": "e1f4d04c626b212c1f4bdbedff07a0a9802619907fa2c4f8a6a26d52010ede6f",
    "ppo_value_none": "19d0e235bf97a17aaf7819bb78fba0001815ed168cff6fa9d381b6c697c22a5a",
}
"""SHA-256 of the weights that the published figures were played with, whatever file holds them."""


@pytest.mark.parametrize("name", pretrained())
def test_pretrained_models_hold_figures_and_weights_alone(name, monkeypatch):
    """Nothing but tensors comes out of them, and nothing is unpickled by the way that runs code."""
    with zipfile.ZipFile(models.PRETRAINED / f"{name}.zip") as file:
        assert sorted(file.namelist()) == ["model.json", "policy.pth"]
        assert set(json.loads(file.read("model.json"))) == {*KEPT, "seen"}
        with zipfile.ZipFile(io.BytesIO(file.read("policy.pth"))) as inner:
            pickled = [inner.read(part) for part in inner.namelist() if part.endswith(".pkl")]
    calls = ("GLOBAL", "STACK_GLOBAL", "INST")
    called = {name for opcode, name, _ in pickletools.genops(*pickled) if opcode.name in calls}
    assert called == {"torch._utils _rebuild_tensor_v2", "torch FloatStorage", "collections OrderedDict"}
    load = torch.load

    def forbidden(*arguments, **options):
        raise AssertionError("unpickled")

    def careful(*arguments, weights_only=False, **more):
        return load(*arguments, weights_only=True, **more) if weights_only else forbidden()

    for library in (pickle, cloudpickle):
        for function in ("load", "loads"):
            monkeypatch.setattr(library, function, forbidden)
    monkeypatch.setattr(torch, "load", careful)
    weights = load_player(models.PRETRAINED / f"{name}.zip").model.policy.state_dict()
    digest = hashlib.sha256()
    for key in sorted(weights):
        digest.update(key.encode() + str(tuple(weights[key].shape)).encode() + weights[key].numpy().tobytes())
    assert digest.hexdigest() == WEIGHTS[name]


@pytest.mark.parametrize("name", pretrained())
def test_pretrained_models_play_today(name):
    player = load_player(models.PRETRAINED / f"{name}.zip")
    tables = SnookerVectorEnv(3, noise="professional", layout="held_out", threads=1)
    tables.reset(seed=0)
    strokes = player.at(tables).play(Positions.of(tables), np.arange(3))
    assert np.isfinite(strokes.values).all() and len(set(strokes.aim.tolist())) == 3


def test_a_run_is_published_with_its_card(run, capsys):
    publish.main([str(run), "--limits", "no safety"])
    assert published(run) == ["ppo_mask.json", "ppo_mask.zip"]
    assert "ppo_mask.zip and its card" in capsys.readouterr().out
    folder = run.parent / "pretrained"
    there, trained = load_player(folder / "ppo_mask.zip").model, load_player(run).model
    weights = [one.policy.state_dict() for one in (there, trained)]
    assert weights[0].keys() == weights[1].keys()
    assert all(torch.equal(weights[0][name], weights[1][name]) for name in weights[0])
    assert all(getattr(there, key) == getattr(trained, key) for key in KEPT)
    card = json.loads((folder / "ppo_mask.json").read_text())
    assert (card["limits"], card["hours"], card["imitated"], card["start"]) == ("no safety", 0.01, 0, None)


def test_the_card_counts_what_was_imitated_and_names_the_start(run):
    write(run, {"start": "runs/a"}, imitation=[{"states": 64}, {"states": 128}])
    publish.main([str(run), "--limits", "none", "--name", "second"])
    card = json.loads((run.parent / "pretrained" / "second.json").read_text())
    assert card["imitated"] == 128 and card["start"] == "runs/a"


def test_a_published_model_is_replaced_only_when_asked(run, refused):
    publish.main([str(run), "--limits", "first"])
    card = run.parent / "pretrained" / "ppo_mask.json"
    before = card.read_bytes()
    assert "name = 'ppo_mask': must be new" in refused(publish.main, run, "--limits", "second")
    assert card.read_bytes() == before
    publish.main([str(run), "--limits", "second", "--replace"])
    assert b"second" in card.read_bytes()


FIDELITIES = {"fidelity": "standard"}, {"fidelity": "fast"}


@pytest.mark.parametrize("settings", [{"set": ["gamma=0"]}, {"noise": "club"}, {"start": "a"}, *FIDELITIES])
def test_another_way_to_train_needs_another_name(run, refused, settings):
    write(run, settings)
    assert "name = None: must be given" in refused(publish.main, run, "--limits", "none")
    assert published(run) == []
    publish.main([str(run), "--limits", "none", "--name", "other"])
    assert published(run) == ["other.json", "other.zip"]


@pytest.mark.parametrize("name", ["a/b", "../a", "", ".a", "a b", "search", "ghost_ball"])
def test_bad_names_are_refused(run, refused, name):
    assert f"name = {name!r}: must" in refused(publish.main, run, "--limits", "none", "--name", name)
    assert published(run) == []


def test_limits_must_say_something(run, refused):
    assert "limits = ' ': must say" in refused(publish.main, run, "--limits", " ")


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", "3", "{}", json.dumps({"settings": SETTINGS}), json.dumps({"settings": 3, **FIGURES})],
)
def test_broken_results_are_refused(run, refused, content):
    (run / "results.json").write_text(content)
    error = refused(publish.main, run, "--limits", "none")
    assert f"run = {str(run)!r}: must be the folder of a finished run" in error
    assert published(run) == []


def test_a_file_that_is_no_model_is_refused(run, refused):
    file, publishing = run / "model.zip", [publish.main, run, "--limits", "none"]
    whole = file.read_bytes()
    for content in (b"junk", b"", whole[: len(whole) // 2]):
        file.write_bytes(content)
        assert f"run = {str(file)!r}: must be a model that train.py saved" in refused(*publishing)
    file.unlink()
    assert "must be a model's .zip or a folder that holds model.zip" in refused(*publishing)
    (run / "checkpoint.pkl").write_bytes(b"")
    says = f"this run has not ended, continue it with: python train.py --resume --out {run}$"
    with pytest.raises(ValueError, match=f"^agent = .*{says}"):
        Entrant.of(str(run)).trained()
    assert published(run) == []


def test_a_model_of_an_older_network_is_refused(run, monkeypatch):
    """Other weights, another observation, a recipe that is gone: one sentence that names the file and the recipe."""
    said = r"{} = '.*model.zip': must be a model of the current ppo_mask: this one is older, train it again"
    for at in ("agents.learning.networks.POT", "agents.learning.networks.CONTEXT"):
        with monkeypatch.context() as patch:
            patch.setattr(at, 64)
            with pytest.raises(ValueError, match=said.format("agent")):
                load_player(run)
    with monkeypatch.context() as patch:
        patch.setattr("agents.features.observed.SHOWN", 7)
        with pytest.raises(ValueError, match=said.format("start")):
            load_trained(run / "model.zip", "start")
    monkeypatch.setattr("agents.learning.model_files.Recipe.of", lambda name, **more: {}[name])
    with pytest.raises(ValueError, match=said.format("agent")):
        load_player(run)
