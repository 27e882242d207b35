"""How is a running training saved and stopped? Checkpoints, curve and an orderly stop, by an SB3 callback."""

import signal
import time
from typing import Any

import numpy as np
import rich
from stable_baselines3.common.callbacks import BaseCallback

from .run_folder import save_checkpoint

POINTS_OF_THE_CURVE = 20
_NAMES = "policy_gradient_loss", "value_loss", "actor_loss", "critic_loss"
LOSSES = {name.partition("_")[0]: name for name in _NAMES}
"""The losses that are shown, by the names under which SB3 records them: of PPO, of SAC and TQC."""


class Stop:
    """Notes SIGINT and SIGTERM: the run is saved after the current update. A second one acts at once."""

    def __init__(self):
        self.signal = None
        self.running = "this round of positions"
        """The work that is finished before the run is saved, in words."""

    def __enter__(self):
        stops = signal.SIGINT, signal.SIGTERM
        self._before = {number: signal.signal(number, self._note) for number in stops}
        return self

    def __exit__(self, *error) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number, frame):
        self.signal = number
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        name = signal.Signals(number).name
        second = "(a second signal stops at once, without saving)"
        rich.get_console().print(f"\n{name}: saving after {self.running} ... {second}")


def rollout_of(model):
    """Shots between two updates, of all tables: training runs in whole rollouts."""
    off_policy = hasattr(model, "train_freq")  # their n_steps is that of n-step returns
    return model.n_envs * (model.train_freq.frequency if off_policy else model.n_steps)


def goal_of(model, steps):
    """The number of shots at the end of a training to ``steps``."""
    left = max(0, steps - model.num_timesteps)
    return model.num_timesteps + rollout_of(model) * -(-left // rollout_of(model))


class RunCallback(BaseCallback):
    """Progress, learning curve, checkpoints and an orderly stop."""

    def __init__(self, out, settings, seconds, curve, imitation, running, stop, progress):
        super().__init__()
        self.imitation, self.running, self.stop = imitation, running, stop
        self.out, self.settings, self.seconds_before, self.curve = out, settings, seconds, curve
        self.progress, self.figures = progress, ""
        self.saved, self.stopping = None, False

    @property
    def seconds(self):
        """Time of this part of the training [s], with the time before a resume."""
        return self.seconds_before + time.perf_counter() - self.started

    def _on_training_start(self):
        self.started = time.perf_counter()
        if self.running is not None:  # learn() begins with a reset, which set them to 0
            tables: Any = self.training_env
            tables.running = self.running

    def _on_rollout_start(self):
        # only here is there no rollout that has not been learned from: a checkpoint loses nothing
        recent = [visit["r"] for visit in self.model.ep_info_buffer or ()]
        due = self.num_timesteps >= len(self.curve) * self.settings.steps // POINTS_OF_THE_CURVE
        # a resume calls this a second time
        if recent and due and self.num_timesteps > (self.curve[-1]["steps"] if self.curve else -1):
            self.curve.append({"steps": self.num_timesteps, "points": round(float(np.mean(recent)), 3)})
        rollout, losses = rollout_of(self.model), self.model.logger.name_to_value
        rounds = goal_of(self.model, self.settings.steps) // rollout
        words = [f"round {self.num_timesteps // rollout + 1:,} of {rounds:,}"]
        known = ((name, losses.get(f"train/{key}")) for name, key in LOSSES.items())
        words += [f"{name} loss {loss:.3g}" for name, loss in known if loss is not None]
        words += [f"{np.mean(recent):.2f} points a visit"] if recent else []
        self.figures = ", ".join(words)
        self.stopping = self.stop.signal is not None
        old = self.saved is None or self.num_timesteps - self.saved >= self.settings.checkpoint_every
        if self.stopping or old:
            self.save()

    def _on_step(self):
        self.progress.at(self.num_timesteps, self.figures)
        # SB3 can stop only here; the one shot since the save is repeated after a resume
        return not self.stopping

    def _on_training_end(self):
        self.seconds_before, self.started = self.seconds, time.perf_counter()
        if not self.stopping:
            self.save()

    def save(self):
        """Write the checkpoint."""
        save_checkpoint(self.out, self.settings, self.model, self.seconds, self.curve, self.imitation)
        self.saved = self.num_timesteps


LEAST, SHARE = 30.0, 0.01
"""Seconds of pre-training that a kill may lose, and the largest share of its time for saving.

A checkpoint of expert iteration holds 155 MB at most.
"""


def imitate(imitation, out, settings, model, stop, progress):
    """Pre-train by imitation, with checkpoints in between. Returns whether it was completed."""
    last, cost = time.perf_counter(), 0.0
    while imitation.done < imitation.states:
        imitation.round()
        progress.at(imitation.done, imitation.figures)
        now = time.perf_counter()
        if stop.signal is not None or now - last > max(LEAST, cost / SHARE):
            save_checkpoint(out, settings, model, 0.0, [], imitation.curve, imitation.get_state())
            last = time.perf_counter()
            cost = last - now
        if stop.signal is not None:
            return False
    model.imitated = imitation.curve[-1]["states"]
    return True
