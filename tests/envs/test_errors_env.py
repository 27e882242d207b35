"""Are wrong arguments, actions, states and options refused, and does that change nothing?"""

import json
from functools import partial
from typing import ClassVar

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env import Options, SnookerEnv, SnookerVectorEnv
from snooker_env.players import SeenPlayer
from snooker_env.tasks.options import NAMES
from tests.refusals import FIDELITY, INF, NAN, WRONG_FIDELITIES, refuse_each, refused
from tests.tables import begun

ARGUMENTS = """
env(task=?) | task | ? | must be one of 'visit', 'frame' | ''; None; b'x'; 'frames'; 'Visit'; ['visit']; {}
env(aim=?) | aim | ? | must be one of 'pot', 'absolute', 'target' | ''; 3; True; 'relative'; 'Target'; ['target']; {}
env(action=?) | action | ? | must be one of 'box', 'discrete' | ''; None; b'x'; 'plain'; 'Box'; ['box']; {}
env(observation=?) | observation | ? | must be one of 'default', 'pots', 'flat', 'balls' | ''; 3; True; 'pixels'; 'Flat'; ['flat']; {}
env(speeds=?) | speeds | ? | must be an integer in [2, 20] | 1; 21; 9.5; None; '9'; True
env(observation=?) | observation | ? | must be "pots", "flat" or "balls" with action="box": a Box has no masks | 'masked'
env(task="frame", observation=?) | observation | ? | must be "pots", "flat" or "balls" with action="box" | 'masked'
env(task="frame", observation=?) | observation | ? | must be one of 'default', 'flat', 'balls', 'masked' | 'pots'
env(reward=?) | reward | ? | must be one of 'points', 'points_and_fouls', 'pots', 'legal' | ''; 3; None; 'score'; ['points']; 'win'
frame(reward=?) | reward | ? | must be one of 'points', 'win' | 'pots'; 'wins'; 'frames'
env(layout=?) | layout | ? | or "break_off:N" with N from 0 to 15 | ''; 3; 'Opened'; 'pots:'; 'pots:Easy'
env(layout=?) | layout | ? | must be one of 'opened', | 'random:'; 'random:3.0'; 'random: 3'; 'random:16'; 'random:\u0663'; []; {}
env(noise=?) | noise | ? | must be one of 'none', 'professional', 'amateur', 'club', 'beginner', 'robot', 'olympiad' or a | ''; 3; 'pro'
env(noise=?) | noise | ? | must be one of | []; ['none']
env(noise={"aim_deg": ?}) | noise.aim_deg | ? | must be a finite number in [0, inf) | -0.1; NAN; INF; '0.1'; None; True
env(noise={"speed_rel": ?}) | noise.speed_rel | ? | must be a finite number in [0, inf) | -0.1; NAN; INF
env(noise={"speed_abs": ?}) | noise.speed_abs | ? | must be a finite number in [0, inf) | -0.1; NAN
env(noise={"offset_mm": ?}) | noise.offset_mm | ? | must be a finite number in [0, inf) | -0.1; NAN
env(noise={"elevation_deg": ?}) | noise.elevation_deg | ? | must be a finite number in [0, inf) | -0.1; NAN
env(noise={"kick": ?}) | noise.kick | ? | must be | -0.1; 1.1; 'often'; NAN
env(noise={?: 0.1}) | noise field | ? | must be one of 'aim_deg', 'speed_rel' | 'aim'; 3
env(conditions=?) | conditions | ? | must be one of 'fixed', 'drawn' | 'random'; True; 1; None
env(conditions="drawn", physics={"nap": 0.11}) | conditions | 'drawn' | physics.nap = 0.11
env(conditions="drawn", physics={"mu_bb": 0.9}) | conditions | 'drawn' | physics.mu_bb
env(observe_conditions=?) | observe_conditions | ? | must be False with conditions="fixed": there is nothing to observe | True
env(conditions="drawn", observe_conditions=?) | observe_conditions | ? | must be True or False | 0; 1; None; 'yes'; 0.5; [True]
env(cue=?) | cue | ? | must be one of 'free', 'real' | ''; None; b'x'; 'Real'; ['real']; {}
env(table=?) | table | ? | must be one of 'match', 'tight' | 'loose'
env(table=?) | table | ? | "match", "tight" | 3; None
env(physics={"R": 0.03}) | physics.R | 0.03 | must be 0.02625 in Snooker-v0
env(physics={"mu_s": 0.0}) | physics.mu_s | 0.0 | must be > 0
env(placement=?) | placement | ? | must be True or False | 0; 1; None; 'yes'; 0.5; [True]
env(elevation=?) | elevation | ? | must be True or False, or degrees in [5, 70] | 1; None; 'yes'; -0.5; 70.1; NAN; INF
discrete(elevation=?) | elevation | ? | must be False | True
discrete(placement=?) | placement | ? | must be False | True
env(trust=?) | trust | ? | must be True or False | 0; None; 'yes'
env(trust=?) | trust | ? | must be False with task="visit" | True
frame(one_stroke=?) | one_stroke | ? | must be True or False | 1; None
env(task="match", one_stroke=?) | one_stroke | ? | must be False with task="match" | True
frame(says=?) | says | ? | must be a sequence of some of | 'lot'; 3; None
frame(says=[?]) | says | ? | must be one of 'nominate', 'decision' | 'shout'
env(says=["lot"]) | says | ('lot',) | must be () with task="visit"
frame(action="discrete", says=("decision",)) | says | ('decision',) | must not hold "decision"
frame(opponent=?) | opponent | ? | 'none', 'random', 'ghost_ball',  | ''; 'Random'; 'model'; 3; None; True; ['x']
frame(opponent=?) | opponent | ? | must be a model saved by Stable-Baselines3 | 'missing.zip'
env(opponent=?) | opponent | ? | must be 'none' with task="visit" | 'random'
frame(miss=?) | miss | ? | must be one of 'off', 'clear_path' | 'on'; None; True
frame(game="shoot_out", miss=?) | miss | ? | must be | 'clear_path'
env(miss=?) | miss | ? | must be 'off' with task="visit" | 'clear_path'
frame(max_strokes=?) | max_strokes | ? | must be an integer in [1, 1000000000] | 0; -1; 1.5; '9'; True; 10**9 + 1; NAN
env(max_strokes=?) | max_strokes | ? | must be 1000 with task="visit" | None; 50
frame(frames=?) | frames | ? | must be 7 with task="frame" | 5
env(frames=?) | frames | ? | must be 7 with task="visit" | 5
env(task="match", frames=?) | frames | ? | must be odd | 2
env(task="match", frames=?) | frames | ? | must be | 0; True; '7'
frame(game=?) | game | ? | must be one of | 'pool'
env(game=?) | game | ? | must be 'snooker' with task="visit" | 'six_red'
frame(game="six_red", time_to_play=?) | time_to_play | ? | must be | 5.0
frame(game="shoot_out", time_to_play=?) | time_to_play | ? | must be | 0.0; 15.001
env(time_to_play=?) | time_to_play | ? | must be 9.0 with task="visit" | 5.0
env(render_mode=?) | render_mode | ? | must be one of 'human', 'rgb_array', 'ansi' | ''; 'Human'; 'depth_array'; 3; True; ['ansi']
env(?) | options | ? | must be an Options or None | 'visit'
many(options=?) | options | ? | must be an Options or None | 'frame'
many(threads=?) | threads | ? | must be | 0
many(num_envs=?) | num_envs | ? | must be | 0
many(max_episode_steps=?) | max_episode_steps | ? | must be | 0
many(render_mode=?) | render_mode | ? | must be | 'human'
"""
OF_TWO = """
match(seats=({},)) | seats | {} | must be None, or two dicts
matches(seats=({},)) | seats | {} | must be None, or two dicts
matches(seats=({}, {"layout": "line_up"})) | key of seats[1] | 'layout' | must be one of 'action'
matches(seats=({"noise": "club"}, {"noise": "xx"})) | seats[1].noise | 'xx' | must be
matches(seats=({"cue": "real"}, {})) | key of seats[0] | 'cue' | must be one of 'action'
matches(seats=({}, CONCEDES), action="discrete", observation="masked") | seats | concede | must give both players
matches(seats=({}, {"action": "discrete"})) | seats | discrete | must give both players the same actions
matches(opponent="random") | options | opponent='random' | a match has two players
matches(autoreset_mode=?) | autoreset_mode | ? | must be | 'SameStep'
matches(one_stroke=?) | options | one_stroke=? | a match has two players | True
match(one_stroke=?) | options | one_stroke=? | a match has two players | True
match(reward=?) | reward | ? | must be | 'pots'
match(render_mode=?) | render_mode | ? | must be | 'x'
match(Options()) | options | task='visit' | a match has two players
match(Options(task="frame", opponent="random")) | options | opponent='random' | a match has two players
match(task="frame", frames=?) | frames | ? | must be 7 with task="frame" | 3
"""
MAKES = {"NAN": NAN, "INF": INF, "Options": Options, "env": SnookerEnv, "many": SnookerVectorEnv}
MAKES |= {"frame": partial(SnookerEnv, task="frame"), "discrete": partial(SnookerEnv, action="discrete")}
MAKES |= {"CONCEDES": {"says": ["concede"]}, "match": sn.match_env, "matches": partial(sn.MatchVectorEnv, 2)}


