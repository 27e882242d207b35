"""Whom can the benchmark judge? Names, models, classes and programs; and what becomes of those that fail, or of Ctrl-C."""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from snooker_env.benchmark import TASKS, Agent, AgentError, faults, figures_of, judge, read_result, write_result
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.checking import strokes_of
from snooker_env.benchmark.playing import BATCH
from snooker_env.benchmark.strokes import packed

ROOT = Path(__file__).parents[2]
EXAMPLE = f"program:{sys.executable} {ROOT / 'examples/program_player.py'}"


def test_the_example_of_a_class_plays(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    arguments = ["run", "SnookerBreak-v0", "--agent", "examples.own_player:Softly", "--training-shots", "0", "--episodes", "30"]
    assert main([*arguments, "--out", str(tmp_path)]) == 0
    found = read_result(tmp_path / "SnookerBreak-v0.Softly.json")
    assert faults(found) == [] and found["agent"]["class"] == "model_free" and found["figures"]["score"]["value"] > 4
    assert "SnookerBreak-v0  Softly: " in capsys.readouterr().out


@pytest.mark.parametrize("task", ["SnookerColours-v0", "SnookerEscape-v0", "SnookerFrame-v0"])
def test_the_example_of_a_program_plays(tmp_path, task):
    agent = Agent.of(EXAMPLE, training_shots=0, shots_declared=0)
    found = judge(TASKS[task], agent, episodes=2 if task == "SnookerFrame-v0" else 8, out=tmp_path / "one.json")
    assert found["incomplete"] is None and faults(found) == [], found["incomplete"]
    assert found["agent"]["label"] == "program_player" and found["agent"]["declared"] and found["agent"]["class"] == "model_free"
    if task == "SnookerColours-v0":
        assert found["figures"]["pots"]["value"] > 0.5


def program(tmp_path, body):
    file = tmp_path / "player.py"
    file.write_text(f"import json, sys, time\n{body}\n")
    return f"program:{sys.executable} {file}"


GOOD = 'print(json.dumps({"speed": 1.0, "aim": 0.0}), flush=True)'
TWICE = """'{"speed": 1.0, "aim": 0.0}' + chr(10)"""
BROKEN = {
    "dies": (f"for k, line in enumerate(sys.stdin):\n if k == 3: sys.exit(7)\n {GOOD}", "ended with exit code 7 instead of a stroke"),
    "hangs": (f"for k, line in enumerate(sys.stdin):\n if k == 3: time.sleep(60)\n {GOOD}", "gave no stroke within 3 s"),
    "says": (f"for k, line in enumerate(sys.stdin):\n if k == 3: print('hello', flush=True)\n {GOOD}",
             "answered 'hello', which is no stroke"),
    "far": (f"for k, line in enumerate(sys.stdin):\n if k == 3: print('{{\"speed\": 99, \"aim\": 0}}', flush=True)\n {GOOD}",
            "which is refused: speed = 99: must be a finite number in [0.2, 7]"),
    "nominates": (f"for k, line in enumerate(sys.stdin):\n if k == 3: print('{{\"nominate\": \"blue\"}}', flush=True)\n {GOOD}",
                  "field = 'nominate': must be one of"),
    "never reads": (f"for k in range(3):\n sys.stdin.readline()\n {GOOD}\ntime.sleep(60)", "gave no stroke within 3 s"),
    "prints twice": (f"GOOD = {TWICE}\nfor k, line in enumerate(sys.stdin):\n print(GOOD * (1 + (k == 2)), end='', flush=True)",
                     "without a state: one line for each"),
    "prints without end": (f"for k, line in enumerate(sys.stdin):\n if k == 3:\n  while True: sys.stdout.write('x' * 9999)\n {GOOD}",
                           "answered a line of more than 1,048,576 bytes"),
}  # fmt: skip


@pytest.mark.parametrize("how", BROKEN)
def test_a_program_that_fails_is_said_in_one_line_and_what_was_played_is_kept(tmp_path, capsys, how):
    body, why = BROKEN[how]
    out = tmp_path / "one.json"
    arguments = ["run", "SnookerEscape-v0", "--agent", program(tmp_path, body), "--episodes", "6", "--out", str(out), "--timeout", "3"]
    assert main([*arguments, "--training-shots", "0", "--simulated-shots", "0"]) == 1
    *said, error = capsys.readouterr().err.splitlines()
    assert why in error and error.endswith("(after 3 of 6 episodes)")
    assert said[0] == "SnookerEscape-v0: 0 of 6 episodes" and said[-1].startswith("SnookerEscape-v0: 3 of 6 episodes, ")
    found = read_result(out)
    assert len(found["rows"]) == 3 and why in found["incomplete"] and faults(found) == [] and not found["protocol"]["official"]


def test_a_result_is_resumed_by_whole_batches_with_the_same_options(tmp_path):
    out, task = tmp_path / "one.json", TASKS["SnookerPotHard-v0"]
    made = iter([{"action": "discrete"}, {"action": "discrete"}, {"aim": "target"}])

    class Still:
        def __init__(self):
            self.options = next(made)

        def act(self, tables, observations, going):
            return np.zeros(tables.action_space.shape, tables.action_space.dtype)

    agent = Agent(label="still", kind="object", sources=("here",), maker=Still, training_shots=0)
    whole = judge(task, agent, episodes=BATCH + 30)
    for many, why in (
        (BATCH - 1, "must hold whole batches to go on with, not 99 episodes"),
        (BATCH, "must be those of all training seeds"),
    ):
        rows, strokes = whole["rows"][:many], packed(strokes_of(whole)[:many])
        figures = figures_of(task, "still", rows)
        part = whole | {"rows": rows, "strokes": strokes, "figures": figures, "incomplete": "stopped"}
        write_result(out, part)
        if many == BATCH:
            assert len(judge(task, agent, episodes=BATCH + 30, out=out, resume=True)["rows"]) == BATCH + 30
            write_result(out, part)
        with pytest.raises(ValueError, match=why):
            judge(task, agent, episodes=BATCH + 30, out=out, resume=True)


def test_a_program_that_is_not_there(capsys):
    assert main(["run", "SnookerEscape-v0", "--agent", "program:no-such-program-here", "--episodes", "6"]) == 1
    assert "cannot be started" in capsys.readouterr().err
    with pytest.raises(AgentError, match="cannot be started"):
        Agent.of("program:no-such-program-here").player(TASKS["SnookerEscape-v0"])


def test_a_program_sees_the_state_of_the_protocol(tmp_path):
    """What it gets is what the server of play answers, for the table of the episode."""
    kept = tmp_path / "seen.jsonl"
    body = f"for line in sys.stdin:\n open({str(kept)!r}, 'a').write(line)\n {GOOD}"
    judge(TASKS["SnookerColours-v0"], Agent.of(program(tmp_path, body), training_shots=0), episodes=2)
    state = json.loads(kept.read_text().splitlines()[0])
    assert state["phase"] == "stroke" and state["ball_on"] == "yellow" and state["noise"] == ["professional"] * 2
    assert (
        set(state["positions"]) == {"cue", "yellow", "green", "brown", "blue", "pink", "black"} and "Balls (x to the right" in state["text"]
    )


class Interrupted:
    """ghost_ball, stopped by Ctrl-C in its third batch."""

    options = {"action": "discrete"}  # noqa: RUF012
    stopped = False

    def __init__(self):
        self.batches = 0

    def begin(self, seed):
        self.batches += 1
        if self.batches == 3 and not Interrupted.stopped:
            Interrupted.stopped = True
            raise KeyboardInterrupt

    def act(self, tables, observations, going):
        return np.full(len(going), 67)


def test_ctrl_c_keeps_what_was_played_and_it_can_be_resumed(tmp_path, capsys):
    out = tmp_path / "one.json"
    arguments = ["run", "SnookerPotHard-v0", "--agent", f"{__name__}:Interrupted", "--episodes", str(2 * BATCH + 30), "--out", str(out)]
    arguments += ["--training-shots", "0"]
    sys.modules.setdefault(__name__, sys.modules[Interrupted.__module__])
    assert main(arguments) == 130
    assert f"interrupted after {2 * BATCH} of {2 * BATCH + 30} episodes" in capsys.readouterr().err
    found = read_result(out)
    assert len(found["rows"]) == 2 * BATCH and found["incomplete"].startswith("interrupted") and faults(found) == []
    assert main([*arguments, "--resume"]) == 0
    whole = read_result(out)
    assert whole["incomplete"] is None and len(whole["rows"]) == 2 * BATCH + 30 and faults(whole) == []
    assert whole["rows"][: 2 * BATCH] == found["rows"] and len(strokes_of(whole)) == 2 * BATCH + 30
    assert main([*arguments, "--resume"]) == 0 and read_result(out) == whole  # left as it is
    assert main(arguments) == 2 and "must be a new file" in capsys.readouterr().err and read_result(out) == whole
    assert main([*arguments, "--force"]) == 0 and read_result(out)["rows"] == whole["rows"]
    forged = found | {"rows": [[*row[:2], 1, 1, 1, 1, 0, 1, 0, 1] for row in found["rows"]]}
    for part, why in (
        (forged, "must be a sound result to go on with (rows["),
        ({"rows": []}, "must be a sound result to go on with (schema"),
    ):
        write_result(tmp_path / "part.json", part)
        assert main([*arguments[:-4], "--out", str(tmp_path / "part.json"), "--training-shots", "0", "--resume"]) == 2
        assert why in capsys.readouterr().err and read_result(tmp_path / "part.json") == part
    wrong = [*arguments, "--resume", "--label", "other"]
    assert main(wrong) == 2 and "must be a result of other on SnookerPotHard-v0" in capsys.readouterr().err


def test_wrong_agents_are_refused_in_one_line(tmp_path, capsys):
    for agent, line in (
        ("nobody", "agent = 'nobody': must be one of lookahead, ghost_ball"),
        ("a=b,examples.own_player:Softly", "must be one of"),
        ("examples.own_player:Nobody", "must be MODULE:CLASS of a player"),
        ("program:", "must name a program"),
        ('program:"cat', """agent = 'program:"cat': must be a command line (No closing quotation)"""),
        ("a=train.py,train.py", "must be different models"),
        ("ppo_mask=train.py", "label = 'ppo_mask': must not be the name of another player: give --label"),
        (str(tmp_path / "no.zip"), "must be one of"),
    ):
        assert main(["run", "SnookerEscape-v0", "--agent", agent, "--episodes", "4"]) == 2
        error = capsys.readouterr().err
        assert line in error and error.count("\n") == 1, error
    (tmp_path / "no.zip").write_text("no zip")
    assert main(["run", "SnookerEscape-v0", "--agent", str(tmp_path / "no.zip")]) == 2
    assert "must be a model saved by Stable-Baselines3" in capsys.readouterr().err


class Peeks:
    options = {"noise": "none"}  # noqa: RUF012

    def act(self, tables, observations, going):
        raise AssertionError


def test_a_player_with_a_budget_in_its_name_is_one_of_the_repository():
    agent = Agent.of("lookahead_60")
    assert (agent.kind, agent.label, agent.player(TASKS["SnookerBreak-v0"]).player.budget) == ("repository", "lookahead_60", 60)
    assert Agent.of("planner_500").label == "planner_500"


def test_no_agent_changes_what_is_frozen():
    agent = Agent(label="peeks", kind="object", sources=("here",), maker=Peeks)
    with pytest.raises(ValueError, match="key of options = 'noise': must be one of 'action', 'aim'"):
        judge(TASKS["SnookerBreak-v0"], agent, episodes=2)


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    sb3 = pytest.importorskip("stable_baselines3")
    from snooker_env.sb3 import SnookerVecEnv

    made = {}
    for name in ("SnookerPotHard-v0", "SnookerFrame-v0"):
        tables = SnookerVecEnv(2, options=TASKS[name].options(aim="target"), seed=1)
        made[name] = tmp_path_factory.mktemp("models") / f"{name}.zip"
        sb3.PPO("MlpPolicy", tables, n_steps=8, batch_size=16, n_epochs=1, seed=0, device="cpu").learn(16).save(made[name])
    return made


def test_a_model_of_stable_baselines_plays_with_consent(model, tmp_path, capsys):
    """Only with --trust, only where its actions fit, and a model of frames plays frames."""
    visit, frame = (str(model[name]) for name in ("SnookerPotHard-v0", "SnookerFrame-v0"))
    run = ["run", "SnookerPotHard-v0", "--agent", visit, "--episodes", "8", "--out", str(tmp_path / "one.json"), "--label", "ppo"]
    assert main([*run, "--options", "aim=target"]) == 2 and "come with --trust" in capsys.readouterr().err
    assert main([*run, "--trust", "--options", "aim=target", "placement=True"]) == 2
    assert "give --options as in its training" in capsys.readouterr().err
    assert main([*run, "--trust", "--options", "aim=target", "--training-shots", "16"]) == 0
    found = read_result(tmp_path / "one.json")
    assert faults(found) == [] and found["agent"]["options"] == {"aim": "target"} and found["agent"]["budget"] == "50k"
    other = str(shutil.copy(frame, tmp_path / "other.zip"))
    run = ["run", "SnookerFrame-v0", "--agent", f"two={frame},{other}", "--episodes", "2", "--out", str(tmp_path / "two.json"), "--trust"]
    assert main([*run, "--options", "aim=target"]) == 0
    found = read_result(tmp_path / "two.json")
    assert (
        faults(found) == [] and len(found["rows"]) == 4 and [row[1:] for row in found["rows"][:2]] == [row[1:] for row in found["rows"][2:]]
    )
    assert main(["run", "SnookerPotHard-v0", "--agent", frame, "--episodes", "2", "--trust", "--options", "aim=target"]) == 2
    assert "must be trained on a visit" in capsys.readouterr().err


def test_without_the_libraries_one_line_says_which_to_install(model, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    arguments = ["run", "SnookerPotHard-v0", "--agent", str(model["SnookerPotHard-v0"]), "--trust", "--options", "aim=target"]
    from snooker_env.benchmark.agents import _model

    _model.cache_clear()
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "needs stable_baselines3" in error and 'pip install -e ".[train]"' in error


def test_a_model_of_the_repository_plays_visits_and_frames():
    pytest.importorskip("sb3_contrib")
    agent = Agent.of("ppo_target")
    for name, n in (("SnookerColours-v0", 20), ("SnookerFrame-v0", 2)):
        found = judge(TASKS[name], agent, episodes=n)
        assert faults(found) == [] and found["agent"]["class"] == "model_free"
