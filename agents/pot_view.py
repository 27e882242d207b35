"""What does an agent see beside the balls? The pots that the table offers, as numbers."""

import gymnasium
import numpy as np

from snooker_env.game.balls import HALF_LENGTH
from snooker_env.game.pots import POCKETS, pots


class PotView(gymnasium.ObservationWrapper):
    """Appends the four widest direct pots to the flat observation, eight numbers each; all 0 where there are fewer.

    1, direction cue ball -> ghost ball (x, y), sine and cosine of the cut, both distances, tolerance. A small network cannot find these
    lines itself in a few minutes: without them the same run makes a third of the pots.
    """

    MOST = 4

    def __init__(self, env):
        super().__init__(env)
        (n,) = env.observation_space.shape
        self.observation_space = gymnasium.spaces.Box(-1.0, 1.0, (n + 8 * self.MOST,), np.float32)

    def observation(self, observation):
        table = self.unwrapped
        rows = np.zeros((self.MOST, 8), np.float32)
        for row, (ball, pocket, x, y, cos_cut, tolerance) in zip(
            rows, pots(table.positions, table.on_table, table.on, most=self.MOST), strict=False
        ):
            at = table.positions[int(ball)]
            path, run = np.array([x, y]) - table.positions[0], at - (x, y)
            away = np.hypot(*path)
            path, run = path / away, run / np.hypot(*run)
            to_pocket = np.hypot(*(POCKETS[int(pocket), :2] - at))
            row[:] = 1, *path, path[0] * run[1] - path[1] * run[0], cos_cut, away / HALF_LENGTH - 1, to_pocket / HALF_LENGTH - 1, \
                1 + np.log10(tolerance) / 2  # fmt: skip
        return np.concatenate([observation, np.clip(rows, -1.0, 1.0).ravel()])
