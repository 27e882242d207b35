"""How does ``MaskablePPO`` learn quickly on many tables? Lean rollouts, and updates of ``TablePolicy`` by the passes of ``fused``.

The algorithm, its hyperparameters, its files and what it reports are those of sb3-contrib, and ``MaskablePPO.load`` reads its models. Only
the work differs: ``TablePolicy.forward`` draws the choices of a rollout, a rollout reads the masks of all tables at once and only the infos
of tables whose episode ended, masks are kept as bool, and an update computes the gradient by ``FusedTable.ppo_gradient``.
"""

import numpy as np
import torch
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.buffers import MaskableRolloutBuffer
from sb3_contrib.common.maskable.utils import get_action_masks
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.utils import explained_variance

from .networks import TablePolicy


class BoolMasks(MaskableRolloutBuffer):
    """A rollout buffer whose masks are bool: a quarter of the memory, 9 instead of 35 MB for 16,384 shots."""

    def reset(self):
        self.mask_dims = int(self.action_space.n)
        self.action_masks = np.ones((self.buffer_size, self.n_envs, self.mask_dims), np.bool_)
        RolloutBuffer.reset(self)


def _masks_of(env):
    """The masks of all tables, bool (n, choices): from the tables at once if they offer that."""
    return env.action_masks() if hasattr(env, "action_masks") else get_action_masks(env)


class FastPPO(MaskablePPO):
    """``MaskablePPO`` for observations in one array; other policies than ``TablePolicy`` are updated as there."""

    def collect_rollouts(self, env, callback, rollout_buffer, n_rollout_steps, use_masking=True):
        """Play ``n_rollout_steps`` steps on all tables into the buffer. Returns False if the callback stopped it."""
        self.policy.set_training_mode(False)
        rollout_buffer.reset()
        callback.on_rollout_start()
        for _ in range(n_rollout_steps):
            masks = _masks_of(env) if use_masking else None
            actions, values, logs = self._passed(self.policy, self._last_obs, action_masks=masks)
            new_obs, rewards, dones, infos = env.step(actions.numpy())
            self.num_timesteps += env.num_envs
            callback.update_locals(locals())
            if not callback.on_step():
                return False
            ended = np.flatnonzero(dones).tolist()
            self._update_info_buffer([infos[k] for k in ended], dones[ended])
            for k in ended:
                if infos[k].get("TimeLimit.truncated", False):  # the visit would have gone on: what was to come is estimated
                    last = np.asarray(infos[k]["terminal_observation"])[None]
                    rewards[k] += self.gamma * float(self._passed(self.policy.predict_values, last))
            rollout_buffer.add(
                self._last_obs, actions.numpy(), rewards, self._last_episode_starts, values, logs, action_masks=masks
            )
            self._last_obs, self._last_episode_starts = new_obs, dones
        last_values = self._passed(self.policy.predict_values, self._last_obs)
        rollout_buffer.compute_returns_and_advantage(last_values=last_values, dones=self._last_episode_starts)
        callback.on_rollout_end()
        return True

    def _passed(self, network, seen, **more):
        with torch.no_grad():
            return network(torch.as_tensor(seen, device=self.device), **more)

    def train(self):
        """Update the policy on the rollout in the buffer."""
        if not isinstance(self.policy, TablePolicy) or self.clip_range_vf is not None or self.target_kl is not None:
            super().train()
            return
        self.policy.set_training_mode(True)
        self._update_learning_rate(self.policy.optimizer)
        clip, fused, buffer = self.clip_range(self._current_progress_remaining), self.policy.fused, self.rollout_buffer
        n = buffer.buffer_size * buffer.n_envs
        seen, masks = buffer.observations.reshape(n, -1), buffer.action_masks.reshape(n, -1)
        actions, before, advantages, returns = (a.reshape(n) for a in (buffer.actions, buffer.log_probs, buffer.advantages, buffer.returns))
        scaled, figures = np.empty_like(advantages), []
        for _ in range(self.n_epochs):
            order = np.random.permutation(n)  # noqa: NPY002 - as SB3: a checkpoint holds its state
            for start in range(0, n, self.batch_size):
                rows = order[start : start + self.batch_size]
                scaled[rows] = self._normalised(advantages[rows])
                fused.zero_grad()
                figures.append(
                    fused.ppo_gradient(rows, seen, masks, actions, before, scaled, returns, clip, self.ent_coef, self.vf_coef)
                )
                gradient = fused.gradient
                gradient *= min(1.0, self.max_grad_norm / (float(gradient.norm()) + 1e-6))
                self.policy.optimizer.step()
            self._n_updates += 1
        self._report(np.array(figures), clip)

    def _normalised(self, advantages):
        """The advantages of a minibatch with mean 0 and deviation 1. A single one stays as it is."""
        if not self.normalize_advantage or len(advantages) < 2:
            return advantages
        return (advantages - advantages.mean()) / (advantages.std(ddof=1) + 1e-8)

    def _report(self, figures, clip):
        """The curves of SB3, from the figures of ``FusedTable.ppo_gradient`` of all minibatches."""
        policy_loss, value_loss, entropy, clipped, _ = figures.mean(axis=0).tolist()
        last = figures[-1]
        for name, value in {
            "entropy_loss": -entropy, "policy_gradient_loss": policy_loss, "value_loss": value_loss,
            "approx_kl": float(figures[-len(figures) // self.n_epochs :, 4].mean()), "clip_fraction": clipped,
            "loss": float(last[0] - self.ent_coef * last[2] + self.vf_coef * last[1]),
            "explained_variance": explained_variance(self.rollout_buffer.values.flatten(), self.rollout_buffer.returns.flatten()),
            "clip_range": clip,
        }.items():  # fmt: skip
            self.logger.record(f"train/{name}", value)
        self.logger.record("train/n_updates", self._n_updates, exclude="tensorboard")