def test_wrong_arguments_of_the_environment():
    refuse_each(ARGUMENTS, MAKES)
    for wrong in WRONG_FIDELITIES:
        refused(lambda wrong=wrong: SnookerEnv(fidelity=wrong), "fidelity", repr(wrong), FIDELITY)
    named = {line.split(" | ")[1].split(".")[0].split()[0] for line in ARGUMENTS.split("\n") if line}
    assert {*NAMES, "render_mode"} <= named | {"fidelity"}
    with pytest.raises(TypeError, match="foul_play"):
        SnookerEnv(foul_play=True)
    with pytest.raises(ValueError, match="never"):
        SnookerVectorEnv(autoreset_mode="never")


def test_wrong_arguments_of_matches():
    pytest.importorskip("pettingzoo")
    refuse_each(OF_TWO, MAKES)


ACTIONS = """
plain([0.0] * ?) | action | shape (?,) | must have shape (4,) | 3; 8
long([0.0] * ?) | action | shape (?,) | must have shape (7,) | 3; 8
plain(?) | action | ? | must have shape (4,) | None
plain(0.0) | action | shape () | must have shape (4,)
plain([[0.0] * 4]) | action | shape (1, 4) | must have shape (4,)
plain([0.0, 0.0, 0.0, ?]) | action | ? | BOUNDS | 1.00000101; INF
plain([?, 0.0, 0.0, 0.0]) | action | ? | BOUNDS | -1.5; NAN
long([0.0] * 6 + [?]) | action | ? | BOUNDS | 1.00000101; NAN
plain(np.array([-128, 0, 0, 0], np.int8)) | action | -128 | BOUNDS
plain(["a"] * 4) | action | 'a' | must have shape
plain(np.zeros(4, complex)) | action | 0 | must have shape
choices(?) | action | ? | an integer in [0, 540) | -1; 540; 0.5; None; '3'; [1, 2]
match(np.zeros(4)) | action | shape (4,) | must
match(np.full(7, ?)) | action | ? | must | 1.1; NAN
matches([[0.0] * 7, [?] * 7]) | actions[1] | ? | must be finite | 2.0
matches(np.zeros((3, 7))) | actions | shape (3, 7) | must
many([[0.0] * 4, [0.0] * 4, [0.0, ?, 0.0, 0.0]]) | actions[2] | ? | BOUNDS | NAN
many([[0.0] * 4, [0.0, 0.0, 0.0, ?], [2.0] * 4]) | actions[1] | ? | BOUNDS | 1.0001; -INF
many(np.zeros((2, 4))) | actions | shape (2, 4) | must have shape (3, 4)
many(np.zeros((3, 5))) | actions | shape (3, 5) | must have shape (3, 4)
many(np.zeros(4)) | actions | shape (4,) | must have shape
many(?) | actions | ? | must have shape | None
many([[0.0] * 4, [0.0]]) | actions | [0.0] | must have shape
many([["a"] * 4] * 3) | actions | a | real numbers
many(np.zeros((3, 4), bool)) | actions | False | real numbers
many_choices(np.array([0, ?, 1])) | actions[1] | ? | must be in [0, 540) | 540
many_choices(np.zeros((3, 4))) | actions | (3, 4) | must be 3 integers
""".replace("BOUNDS", "must be finite and within [-1, 1]; gymnasium.wrappers.ClipAction clips")


