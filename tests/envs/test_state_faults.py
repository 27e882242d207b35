"""Is every fault of a saved state refused by its name, with nothing changed?"""

import copy
import re
from dataclasses import replace
from json import dumps
from math import inf, nan

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, PINK, SPOTS, BallOn
from snooker_env.game.frame import Frame, Saved
from snooker_env.game.referee import FULL_TABLE, Stroke
from tests.refusals import refuse_each
from tests.tables import PLACES, begun, frame_env, frame_state, plain

FRAME = {"opponent": "random", "miss": "clear_path", "noise": "club", "layout": "random:3", "aim": "target"}
WANTED = {
    "in_hand": lambda f: f.in_hand and f.phase == "stroke",
    "a break": lambda f: f.break_points > 0 and f.ball_on == BallOn.ANY_COLOUR,
    "a choice": lambda f: f.phase == "choice" and not f.miss_called,
    "a miss": lambda f: f.miss_called and f.failures,
    "replaced": lambda f: f.phase == "stroke" and f.saved is not None,
    "a free ball": lambda f: f.free_ball,
}
"""Frames to be in the middle of, at the agent's turn."""


# How a state is spoilt

ROWS = (0, 1, 4, 21)
"""Of the 22 balls, only these are spoilt one by one."""


def fields(node, path=()):
    """The paths of all parts of a state, the whole one first."""
    yield path
    parts = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, part in parts:
        if not isinstance(key, int) or len(node) < 22 or key in ROWS:
            yield from fields(part, (*path, key))


def at(state, path):
    """The part of a state there."""
    for key in path:
        state = state[key]
    return state


def spoilt(value):
    """Other things to stand in the place of a value, None among them where it was not."""
    wrong = [None, nan, inf, -inf, -1, 2**70, 10**400, 1e300, 1.5, "x", "", True, False, [], {}]
    wrong += [[value], {"a": 1}, 3]
    if isinstance(value, str):
        wrong += ["over", "stroke", "choice", "lot", "off", "clear_path"]
    elif isinstance(value, bool):
        wrong += [0, 1, 0.0]
    elif isinstance(value, int | float):
        wrong += [value + 1, value - 1, -value, value + 2**64, str(value), value + 0.25, 0, 1, 2, 7, 155]
    elif isinstance(value, list):
        wrong += [value[:-1], [*value, *value[-1:]], [None, *value[1:]], value[::-1], tuple(value)]
        wrong.append(dict.fromkeys(map(str, range(len(value)))))
    elif isinstance(value, dict):
        wrong += [{k: v for k, v in value.items() if k != key} for key in value]
        wrong += [value | {"more": 1}, value | {7: 1}, list(value)]
    as_text = repr(value)
    return [other for other in wrong if repr(other) != as_text]


def mutations(state):
    """(path, value put there, the state with it) for every way to spoil every part."""
    for path in fields(state):
        for wrong in spoilt(at(state, path)):
            new = copy.deepcopy(state)
            if path:
                at(new, path[:-1])[path[-1]] = wrong
            yield path, wrong, (new if path else wrong)


KINDS = {bool: "truth", int: "integer", float: "number", str: "text", dict: "dict", type(None): "null"}


def kind_of(value):
    """What JSON calls the type of a value; a tuple is as good as a list."""
    return "list" if isinstance(value, list | tuple) else KINDS[type(value)]


def keys_of(field):
    """``state.positions[3, 0]`` as the way to it: ("state", "positions", 3, 0)."""
    return tuple(int(key) if key.isdigit() else key for key in re.findall(r"\w+", field))


def way_of(keys):
    """Positions and on_table are one layout: a ball that cannot lie where it does may be either's fault."""
    if keys[:2] in (("state", "positions"), ("state", "on_table")):
        return ("state", "layout", *keys[2:])
    return tuple(key for k, key in enumerate(keys) if k == 0 or keys[k - 1] != "layout")


def names_it(message, root, path):
    """Does a complaint name the part that was spoilt?

    It names that part, what it is a part of, or a part of it; or another that does not fit it, and then its
    text says which it is.
    """
    field = message.split(" = ")[0]
    field_way, way = way_of(keys_of(field)), way_of((root, *path))
    if field_way == way[: len(field_way)] or way == field_way[: len(way)]:
        return True
    return [key for key in path if isinstance(key, str)][-1] in message[len(field) :]


# Attacks


@pytest.fixture(scope="module")
def frame_states():
    """A state of every kind that is ``WANTED``, found in random play, and one of a re-spotted black."""
    env, states, rng = frame_env(**FRAME | {"layout": "break_off"}), {}, np.random.default_rng(0)
    for seed in range(60):
        env.reset(seed=seed)
        for _ in range(60):
            if env.over or len(states) == len(WANTED):
                break
            for name, wanted in WANTED.items():
                if name not in states and wanted(env.frame):
                    states[name] = plain(env.get_state())
            env.step(rng.uniform(-1, 1, 7))
    assert len(states) == len(WANTED), set(WANTED) - set(states)
    places = {CUE: (0.1, -1.2), BLACK: SPOTS[BLACK]}
    frame = {"ball_on": BallOn.BLACK, "in_hand": True, "respotted_black": True, "scores": (64, 64)}
    return states | {"a re-spotted black": plain(frame_state(env, places, frame).get_state())}


