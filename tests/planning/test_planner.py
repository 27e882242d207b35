"""Is a planned stroke the environment's, bit for bit, and is what makes no sense refused by name?"""

import pickle
from concurrent.futures import ThreadPoolExecutor

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import POCKET_PLACES
from snooker_env.planning import Planner, Position, Positions
from snooker_env.tasks import stroke
from snooker_env.tasks.noise import errors_of

SILENT = Planner({})
"""Box actions without noise."""


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
        {"aim": "target", "noise": "professional"},
        {"action": "discrete", "noise": "club", "layout": "random:6"},
        {"aim": "target", "elevation": True, "placement": True, "layout": "break_off", "noise": "club"},
        {"aim": "target", "physics": "match", "table": "tight", "fidelity": "fast", "layout": "line_up"},
    ],
)
def test_a_planned_stroke_is_the_stroke_of_the_environment(options):
    """From the same state, with the same stream: points, end, table, game and observation, bit for bit."""
    env = sn.SnookerEnv(**options)
    planner, scored = Planner(env, threads=1), 0
    for k in range(30):
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
    assert scored or options.get("layout") == "break_off"


def test_whole_tables_are_read_from_a_vector_environment_and_left_as_they_are():
    mode = {"vectorization_mode": "vector_entry_point"}
    env = gymnasium.make_vec("Snooker-v0", 9, **mode, aim="target", noise="club")
    env.reset(seed=3)
    before, streams = env.unwrapped.get_state(), [state["stream"] for state in env.unwrapped.get_state()]
    at, strokes = Positions.of(env), actions(9, 4)
    kept = at.copy()
    played = Planner(env).play(at, np.arange(9), strokes, np.array(streams, np.uint64))
    assert env.unwrapped.get_state() == before and np.array_equal(at.positions, kept.positions)
    assert np.array_equal(at.on_table, kept.on_table) and np.array_equal(at.game, kept.game)
    observations, rewards, ended, _, _ = env.step(strokes)
    assert np.array_equal(played.points, rewards) and np.array_equal(~played.goes_on, ended)
    assert np.array_equal(played.observations, observations)
    assert not np.array_equal(played.afterstates.positions, at.positions)


def test_any_number_of_threads_and_any_order_of_strokes_give_the_same():
    env = sn.SnookerVectorEnv(7, aim="target", noise="club")
    env.reset(seed=1)
    rng = np.random.default_rng(2)
    rows, strokes = rng.integers(0, 7, 333), actions(333, 4)
    keys = rng.integers(0, 2**64 - 1, 333, dtype=np.uint64)
    one = Planner(env, threads=1)
    first = one.play(env, rows, strokes, keys)
    assert one.shots == 333 and one.threads == 1
    for threads in (2, 5):
        assert same(first, Planner(env, threads=threads).play(env, rows, strokes, keys))
    order = rng.permutation(333)
    turned = Planner(env).play(env, rows[order], strokes[order], keys[order])
    assert np.array_equal(turned.observations, first.observations[order])
    shared = Planner(env, threads=2)
    with ThreadPoolExecutor(4) as pool:
        many = list(pool.map(lambda _: shared.play(env, rows, strokes, keys), range(4)))
    assert all(same(first, other) for other in many) and shared.shots == 4 * 333
    assert same(first, pickle.loads(pickle.dumps(shared)).play(env, rows, strokes, keys))


@pytest.mark.parametrize(
    "options",
    [
        {"aim": "target", "noise": "club", "elevation": True},
        {"noise": "olympiad", "placement": True, "layout": "break_off", "physics": {"max_offset": 0.3}},
        {"action": "discrete", "noise": "professional", "layout": "random:6"},
    ],
)
def test_a_stroke_decoded_is_played_as_its_action(options):
    """By keys, by the errors that the keys draw, as a stroke or as an action: equal but for rounding."""
    env = sn.SnookerVectorEnv(5, threads=1, **options)
    env.reset(seed=4)
    planner, rows, keys = Planner(env, threads=1), np.arange(60) % 5, np.arange(100, 160)
    shape = env.single_action_space.shape
    chosen = actions(60, *shape, seed=1) if shape else np.arange(60) * 9
    strokes, at = planner.strokes_of(env, rows, chosen)
    assert strokes.shape == (60, 5) and len(at) == 60
    whole = planner.play(env, rows, chosen, keys)
    errors = errors_of(np.stack([keys, 0 * keys], 1).astype(np.uint64))
    for other in (
        planner.play_strokes(at, np.arange(60), strokes, keys),
        planner.play_strokes(at, np.arange(60), strokes, errors=errors),
    ):
        apart = np.abs(other.afterstates.positions - whole.afterstates.positions).max(axis=(1, 2))
        assert apart.max() < 1e-3 and np.median(apart) < 1e-9 and np.array_equal(other.points, whole.points)
    exact = planner.play_strokes(at, np.arange(60), strokes, errors=np.zeros((60, 5))).afterstates.positions
    assert (np.abs(exact - whole.afterstates.positions).max(axis=(1, 2)) > 1e-3).mean() > 0.5


