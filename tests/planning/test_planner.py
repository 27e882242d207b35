"""Is a planned stroke the environment's, bit for bit, and is what makes no sense refused by name?"""

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import count_shots
from snooker_env.geometry import POCKET_PLACES
from snooker_env.planning import Planner, Position, Positions


def actions(n, k, seed=0):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (n, k)).astype(np.float32)


def parts(made):
    left = made.afterstates
    return left.positions, left.on_table, left.game, *(part for part in made if part is not left)


def same(one, other):
    return all(map(np.array_equal, parts(one), parts(other)))


@pytest.mark.parametrize(
    "options",
    [
        {"noise": "professional", "cue": "real"},
        {"action": "discrete", "noise": "club", "layout": "random:6"},
        {"aim": "target", "elevation": True, "placement": True, "layout": "break_off", "noise": "club"},
        {"aim": "target", "physics": "match", "table": "tight", "fidelity": "fast", "layout": "line_up"},
        {"aim": "target", "cue": "real", "noise": {"aim_deg": 0.3, "kick": 0.5}, "layout": "random:3"},
        {"action": "discrete", "cue": "real", "noise": "club", "layout": "random:6"},
    ],
)
def test_a_planned_stroke_is_the_stroke_of_the_environment(options):
    """From the same state, with the same stream: points, end, table, game and observation, bit for bit."""
    env = sn.SnookerEnv(observation="flat", **options)
    planner, scored = Planner(env, threads=1), 0
    for k in range(20):
        env.reset(seed=k)
        state = env.get_state()
        shape = env.action_space.shape
        chosen = actions(1, *shape, seed=k) if shape else np.flatnonzero(env.action_masks())[[17]]
        made = planner.play(state, [0], chosen, [state["stream"]])
        left = made.afterstates
        observation, reward, ended, _, info = env.step(chosen[0])
        assert made.points[0] == reward and made.goes_on[0] == (not ended)
        assert np.array_equal(made.observations[0], observation)
        assert np.array_equal(left.positions[0], env.positions)
        assert np.array_equal(left.on_table[0], env.on_table)
        after = left.ball_on[0], left.in_hand[0], left.points[0], left.over[0]
        assert after == (env.ball_on, env.in_hand, info["break"], env.over)
        assert np.array_equal(left.observations()[0], observation)
        scored += reward > 0
    assert scored or "cue" in options or options.get("layout") == "break_off"


def test_any_number_of_threads_and_any_order_of_strokes_give_the_same():
    env = sn.SnookerVectorEnv(7, aim="target", noise="club")
    env.reset(seed=1)
    rng = np.random.default_rng(2)
    rows, strokes = rng.integers(0, 7, 333), actions(333, 4)
    keys = rng.integers(0, 2**64 - 1, 333, dtype=np.uint64)
    one, before = Planner(env, threads=1), count_shots()
    first = one.play(env, rows, strokes, keys)
    assert count_shots() - before == 333 and one.threads == 1
    for threads in (2, 5):
        assert same(first, Planner(env, threads=threads).play(env, rows, strokes, keys))
    order = rng.permutation(333)
    turned = Planner(env).play(env, rows[order], strokes[order], keys[order])
    assert np.array_equal(turned.observations, first.observations[order])
    shared, before = Planner(env, threads=2), count_shots()
    with ThreadPoolExecutor(4) as pool:
        many = list(pool.map(lambda _: shared.play(env, rows, strokes, keys), range(4)))
    assert all(same(first, other) for other in many) and count_shots() - before == 4 * 333
    assert same(first, pickle.loads(pickle.dumps(shared)).play(env, rows, strokes, keys))


def test_the_key_alone_decides_the_errors():
    position = Position(cue=(0.0, -0.5), reds=[(0.3, 0.3)])
    planner, action = Planner({"noise": "club"}), np.tile(np.float32([[0.0, 0.0, 0.0, 0.3]]), (6, 1))
    first = planner.play(position, np.zeros(6, int), action, [5, 5, 6, 7, 7, 2**64 - 1])
    cue = first.afterstates.positions[:, 0]
    assert np.array_equal(cue[0], cue[1]) and np.array_equal(cue[3], cue[4])
    assert len(np.unique(cue, axis=0)) == 4
    again = planner.play(position, [0], action[:1], np.array([[5, 0]], np.uint64)).afterstates.positions[0, 0]
    assert np.array_equal(again, cue[0])  # a key is a stream at its beginning
    later = planner.play(position, [0], action[:1], [[5, 3]]).afterstates.positions[0, 0]
    assert not np.array_equal(later, cue[0])


