"""How are tables shown to an agent? By a view: pots, or simulated outcomes too; to train as a ``VecEnv``."""

import numpy as np
from gymnasium import spaces

from snooker_env.checks import choice
from snooker_env.planning import Positions
from snooker_env.planning.learned.pot_view import SHOWN, with_pots
from snooker_env.tasks import OBSERVATION_SIZE, observation_space

from .lookahead_features import ForesightView

VIEWS = ("pots", "foresight")


OBSERVED_SIZE = spaces.flatdim(observation_space("flat", conditions=True))
"""Numbers in a flat observation with the constants of the table."""


class PotsView:
    """The view with the table and its pots: ``with_pots``. ``constants``: those of the table follow, as
    environments with ``observe_conditions=True`` show them."""

    def __init__(self, constants=False):
        self.constants = constants
        size = SHOWN + (OBSERVED_SIZE - OBSERVATION_SIZE) * constants
        self.space = spaces.Box(-1.0, 1.0, (size,), np.float32)

    def at(self, options):
        """The view under the rules of ``options``."""
        return self

    def __call__(self, at, observations):
        """The view of n ``Positions`` with these flat observations."""
        shown = with_pots(observations)
        return np.concatenate([shown, observations[:, OBSERVATION_SIZE:]], 1) if self.constants else shown

    def allowed(self, masks):
        """Which of the available choices may be played."""
        return masks


def view_of(name, threads=None, constants=False):
    """The view of that name; ``constants``: with those of the table, which "foresight" never shows."""
    return ForesightView(threads) if choice("view", name, VIEWS) == "foresight" else PotsView(constants)


def training_tables(n, threads=None, view="pots", **options):
    """n tables of ``SnookerVecEnv`` with the observations of a view: an SB3 ``VecEnv``."""
    from stable_baselines3.common.vec_env import VecEnvWrapper

    from snooker_env.sb3 import SnookerVecEnv

    base = SnookerVecEnv(n, threads=threads, **options)
    options = base.tables.options
    shown = view_of(view, threads, options.observe_conditions).at(options)

    class Viewed(VecEnvWrapper):
        """All tables at once. A terminal observation holds table and pots only: nothing is learned from it."""

        judge = None
        """Values [points] of ``Positions``, added to rewards where the visit goes on; or None."""

        def reset(self):
            observations = self.venv.reset()
            return shown(Positions.of(base.tables), observations)

        def step_wait(self):
            observations, rewards, done, infos = self.venv.step_wait()
            if self.judge is not None:
                rewards, on = rewards.copy(), np.flatnonzero(~done)
                rewards[on] += self.judge(Positions.of(base.tables)[on])
            ended = [info for info in infos if "terminal_observation" in info]
            if ended:
                last = np.zeros((len(ended), *shown.space.shape), np.float32)
                last[:, :SHOWN] = with_pots(np.stack([info["terminal_observation"] for info in ended]))
                for info, row in zip(ended, last, strict=True):
                    info["terminal_observation"] = row
            return shown(Positions.of(base.tables), observations), rewards, done, infos

        @property
        def running(self):
            """Returns and lengths so far of running visits, for ``episode`` in the last info; in no state."""
            return base.episode_returns.copy(), base.episode_lengths.copy()

        @running.setter
        def running(self, sums):
            base.episode_returns[:], base.episode_lengths[:] = sums

        def env_method(self, method_name, *arguments, indices=None, **more):
            if method_name == "action_masks":
                return list(shown.allowed(base.tables.action_masks())[np.array(self._get_indices(indices))])
            return self.venv.env_method(method_name, *arguments, indices=indices, **more)

    return Viewed(base, shown.space)
