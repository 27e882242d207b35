"""Does ``train.py`` learn, say so honestly, and survive whatever stops it?"""

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import snooker_env as sn
import train
from agents.evaluation import training_summary
from agents.learning import callback
from agents.learning.hyperparameters import names
from agents.players.trained import load_player
from snooker_env import progress
from snooker_env.benchmark import play_visits, summary, tables_of
from snooker_env.progress import Progress

ROOT = Path(__file__).resolve().parents[2]
AGENTS = ("ppo_mask", "ppo_foresight", "ppo_target", "ppo_absolute", "tqc_target")
TINY = str.split(
    "--agent ppo_mask --envs 2 --eval-visits 4 --no-progress --parallel one --steps 512 --imitate 0"
)


def run(out, *options):
    """``train.main`` in this process; the exit code."""
    return train.main([*TINY, "--out", str(out), *options])


def weights(out):
    """Every parameter of the saved model, flat."""
    model = load_player(out).model
    return np.concatenate([p.detach().numpy().ravel() for p in model.policy.parameters()])


def silent(total):
    return Progress("evaluation", total, "visits", quiet=True)


def results(out):
    return json.loads((out / "results.json").read_text())


def refused(capsys, *arguments):
    """The one-line error with which these arguments are refused."""
    with pytest.raises(SystemExit) as stop:
        train.main([*arguments])
    assert stop.value.code == 2
    return capsys.readouterr().err.strip().splitlines()[-1]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Folders of one uninterrupted run of each agent."""
    folder = tmp_path_factory.mktemp("runs")
    for agent in AGENTS:
        assert run(folder / agent, "--agent", agent) == 0
    return folder


@pytest.mark.parametrize("agent", AGENTS)
def test_run_leaves_model_figures_and_curves(finished, agent):
    out = finished / agent
    assert {p.name for p in out.iterdir()} == {"checkpoint.pkl", "model.zip", "results.json", "tb"}
    assert list((out / "tb").rglob("events.out.tfevents.*"))
    found = results(out)
    assert set(found) == set(
        str.split(
            "command settings steps seconds parts start learned evaluation curve imitation versions "
            "git_commit processors"
        )
    )
    assert found["settings"]["agent"] == agent and found["steps"] == 512
    (part,) = found["parts"]
    assert (part["part"], part["unit"], part["amount"]) == (agent.partition("_")[0].upper(), "shots", 512)
    assert part["seconds"] == found["seconds"] and part["per_second"] == pytest.approx(512 / found["seconds"])
    assert set(found["evaluation"]) == {"trained", "ghost_ball", "random"}
    for figures in found["evaluation"].values():
        assert figures["visits"] == 4
        assert figures["pot_rate"] == pytest.approx(4 * figures["pots_a_visit"] / figures["strokes"])
        assert all(figures[name + "_se"] >= 0 for name in ("pots_a_visit", "points_a_visit", "fouls_a_visit"))
    assert "512 shots" in found["learned"]


@pytest.mark.parametrize("agent", AGENTS)
def test_saved_model_plays_as_it_was_judged(finished, agent):
    again = summary(play_visits(load_player(finished / agent / "model.zip"), 4))
    assert again == results(finished / agent)["evaluation"]["trained"]


@pytest.mark.parametrize(
    ("agent", "at", "number"), [("ppo_mask", 100, signal.SIGTERM), ("tqc_target", 100, signal.SIGINT)]
)
def test_signal_saves_and_the_resumed_run_equals_an_uninterrupted_one(
    finished, tmp_path, capsys, monkeypatch, agent, at, number
):
    original = callback.RunCallback._on_step  # at 100 shots tqc only gathers yet

    def interrupted(self):
        if self.num_timesteps == at:
            signal.raise_signal(number)
        return original(self)

    with monkeypatch.context() as patch:
        patch.setattr(callback.RunCallback, "_on_step", interrupted)
        assert run(tmp_path / "run", "--agent", agent) == 128 + number
    assert f"--resume --out {tmp_path / 'run'}" in capsys.readouterr().out
    assert not (tmp_path / "run" / "results.json").exists()
    kept, begun, start = (
        pickle.loads((tmp_path / "run" / "checkpoint.pkl").read_bytes())["running"],
        [],
        callback.RunCallback._on_training_start,
    )

    def watched(self):
        start(self)
        begun.append(self.training_env.running)

    with monkeypatch.context() as patch:
        patch.setattr(callback.RunCallback, "_on_training_start", watched)
        assert train.main(["--resume", "--no-progress", "--out", str(tmp_path / "run")]) == 0
    # visits go on where they were, with their sums
    assert np.array_equal(begun, [kept]) and (agent == "tqc_target" or kept[1].any())
    assert np.array_equal(weights(tmp_path / "run"), weights(finished / agent))
    before, after = results(finished / agent), results(tmp_path / "run")
    for name in ("evaluation", "settings", "steps", "curve", "learned"):
        assert after[name] == before[name]


def test_it_says_in_a_pipe_what_it_does(tmp_path, capsys, monkeypatch):
    """A line at the start of each part and every few seconds, with what was measured; the last words give
    each part its own time."""
    monkeypatch.setattr(progress, "EVERY", 0.02)
    spoken = [word for word in TINY if word != "--no-progress"]
    more = ["--agent", "ppo_foresight", "--imitate", "64", "--steps", "256", "--out", str(tmp_path / "run")]
    assert train.main([*spoken, *more]) == 0
    lines = capsys.readouterr().out.splitlines()
    parts = [
        (
            "part 1 of 3, imitation",
            "64 positions",
            r"round \d+ of 32, loss [\d.]+, (.* points a visit, )?.*positions/s",
        ),
        (
            "part 2 of 3, PPO",
            "256 shots",
            r"round 2 of 2, policy loss \S+, value loss \S+, [\d.]+ points a visit, .*shots/s",
        ),
        ("part 3 of 3, evaluation", "12 visits", r"(trained|ghost_ball|random), .*visits/s"),
    ]
    for name, total, figures in parts:
        said = [line for line in lines if line.startswith(f"ppo_foresight, {name}: ")]
        assert said[0] == f"ppo_foresight, {name}: 0 of {total}"
        assert re.fullmatch(rf"ppo_foresight, {name}: {total.split()[0]} of {total}, .* elapsed", said[-1])
        assert [
            line
            for line in said[1:-1]
            if re.search(rf"of {total}, {figures}, [\d:]+ elapsed, [\d:]+ left$", line)
        ], said
    found = results(tmp_path / "run")
    assert [(part["part"], part["amount"], part["unit"]) for part in found["parts"]] == [
        ("imitation", 64, "positions"),
        ("PPO", 256, "shots"),
    ]
    assert found["seconds"] == pytest.approx(sum(part["seconds"] for part in found["parts"]))
    assert any(re.fullmatch(r"imitation: 64 positions in \d+ s, [\d,]+ a second", line) for line in lines)
    assert any(
        re.fullmatch(r"PPO: 256 shots in \d+ s, [\d,]+ a second \(learning included\)", line)
        for line in lines
    )
    seconds = {part["part"]: part["seconds"] for part in found["parts"]}
    assert seconds["imitation"] == pytest.approx(found["imitation"][-1]["seconds"]) and seconds["PPO"] > 0


def launch(out, *options):
    """``python train.py`` in a session of its own, once its first checkpoint is there."""
    command = [
        sys.executable,
        str(ROOT / "train.py"),
        *TINY,
        "--parallel",
        "auto",
        "--out",
        str(out),
        *options,
    ]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        cwd=out.parent,
    )
    deadline = time.monotonic() + 120
    while not (out / "checkpoint.pkl").exists():
        assert process.poll() is None, process.stdout.read()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


def steps_of(out):
    """Shots in a checkpoint, read as a resume reads it."""
    state = pickle.loads((out / "checkpoint.pkl").read_bytes())
    return state["curve"][-1]["steps"] if state["curve"] else 0


def test_kill_9_leaves_a_run_that_resume_finishes(finished, tmp_path):
    out = tmp_path / "run"
    process = launch(out, "--checkpoint-every", "1")
    try:
        while steps_of(out) == 0 and process.poll() is None:
            pass
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == -signal.SIGKILL and not (out / "results.json").exists()
    assert run(out, "--resume") == 0  # in one thread now: it plays the same shots
    assert results(out)["steps"] == 512
    assert np.array_equal(weights(out), weights(finished / "ppo_mask"))
    assert results(out)["curve"] == results(finished / "ppo_mask")["curve"]


def test_ctrl_c_ends_it_in_order(tmp_path):
    process = launch(tmp_path / "run", "--steps", "100000")
    os.killpg(process.pid, signal.SIGINT)  # what a terminal does
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 130, output
    assert "--resume" in output and "Traceback" not in output


def test_resume_refuses_other_settings(finished, capsys):
    error = refused(capsys, "--resume", "--out", str(finished / "ppo_mask"), "--noise", "club")
    assert "--noise is 'club'" in error and "has ''" in error
    assert "--agent is 'tqc_target'" in refused(
        capsys, "--resume", "--out", str(finished / "ppo_mask"), "--agent", "tqc_target"
    )


def test_existing_run_is_not_overwritten(finished, tmp_path, capsys):
    before = (finished / "ppo_mask" / "checkpoint.pkl").read_bytes()
    assert "--resume continues it" in refused(capsys, "--out", str(finished / "ppo_mask"))
    assert (finished / "ppo_mask" / "checkpoint.pkl").read_bytes() == before
    (tmp_path / "thesis.txt").write_text("mine")
    assert "thesis.txt" in refused(capsys, "--out", str(tmp_path))
    assert "holds no checkpoint" in refused(capsys, "--resume", "--out", str(tmp_path))
    # wrong options are reported first
    assert "noise = 'pro'" in refused(capsys, "--noise", "pro", "--out", str(tmp_path))


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("layout", "moon"),
        ("layout", "held_out"),
        ("noise", "drunk"),
        ("fidelity", "rough"),
        ("agent", "dqn"),
        ("set", "gamma"),
        ("set", "charm=2"),
        ("envs", "-1"),
        ("steps", "-1"),
        ("eval-visits", "1"),
        ("eval-visits", "2049"),
        ("seed", "-1"),
        ("seed", "x"),
        ("seed", "4294967296"),
        ("start", "nowhere"),
        ("start", __file__),
    ],
)
def test_bad_option_gives_one_clear_error(tmp_path, capsys, monkeypatch, option, value):
    monkeypatch.setattr(train.snooker_env, "warmup", None)  # nothing is compiled before
    error = refused(capsys, "--out", str(tmp_path / "run"), f"--{option}", value)
    assert option in error and value in error
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ("gamma=abc", "gamma = 'abc': must be a finite number in [0, 1]"),
        ("gamma=2", "gamma = 2: must be a finite number in [0, 1]"),
        ("gamma=-1", "gamma = -1"),
        ("gae_lambda=5", "gae_lambda = 5"),
        ("gamma=0 gamma=0.5", "must give gamma only once"),
        ("n_epochs=abc", "n_epochs = 'abc': must be an integer"),
        ("n_epochs=0", "n_epochs = 0"),
        ("ent_coef=x", "ent_coef = 'x'"),
        ("batch_size=0", "batch_size = 0"),
        ("n_steps=0", "n_steps = 0"),
        ("learning_rate=abc", "learning_rate = 'abc'"),
        ("learning_rate=lin_abc", "learning_rate = 'lin_abc': must be a number in [0, 1], or lin_X"),
        ("algo=foo", "'algo=foo': must be KEY=VALUE with KEY one of env_kwargs, n_steps"),
        ("policy=Foo", "'policy=Foo'"),
        ("n_envs=0", "(n_timesteps, n_envs, imitation have options of their own)"),
        ("env_kwargs=3", "env_kwargs = 3: must be a dict"),
        ("env_kwargs={'fun':1}", "env_kwargs = 'fun': must be one of 'action'"),
        ("env_kwargs={'aim':'target'}", "action = 'box': must be 'discrete'"),
        ("env_kwargs={'action':'discrete','layout':'held_out'}", "layout = 'held_out'"),
        ("env_kwargs={'action':'discrete','fidelity':[]}", "fidelity = []"),
    ],
)
def test_bad_hyperparameter_gives_one_clear_error(tmp_path, capsys, monkeypatch, changes, said):
    monkeypatch.setattr(train.snooker_env, "warmup", None)
    assert said in refused(capsys, "--out", str(tmp_path / "run"), "--set", *changes.split())
    assert not (tmp_path / "run").exists()


def test_a_folder_that_cannot_be_written_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(train.snooker_env, "warmup", None)
    file = tmp_path / "file"
    file.write_text("mine")
    assert "must be a folder, new or empty" in refused(capsys, "--out", str(file))
    assert "must be a folder that can be written" in refused(capsys, "--out", str(file / "run"))
    assert file.read_text() == "mine"


def test_resume_refuses_a_broken_checkpoint(finished, tmp_path, capsys):
    state = pickle.loads((finished / "ppo_mask" / "checkpoint.pkl").read_bytes())
    whole = pickle.dumps(state)
    older = pickle.dumps({key: value for key, value in state.items() if key != "running"})
    strange = pickle.dumps(state | {"settings": {"wheels": 4}})
    for content in (
        b"junk",
        b"",
        whole[: len(whole) // 2],
        older,
        strange,
        pickle.dumps(3),
        pickle.dumps(state | {"model": b"x"}),
    ):
        (tmp_path / "checkpoint.pkl").write_bytes(content)
        error = refused(capsys, "--resume", "--out", str(tmp_path))
        assert f"resume = '{tmp_path / 'checkpoint.pkl'}': must be a complete checkpoint" in error


def test_every_player_meets_the_same_tables():
    seen = []

    class Watching(type(sn.player("ghost_ball"))):
        def play(self, positions, seeds):
            seen.append(positions.positions)
            return super().play(positions, seeds)

    first, second = (summary(play_visits(Watching(), 3)) for _ in range(2))
    assert first == second
    assert all(
        np.array_equal(a, b) for a, b in zip(seen[: len(seen) // 2], seen[len(seen) // 2 :], strict=True)
    )


def test_evaluation_plays_under_the_options_of_training(finished, monkeypatch):
    """All options but layout and reward, the environment's own noise where none is given."""
    played, original = [], play_visits

    def watched(player, n, **options):
        played.append(options)
        return original(player, n, **options)

    monkeypatch.setattr(training_summary, "play_visits", watched)
    settings = train.Settings(agent="ppo_mask")
    model = load_player(finished / "ppo_mask").model
    training_summary.evaluate(train.recipe_of(settings), model, 2, silent)
    level = {
        "noise": "club",
        "table": "tight",
        "physics": {"preset": "paper", "mu_bb": "marlow"},
        "fidelity": "fast",
    }
    given = str({"action": "discrete", "layout": "line_up", "reward": "pots", **level})
    training_summary.evaluate(
        train.recipe_of(train.Settings(agent="ppo_mask", set=(f"env_kwargs={given}",))), model, 2, silent
    )
    bare = train.recipe_of(train.Settings(agent="ppo_mask", set=("env_kwargs={'action': 'discrete'}",)))
    training_summary.evaluate(bare, model, 2, silent)
    levels = [{"noise": "professional"}] * 3 + [level] * 3 + [{"noise": "none"}] * 3
    assert [{name: value for name, value in options.items() if name != "each"} for options in played] == [
        {"first_seed": tables_of("held_out", 2)} | one for one in levels
    ]