def test_wrong_actions_change_nothing():
    envs = {
        "plain": SnookerEnv(noise="club", layout="random:3"),
        "long": SnookerEnv(noise="club", layout="break_off", elevation=True, placement=True),
        "choices": SnookerEnv(action="discrete"),
        "many": SnookerVectorEnv(3, noise="club"),
        "many_choices": SnookerVectorEnv(3, action="discrete"),
        "match": sn.match_env(),
        "matches": sn.MatchVectorEnv(2, threads=1),
    }
    before = {name: json.dumps(begun(env).get_state()) for name, env in envs.items()}
    refuse_each(ACTIONS, {"np": np, "NAN": NAN, "INF": INF} | {name: env.step for name, env in envs.items()})
    assert before == {name: json.dumps(env.get_state()) for name, env in envs.items()}


def _played(make, shaped=lambda action: action):
    """One step of a new environment, and the state after it."""

    def way(action):
        env = begun(make())
        env.step(shaped(action))
        return env.get_state()

    return way


def _sb3(action):
    envs = pytest.importorskip("snooker_env.sb3").SnookerVecEnv(2, seed=1, threads=1)
    envs.reset()
    envs.step(np.array([[0.0] * 4, action]))
    return envs.tables.get_state()


def _opponent(action):
    env = SnookerEnv(task="frame", opponent=SeenPlayer(_Same(action), {"task": "frame"}))
    env.reset(seed=1, options={"breaker": 0})
    env.step([0.0] * 4)
    return env.get_state()


