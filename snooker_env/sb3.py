"""How does Stable-Baselines3 train on many tables? ``SnookerVecEnv``, on the native vector environment.

from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy
MaskablePPO(StrokesPolicy, SnookerVecEnv(128, action="strokes", observation="strokes"), n_steps=32).learn(100_000)"""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

try:
    import torch
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.policies import ActorCriticPolicy
    from stable_baselines3.common.vec_env import VecEnv
    from stable_baselines3.dqn.policies import DQNPolicy, QNetwork
except ModuleNotFoundError as error:
    if (error.name or "").split(".")[0] not in ("torch", "stable_baselines3"):
        raise
    from ._lib.install import missing

    raise missing("snooker_env.sb3 needs Stable-Baselines3", "train") from error

try:
    from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy

    _ActorCritic: Any = MaskableActorCriticPolicy
except ModuleNotFoundError as error:
    if (error.name or "").split(".")[0] != "sb3_contrib":
        raise
    _ActorCritic = ActorCriticPolicy

from ._lib.check import choice, integer, refuse, refuse_what
from ._lib.types import Bools, Floats, Ints, Observation, Singles
from .envs.vector import SnookerVectorEnv
from .tasks.observations import STROKE_SIZE
from .tasks.stroke_menu import speeds_of

__all__ = ["SnookerVecEnv", "StrokesPolicy", "StrokesQPolicy"]


