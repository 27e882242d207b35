"""Whom can the benchmark judge: names, models, classes and programs? And what becomes of those that fail?"""

import json
import shutil
import sys

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import TASKS, Agent, faults, judge
from snooker_env.benchmark.__main__ import main
from snooker_env.benchmark.playing import BATCH
from snooker_env.benchmark.results import read_result, strokes_of, write_result
from snooker_env.players import VISITS, Strokes, ask_player
from tests.processes import ROOT

EXAMPLE = f"program:{sys.executable} {ROOT / 'examples/program_player.py'}"
HARD = TASKS["SnookerEscape-v0"]


def test_the_example_of_a_class_plays(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    arguments = ["run", "SnookerBreak-v0", "--agent", "examples.own_player:Softly", "--training-shots", "0"]
    assert main([*arguments, "--episodes", "30", "--out", str(tmp_path)]) == 0
    result = read_result(tmp_path / "SnookerBreak-v0.Softly.json")
    assert faults(result) == [] and result["agent"]["class"] == "model_free"
    assert result["figures"]["score"]["value"] > 1.5
    assert "SnookerBreak-v0  Softly: " in capsys.readouterr().out


@pytest.mark.parametrize("task", ["SnookerBreakClub-v0", "SnookerEscape-v0", "SnookerFrame-v0"])
def test_the_example_of_a_program_plays(tmp_path, task):
    agent, many = Agent.of(EXAMPLE, training_shots=0, shots_declared=0), 2 if TASKS[task].frame else 8
    result = judge(TASKS[task], agent, episodes=many, out=tmp_path / "one.json")
    assert result["incomplete"] is None and faults(result) == [], result["incomplete"]
    assert result["agent"]["label"] == "program_player" and result["agent"]["declared"]
    assert result["agent"]["class"] == "model_free"
    if task == "SnookerBreakClub-v0":
        assert result["figures"]["pots"]["value"] > 0.5


def program(tmp_path, body):
    file = tmp_path / "player.py"
    file.write_text(f"import json, sys, time\n{body}\n")
    return f"program:{sys.executable} {file}"


GOOD = 'print(json.dumps({"speed": 1.0, "aim": 0.0}), flush=True)'
EACH = "for k, line in enumerate(sys.stdin):\n if k == 3: "
ANSWER = "for k, line in enumerate(sys.stdin):\n print(GOOD * (1 + (k == 2)), end='', flush=True)"
TWICE = """GOOD = '{"speed": 1.0, "aim": 0.0}' + chr(10)\n""" + ANSWER
SLEEPS = f"for k in range(3):\n sys.stdin.readline()\n {GOOD}\ntime.sleep(60)"
FAR, NOMINATES = """'{"speed": 99, "aim": 0}'""", """'{"nominate": "blue"}'"""
REFUSED = "which is refused: speed = 99: must be a finite number in [0.2, 7]"


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (f"{EACH}sys.exit(7)\n {GOOD}", "ended with exit code 7 instead of a stroke"),
        (f"{EACH}time.sleep(60)\n {GOOD}", "gave no stroke within 3 s"),
        (f"{EACH}print('hello', flush=True)\n {GOOD}", "answered 'hello', which is no stroke"),
        (f"{EACH}print({FAR}, flush=True)\n {GOOD}", REFUSED),
        (f"{EACH}print({NOMINATES}, flush=True)\n {GOOD}", "field = 'nominate': must be one of"),
        pytest.param(SLEEPS, "gave no stroke within 3 s", marks=pytest.mark.slow),
        (TWICE, "without a state: one line for each"),
        (
            f"{EACH}\n  while True: sys.stdout.write('x' * 9999)\n {GOOD}",
            "answered a line of more than 1,048,576 bytes",
        ),
    ],
    ids=str.split("dies hangs says far nominates never-reads prints-twice prints-without-end"),
)
def test_a_program_that_fails_is_said_in_one_line_and_what_was_played_is_kept(tmp_path, capsys, body, why):
    agent, out = program(tmp_path, body), tmp_path / "one.json"
    arguments = ["run", "SnookerEscape-v0", "--agent", agent, "--episodes", "6", "--out", str(out)]
    assert main([*arguments, "--timeout", "3", "--training-shots", "0", "--simulated-shots", "0"]) == 1
    (error,) = capsys.readouterr().err.splitlines()
    assert why in error and error.endswith("(after 3 of 6 episodes)")
    result = read_result(out)
    assert len(result["rows"]) == 3 and why in result["incomplete"] and faults(result) == []
    assert not result["protocol"]["official"]