class _Same:
    """A player of observations that always answers the same."""

    options: ClassVar = {"aim": "absolute"}

    def __init__(self, action):
        self.action = action

    def act(self, observations, masks, seeds):
        return [self.action] * len(seeds)


AT = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
WAYS = {
    "one table": _played(SnookerEnv),
    "target": _played(partial(SnookerEnv, aim="target")),
    "long": _played(partial(SnookerEnv, layout="break_off", placement=True), lambda a: [*a, 0.0, 0.0]),
    "many": _played(partial(SnookerVectorEnv, 2, threads=1), lambda a: [[0.0] * 4, a]),
    "match": _played(sn.match_env, lambda a: [*a, 0.0, 0.0, 0.0]),
    "matches": _played(partial(sn.MatchVectorEnv, 2, threads=1), lambda a: [[*a, 0.0, 0.0, 0.0]] * 2),
    "SB3": _sb3,
    "opponent": _opponent,
    "player": lambda a: sn.player(_Same(a)).at({}).play(AT, [7]).values.tolist(),
    "planner": lambda a: sn.Planner({}).play(AT, [0], [a]).places.tolist(),
}
"""Every way by which an action in [-1, 1] comes in, and what it leaves."""


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("component", range(4))
def test_rounding_outside_the_bounds_is_clipped_and_more_is_refused(way, component):
    def action(x):
        a = [0.5, 0.0, 0.0, 0.25]
        a[component] = x
        return a

    for end in (-1.0, 1.0):
        at_the_end = WAYS[way](action(end))
        assert WAYS[way](action(end * (1.0 + 1e-6))) == at_the_end
        assert WAYS[way](np.array(action(end * 1.0000005), np.float32)) == at_the_end  # as of a network
        if component < 3 and way != "SB3":  # nor is it deaf; SB3 deals a new table after a miss
            assert WAYS[way](action(end * 0.99)) != at_the_end
    says = r"must be finite and within \[-1, 1\]; gymnasium\.wrappers\.ClipAction"
    for wrong in (1.0000011, -1.0000011, NAN):
        with pytest.raises(ValueError, match=says):
            WAYS[way](action(wrong))


