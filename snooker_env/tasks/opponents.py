"""Who plays the other side of a frame? Built-in players, any callable, or a Stable-Baselines3 model from a file.

A player is asked with ``play(table, observe, rng, path)`` when it is its turn on a ``FrameTable``: it decides, places and plays one
stroke, and returns what was ``Played`` (None if it handed the table back to the offender).
"""

from math import atan2, hypot, pi, sqrt
from pathlib import Path

import numpy as np

from .._check import refuse, truth
from ..game.balls import CUE, N_BALLS
from ..game.pots import pots
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS, POCKET_AIMS
from . import observations
from .saved_models import Saved, outline

OPPONENTS = ("none", "random", "ghost_ball")

_ROLL = 0.25  # twice a rolling ball's deceleration [m/s^2]
_SLIDE = 1.4  # speed that a ball struck in its middle must have, over that with which it rolls on
_PLACES = [(x * D_RADIUS, BAULK_Y - y * D_RADIUS) for y in (0.0, 0.5) for x in (-0.8, -0.4, 0.0, 0.4, 0.8)]


class Player:
    """A player by a policy: ``policy(observation, rng) -> action`` in the environment's own spaces, decision and placement included."""

    def __init__(self, policy):
        self.policy = policy

    def play(self, table, observe, rng, path):
        """One turn. Raises ValueError, naming "opponent's action", for a wrong one."""
        wished = self.policy(observe(), rng)
        try:
            action = table.shooter.actions.check(wished)
        except ValueError as error:
            raise ValueError(f"opponent's {error}") from None
        return table.act(action, rng, path=path)


class RandomPlayer:
    """Every component of the action uniform, the decision too."""

    def play(self, table, observe, rng, path):
        """One turn."""
        return table.act(rng.uniform(-1.0, 1.0, table.shooter.actions.size).tolist(), rng, path=path)


class GhostBall:
    """The plain geometric player: the widest direct pot (``game.pots``), struck in the middle, as soft as will do.

    Without a pot it rolls full at the nearest ball on that it sees; seeing none, it strikes anywhere and hopes. In hand it takes the best
    of ten places. After a foul it always plays the table as it lies. It knows neither throw nor position. Its speed is drawn within a
    tenth of what it wants, and after the other's foul it strikes anywhere one time in ten: two exact players could repeat one failing
    stroke for ever.
    """

    def play(self, table, observe, rng, path):
        """One turn."""
        fouled = table.frame.phase == "choice"
        if fouled:
            table.choose("play")
        if table.frame.in_hand:
            self._place(table)
        speed, aim = 3.0, rng.uniform(-pi, pi)
        if not (fouled and rng.random() < 0.1):
            speed, aim = self.aim(table.positions, table.on_table, table.on, rng)
        return table.play((speed * rng.uniform(0.9, 1.1), 0.0, 0.0, aim, 0.0), rng, path=path)

    @staticmethod
    def _place(table):
        widest, best = 0.0, _PLACES[2]
        for place in _PLACES:
            table.place(*place)
            found = pots(table.positions, table.on_table, table.on, most=1)
            if len(found) and found[0, 5] > widest:
                widest, best = found[0, 5], place
        table.place(*best)

    @staticmethod
    def aim(positions, on_table, on, rng):
        """Speed [m/s] and direction [rad] of its shot at the balls in the mask ``on``."""
        x, y = positions[CUE]
        found = pots(positions, on_table, on, most=1)
        if len(found):
            ball, pocket, gx, gy, cos_cut, _ = found[0]
            run = hypot(*(POCKET_AIMS[int(pocket), :2] - positions[int(ball)]))
            needed = _SLIDE * sqrt(_ROLL * (run + 0.6)) / max(cos_cut, 0.2)  # of the cue ball at the impact
            return min(6.0, _SLIDE * sqrt(_ROLL * hypot(gx - x, gy - y) + needed * needed)), atan2(gy - y, gx - x)
        for ball in sorted((i for i in range(1, N_BALLS) if on >> i & 1), key=lambda i: hypot(*(positions[i] - positions[CUE]))):
            d = positions[ball] - positions[CUE]
            if _full(positions, on_table, ball):
                return _SLIDE * sqrt(_ROLL * hypot(*d)) + 0.5, atan2(d[1], d[0])
        return 3.0, rng.uniform(-pi, pi)


