"""Do the commands of ``agents`` and ``train.py`` refuse what is wrong with one line, before anything is compiled or written?"""

import shlex

import pytest

import snooker_env as sn
import train
from agents import dataset, evaluate, learn_worth, tournament
from tests.processes import ROOT

COMMANDS = {"train": train, "evaluate": evaluate, "tournament": tournament}
COMMANDS |= {"dataset": dataset, "learn_worth": learn_worth}
WRONG = r"""
train --layout moon | layout = 'moon'
train --layout held_out | layout = 'held_out'
train --noise drunk | noise = 'drunk'
train --fidelity rough | fidelity = 'rough'
train --agent dqn | 'dqn'
train --envs -1 | --envs is -1
train --steps -1 | --steps is -1
train --eval-visits 1 | --eval-visits is 1
train --eval-visits 2049 | --eval-visits is 2049
train --seed 4294967296 | --seed is 4294967296, must be an integer in [0, 4294967295]
train --imitate 100 | imitate = 100: must be 0 for strokes
train --agent ppo_value --imitate 0 | imitate = 0: must be 1 or more for ppo_value: PPO needs
train --agent ppo_target --observe-conditions | observe_conditions = True: must be False with conditions="fixed"
train --agent ppo_value --imitate 8 --conditions drawn --observe-conditions | observe_conditions = True: must be left out for ppo_value
train --set gamma | gamma
train --set "env_kwargs={'action': 'strokes'}" | observation = None: must be 'strokes'
train --agent ppo_value --set "env_kwargs={'action': 'discrete', 'observation': 'balls'}" | observation = 'balls': must be left out
train --set charm=2 | 'charm=2': must be KEY=VALUE with KEY one of env_kwargs, n_steps
train --set gamma=abc | gamma = 'abc': must be a finite number in [0, 1]
train --set gamma=2 | gamma = 2: must be a finite number in [0, 1]
train --set gamma=0 gamma=0.5 | must give gamma only once
train --set n_epochs=abc | n_epochs = 'abc': must be an integer
train --set batch_size=0 | batch_size = 0
train --set learning_rate=lin_abc | learning_rate = 'lin_abc': must be a number X in [0, 1], or lin_X
train --set policy=Foo | 'policy=Foo'
train --set n_envs=0 | (n_timesteps, n_envs, imitation have their own options)
train --set env_kwargs=3 | env_kwargs = 3: must be a dict
train --set "env_kwargs={'fun':1}" | env_kwargs = 'fun': must be one of 'action'
train --set "env_kwargs={'aim':'target'}" | action = 'box': must be 'strokes'
train --agent ppo_value --set "env_kwargs={'action':'discrete','layout':'held_out'}" | layout = 'held_out'
train --agent ppo_value --set "env_kwargs={'action':'discrete','fidelity':[]}" | fidelity = []
train --agent stroke_value --envs 64 | envs = 64: must be left out for stroke_value
train --agent stroke_value --set tables=3 | tables = 3
train --agent stroke_value --set widths=3 | must be KEY=VALUE with KEY one of rounds, tables, frame_rounds, frames, cue
train --agent stroke_value --seed 81 | seed = 81
evaluate --agent nobody | agent = 'nobody': must be random,
evaluate --agent tests/bombs.py | tests/bombs.py': must be a model saved by Stable-Baselines3
evaluate --agent x=nowhere-* | agent = 'nowhere-*': must be
evaluate --agent random random | agent = 'random': must differ for each agent
evaluate --agent random --against me | against = 'me': must be one of random, ghost_ball
evaluate --agent random --layouts moon=3 | layout = 'moon': must be one of
evaluate --agent random --layouts colours=x | layouts = 'colours=x': must be LAYOUT or
evaluate --agent random --visits 1 | visits = 1: must be an integer in [2
evaluate --agent random --noise loud | noise = 'loud': must be one of
evaluate --agent random --fidelity true | fidelity = 'true': must be
evaluate --agent random --physics mars | physics = 'mars': must be one of
evaluate --agent random --physics paper,mu_bb | physics = 'paper,mu_bb': must be PRESET
evaluate --agent random --physics paper,R=0.03 | physics = 'paper,R=0.03': must keep R
evaluate --agent random --physics paper,mu_r=0 | physics.mu_r = 0.0: must be > 0
evaluate --agent search_1 | player = 'search_1': must end in a number of simulated shots from 8
evaluate --agent random --json tests | json = 'tests': must be a file
evaluate --agent random --markdown /proc/none/r.md | markdown = '/proc/none/r.md': must be a file
evaluate --agent random --resamples 5 | resamples = 5: must be an integer in
evaluate --agent random --options aim=target | 'aim=target': must be left out: it is for models not made by train.py
evaluate --agent random --options noise=club | options = 'noise=club': must be KEY=VALUE, KEY once each of action
evaluate --agent random --options aim=target aim=target | must be KEY=VALUE, KEY once each of action
evaluate --agent random --options aim=up | aim = 'up': must be one of 'pot', 'absolute', 'target'
evaluate --agent random --ray host: | ray = 'host:': must be local, auto, or HOST:PORT
tournament ghost_ball | players = 'ghost_ball': must be two or more
tournament ghost_ball nobody | agent = 'nobody': must be random,
tournament ghost_ball ghost_ball | player = 'ghost_ball': must differ for each player
tournament ghost_ball x=ghost_ball,random | player = 'x=ghost_ball,random': must be one player
tournament ghost_ball tests.agents.user_players:Mute | player = a Mute: must be a player: at(rules) and play
tournament ghost_ball tests.agents.user_players:Loud | key of the options of player Loud = 'noise'
tournament ghost_ball random --frames 7 | frames = 7: must be even
tournament ghost_ball random --match 4 | match = 4: must be odd
tournament ghost_ball random --miss always | miss = 'always': must be one of
tournament ghost_ball random --rules pool | game = 'pool': must be one of
tournament ghost_ball random --max-strokes 0 | max_strokes = 0: must be an integer
tournament ghost_ball random --threads 0 | threads = 0: must be an integer
tournament ghost_ball random --options aim=target | options = 'aim=target': must be left out
tournament ghost_ball random --resume | resume = True: must be given together with --out
tournament ghost_ball random --out pyproject.toml | out = 'pyproject.toml': must be a new file
tournament ghost_ball random --out pyproject.toml --resume | pyproject.toml': must be JSON
tournament ghost_ball random --out tests --resume | out = 'tests': must be a file
dataset --task Snooker-v0 | task = 'Snooker-v0': must be one of
dataset --form targets | form = 'targets': must be one of 'strokes', 'choices'
dataset --strokes 0 | strokes = 0: must be an integer
dataset --player nobody | player = 'nobody': must be the name of a player
dataset --task SnookerFrame-v0 --form choices | form = 'choices': must be "strokes" in frames
learn_worth --rounds 0 | rounds = 0
learn_worth --frames 20 | frames = 20
learn_worth --budget 5 | budget = 5
"""


@pytest.mark.parametrize("line", WRONG.strip().splitlines())
def test_a_wrong_command_is_refused_with_one_line_and_nothing_is_written(
    line, tmp_path, refused, monkeypatch
):
    monkeypatch.chdir(ROOT)
    command, _, said = line.partition(" | ")
    name, *words = shlex.split(command)
    if name == "train":
        monkeypatch.setattr(sn, "warmup", None)  # nothing is compiled before
    if name == "dataset":
        pytest.importorskip("minari")
    if name not in ("evaluate", "tournament"):
        words += ["--out", str(tmp_path / "run")]
    assert said and said in refused(COMMANDS[name].main, *words)
    assert not list(tmp_path.iterdir())