@pytest.mark.parametrize("agent", names())
def test_agents_are_judged_at_the_usual_fidelity(finished, agent, monkeypatch):
    """Those whose recipe learns at another too, unless one is asked for."""
    seen = []
    monkeypatch.setattr(
        training_summary, "play_visits", lambda player, n, **options: seen.append(options.get("fidelity"))
    )
    monkeypatch.setattr(training_summary, "summary", lambda visits: None)
    model = load_player(finished / "ppo_mask").model
    for settings in (
        {},
        {"fidelity": "fast"},
        {"set": ("env_kwargs={'action': 'discrete', 'fidelity': 'reference'}",)},
    ):
        if "set" not in settings or agent in ("ppo_mask", "ppo_value"):
            training_summary.evaluate(
                train.recipe_of(train.Settings(agent=agent, **settings)), model, 2, silent
            )
    assert seen[:6] == [None] * 3 + ["fast"] * 3 and set(seen[6:]) <= {"reference"}
    assert len(seen) == (9 if agent in ("ppo_mask", "ppo_value") else 6)


def test_random_play_is_the_same_for_every_agent(finished):
    """It is that of agents.evaluate, not any action of the agent's own."""
    of_each = [results(finished / agent)["evaluation"] for agent in AGENTS]
    for name in ("random", "ghost_ball"):
        assert all(figures[name] == of_each[0][name] for figures in of_each)
    assert of_each[0]["random"] == summary(play_visits(sn.player("random"), 4))


