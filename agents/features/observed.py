"""What does an agent observe of a table? The ``observation`` in its recipe's ``env_kwargs``, or by default the flat one
with its pots. For training there is a ``VecEnv``."""

import numpy as np
from gymnasium import spaces

from snooker_env.planning import Positions
from snooker_env.planning.learned.stroke_policy import SHOWN, with_pots
from snooker_env.tasks import OBSERVATION_SIZE


def shown(env_kwargs):
    """The environment's observation for an agent with these ``env_kwargs``, and the function from n observations to its inputs."""
    named = env_kwargs.get("observation")
    return (named, _as_they_are) if named else ("flat", seen_of)


def space_of(tables, env_kwargs):
    """The observation space of an agent with these ``env_kwargs`` on one of these tables."""
    if shown(env_kwargs)[1] is _as_they_are:
        return tables.single_observation_space
    constants = 8 * bool(tables.options.observe_conditions)  # of the table
    return spaces.Box(-1.0, 1.0, (SHOWN + constants,), np.float32)


def _as_they_are(observations):
    return observations


def seen_of(observations):
    """``with_pots`` of n flat observations, float32, followed by the constants of the table if they hold them."""
    seen = with_pots(observations)
    constants = observations[:, OBSERVATION_SIZE:]
    return np.concatenate([seen, constants], 1) if constants.shape[1] else seen


def training_tables(n, threads=None, **options):
    """n tables of ``SnookerVecEnv`` with the observations of an agent with these ``env_kwargs``: an SB3 ``VecEnv``."""
    from stable_baselines3.common.vec_env import VecEnvWrapper

    from snooker_env.sb3 import SnookerVecEnv

    observation, see = shown(options)
    its = options | {"observation": observation, "threads": threads}
    base = SnookerVecEnv(n, **its)

    class Seen(VecEnvWrapper):
        """All tables at once."""

        judge = None
        """Values [points] of ``Positions``, added to rewards if the visit continues; or None."""

        def reset(self):
            return see(self.venv.reset())

        def step_wait(self):
            observations, rewards, done, infos = self.venv.step_wait()
            if self.judge is not None:
                rewards, on = rewards.copy(), np.flatnonzero(~done)
                rewards[on] += self.judge(Positions.of(base.tables)[on])
            ended = [info for info in infos if "terminal_observation" in info]
            if ended:
                last = np.stack([info["terminal_observation"] for info in ended])
                for info, row in zip(ended, see(last), strict=True):
                    info["terminal_observation"] = row
            return see(observations), rewards, done, infos

        @property
        def running(self):
            """Returns and lengths so far of current visits, for ``episode`` in the last info; not part of a state."""
            return base.episode_returns.copy(), base.episode_lengths.copy()

        @running.setter
        def running(self, sums):
            base.episode_returns[:], base.episode_lengths[:] = sums

    return Seen(base, space_of(base.tables, options))