def test_a_program_that_is_closed_may_finish_what_it_does(tmp_path):
    kept = tmp_path / "kept.txt"
    ends = (
        f"for k in range(5): print(k, flush=True), time.sleep(0.05)\nopen({str(kept)!r}, 'w').write('whole')"
    )
    player = sn.player(program(tmp_path, f"for line in sys.stdin:\n {GOOD}\n{ends}")).at({})
    assert player.play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [1]).speed == [1.0]
    player.close()
    assert kept.read_text() == "whole"


def watching(tmp_path):
    """A program that keeps what it is sent, and a call that reads it."""
    kept = tmp_path / "seen.jsonl"
    body = f"for line in sys.stdin:\n open({str(kept)!r}, 'a').write(line)\n {GOOD}"
    return program(tmp_path, body), lambda: list(map(json.loads, kept.read_text("utf-8").splitlines()))


def test_a_program_sees_the_state_of_the_protocol(tmp_path):
    """What it gets is what the server of play answers, with a seed for what it draws."""
    name, seen = watching(tmp_path)
    task, agent = TASKS["SnookerBreakClub-v0"], Agent.of(name, training_shots=0)
    assert judge(task, agent, episodes=2)["agent"]["class"] == "undeclared"
    states = seen()
    balls = {"cue", "red 1", "yellow", "green", "brown", "blue", "pink", "black"}
    assert set(states[0]["positions"]) >= balls and "Balls (x to the right" in states[0]["text"]
    assert states[0]["phase"] == "stroke" and states[0]["ball_on"] == "red"
    assert states[0]["noise"] == ["club"] * 2
    assert states[0]["seed"] == states[2]["seed"] != states[1]["seed"]  # the first table again, timed


class Softly:
    """A soft stroke at a random angle; the third of many positions at once fails as ``error`` says."""

    error = None
    asked = 0

    def at(self, rules):
        return self

    def play(self, positions, seeds):
        if len(seeds) > 1 and self.error is not None:
            type(self).asked += 1
            if self.asked == 3:
                raise self.error
        aims = [np.random.default_rng(seed).uniform(-3, 3) for seed in seeds]
        return Strokes(np.array([[1.0, 0.0, 0.0, aim, 0.0] for aim in aims]))


class Interrupted(Softly):
    error = KeyboardInterrupt()


class Careless(Softly):
    error = RuntimeError("no more")


class Quitter(Softly):
    error = SystemExit(0)


def test_ctrl_c_keeps_what_was_played_and_it_can_be_resumed(tmp_path, capsys):
    Interrupted.asked = 0
    out = tmp_path / "one.json"
    many = 2 * BATCH + 30
    command = f"run SnookerEscape-v0 --agent {__name__}:Interrupted --training-shots 0 --episodes {many}"
    arguments = [*command.split(), "--out", str(out)]
    assert main(arguments) == 130
    assert f"interrupted after {2 * BATCH} of {many} episodes" in capsys.readouterr().err
    part = read_result(out)
    assert len(part["rows"]) == 2 * BATCH and part["incomplete"].startswith("interrupted")
    assert faults(part) == []
    assert main([*arguments, "--resume"]) == 0
    whole = read_result(out)
    assert whole["incomplete"] is None and len(whole["rows"]) == many and faults(whole) == []
    assert whole["rows"][: 2 * BATCH] == part["rows"] and len(strokes_of(whole)) == many
    assert main([*arguments, "--resume"]) == 0 and read_result(out) == whole  # left as it is
    assert main(arguments) == 2 and "must be a new file" in capsys.readouterr().err
    assert read_result(out) == whole
    assert main([*arguments, "--force"]) == 0 and read_result(out)["rows"] == whole["rows"]
    forged = part | {"rows": [[*row[:2], 1, 1, 1, 1, 0, 1, 0, 1] for row in part["rows"]]}
    for other, why in (
        (forged, "must be a sound result to go on with (rows["),
        ({"rows": []}, "must be a sound result to go on with (schema"),
    ):
        write_result(out, other)
        assert main([*arguments, "--resume"]) == 2
        assert why in capsys.readouterr().err and read_result(out) == other
    write_result(out, whole)
    assert main([*arguments, "--resume", "--label", "other"]) == 2
    assert "must be a result of other on SnookerEscape-v0" in capsys.readouterr().err


@pytest.mark.parametrize("maker", [Careless, Quitter])
def test_what_was_played_before_a_failure_is_kept(maker, tmp_path):
    maker.asked, out = 0, tmp_path / "one.json"
    with pytest.raises(RuntimeError, match="no more" if maker is Careless else "ended the program"):
        judge(HARD, Agent.of(maker(), training_shots=0), episodes=2 * BATCH + 30, out=out)
    result = read_result(out)
    assert len(result["rows"]) == 2 * BATCH and faults(result) == []
    assert type(maker.error).__name__ in result["incomplete"]