SOFT = [2.0, 0.0, 0.0, 0.3, 0.0]


@pytest.mark.parametrize(
    ("passed", "complaint"),
    [
        ({"strokes": [SOFT]}, "keys = None: must be given with execution noise"),
        ({"strokes": [SOFT], "keys": [1], "errors": [[0] * 5]}, "keys, errors = both"),
        ({"strokes": [SOFT], "errors": [[0] * 4]}, "errors = array of shape"),
        ({"strokes": [SOFT], "errors": [[np.nan] * 5]}, r"errors\[0, 0\] = nan"),
        ({"strokes": [SOFT[:4]], "keys": [1]}, r"strokes = float64 array of shape \(1, 4\): must be real"),
        ({"strokes": [[9.0, *SOFT[1:]]], "keys": [1]}, r"strokes\[0\], speed = 9.0: must be a finite number"),
        ({"strokes": [[2.0, 0.0, np.nan, 0.0, 0.0]], "keys": [1]}, r"strokes\[0\], top = nan"),
        ({"strokes": [[2.0, 0.6, 0.0, 0.0, 0.0]], "keys": [1]}, r"strokes\[0\], side = 0.6"),
        ({"strokes": [[2.0, 0.0, 0.0, np.inf, 0.0]], "keys": [1]}, r"strokes\[0\], aim = inf"),
        ({"strokes": [[2.0, 0.0, 0.0, 0.0, -0.1]], "keys": [1]}, r"strokes\[0\], elevation = -0.1"),
    ],
)
def test_strokes_and_errors_that_make_no_sense_are_refused(passed, complaint):
    planner = Planner({"noise": "club"}, threads=1)
    with pytest.raises(ValueError, match=f"^{complaint}"):
        planner.play_strokes(Position(cue=(0.0, -0.5), reds=[(0.3, 0.3)]), [0], **passed)
    assert planner.shots == 0


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
    assert exact.noise.silent and not Planner(env).noise.silent
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
    lost = int(np.flatnonzero(~first.goes_on)[0])
    with pytest.raises(ValueError, match=rf"positions\[{lost}\].over = True: must be False: the visit has"):
        planner.play(first.afterstates, [made[0], lost], [0, 0])


def test_a_frame_and_a_match_are_planned_as_a_visit():
    pytest.importorskip("pettingzoo")
    frame = gymnasium.make("Snooker-v0", task="frame", aim="target", placement=True, says=["decision"])
    frame.reset(seed=0)
    match = sn.match_env(aim="target")
    match.reset(seed=0)
    for env in (frame, match):
        at, planner = Positions.of(env), Planner(env)
        assert len(at) == 1 and at.in_hand[0] and at.ball_on[0] == 1
        assert planner.rules.actions.space.shape == (7,)
        action = np.float32([[0.6, 0.0, 0.0, 0.1, 0.5, 0.5, 0.0]])
        made = planner.play(at, [0], action)
        env.step(action[0])
        after = env.unwrapped.get_state()
        assert made.observations.shape == (1, 121)
        assert np.array_equal(made.afterstates.positions[0], after["positions"])


def test_what_may_be_planned_for():
    made = gymnasium.make("Snooker-v0", aim="target", max_episode_steps=3)
    for source in (sn.SnookerEnv(aim="target"), {"aim": "target"}, made):
        assert Planner(source).rules.actions.space.shape == (4,)
    assert Planner({"physics": "match", "table": "tight"}).table.name == "tight"
    for wrong in (gymnasium.make("CartPole-v1"), None, 3, "Snooker-v0"):
        with pytest.raises(ValueError, match=r"env_or_options = a .*must be an environment of snooker_env"):
            Planner(wrong)
    with pytest.raises(ValueError, match="aim = 'north'"):
        Planner({"aim": "north"})
    with pytest.raises(ValueError, match="threads = 0"):
        Planner({}, threads=0)
    with pytest.raises(ValueError, match="noise = 'loud'"):
        Planner({}, noise="loud")