def must_be_refused(path, value, old, root):
    """Whether something of that type must be refused there, whatever its value."""
    if path[-1] == "layout" and root == "frame":  # which is the caller's own
        return False
    if path[-1] in ("saved", "layout") and value is None:
        return False
    return kind_of(value) != kind_of(old) and not (kind_of(old) == "number" and kind_of(value) == "integer")


def attack(state, load, saved, root="state", play=lambda: None):
    """Load every mutation: refused by name with nothing changed, or played. Counts (refused, taken)."""
    counts = [0, 0]
    load(state)
    good = dumps(saved())
    for path, value, wrong in mutations(state):
        try:
            load(wrong)
        except Exception as error:
            assert type(error) is ValueError, (path, value, repr(error))
            assert names_it(str(error), root, path), (path, value, str(error))
            assert dumps(saved()) == good, (path, value)
            counts[0] += 1
            continue
        assert path and not must_be_refused(path, value, at(state, path), root), (path, value)
        dumps(saved())
        play()
        counts[1] += 1
        load(state)
        assert dumps(saved()) == good
    return counts


def player(env, strokes=2):
    """Plays a few strokes and reads what is shown of them."""

    def play():
        assert env.observation_space.contains(env._last_seen)
        for k in range(strokes):
            if env.over:
                return
            action = np.random.default_rng(k).uniform(-1, 1, env.action_space.shape)
            observation, reward, *_, info = env.step(action)
            assert env.observation_space.contains(observation) and np.isfinite([reward, info["break"]]).all()

    return play


def loader(env, seed):
    """Loads a state by reset, with a seed or without, and notes what is seen."""

    def load(state):
        env._last_seen = env.reset(seed=seed, options={"state": state})[0]

    return load


@pytest.mark.parametrize("layout", ["random:3", "break_off"])
def test_every_fault_of_a_visit(layout):
    env = begun(SnookerEnv(layout=layout, noise="club", placement=layout == "break_off"), 3)
    refusals, taken = attack(plain(env.get_state()), loader(env, None), env.get_state, play=player(env))
    assert refusals > 500 and taken > 30


def test_every_fault_of_a_visit_in_the_vector_environment():
    env = begun(SnookerVectorEnv(2, layout="random:3", noise="club"), 3)
    sound = plain(env.get_state()[1])
    for how in (lambda state: {"state": state}, lambda state: {"states": [sound, state]}):
        refusals, taken = attack(sound, lambda state, how=how: env.reset(options=how(state)), env.get_state)
        assert refusals > 500 and taken > 30


@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=pytest.mark.slow) for name in ("in_hand", "replaced")), "a choice"]
)
def test_every_fault_of_a_frame(name, frame_states):
    env = frame_env(**FRAME)
    refusals, taken = attack(frame_states[name], loader(env, None), env.get_state, play=player(env, 1))
    assert refusals > 800 and taken > 50


@pytest.mark.parametrize("name", [pytest.param("a miss", marks=pytest.mark.slow), "replaced"])
def test_every_fault_of_a_match(name, frame_states):
    pytest.importorskip("pettingzoo")
    env = begun(sn.match_env(**{key: FRAME[key] for key in ("miss", "noise", "layout", "aim")}))

    def play():
        spaces = env.observation_spaces
        assert all(spaces[player].contains(env.observe(player)) for player in env.possible_agents)
        if not any([*env.terminations.values(), *env.truncations.values()]):
            env.step(np.zeros(7, np.float32))
            assert all(spaces[player].contains(env.observe(player)) for player in env.possible_agents)

    def whole():
        seen = env.rewards, env.infos, env.terminations, env.truncations
        return env.get_state(), env.agent_selection, *seen

    def load(state):
        env.reset(seed=9, options={"state": state})

    how = env.set_state if name == "a miss" else load
    refusals, taken = attack(frame_states[name], how, whole, play=play)
    assert refusals > 800 and taken > 50


@pytest.mark.parametrize("name", [*WANTED, "a re-spotted black"])
def test_every_fault_of_a_frame_alone(name, frame_states):
    state = frame_states[name]["frame"]
    kept = []

    def load(plain):
        kept[:] = [Frame.from_dict(plain)]

    def play():
        frame = kept[0]
        if frame.phase == "choice":
            frame = frame.choose("play")
        if frame.phase == "stroke":
            frame.play(Stroke())

    if state["saved"] is not None:
        state = state | {"saved": state["saved"] | {"layout": None}}  # which is for the environment to read
    refusals, taken = attack(state, load, lambda: 0, "frame", play)
    assert refusals > 300 and taken > 15


def changed(state, **parts):
    state = copy.deepcopy(state)
    for path, value in parts.items():
        *way, last = path.split("__")
        part = state
        for key in way:
            part = part[int(key) if key.isdigit() else key]
        part[int(last) if last.isdigit() else last] = value
    return state