def _full(positions, on_table, ball):
    """Can the cue ball be rolled straight at the middle of ``ball``, past every other?"""
    d = positions[ball] - positions[CUE]
    far = hypot(*d)
    others = positions - positions[CUE]
    along = np.clip(others @ d / far, 0.0, max(0.0, far - 2 * BALL_RADIUS))
    gaps = np.hypot(*(others - along[:, None] * d / far).T)
    blocked = on_table & (gaps < 2 * BALL_RADIUS)
    blocked[[CUE, ball]] = False
    return not blocked.any()


class Model:
    """A model that Stable-Baselines3 or sb3-contrib saved; its pickles run when it is loaded, which is why ``trust`` is asked for.

    Trained on a frame or on the visit task, with the observation kind, aim and action options of this environment: of the frame's entries
    and the decision it then gets and gives none (the decision is to play). Its actions are its deterministic ones. One that is not is
    refused here, by what its file says of itself before anything of it runs.
    """

    def __init__(self, path, kind, actions, trust):
        self.path, self.kind, self.actions, self.trust = Path(path), kind, actions, trust
        self._network = self._load()

    def __getstate__(self):
        return self.__dict__ | {"_network": None}  # loaded again where it is needed

    def __call__(self, observation, rng):
        """The action."""
        if self._network is None:
            self._network = self._load()
        if self._network.observation_space == observations.space(self.kind):
            observation = visit_part(observation)
        action = np.clip(self._network.predict(observation, deterministic=True)[0], -1.0, 1.0)
        return np.append(action, 0.0) if len(action) < self.actions.size else action

    def _load(self):
        seen = [observations.space(self.kind), observations.space(self.kind, frame=True)]
        sizes = sorted({self.actions.size, self.actions.size - self.actions.decision})
        saved = Saved.of(self.path, "opponent")
        if saved.action[0] != "Box":  # a frame is played by numbers
            raise saved.refused("must be a model whose actions are a Box")
        other_view = saved.refused(f'must be a model that sees observation="{self.kind}" of the visit or frame task and nothing else')
        other_actions = saved.refused(f"must be a model with {' or '.join(map(str, sizes))} actions")
        if saved.observation not in [outline(space) for space in seen]:
            raise other_view
        if saved.action[1] not in [[size] for size in sizes]:
            raise other_actions
        network = saved.network(self.trust, "trust=True")
        if network.observation_space not in seen:  # a file may say one thing and hold another
            raise other_view
        if outline(network.action_space) not in [("Box", [size]) for size in sizes]:
            raise other_actions
        return network


def visit_part(observation):
    """What the visit task would show of a frame's observation."""
    extra = len(observations.FRAME_ENTRIES)
    if isinstance(observation, dict):
        return observation | {"state": observation["state"][:-extra]}
    return observation[:-extra]


def opponent_of(opponent, kind, actions, trust=False):
    """The player that ``opponent`` names; None for "none". ``kind``: of the observation, ``trust``: may code run, for a model's file."""
    allowed = "must be one of " + ", ".join(map(repr, OPPONENTS)) + ", a path to a model (.zip), or a callable(observation, rng) -> action"
    truth("trust", trust)
    if callable(opponent):
        return Player(opponent)
    if not isinstance(opponent, str | Path) or (str(opponent) not in OPPONENTS and Path(opponent).suffix != ".zip"):
        raise refuse("opponent", opponent, allowed)
    if str(opponent) in OPPONENTS:
        return {"none": lambda: None, "random": RandomPlayer, "ghost_ball": GhostBall}[str(opponent)]()
    return Player(Model(opponent, kind, actions, trust))
