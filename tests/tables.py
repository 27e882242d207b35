"""How does a test of the environment set up a table, strike, and compare what comes back bit for bit?"""

import json

import numpy as np

from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, CUE, N_BALLS, PINK, SPOTS
from snooker_env.game.frame import Frame
from snooker_env.players import SeenPlayer
from snooker_env.tasks.box_actions import MAX_SPEED, MIN_SPEED

LAYOUTS = ("opened", "held_out", "break_off", "line_up", "colours", "random:0", "random:1", "random:15")
INFO = {"points": float, "break": float, "foul": bool, "seconds": float}
INFO |= dict.fromkeys(("penalty", "pots", "fouls", "first_ball", "ball_on", "events"), int)
PLACES = {CUE: (0.3, 1.1), 1: (0.6, 1.4), 2: (-0.5, 0.2), BLACK: SPOTS[BLACK], PINK: SPOTS[PINK]}
"""Red 1 can be potted along the target line, red 2 is out of the way."""


def begun(env, seed=1, **more):
    """The environment after a reset."""
    env.reset(seed=seed, **more)
    return env


def layout(places):
    """Balls {id: (x, y)} and nothing else on the table, as the parts of a state."""
    positions = SPOTS.copy()
    for ball, place in places.items():
        positions[ball] = place
    return {"positions": positions.tolist(), "on_table": [ball in places for ball in range(N_BALLS)]}


def plain(state):
    """What JSON makes of it."""
    return json.loads(json.dumps(state))


def table_state(env, places, ball_on, points=0, **fields):
    """Put balls {id: (x, y)} and nothing else on the table."""
    if not env.np_random_seed:
        env.reset(seed=1)
    game = {"ball_on": int(ball_on), "points": points, "in_hand": False, "over": False}
    env.set_state(env.get_state() | layout(places) | game | fields)


def viewed(observation):
    """The options of an environment with that kind of observation: masks are of discrete actions."""
    return {"observation": observation} | ({"action": "discrete"} if observation == "masked" else {})


def drawn(env, rng, spread=1.0):
    """A random action for one table: within ``spread`` of the middle, or one of the available choices."""
    if env.options.action == "discrete":
        return int(rng.choice(np.flatnonzero(env.action_masks())))
    return rng.uniform(-spread, spread, env.action_space.shape)


def frame_env(**options):
    return SnookerEnv(**{"task": "frame", "aim": "target", "says": ["decision"], "placement": True} | options)


def frame_state(env, places, frame, **state):
    """Put balls {id: (x, y)} and nothing else on the table, in a ``Frame`` given by its fields."""
    env.reset(seed=1)
    mask = sum(1 << ball for ball in places if ball)
    fields = {"on_table": mask, "in_hand": False, "miss": env.options.miss} | frame
    parts = layout(places) | {"frame": Frame(**fields).to_dict(), "unpaid": 0, "due": False}
    env.reset(options={"state": plain(env.get_state() | parts | state)})
    return env


class Acting:
    """What answers each observation by a function of it and a generator."""

    def __init__(self, answer):
        self.answer = answer

    def act(self, observations, masks, seeds):
        rngs = map(np.random.default_rng, seeds.tolist())
        return [self.answer(row, rng) for row, rng in zip(observations, rngs, strict=True)]


def acting(answer, **options):
    """A player of the frames of ``frame_env``, by a function of observation and generator."""
    usual = {"task": "frame", "aim": "target", "says": ["decision"], "placement": True}
    return SeenPlayer(Acting(answer), usual | options)


def after_strike(env, action):
    """The cue ball's velocity and spin as it leaves the tip."""
    env.step(np.array(action, np.float32))
    _, v, w = env.last_shot.at(0.0)
    return v[CUE], w[CUE]


def speed_of(a):
    return MIN_SPEED + (a + 1) / 2 * (MAX_SPEED - MIN_SPEED)


def jsonable(x):
    """Arrays as bytes, so that equality is equality of bits."""
    if isinstance(x, np.ndarray):
        return (x.dtype.str, x.shape, x.tobytes())
    if isinstance(x, dict):
        return {k: jsonable(v) for k, v in x.items()}
    if isinstance(x, list | tuple):
        return [jsonable(v) for v in x]
    return x
