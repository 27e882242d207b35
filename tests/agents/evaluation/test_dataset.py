"""Is a data set what it says: the player's own strokes, on tables of training, gone on with after an interruption?"""

import hashlib
import importlib.util
import json
import shutil

import gymnasium
import numpy as np
import pytest
import torch

from agents import dataset
from agents.players.trained import load_player
from snooker_env.benchmark import HELD_OUT_SEED, TASKS
from snooker_env.planning import Planner, Positions
from snooker_env.players import Strokes

BREAK = TASKS["SnookerBreak-v0"]


@pytest.fixture(autouse=True)
def few_tables(monkeypatch):
    monkeypatch.setattr(dataset, "TABLES", 6)


@pytest.mark.parametrize("form", dataset.FORMS)
def test_the_actions_of_an_episode_play_it_again(form):
    """From its seed, in the environment that the data set names, to the bit."""
    seeds = dataset.seeds_of(0)
    part = dataset.play_table_episodes(BREAK, "ghost_ball", form, seeds, threads=1)
    env, at = gymnasium.make(BREAK.id, **dataset.free_options(BREAK, form)), 0
    for k, (seed, length) in enumerate(zip(seeds, part["lengths"], strict=True)):
        seen, _ = env.reset(seed=seed)
        for row in range(at, at + length):
            shown = seen["observations"] if form == "choices" else seen
            assert np.array_equal(part["observations"][row], shown)
            if form == "choices":
                assert np.array_equal(part["masks"][row], seen["action_mask"])
                assert seen["action_mask"][part["actions"][row]]
            seen, reward, terminated, truncated, info = env.step(part["actions"][row])
            kept = [part[name][row] for name in ("rewards", "terminations", "truncations", *dataset.INFOS)]
            assert kept == [reward, terminated, truncated, info["points"], info["foul"]]
        assert terminated
        assert np.array_equal(part["last"][k], seen["observations"] if form == "choices" else seen)
        at += length
    assert at == len(part["rewards"])


def test_no_table_of_the_judging_is_among_them():
    assert dataset.seeds_of(1)[0] == dataset.seeds_of(0)[-1] + 1
    most = (HELD_OUT_SEED - dataset.FIRST_SEED) // 6
    assert dataset.seeds_of(most - 1)[-1] < HELD_OUT_SEED
    with pytest.raises(ValueError, match=r"^strokes = more: must be at most the strokes of 799,998 episodes"):
        dataset.seeds_of(most)


def test_strokes_that_are_choices_become_those_choices():
    envs = gymnasium.make_vec(
        "SnookerBreakMasked-v0", num_envs=40, vectorization_mode="vector_entry_point", threads=1
    ).unwrapped
    seen, _ = envs.reset(seed=3)
    at, masks, planner = Positions.of(envs), seen["action_mask"] != 0, Planner(envs.options, threads=1)
    rng, rows = np.random.default_rng(0), np.arange(40)
    choices = np.array([rng.choice(np.flatnonzero(row)) for row in masks])
    values = planner.strokes_of(at, rows, choices)[0]
    assert np.array_equal(dataset.nearest_choices(Strokes(values), at, masks, planner), choices)
    values[:, 0] *= 1.02  # within half a step of the speeds
    values[:, 1:3] += 0.05
    values[:, 3] += 1e-4
    assert np.mean(dataset.nearest_choices(Strokes(values), at, masks, planner) == choices) > 0.9