def test_a_run_can_start_from_a_model_of_its_kind(finished, tmp_path, capsys):
    start = str(finished / "ppo_mask")
    assert run(tmp_path / "run", "--start", start, "--set", "learning_rate=0.0") == 0
    assert np.array_equal(weights(tmp_path / "run"), weights(finished / "ppo_mask"))
    found = results(tmp_path / "run")
    assert found["start"] == {"model": start, "shots": 512, "imitated": 0, "start": None}
    assert found["learned"].startswith(f"With 512 shots of training on top of the 512 of {start}, ppo_mask ")
    with pytest.raises(SystemExit) as stop:
        run(tmp_path / "other", "--agent", "ppo_foresight", "--start", start)
    assert stop.value.code == 2 and "must be a model of ppo_foresight" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stop:
        run(tmp_path / "other", "--start", start, "--agent", "ppo_target")
    assert stop.value.code == 2 and "must be a model of ppo_target" in capsys.readouterr().err


def test_an_interruption_before_the_first_save_is_reported_in_one_line(tmp_path):
    code = f"""
import runpy, sys, snooker_env
def stop(): raise KeyboardInterrupt
snooker_env.warmup, sys.argv = stop, {["train.py", *TINY, "--out", str(tmp_path / "run")]!r}
runpy.run_path("train.py", run_name="__main__")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 130
    assert done.stderr == "Interrupted. Nothing was saved yet: start the run again.\n"


@pytest.mark.parametrize("agent", ["ppo_mask", "tqc_target"])
def test_whole_rollouts_are_announced_and_a_finished_run_says_so(tmp_path, capsys, agent):
    more = ["--set", "train_freq=3"] if agent == "tqc_target" else []
    assert run(tmp_path / "run", "--agent", agent, "--steps", "1", *more) == 0
    steps = results(tmp_path / "run")["steps"]
    whole = {"ppo_mask": 64, "tqc_target": 6}[agent]  # two tables
    assert (
        f": 0 of {steps:,} shots played (1 asked for; whole rollouts of {whole:,})" in capsys.readouterr().out
    )
    assert steps == whole
    assert train.main(["--resume", "--no-progress", "--out", str(tmp_path / "run")]) == 0
    assert (
        f": {steps:,} of {steps:,} shots played\nAll steps are done: nothing left to train."
        in capsys.readouterr().out
    )


class AnyAction:
    """Any action of another player's own format."""

    def __init__(self, player):
        self.options, self._space = player.sees if hasattr(player, "sees") else {"action": "discrete"}, None

    def act(self, observations, masks, seeds):
        rngs = [np.random.default_rng(seed) for seed in seeds]
        if masks is not None:
            return np.array([rng.choice(np.flatnonzero(mask)) for rng, mask in zip(rngs, masks, strict=True)])
        size = sn.Options(**self.options).rules.actions.size
        return np.stack([rng.uniform(-1.0, 1.0, size) for rng in rngs])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("agent", "steps", "least"),
    [("ppo_mask", "300000", 2.0), ("ppo_target", "100000", 0.3), ("tqc_target", "15000", 0.3)],
)
def test_it_learns(tmp_path, agent, steps, least):
    assert (
        run(tmp_path / "run", "--agent", agent, "--steps", steps, "--envs", "64", "--eval-visits", "300") == 0
    )
    trained = results(tmp_path / "run")["evaluation"]["trained"]
    chance = summary(play_visits(sn.player(AnyAction(load_player(tmp_path / "run"))), 300))
    gain = trained["points_a_visit"] - chance["points_a_visit"]
    assert gain > least and gain > 3 * trained["points_a_visit_se"]
