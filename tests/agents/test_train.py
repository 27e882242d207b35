"""Does ``train.py`` learn, say so honestly, and survive whatever stops it?"""

import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from sb3_contrib import MaskablePPO

import snooker_env as sn
import train
from agents.evaluation import training_summary
from agents.learning import callback, hyperparameters
from agents.learning.hyperparameters import names
from agents.players.trained import load_player
from snooker_env import progress
from snooker_env.benchmark import play_visits, summary
from snooker_env.benchmark.tasks import tables_of
from snooker_env.progress import Progress
from tests.agents.training import TINY, results, resume, run, weights
from tests.processes import ROOT, replace

AGENTS = ("ppo_mask", "ppo_target", "tqc_target")


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
    names = "command settings steps simulated_shots seconds parts start learned evaluation curve imitation"
    assert sorted(found) == sorted(f"{names} versions git_commit processors".split())
    assert found["settings"]["agent"] == agent and found["steps"] == 512 == found["simulated_shots"]
    (part,) = found["parts"]
    assert (part["part"], part["unit"], part["amount"]) == (agent.partition("_")[0].upper(), "shots", 512)
    assert part["seconds"] == found["seconds"] and part["per_second"] == pytest.approx(512 / found["seconds"])
    assert set(found["evaluation"]) == {"trained", "ghost_ball", "random"}
    for figures in found["evaluation"].values():
        assert figures["visits"] == 4
        assert figures["pot_rate"] == pytest.approx(4 * figures["pots_a_visit"] / figures["strokes"])
        assert all(figures[name + "_se"] >= 0 for name in ("pots_a_visit", "points_a_visit", "fouls_a_visit"))
    assert "512 shots" in found["learned"]
    assert found["evaluation"]["trained"] == summary(
        play_visits(load_player(out / "model.zip"), 4, cue="real")
    )


@pytest.mark.parametrize(("agent", "number"), [("ppo_mask", signal.SIGTERM), ("tqc_target", signal.SIGINT)])
def test_signal_saves_and_the_resumed_run_equals_an_uninterrupted_one(
    finished, tmp_path, capsys, monkeypatch, agent, number
):
    out, kind = tmp_path / "run", callback.RunCallback
    step, start, begun = kind._on_step, kind._on_training_start, []

    def interrupted(self):
        if self.num_timesteps == 100:  # tqc only gathers yet
            signal.raise_signal(number)
        return step(self)

    with monkeypatch.context() as patch:
        patch.setattr(kind, "_on_step", interrupted)
        assert run(out, "--agent", agent) == 128 + number
    assert f"--resume --out {out}" in capsys.readouterr().out and not (out / "results.json").exists()
    kept = pickle.loads((out / "checkpoint.pkl").read_bytes())["running"]

    def watched(self):
        start(self)
        begun.append(self.training_env.running)

    monkeypatch.setattr(kind, "_on_training_start", watched)
    assert resume(out) == 0
    # visits go on where they were, with their sums
    assert np.array_equal(begun, [kept]) and (agent == "tqc_target" or kept[1].any())
    assert np.array_equal(weights(out), weights(finished / agent))
    before, after = results(finished / agent), results(out)
    for name in ("evaluation", "settings", "steps", "curve", "learned"):
        assert after[name] == before[name]


def test_it_says_in_a_pipe_what_it_does(tmp_path, capsys, monkeypatch):
    """A line at the start of each part and every few seconds; the last words give each part its own time."""
    monkeypatch.setattr(progress, "EVERY", 0.02)
    spoken = [word for word in TINY if word != "--no-progress"]
    more = ["--imitate", "64", "--steps", "256", "--out", str(tmp_path / "run")]
    assert train.main([*spoken, *more]) == 0
    printed = capsys.readouterr().out
    learning = r"round [2-4] of 4, policy loss \S+, value loss \S+, [\d.]+ points a visit, .*shots/s"
    for k, name, total, figures in (
        (
            1,
            "imitation",
            "64 positions",
            r"round \d+ of 32, loss [\d.]+, (.* points a visit, )?.*positions/s",
        ),
        (2, "PPO", "256 shots", learning),
        (3, "evaluation", "12 visits", r"(trained|ghost_ball|random), .*visits/s"),
    ):
        head = f"ppo_mask, part {k} of 3, {name}: "
        said = [line for line in printed.splitlines() if line.startswith(head)]
        assert said[0] == f"{head}0 of {total}"
        assert re.fullmatch(rf"{head}{total.split()[0]} of {total}, .* elapsed", said[-1])
        between = re.compile(rf"of {total}, {figures}, [\d:]+ elapsed, [\d:]+ left$")
        assert k == 3 or any(map(between.search, said[1:-1])), said  # so few visits may take no time
    found = results(tmp_path / "run")
    amounts = [(part["part"], part["amount"], part["unit"]) for part in found["parts"]]
    assert amounts == [("imitation", 64, "positions"), ("PPO", 256, "shots")]
    tried = found["simulated_shots"] - 64 - 256  # every position is played on, too
    assert 24 * 64 < tried <= 48 * 64
    seconds = [part["seconds"] for part in found["parts"]]
    assert found["seconds"] == pytest.approx(sum(seconds)) and seconds[1] > 0
    assert seconds[0] == pytest.approx(found["imitation"][-1]["seconds"])
    assert re.search(r"^imitation: 64 positions in \d+ s, [\d,]+ a second$", printed, re.M)
    assert re.search(r"^PPO: 256 shots in \d+ s, [\d,]+ a second \(learning included\)$", printed, re.M)