def test_wrong_agents_are_refused_in_one_line(tmp_path, capsys):
    (tmp_path / "bad.zip").write_text("no zip")
    for agent, line in (
        ("", "must be one of 'random'"),
        ("nobody", "player = 'nobody': must be one of 'random', 'ghost_ball'"),
        ("a=b,examples.own_player:Softly", "must be one of"),
        (f"{__name__}:Nobody", "must be MODULE:CLASS of a player"),
        (f"{__name__}:EXAMPLE", "must be MODULE:CLASS of a player"),
        ("program:", "must name a program"),
        ('program:"cat', """player = 'program:"cat': must be a command line (No closing quotation)"""),
        ("a=train.py,train.py", "must be different players or models"),
        ("ppo_value=train.py", "label = 'ppo_value': must not be the name of another player: give --label"),
        (str(tmp_path / "no.zip"), "no.zip': must be a file or folder that is there: it is missing"),
        (f"planner@{tmp_path / 'no.npz'}", "must name a model with policy and value"),
        (str(tmp_path / "bad.zip"), "must be a model saved by Stable-Baselines3"),
    ):
        assert main(["run", "SnookerEscape-v0", "--agent", agent, "--episodes", "4"]) == 2
        error = capsys.readouterr().err
        assert line in error and error.count("\n") == 1, error


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    sb3 = pytest.importorskip("stable_baselines3")
    from snooker_env.sb3 import SnookerVecEnv

    made = {}
    for name in ("SnookerEscape-v0", "SnookerFrame-v0"):
        tables = SnookerVecEnv(2, options=TASKS[name].options(aim="target"), seed=1)
        made[name] = tmp_path_factory.mktemp("models") / f"{name}.zip"
        ppo = sb3.PPO("MlpPolicy", tables, n_steps=8, batch_size=16, n_epochs=1, seed=0, device="cpu")
        ppo.learn(16).save(made[name])
    return made


def test_a_model_of_stable_baselines_plays_with_consent(model, tmp_path, capsys):
    """Only with --trust, only where its actions fit, and a model of frames plays frames."""
    visit, frame = (str(model[name]) for name in ("SnookerEscape-v0", "SnookerFrame-v0"))
    one, two = tmp_path / "one.json", tmp_path / "two.json"
    run = f"run SnookerEscape-v0 --agent {visit} --episodes 8 --out {one} --label ppo".split()
    assert main([*run, "--options", "aim=target"]) == 2 and "trust" in capsys.readouterr().err
    assert main([*run, "--trust", "--options", "aim=target", "placement=True"]) == 2
    assert "options of its training" in capsys.readouterr().err
    assert main([*run, "--trust", "--options", "aim=target", "--training-shots", "16"]) == 0
    result = read_result(one)
    assert faults(result) == [] and result["agent"]["budget"] == "50k"
    other = str(shutil.copy(frame, tmp_path / "other.zip"))
    run = ["run", "SnookerFrame-v0", "--agent", f"two={frame},{other}", "--episodes", "2", "--out", str(two)]
    assert main([*run, "--trust", "--options", "aim=target"]) == 0
    result = read_result(two)
    assert faults(result) == [] and len(result["rows"]) == 4
    assert [row[1:] for row in result["rows"][:2]] == [row[1:] for row in result["rows"][2:]]
    run = f"run SnookerEscape-v0 --agent {frame} --episodes 2 --trust --options aim=target".split()
    assert main(run) == 2 and "must see visits to play them" in capsys.readouterr().err


def test_what_is_kept_is_what_was_played():
    """Actions are rounded to float32 first; and one table stroke by stroke plays the same."""
    player = Softly()
    result = judge(HARD, Agent.of(player, label="softly"), episodes=24)
    kept = strokes_of(result)
    env = sn.SnookerEnv(HARD.judged_options(**VISITS))
    for row, strokes in zip(result["rows"], kept, strict=True):
        env.reset(seed=row[1])
        assert env.step(strokes[0])[1] == row[2]
    tables, seed = sn.SnookerVectorEnv(1, HARD.judged_options(**VISITS)), result["rows"][0][1]
    tables.reset(seed=[seed])
    exact = ask_player(player, tables, np.ones(1, bool), sn.players.decision_seeds(0, np.array([seed]), 0))
    assert np.array_equal(kept[0], exact.astype(np.float32)) and not np.array_equal(kept[0], exact)