AT = Position(cue=(0.0, -0.5), reds=[(0.3, 0.3)])
STROKE = [[0.0, 0.0, 0.0, 0.2]]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((AT, [1], STROKE), r"rows\[0\] = 1: must be in \[0, 1\)"),
        ((AT, [-1], STROKE), r"rows\[0\] = -1"),
        ((AT, [0.0], STROKE), "rows = float64 array"),
        ((AT, [[0]], STROKE), r"rows = int64 array of shape \(1, 1\)"),
        ((AT, [0, 0], STROKE), r"actions = array of shape \(1, 4\)"),
        ((AT, [0], [[0.0, 0.0, 0.0]]), r"actions = array of shape \(1, 3\)"),
        ((AT, [0], [[0.0, 0.0, 0.0, np.nan]]), r"actions\[0\] = .*must be finite"),
        ((AT, [0], [[0.0, 0.0, 0.0, 1.1]]), r"actions\[0\] ="),
        ((AT, [0], [["a", "b", "c", "d"]]), "actions = "),
        ((AT, [0], STROKE, [1, 2]), r"keys = array of shape \(2,\)"),
        ((AT, [0], STROKE, [-1]), "keys = array of object: must be 1 integers"),
        ((AT, [0], STROKE, [0.5]), "keys = array of object"),
        ((None, [0], STROKE), "positions = a NoneType"),
        (([], [0], STROKE), "positions = a list"),
        ((AT, [0], STROKE, np.array([-1])), "keys = negative numbers: must be 1"),
        (({"points": 1}, [0], STROKE), "state = a dict without"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        SILENT.play(*arguments)
    assert SILENT.play(AT, [0], STROKE).points.shape == (1,)
    none = SILENT.play(AT, [], np.zeros((0, 4)))  # no strokes are no error
    assert {len(part) for part in none} == {0} and none.observations.shape == (0, 121)


@pytest.mark.parametrize(
    ("choice", "complaint"),
    [([540], r"actions\[0\] = 540"), ([0.5], "actions = array of float64"), ([[0, 1]], "actions = ")],
)
def test_choices_are_integers_in_range(choice, complaint):
    with pytest.raises(ValueError, match=complaint):
        Planner({"action": "discrete"}).play(AT, [0], choice)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda at: at.positions[2, 1].__setitem__(0, np.nan), r"positions\[2\], ball 1 = .*must be finite"),
        (
            lambda at: np.copyto(at.positions[2, 1], at.positions[2, 0]),
            r"positions\[2\] = balls 0 and 1: over",
        ),
        (
            lambda at: at.positions[2, 1].__setitem__(0, 0.9),
            r"positions\[2\]\[1\] = \(0.9, 0.3\): overlaps the",
        ),
        (lambda at: at.on_table[2].__setitem__(0, False), r"positions\[2\].cue = None: must be on the table"),
        (lambda at: at.ball_on.__setitem__(2, 9), r"positions\[2\].ball_on = 9: must be in \[-1, 7\]"),
        (lambda at: at.ball_on.__setitem__(2, 7), r"positions\[2\].ball_on = 'black': must name balls"),
        (lambda at: at.ball_on.__setitem__(2, -1), r"positions\[2\].ball_on = 'nothing': must name balls"),
        (lambda at: at.points.__setitem__(2, 200), r"positions\[2\].points = 200"),
    ],
)
def test_an_unsound_position_is_refused_by_its_row_if_it_is_played(change, complaint):
    at = Positions.of([AT] * 4)
    change(at)
    assert len(SILENT.play(at, [0, 1, 3], STROKE * 3).points) == 3
    for rows in ([0, 2], [0, 1, 2, 3]):
        with pytest.raises(ValueError, match=complaint):
            SILENT.play(at, rows, STROKE * len(rows))


@pytest.mark.parametrize(
    "options", [{"noise": "club"}, {"noise": "club", "physics": "match", "fidelity": "fast"}]
)
def test_strokes_in_succession_are_those_played_alone(options):
    """An aim is solved once for successive equal tables, and anew where choice, ball on or a ball differs."""
    planner = Planner({"action": "discrete", **options}, threads=1)
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


def test_balls_stop_where_the_shot_simulated_by_itself_leaves_them():
    made = SILENT.play_strokes(OPEN, np.zeros(60, int), SWEEP)
    places, present, _ = OPEN.arrays()
    balls = np.flatnonzero(present)
    for k in range(0, 60, 7):
        v, w = sn.strike(SWEEP[k, 0], SWEEP[k, 3])
        velocities, spins = np.zeros((len(balls), 2)), np.zeros((len(balls), 3))
        velocities[0], spins[0] = v[:2], w
        shot = sn.simulate(places[balls], velocities, spins)
        assert np.array_equal(shot.potted, made.potted[k, balls])
        assert np.allclose(shot.positions, made.places[k, balls], atol=1e-9)
        hits = shot.events[(shot.events["kind"] == sn.EventKind.BALL_BALL) & (shot.events["i"] == 0)]
        assert made.first[k] == (balls[hits["j"][0]] if len(hits) else -1)


def test_a_log_that_is_too_short_is_enlarged(monkeypatch):
    """The same with room for three events at first as with room for 512."""
    original, runs = stroke.ShotBuffers.__init__, []
    for log in (512, 3):
        with monkeypatch.context() as patch:
            first = lambda self, m, n=log, **more: original(self, m, n, **more)  # noqa: E731
            patch.setattr(stroke.ShotBuffers, "__init__", first)
            runs.append(SILENT.play_strokes(OPEN, np.zeros(60, int), SWEEP))
    assert same(*runs)
