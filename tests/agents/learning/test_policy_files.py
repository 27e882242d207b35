"""Is another trainer's policy kept as plain weights, played as it scores, and refused if it is no policy?"""

import json
import pickle
import zipfile

import numpy as np
import pytest

import train
from agents.evaluation import protocol
from agents.evaluation.entrants import Entrant
from agents.learning import policy_files
from agents.learning.models import POLICY
from agents.learning.policy_files import packed_policy, read_policy, write_policy
from agents.players.trained import PolicyPlayer, load_player
from snooker_env import SnookerVectorEnv
from snooker_env.planning import Planner, Positions
from snooker_env.planning.learned.dense_layers import Layers
from tests.bombs import Bomb

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
        error = refused(protocol.main, *QUICK, "--agent", name)
        assert error.endswith(f"error: player = {name!r}: {both}")
        error = refused(train.main, "--start", path, "--out", tmp_path / "run")
        assert error.endswith(f"error: start = {str(file)!r}: {whole}")


def test_the_help_of_evaluations_names_it(capsys):
    with pytest.raises(SystemExit):
        protocol.main(["--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert "MODEL (a .zip, an .npz of plain weights, or a run's folder)" in printed


def test_it_is_evaluated_like_any_other_agent(tmp_path):
    """As a file and as a run's folder, with what its file says of its training."""
    folder = tmp_path / "mine-0"
    folder.mkdir()
    write_policy(folder / POLICY, WEIGHTS, **ABOUT)
    assert load_player(folder).model.num_timesteps == 12
    more = [*QUICK, "--json", str(tmp_path / "r.json")]
    assert protocol.main(["--agent", str(folder), f"same={folder / POLICY}", *more]) == 0
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


def test_a_file_that_would_fill_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(policy_files, "MOST", 20_000)
    with zipfile.ZipFile(tmp_path / "p.npz", "w", zipfile.ZIP_DEFLATED) as made:
        made.writestr("weight_0.npy", b"\0" * 10**6)
    with pytest.raises(ValueError, match=r"it holds more than 20,000 bytes"):
        read_policy(tmp_path / "p.npz", "agent")


def test_what_is_written_must_be_described():
    with pytest.raises(ValueError, match=r"^about = .*must have the keys trainer, activation"):
        packed_policy(WEIGHTS, trainer="mine")