def test_noise_given_takes_the_place_of_the_environments_own():
    env = sn.SnookerEnv(noise="club", aim="target")
    env.reset(seed=0)
    exact, strokes = Planner(env, noise="none"), actions(4, 4)
    assert exact.rules.noise.silent and not Planner(env).rules.noise.silent
    silent, rows, keys = Planner(sn.SnookerEnv(aim="target")), [0] * 4, [1, 2, 3, 4]
    assert same(exact.play(env, rows, strokes), silent.play(env, rows, strokes, keys))
    loud = Planner(env, noise={"aim_deg": 3.0})
    assert not same(loud.play(env, rows, strokes, keys), exact.play(env, rows, strokes))


def test_afterstates_are_positions_to_play_on():
    planner = Planner({"action": "discrete"})
    position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.8)], black=(0.0, 1.4605), pink=(0.2, -0.3))
    choices = np.flatnonzero(sn.planning.action_masks(position)[0])
    first = planner.play(position, np.zeros(len(choices), int), choices)
    made = np.flatnonzero(first.goes_on)
    assert len(made) > 5 and (first.points[made] == 1).all() and (first.afterstates.ball_on[made] == 0).all()
    second = planner.play(first.afterstates, made, np.zeros(len(made), int))
    assert len(second.points) == len(made) and not (first.afterstates.over[made]).any()


def test_strokes_in_succession_are_those_played_alone():
    """An aim is solved once for successive equal tables, and anew where choice, ball on or a ball differs."""
    planner = Planner({"action": "discrete", "noise": "club"}, threads=1)
    spread = {"cue": (0.1, 0.4), "reds": [(0.5, 1.0), (-0.3, 1.1)], "blue": (0.0, 0.0), "black": (-0.5, 0.9)}
    later = spread, spread | {"black": (-0.5, 0.90001)}, spread | {"blue": None}  # one moved, one gone
    at = Positions.of([Position(**spread, on="red"), *(Position(**at, on="any_colour") for at in later)])
    rows = np.array([0, 0, 0, 1, 1, 2, 3, 3, 0, 1, 0, 0])
    choices = np.array([67, 67, 67, 67, 67, 67, 67, 40, 40, 40, 203, 67])
    keys = np.arange(len(rows), dtype=np.uint64)
    together = planner.play(at, rows, choices, keys)
    for k in range(len(rows)):
        alone = planner.play(at, rows[k : k + 1], choices[k : k + 1], keys[k : k + 1])
        assert same(alone, type(together)(*(part[k : k + 1] for part in together))), k
    cues = together.afterstates.positions[:, 0]
    assert len(np.unique(cues, axis=0)) == len(rows)  # no two strokes are alike


OPEN = Position(
    cue=(0.25, -0.4), reds=[(0.3, 0.5), (-0.3, 0.7), (0.1, 1.0)], blue=(0.0, 0.0), black=(0.0, 1.4605)
)
SWEEP = np.zeros((60, 5))
SWEEP[:, 0], SWEEP[:, 3] = np.linspace(1.0, 6.0, 60), np.linspace(-3.0, 3.0, 60)
"""Strokes in all directions."""


def test_where_balls_stop_agrees_with_what_is_left():
    planner = Planner({"noise": "club"})
    made = planner.play_strokes(OPEN, np.zeros(60, int), SWEEP, np.arange(60))
    assert ((made.penalty > 0) & (made.points == 0)).any() and (made.penalty == 0).any()
    assert not made.points[made.penalty > 0].any()
    stays = OPEN.arrays()[1][None] & (made.potted < 0)
    reds = stays[:, 1:16]
    # colours may be respotted, reds not
    assert np.array_equal(made.places[:, 1:16][reds], made.afterstates.positions[:, 1:16][reds])
    assert np.array_equal(stays[:, 0], made.afterstates.on_table[:, 0]) and (~stays[:, 0]).any()


def test_a_colour_that_was_potted_lies_in_its_pocket_and_not_on_its_spot():
    position = Position(cue=(0.3, 1.1), reds=[(-0.5, 0.0)], black=(0.0, 1.4605), on="any_colour")
    made = Planner({"action": "discrete"}).play(position, [0], [67])
    pocket = int(made.potted[0, 21])
    assert made.points[0] == 7 and made.first[0] == 21 and made.goes_on[0]
    assert np.hypot(*(made.places[0, 21] - POCKET_PLACES[pocket])) < 0.1
    assert made.afterstates.positions[0, 21].tolist() == [0.0, 1.4605]