MISS = """
miss(frame__striker=1) | state.frame.striker | 1 | must be 0, the agent
miss(frame__saved__layout=None) | state.frame.saved.layout | None | must be positions and on_table
miss(frame__saved__layout=[[[5, 5]] * 22, ALL]) | state.frame.saved.layout[0][0] | (5.0, 5.0) | must be on the table
miss(frame__saved__layout=[[[0, 0]] * 22, ALL]) | state.frame.saved.layout[0] | balls 0 and 1 | overlap
miss(frame__saved__on_table=1 << 21, frame__saved__ball_on=7) | state.frame.saved | a position | must have the balls on_table
miss(frame__saved={}) | state.frame.saved | on_table | must have exactly the fields
miss(frame__phase="lot") | state.frame.phase | lot | must
miss(frame__scores=[0, 2**53]) | state.frame.scores[1] | 9007199254740992 | must be an integer in [0, 900719
miss(frame__scores=[0, 1, 2]) | state.frame.scores | (0, 1, 2) | must be a tuple of two integers
miss(frame__failures=3) | state.frame.failures | 3 | must be an integer in [0, 2]
miss(frame__break_points=20) | state.frame.break_points | 20 | must be
miss(frame__warned=True) | state.frame.warned | True | must be False
miss(rng__state__state=2**128) | state.rng | 340282366920938463463374607431768211456 | must be the state of a PCG64
miss(rng__state__inc=1.0) | state.rng.state.inc | 1.0 | must be of type int
miss(strokes=1000) | state.strokes | 1000 | must be below max_strokes = 1000: there is no shot left
miss(ball_on=1) | state | 'ball_on' | of get_state() here, with the keys ['frame', 'positions',
"""


def test_faults_of_a_frame_in_which_a_miss_was_called(frame_states):
    env = begun(frame_env(**FRAME))
    before = dumps(env.get_state())

    def miss(**parts):
        env.reset(seed=8, options={"state": changed(frame_states["a miss"], **parts)})

    refuse_each(MISS, {"miss": miss, "ALL": [True] * 22})
    assert dumps(env.get_state()) == before and env.np_random_seed == 1


PINK_LEFT, BLACK_LEFT = ({CUE: (0, 0), ball: SPOTS[ball]} for ball in (PINK, BLACK))


@pytest.mark.parametrize(
    ("places", "frame", "field"),
    [
        (PLACES, {"in_hand": True}, "in_hand"),
        (PINK_LEFT | {BLUE: (0.5, 0.5)}, {"ball_on": BallOn.PINK}, "ball_on"),
        (PINK_LEFT, {"ball_on": BallOn.PINK, "break_points": 150}, "break_points"),
        (BLACK_LEFT, {"ball_on": BallOn.BLACK, "respotted_black": True, "scores": (7, 8)}, "respotted"),
        (PLACES, {"free_ball": True, "break_points": 3}, "break_points"),
    ],
)
def test_what_the_rules_exclude_is_refused(places, frame, field):
    with pytest.raises(ValueError, match=f"state.frame.{field}"):
        frame_state(frame_env(), places, frame)


HELD = Saved(on_table=FULL_TABLE, ball_on=BallOn.RED, in_hand=False, free_ball=False)


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"miss_called": True}, "miss_called"),
        ({"failures": 1}, "failures"),
        ({"phase": "choice", "ball_on": BallOn.ANY_COLOUR}, "ball_on"),
        ({"miss": "off", "saved": HELD}, "saved"),
        ({"saved": replace(HELD, on_table=FULL_TABLE & ~2)}, "saved"),
        ({"saved": replace(HELD, ball_on=BallOn.ANY_COLOUR)}, "saved"),
        ({"saved": replace(HELD, in_hand=True)}, "saved"),
        ({"saved": replace(HELD, free_ball=True)}, "saved"),
    ],
)
def test_parts_of_a_frame_that_do_not_fit_together_are_refused(fields, field):
    good = {"in_hand": False, "miss": "clear_path", "saved": HELD}
    Frame.from_dict(Frame(**good).to_dict())
    wrong = Frame(**good | {"saved": None} | fields)
    with pytest.raises(ValueError, match=f"^frame.{field} = "):
        Frame.from_dict(wrong.to_dict())


def test_a_state_with_nothing_left_to_play_is_for_looking_only(frame_states):
    over = Frame.from_dict(frame_states["a break"]["frame"]).concede(0).to_dict()
    env = begun(frame_env(**FRAME))
    ended, stopped = frame_states["a break"] | {"frame": over}, frame_states["in_hand"] | {"strokes": 1000}
    for state, field in ((ended, "phase"), (stopped, "strokes")):
        before = dumps(env.get_state())
        with pytest.raises(ValueError, match=f"{field} = .*no shot"):
            env.reset(options={"state": state})
        assert dumps(env.get_state()) == before
        env.set_state(state)
        assert env.over and dumps(env.get_state()) == dumps(state)