def launch(out, *options):
    """``python train.py`` in a session of its own, once its first checkpoint is there."""
    command = [sys.executable, str(ROOT / "train.py"), *TINY, "--parallel", "auto", "--out", str(out)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    process = subprocess.Popen([*command, *options], start_new_session=True, cwd=out.parent, **pipes)
    deadline = time.monotonic() + 120
    while not (out / "checkpoint.pkl").exists():
        assert process.poll() is None, process.stdout.read()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


def test_kill_9_leaves_a_run_that_resume_finishes(finished, tmp_path):
    out = tmp_path / "run"
    process = launch(out, "--checkpoint-every", "1")
    try:
        while process.poll() is None and not pickle.loads((out / "checkpoint.pkl").read_bytes())["curve"]:
            time.sleep(0.05)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == -signal.SIGKILL and not (out / "results.json").exists()
    assert run(out, "--resume") == 0  # in one thread now: it plays the same shots
    assert results(out)["steps"] == 512
    assert np.array_equal(weights(out), weights(finished / "ppo_mask"))
    assert results(out)["curve"] == results(finished / "ppo_mask")["curve"]


@pytest.mark.slow
def test_ctrl_c_ends_it_in_order(tmp_path):
    process = launch(tmp_path / "run", "--steps", "100000")
    os.killpg(process.pid, signal.SIGINT)  # what a terminal does
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 130, output
    assert "--resume" in output and "Traceback" not in output


def test_resume_refuses_other_settings(finished, refused):
    again = [train.main, "--resume", "--out", finished / "ppo_mask"]
    error = refused(*again, "--noise", "club")
    assert "--noise is 'club'" in error and "has ''" in error
    assert "--agent is 'tqc_target'" in refused(*again, "--agent", "tqc_target")


def test_existing_run_is_not_overwritten(finished, tmp_path, refused):
    before = (finished / "ppo_mask" / "checkpoint.pkl").read_bytes()
    assert "--resume continues it" in refused(train.main, "--out", finished / "ppo_mask")
    assert (finished / "ppo_mask" / "checkpoint.pkl").read_bytes() == before
    (tmp_path / "thesis.txt").write_text("mine")
    assert "thesis.txt" in refused(train.main, "--out", tmp_path)
    assert "holds no checkpoint" in refused(train.main, "--resume", "--out", tmp_path)
    # wrong options are reported first
    assert "noise = 'pro'" in refused(train.main, "--noise", "pro", "--out", tmp_path)


@pytest.mark.parametrize(
    "wrong",
    str.split(
        "layout=moon layout=held_out noise=drunk fidelity=rough agent=dqn set=gamma set=charm=2 envs=-1 steps=-1 "
        "eval-visits=1 eval-visits=2049 seed=-1 seed=x seed=4294967296 start=nowhere start=pyproject.toml"
    ),
)
def test_bad_option_gives_one_clear_error(tmp_path, refused, monkeypatch, wrong):
    monkeypatch.setattr(train.snooker_env, "warmup", None)  # nothing is compiled before
    option, _, value = wrong.partition("=")
    error = refused(train.main, "--out", tmp_path / "run", f"--{option}", value)
    assert option in error and value in error and not (tmp_path / "run").exists()


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
def test_bad_hyperparameter_gives_one_clear_error(tmp_path, refused, monkeypatch, changes, said):
    monkeypatch.setattr(train.snooker_env, "warmup", None)
    assert said in refused(train.main, "--out", tmp_path / "run", "--set", *changes.split())
    assert not (tmp_path / "run").exists()


def test_a_folder_that_cannot_be_written_is_refused(tmp_path, refused, monkeypatch):
    monkeypatch.setattr(train.snooker_env, "warmup", None)
    file = tmp_path / "file"
    file.write_text("mine")
    assert "must be a folder, new or empty" in refused(train.main, "--out", file)
    assert "must be a folder that can be written" in refused(train.main, "--out", file / "run")
    assert file.read_text() == "mine"


def test_resume_refuses_a_broken_checkpoint(finished, tmp_path, refused):
    state = pickle.loads((finished / "ppo_mask" / "checkpoint.pkl").read_bytes())
    older = {key: value for key, value in state.items() if key != "running"}
    others = (older, state | {"settings": {"wheels": 4}}, 3, state | {"model": b"x"})
    whole, file = pickle.dumps(state), tmp_path / "checkpoint.pkl"
    for content in (b"junk", b"", whole[: len(whole) // 2], *map(pickle.dumps, others)):
        file.write_bytes(content)
        error = refused(train.main, "--resume", "--out", tmp_path)
        assert f"resume = '{file}': must be a complete checkpoint" in error


@pytest.fixture
def judged(finished, monkeypatch):
    """Called with the settings of an agent: the options under which its evaluation plays."""
    model = load_player(finished / "ppo_mask").model

    def options_of(agent="ppo_mask", **settings):
        played = []
        monkeypatch.setattr(training_summary, "play_visits", lambda player, n, **more: played.append(more))
        monkeypatch.setattr(training_summary, "summary", lambda visits: None)
        recipe = train.recipe_of(train.Settings(agent=agent, **settings))
        training_summary.evaluate(recipe, model, 2, lambda total: Progress("", total, "visits", quiet=True))
        assert len(played) == 3
        return [{name: value for name, value in one.items() if name != "each"} for one in played]

    return options_of


def test_evaluation_plays_under_the_options_of_training(judged):
    """All options but layout and reward, the environment's own noise where none is given."""
    physics = {"preset": "paper", "mu_bb": "marlow"}
    level = {"noise": "club", "table": "tight", "physics": physics, "fidelity": "fast"}
    whole = {"action": "discrete", "layout": "line_up", "reward": "pots", **level}
    for changes, wanted in (
        ((), {"noise": "professional", "cue": "real"}),
        ((f"env_kwargs={whole}",), level),
        (("env_kwargs={'action': 'discrete'}",), {"noise": "none"}),
    ):
        assert judged(set=changes) == [{"first_seed": tables_of("held_out", 2)} | wanted] * 3


@pytest.mark.parametrize("agent", names())
def test_agents_are_judged_at_the_usual_fidelity(judged, agent):
    """Those whose recipe learns at another too, unless one is asked for."""
    cases = [({}, None), ({"fidelity": "fast"}, "fast")]
    if agent in ("ppo_mask", "ppo_value"):
        changes = ("env_kwargs={'action': 'discrete', 'fidelity': 'reference'}",)
        cases.append(({"set": changes}, "reference"))
    for settings, wanted in cases:
        assert [one.get("fidelity") for one in judged(agent, **settings)] == [wanted] * 3


def test_random_play_is_the_same_for_every_agent(finished):
    """It is that of agents.evaluate, not any action of the agent's own."""
    of_each = [results(finished / agent)["evaluation"] for agent in AGENTS]
    for name in ("random", "ghost_ball"):
        assert all(figures[name] == of_each[0][name] for figures in of_each)
    assert of_each[0]["random"] == summary(play_visits(sn.player("random"), 4, cue="real"))


def test_a_run_can_start_from_a_model_of_its_kind(finished, tmp_path, refused):
    start = str(finished / "ppo_mask")
    assert run(tmp_path / "run", "--start", start, "--set", "learning_rate=0.0") == 0
    assert np.array_equal(weights(tmp_path / "run"), weights(finished / "ppo_mask"))
    found = results(tmp_path / "run")
    begun = {"model": start, "shots": 512, "imitated": 0, "start": None, "simulated_shots": 512}
    assert found["start"] == begun and found["simulated_shots"] == 1024
    assert found["learned"].startswith(f"With 512 shots of training on top of the 512 of {start}, ppo_mask ")
    for agent in ("ppo_value", "ppo_target"):
        error = refused(train.main, *TINY, "--out", tmp_path / "other", "--agent", agent, "--start", start)
        assert f"must be a model of {agent}" in error


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


@pytest.mark.parametrize(
    ("options", "whole"),  # of two tables
    [([], 64), (["--agent", "tqc_target", "--set", "train_freq=3"], 6)],
)
def test_whole_rollouts_are_announced_and_a_finished_run_says_so(tmp_path, capsys, options, whole):
    assert run(tmp_path / "run", "--steps", "1", *options) == 0
    assert results(tmp_path / "run")["steps"] == whole
    announced = f": 0 of {whole} shots played (1 asked for; whole rollouts of {whole})"
    assert announced in capsys.readouterr().out
    assert resume(tmp_path / "run") == 0
    ended = f": {whole} of {whole} shots played\nAll steps are done: nothing left to train."
    assert ended in capsys.readouterr().out


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
    assert run(tmp_path, "--agent", agent, "--steps", steps, "--envs", "64", "--eval-visits", "300") == 0
    trained = results(tmp_path)["evaluation"]["trained"]
    chance = summary(play_visits(sn.player(AnyAction(load_player(tmp_path))), 300, cue="real"))
    gain = trained["points_a_visit"] - chance["points_a_visit"]
    assert gain > least and gain > 3 * trained["points_a_visit_se"]


def test_a_run_goes_on_with_the_tables_that_it_began_with(tmp_path, monkeypatch):
    """Whatever its recipe says by then."""
    folder, seen, original = tmp_path / "recipes", [], train.training_tables
    shutil.copytree(hyperparameters.FOLDER, folder)
    monkeypatch.setattr(hyperparameters, "FOLDER", folder)
    recipe = folder / "ppo_mask.yml"
    now = recipe.read_text()
    replace(recipe, "fidelity: fast", "fidelity: standard")
    assert run(tmp_path / "run", "--steps", "64") == 0
    recipe.write_text(now)
    monkeypatch.setattr(
        train, "training_tables", lambda *args, **options: seen.append(options) or original(*args, **options)
    )
    assert resume(tmp_path / "run", "--steps", "128") == 0
    assert [options["fidelity"] for options in seen] == ["standard"]
    assert results(tmp_path / "run")["steps"] == 128


def test_agents_with_longer_actions_are_judged_and_not_taken_for_shorter(tmp_path, refused):
    out, usual = tmp_path / "run", {"aim": "target"}
    longer = usual | {"elevation": True, "placement": True}
    assert run(out, "--agent", "ppo_target", "--steps", "128", "--set", f"env_kwargs={longer}") == 0
    assert load_player(out).sees == longer
    assert summary(play_visits(load_player(out), 4, noise="none")) == results(out)["evaluation"]["trained"]
    start = ["--agent", "ppo_target", "--start", out, "--out", tmp_path / "new", "--set"]
    error = refused(train.main, *start, f"env_kwargs={usual}")
    assert "start = " in error and "must be a model with actions" in error


def test_imitation_comes_first_and_is_kept(tmp_path):
    few = "--imitate 256 --envs 16 --set n_steps=32"  # of 512 shots a rollout
    assert run(tmp_path, *few.split()) == 0
    first = results(tmp_path)
    assert first["settings"]["imitate"] == 256 and first["imitation"][-1]["states"] == 256
    assert resume(tmp_path, "--steps", "1024") == 0
    again = results(tmp_path)
    assert again["imitation"] == first["imitation"]
    assert all("after 256 positions of imitation, ppo_" in one["learned"] for one in (first, again))


def test_only_what_can_imitate_does(tmp_path, refused):
    """Not what starts from a model, nor an agent without masks."""
    settings = train.Settings
    assert train.recipe_of(settings(start="x")).imitation == 0 < train.recipe_of(settings()).imitation
    for options, says in (
        ("--start x --imitate 5", "imitate = 5: must be 0 or left out with --start"),
        ("--agent ppo_target --imitate 100", "imitate = 100: must be 0 for ppo_target"),
    ):
        assert says in refused(train.main, *options.split(), "--out", tmp_path / "run")


def test_hyperparameters_can_be_changed(tmp_path):
    assert run(tmp_path, "--set", "gamma=0", "n_steps=32") == 0
    # the zip stays one of Stable-Baselines3
    model = MaskablePPO.load(tmp_path / "model.zip", device="cpu")
    assert model.gamma == 0 and model.n_steps == 32 and load_player(tmp_path).model.gamma == 0
    assert results(tmp_path)["settings"]["set"] == ["gamma=0", "n_steps=32"]
    assert results(tmp_path)["command"].endswith(
        "--agent ppo_mask --steps 512 --envs 2 --imitate 0 --set gamma=0 n_steps=32"
    )