def test_it_is_read_by_minari_and_a_longer_one_begins_with_the_shorter(tmp_path, capsys):
    minari = pytest.importorskip("minari")
    command = ["--out", str(tmp_path), "--player", "ghost_ball", "--form", "choices", "--strokes"]
    assert dataset.main([*command, "10"]) == 0
    folder = tmp_path / "snooker" / "break-ghost_ball-choices-v0"
    short = list(minari.MinariDataset(folder / "data").iterate_episodes())
    parts = tmp_path / "parts" / "snooker-break-ghost_ball-choices-v0"
    (parts / "00000.npz.tmp").write_bytes(b"cut off")
    assert dataset.main([*command, "30"]) == 0
    data = minari.MinariDataset(folder / "data")
    long = list(data.iterate_episodes())
    assert len(long) > len(short) == 6 and data.total_steps >= 30 and data.total_episodes == len(long)
    for a, b in zip(short, long[: len(short)], strict=True):
        assert np.array_equal(a.actions, b.actions) and np.array_equal(a.rewards, b.rewards)
        assert len(a.observations["observations"]) == len(a.actions) + 1 == len(a.infos["points"])
    env = data.recover_environment()
    assert env.observation_space == data.observation_space and env.action_space == data.action_space
    seed = next(iter(data.storage.get_episode_metadata([0])))["seed"]
    assert np.array_equal(env.reset(seed=seed)[0]["observations"], long[0].observations["observations"][0])
    before = (folder / "data" / "main_data.hdf5").stat().st_size
    shutil.rmtree(parts)  # from nothing again: the same data set
    assert dataset.main([*command, "30", "--check", "4"]) == 0
    assert "4 of 4 replayed episodes are equal bit for bit" in capsys.readouterr().out
    again = list(minari.MinariDataset(folder / "data").iterate_episodes())
    assert all(np.array_equal(a.actions, b.actions) for a, b in zip(long, again, strict=True))
    assert abs((folder / "data" / "main_data.hdf5").stat().st_size - before) < 1000
    text = (folder / "README.md").read_text(encoding="utf-8")
    assert f"{data.total_steps} strokes of {data.total_episodes} whole episodes" in text
    rows = np.genfromtxt(folder / "episodes.csv", delimiter=",", names=True)
    assert rows["strokes"].tolist() == [len(one.actions) for one in long]
    assert rows["reward"].tolist() == [sum(one.rewards) for one in long] and rows["seed"][0] == seed
    described = json.loads((folder / "croissant.json").read_text(encoding="utf-8"))
    assert described["name"].endswith(folder.name) and "stroke" in described["description"]
    for file in described["distribution"]:
        assert hashlib.sha256((folder / file["@id"]).read_bytes()).hexdigest() == file["sha256"]
    if importlib.util.find_spec("mlcroissant"):
        import mlcroissant

        records = mlcroissant.Dataset(jsonld=folder / "croissant.json").records("episodes_csv")
        assert next(iter(records))["episodes_csv/seed"] == seed


@pytest.mark.parametrize(
    ("of", "task"), [("rewards", "SnookerBreak-v0"), ("observations", "SnookerSafety-v0")]
)
def test_a_changed_number_is_found_when_episodes_are_played_again(tmp_path, capsys, monkeypatch, of, task):
    pytest.importorskip("minari")
    import h5py

    monkeypatch.chdir(tmp_path)  # a folder by its relative name
    command = f"--out made --task {task} --player ghost_ball --strokes 5 --check 9"
    assert dataset.main(command.split()) == 0
    said = capsys.readouterr().out
    assert "6 of 6 replayed episodes are equal bit for bit" in said and "strokes/s" in said
    (folder,) = (tmp_path / "made" / "snooker").iterdir()
    with h5py.File(folder / "data" / "main_data.hdf5", "r+") as file:
        values = file[f"episode_2/{of}"]
        values[-1] = values[-1] + 1
    assert dataset.differing(folder, 6) == ([2], 6)
    assert dataset.differing(folder, 2) == ([], 2)


@pytest.mark.slow
def test_a_policy_is_cloned_from_one(tmp_path, monkeypatch):
    """The expert is one that a network can copy: it always plays the first pot at one speed."""
    pytest.importorskip("minari")
    monkeypatch.setattr(dataset, "TABLES", 100)
    before = torch.random.get_rng_state(), torch.get_num_threads()
    from examples import behaviour_cloning as example

    command = ["--out", str(tmp_path), "--player", "ghost_ball", "--form", "choices", "--strokes", "600"]
    assert dataset.main(command) == 0
    data = tmp_path / "snooker" / "break-ghost_ball-choices-v0" / "data"
    share = example.main(["--data", str(data), "--visits", "60", "--out", str(tmp_path / "cloned.npz")])
    torch.random.set_rng_state(before[0]), torch.set_num_threads(before[1])
    assert share > 0.5
    assert load_player(tmp_path / "cloned.npz").model.recipe == "behaviour cloning"