STATES = """
at(positions=was["positions"][:21]) | state.positions | shape (21, 2) | (22, 2)
ball(3, (NAN, 0.0)) | state.positions[3, 0] | nan | must be finite
at(on_table=[1] * 22) | state.on_table | int64 | must be bool of shape (22,)
ball(3, (1.5, 0.0)) | state.positions[3] | (1.5, 0.0) | must be on the table
ball(3, (0.889, 0.0)) | state.positions[3] | (0.889, 0.0) | is over a pocket
ball(3, (0.88, 0.6)) | state.positions[3] | (0.88, 0.6) | overlaps the cushion
ball(3, was["positions"][2]) | state.positions | balls 2 and 3 | overlap
ball(9, (0.0, 1e300)) | state.positions[9] | 1e+300 | must be within 1000 m
at(ball_on=8) | state.ball_on | 8 | must be
at(ball_on=7) | state.ball_on | black | while reds are on the table
at(ball_on=-1) | state.ball_on | nothing | must
at(points=2.7) | state.points | 2.7 | must be an integer
at(in_hand="no") | state.in_hand | 'no' | must be True or False
at(over=2) | state.over | 2 | must be True or False
at(stream=[1, 2, 3]) | state.stream | [1, 2, 3] | must be two integers
at(stream=[1, -2]) | state.stream[1] | -2 | must be an integer in [0, 18446744073709551615]
at(stream=[2**64, 0]) | state.stream[0] | 18446744073709551616 | must be an integer
at(rng={}) | state.rng | {} | must be
at(on_table=[False, *was["on_table"][1:]]) | state.on_table | False | cue ball
at(spin=1) | state | 'spin' | must be
"""
RESETS = """
reset(?) | options | 'sate' | must be one of 'state' | {"sate": 1}
reset({3: 1}) | options | 3 | must be one of 'state'
reset({"state": {}}) | state | a dict without ['ball_on', 'in_hand', 'on_table' | must be a state of get_state() here
reset({"state": ?}) | state | ? | must be a state of get_state() | None; 3
reset(["state"]) | options | ['state'] | must be
reset({"breaker": 0}) | options["breaker"] | 0 | no opponent
alone({"breaker": 0}) | options["breaker"] | 0 | no opponent
many({"reset_mask": ?}) | options["reset_mask"] | ? | must be a bool array | [True, False]; np.array([1, 0]); np.zeros(2, bool)
frame({"breaker": ?}) | options["breaker"] | ? | must be an integer | 2
frame({"breaker": ?}) | options["breaker"] | ? | must be | '0'
frame({"breaker": [0, 1]}) | options["breaker"] | 2 numbers | 1 of them
"""


def test_wrong_states_and_options_of_reset():
    env = begun(SnookerEnv(layout="random:5"), 5)
    was = env.get_state()

    def spoilt(how):
        def ball(k, place):
            how(was | {"positions": [*was["positions"][:k], list(place), *was["positions"][k + 1 :]]})

        return {"at": lambda **fields: how(was | fields), "ball": ball, "was": was, "NAN": NAN}

    refuse_each(STATES, spoilt(env.set_state))
    refuse_each(STATES, spoilt(lambda state: env.reset(options={"state": state})))
    envs = {
        "reset": env,
        "alone": SnookerEnv(task="frame"),
        "frame": SnookerEnv(task="frame", opponent="random"),
        "many": begun(SnookerVectorEnv(2)),
    }
    ways = {name: (lambda o, one=one: one.reset(options=o)) for name, one in envs.items()}
    refuse_each(RESETS, {"np": np} | ways)
    assert env.get_state() == was
    for seed in (-1, "x", 1.5):
        with pytest.raises((gymnasium.error.Error, ValueError, TypeError)):
            env.reset(seed=seed)
    match = begun(sn.match_env(task="match", frames=5))
    was = match.get_state()
    table = """
at(frames=[3, 0]) | state.frames[0] | 3 | must
at(first_break=2) | state.first_break | 2 | must
at(frames=1) | state.frames | 1 | must
at(best_of=3) | state.best_of | 3 | must
"""
    refuse_each(table, {"at": lambda **fields: match.reset(options={"state": was | fields})})
    assert match.get_state() == was