class SnookerVecEnv(VecEnv):
    """Many tables as a ``VecEnv`` of Stable-Baselines3.

    A step that ends an episode starts the next one. Its info holds ``terminal_observation``,
    ``TimeLimit.truncated`` and, as from a ``Monitor`` around each table, ``episode`` with the return "r", the
    length "l" and the time "t" [s]. Other entries are left out for speed, unless ``info_keys`` names them.

    Parameters
    ----------
    num_envs, **kwargs
        As in ``SnookerVectorEnv``, without ``autoreset_mode``.
    seed : int, optional
        Table k begins with seed + k, as after ``seed(seed)``. Default None: random.
    info_keys : sequence of str, optional
        Keys of the environment's info to include; default none.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.sb3 import SnookerVecEnv
    >>> tables = SnookerVecEnv(4, seed=1, noise="club", threads=1)
    >>> observations = tables.reset()
    >>> observations, rewards, dones, infos = tables.step(np.zeros((4, 4), np.float32))
    >>> observations.shape, rewards.dtype.name, len(infos)
    ((4, 61), 'float32', 4)
    """

    def __init__(
        self, num_envs: int, *, seed: int | None = None, info_keys: Sequence[str] = (), **kwargs: Any
    ):
        if seed is not None:
            seed = integer("seed", seed, 0, 2**63 - 1)
        if "autoreset_mode" in kwargs:
            words = "must be left out: Stable-Baselines3 needs SAME_STEP"
            raise refuse("autoreset_mode", kwargs["autoreset_mode"], words)
        self.tables: SnookerVectorEnv = SnookerVectorEnv(
            num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **kwargs
        )
        known = (*self.tables.tables.reals, *self.tables.tables.COUNTS, "foul")
        self.info_keys: tuple[str, ...] = tuple(choice("info_keys", key, known) for key in info_keys)
        super().__init__(num_envs, self.tables.single_observation_space, self.tables.single_action_space)
        self.metadata = self.tables.metadata
        self._actions: Any = None
        # rewards and steps so far: no state of a table holds them, save them with it
        self.episode_returns: Floats = np.zeros(num_envs)
        self.episode_lengths: Ints = np.zeros(num_envs, np.int64)
        self._start = time.time()
        if seed is not None:
            self.seed(seed)

    def reset(self) -> Observation:
        """Begin new episodes on all tables, with the seeds and options set before; returns the observations.

        ``set_options([{"state": ...}, ...])``, or "position" or "breaker": one for each table. Of a state's
        random stream and a seed, the seed holds. ValueError if the options differ in kind, or are invalid."""
        options = None
        if any(self._options):
            key = next((key for key in ("position", "breaker") if key in self._options[0]), "state")
            for k, each in enumerate(self._options):
                if set(each) != {key}:
                    words = "alone, the same for each table, or nothing for all"
                    allowed = f'must be "state", "position" or "breaker" {words}'
                    raise refuse(f"keys of options[{k}]", list(each), allowed)
            options = {key if key == "breaker" else f"{key}s": [each[key] for each in self._options]}
        observation, info = self.tables.reset(seed=self._seeds, options=options)
        self.reset_infos = [{key: info[key][k] for key in self.info_keys} for k in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        self.episode_returns[:], self.episode_lengths[:] = 0.0, 0
        return observation

    def step_async(self, actions: Any) -> None:
        """Store the actions that ``step_wait`` plays: float (num_envs, k), or choices, int (num_envs,)."""
        self._actions = actions

    def step_wait(self) -> tuple[Observation, Singles, Bools, list[dict[str, Any]]]:
        """Play the stored actions: observations, rewards float32 (n,), dones bool (n,), infos."""
        observation, rewards, terminated, truncated, info = self.tables.step(self._actions)
        done = terminated | truncated
        self.episode_returns += rewards
        self.episode_lengths += 1
        infos = [{} for _ in range(self.num_envs)]
        for key in self.info_keys:
            values = np.where(done, info["final_info"][key], info[key]) if "final_info" in info else info[key]
            for each, value in zip(infos, values.tolist(), strict=True):
                each[key] = value
        now = round(time.time() - self._start, 6)
        for k in np.flatnonzero(done).tolist():
            total, length = round(float(self.episode_returns[k]), 6), int(self.episode_lengths[k])
            infos[k]["episode"] = {"r": total, "l": length, "t": now}
            infos[k]["terminal_observation"] = info["final_obs"][k]
            infos[k]["TimeLimit.truncated"] = bool(truncated[k] and not terminated[k])
        self.episode_returns[done], self.episode_lengths[done] = 0.0, 0
        return observation, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """End the threads."""
        self.tables.close()

    def get_images(self) -> Sequence[Any]:
        """Return a picture of each table, uint8 (H, W, 3), with ``render_mode="rgb_array"``."""
        return self.tables.render()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Read what all tables share, or "np_random" or "np_random_seed" of each; AttributeError if there is none."""
        name = f"single_{attr_name}" if attr_name in ("observation_space", "action_space") else attr_name
        value, rows = getattr(self.tables, name), self._get_indices(indices)
        return [value[k] if name in ("np_random", "np_random_seed") else value for k in rows]

    def set_attr(self, attr_name: str, value: object, indices: object = None) -> None:
        """Refuse with AttributeError: the tables share everything. Make another ``SnookerVecEnv`` instead."""
        words = "the tables share everything; make another SnookerVecEnv"
        raise AttributeError(f"{attr_name} cannot be set: {words}")

    def env_method(
        self, method_name: str, *method_args: object, indices: Any = None, **method_kwargs: object
    ) -> list[Any]:
        """Call ``get_state`` or ``action_masks`` for some tables; ValueError for another method."""
        choice("method_name", method_name, ("get_state", "action_masks"))
        each = getattr(self.tables, method_name)()
        return [each[k] for k in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Return whether tables are wrapped: only as in a ``Monitor``, for each reports its episodes."""
        return [issubclass(wrapper_class, Monitor) for _ in self._get_indices(indices)]


HIDDEN = 64  # units of each of the two layers that read a stroke, and of the one that reads the position
_AWAY = -1e8  # the score of a stroke that is not there


class _StrokesNet(torch.nn.Module):
    """Reads ``observation="strokes"``, (b, K * C + S) float32: each stroke alike with the state, then all that are there."""

    def __init__(self, choices: int, size: int):
        super().__init__()
        self.choices, self.columns = choices, size // choices
        state = size - choices * self.columns
        self.of_stroke = torch.nn.Linear(self.columns, HIDDEN)
        self.of_state = torch.nn.Linear(state, HIDDEN, bias=False)
        self.second = torch.nn.Linear(HIDDEN, HIDDEN)
        self.score = torch.nn.Linear(HIDDEN, 1)
        self.position = torch.nn.Linear(2 * HIDDEN + state, HIDDEN)
        self.latent_dim_pi, self.latent_dim_vf = choices, HIDDEN
        for layer in (self.of_stroke, self.of_state, self.second, self.position):
            torch.nn.init.orthogonal_(layer.weight, 2.0**0.5)
        torch.nn.init.orthogonal_(self.score.weight, 0.01)

    def read(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """The features of each stroke (b, K, HIDDEN), whether it is there (b, K), and the state (b, S)."""
        strokes = seen[:, : self.choices * self.columns].view(-1, self.choices, self.columns)
        state = seen[:, self.choices * self.columns :]
        first = torch.tanh(self.of_stroke(strokes) + self.of_state(state)[:, None])
        return torch.tanh(self.second(first)), strokes[..., 0] > 0.5, state

    def logits(self, made: torch.Tensor, there: torch.Tensor) -> torch.Tensor:
        """The scores (b, K) of the strokes that are there."""
        return torch.where(there, self.score(made)[..., 0], _AWAY)

    def judge(self, made: torch.Tensor, there: torch.Tensor, state: torch.Tensor) -> torch.Tensor:
        """The features of positions (b, HIDDEN)."""
        here = there[..., None]
        mean = (made * here).sum(1) / here.sum(1).clamp(min=1)
        most = torch.where(here, made, -1.0).amax(1)
        return torch.tanh(self.position(torch.cat([mean, most, state], 1)))

    def forward(self, features: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Logits of the strokes (b, K), and the features of positions (b, HIDDEN)."""
        made, there, state = self.read(features)
        return self.logits(made, there), self.judge(made, there, state)

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """The logits alone."""
        return self.logits(*self.read(features)[:2])

    def forward_critic(self, features: torch.Tensor) -> torch.Tensor:
        """The features of positions alone."""
        return self.judge(*self.read(features))


def _net_of(observations: Any, actions: Any) -> _StrokesNet:
    """The network for an environment; ValueError for spaces of another one."""
    choices = int(getattr(actions, "n", 0))
    shape = observations.shape or (0,)
    menu = speeds_of(choices, False) or speeds_of(choices, True)
    if not menu or len(shape) != 1 or shape[0] // choices != STROKE_SIZE:
        allowed = 'must be those of action="strokes", observation="strokes"'
        raise refuse_what("spaces", f"{observations} and {actions}", allowed)
    return _StrokesNet(choices, shape[0])


class StrokesPolicy(_ActorCritic):
    """The policy of PPO and MaskablePPO for ``action="strokes", observation="strokes"``.

    One small network reads each stroke alike and gives its logit; the value comes from all strokes together and the state.
    A stroke that is not there is never chosen, by PPO neither. K and the columns come from the spaces.

    Parameters
    ----------
    *args, **kwargs
        As of the policies of PPO, or MaskablePPO of sb3-contrib, which give them. The network is fixed.
    use_sde : bool, optional
        Ignored: choices have no noise of their own.

    Examples
    --------
    >>> from stable_baselines3 import PPO
    >>> from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy
    >>> tables = SnookerVecEnv(4, action="strokes", observation="strokes", seed=1, threads=1)
    >>> agent = PPO(StrokesPolicy, tables, n_steps=8, batch_size=32, device="cpu")
    """

    def __init__(self, *args: Any, use_sde: bool = False, **kwargs: Any):
        super().__init__(*args, **kwargs)

    def _build(self, lr_schedule: Any) -> None:
        """Make the network, in place of that of the base class, and its optimizer."""
        self.mlp_extractor = _net_of(self.observation_space, self.action_space)
        self.action_net, self.value_net = torch.nn.Identity(), torch.nn.Linear(HIDDEN, 1)
        self.optimizer = self.optimizer_class(self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs)


class _StrokesQ(QNetwork):
    def __init__(self, *args: Any, **kwargs: Any):
        super().__init__(*args, **kwargs)
        self.q_net = _net_of(self.observation_space, self.action_space)

    def forward(self, obs: Any) -> torch.Tensor:
        net = self.q_net
        return net.score(net.read(self.extract_features(obs, self.features_extractor))[0])[..., 0]


class StrokesQPolicy(DQNPolicy):
    """The policy of DQN for ``action="strokes", observation="strokes"``: the same network gives the value of each stroke.

    Examples
    --------
    >>> from stable_baselines3 import DQN
    >>> from snooker_env.sb3 import SnookerVecEnv, StrokesQPolicy
    >>> tables = SnookerVecEnv(4, action="strokes", observation="strokes", seed=1, threads=1)
    >>> agent = DQN(StrokesQPolicy, tables, learning_starts=8, buffer_size=1_000, device="cpu")
    """

    def make_q_net(self) -> QNetwork:
        """The network of the values of strokes."""
        its = self._update_features_extractor(self.net_args, features_extractor=None)
        return _StrokesQ(**its).to(self.device)
