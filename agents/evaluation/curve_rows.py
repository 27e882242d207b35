"""What would a new user train? Algorithms of Stable-Baselines3 on each form of action, in a few lines of code each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from sb3_contrib import TQC, MaskablePPO
from stable_baselines3 import DQN, PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm

from snooker_env import SnookerVectorEnv
from snooker_env.benchmark.tasks import TASKS, tables_of
from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy, StrokesQPolicy

from ..learning.hyperparameters import Recipe

GAME: dict[str, Any] = {"noise": "professional", "cue": "real"}
FORMS: dict[str, dict[str, Any]] = {
    "pot": {},  # the default
    "strokes": {"action": "strokes", "observation": "strokes"},
    "target": {"aim": "target", "observation": "flat"},
    "absolute": {"aim": "absolute", "observation": "flat"},
}
"""Options of each form of action."""
SEEDS = 1000
"""Table k of training seed s begins with this times s, plus k; held-out tables begin with a million."""
MOST_STEPS = 20
"""Maximum steps of a one-stroke episode in a frame, where a player who fouls may have to play again."""


class Place(NamedTuple):
    """Where an agent is trained and evaluated: options of training, and the options that differ in the evaluation."""

    options: dict[str, Any]
    judged: dict[str, Any]
    shots: tuple[int, ...] = (100_000,)
    """The default numbers of shots after which the agent is evaluated."""

    @property
    def judged_options(self) -> dict[str, Any]:
        """All options of the evaluation."""
        return self.options | self.judged


def _one_stroke(task: str, **instead: str) -> Place:
    options = {**TASKS[task].changes, "observation": TASKS[task].observation}
    judged = {key: options[key] for key in instead} | {"layout": TASKS[task].judged_layout}
    return Place(options | instead, judged)


PLACES = {
    "visit": Place(GAME, {"layout": "held_out"}, (50_000, 200_000, 1_000_000)),
    "hard pot": Place(GAME | {"layout": "pots:hard", "one_stroke": True}, {}),
    "escape": _one_stroke("SnookerEscape-v0"),
    # the planner's 118 shots a decision are too slow to train against
    "safety": _one_stroke("SnookerSafety-v0", opponent="planner_20"),
}


@dataclass(frozen=True)
class Row:
    """What is trained: an algorithm with its settings (others at their defaults) on tables with a form of action."""

    form: str
    algorithm: type[BaseAlgorithm]
    tables: int | None
    """Number of tables in a ``SnookerVecEnv``; None: a single table of ``gymnasium.make``."""
    settings: Mapping[str, object] = field(default_factory=dict)
    policy: str | type = "MlpPolicy"
    place: str = "visit"

    @property
    def options(self) -> dict[str, Any]:
        """Options of the training tables."""
        return PLACES[self.place].options | FORMS[self.form]

    def code(self) -> str:
        """The row in Python, as a new user would write it."""
        made = ("gymnasium.make", '"snooker_env:Snooker-v0"')
        tables = _call(*(("SnookerVecEnv", str(self.tables)) if self.tables else made), **self.options)
        policy = f'"{self.policy}"' if isinstance(self.policy, str) else self.policy.__name__
        return _call(self.algorithm.__name__, policy, tables, **self.settings)

    def describe(self) -> dict[str, str]:
        """The description of the row in a file of points."""
        policy = "" if isinstance(self.policy, str) else f", {self.policy.__name__}"
        name = self.algorithm.__name__ + policy
        return {"place": self.place, "form": self.form, "algorithm": name, "code": self.code()}

    def agent(self, seed: int, threads: int | None) -> tuple[BaseAlgorithm, Any]:
        """The untrained agent of one training seed, and its tables."""
        if self.tables is None:
            tables = gymnasium.make("snooker_env:Snooker-v0", **self.options)
        else:
            tables = SnookerVecEnv(self.tables, threads=threads, **self.options)
        return self.new_agent(tables, SEEDS * seed), tables

    def new_agent(self, tables: Any, seed: int) -> BaseAlgorithm:
        """The untrained agent on these tables."""
        make: Any = self.algorithm
        return make(self.policy, tables, seed=seed, device="cpu", **self.settings)

    def judge(self, agent: BaseAlgorithm, visits: int, threads: int | None) -> np.ndarray:
        """The return of the deterministic policy in each held-out episode (visits,)."""

        def decide(seen: Any, tables: SnookerVectorEnv) -> np.ndarray:
            if isinstance(agent, MaskablePPO):
                return agent.predict(seen, deterministic=True, action_masks=tables.action_masks())[0]
            return agent.predict(seen, deterministic=True)[0]

        return play(self.options | PLACES[self.place].judged, decide, visits, threads)


def _call(name: str, *first: str, **more: object) -> str:
    """Write a call in Python."""
    keywords = [
        f'{key}="{value}"' if isinstance(value, str) else f"{key}={value}" for key, value in more.items()
    ]
    return f"{name}({', '.join([*first, *keywords])})"


def _recipe(name: str) -> dict[str, Any]:
    """Tables and settings of a recipe of train.py."""
    recipe = Recipe.of(name)
    return {"tables": recipe.n_envs, "settings": recipe.settings}


_SHORT = {"n_steps": 32}  # otherwise 64 tables collect 131,072 strokes before the first update
_OFF = {"gamma": 0.9, "gradient_steps": 4}  # SAC and TQC: four updates per stroke on each of 16 tables
# a million observations of the menu would need more than 11 GB
_DQN = {"gamma": 0.9, "train_freq": 1, "gradient_steps": 4, "buffer_size": 100_000}
ROWS = {
    "pot_ppo": Row("pot", PPO, 64, _SHORT),
    "pot_ppo_one": Row("pot", PPO, None),
    "pot_sac": Row("pot", SAC, 16, _OFF),
    "pot_tqc": Row("pot", TQC, 16, _OFF),
    "target_ppo": Row("target", PPO, 64, _SHORT),
    "absolute_ppo": Row("absolute", PPO, 64, _SHORT),
    "strokes_ppo": Row("strokes", PPO, 64, _SHORT),
    "strokes_dqn": Row("strokes", DQN, 16, _DQN),
    "strokes_dqn_policy": Row("strokes", DQN, 16, _DQN, StrokesQPolicy),
    "strokes_maskable": Row("strokes", MaskablePPO, **_recipe("strokes"), policy=StrokesPolicy),
    **{
        f"{place.replace(' ', '_')}_{name}": Row("pot", algorithm, tables, settings, place=place)
        for place in list(PLACES)[1:]
        for name, algorithm, tables, settings in (("ppo", PPO, 64, _SHORT), ("sac", SAC, 16, _OFF))
    },
}
"""Name -> what is trained."""


def play(
    options: dict[str, Any],
    decide: Callable[[Any, SnookerVectorEnv], np.ndarray],
    visits: int,
    threads: int | None = None,
) -> np.ndarray:
    """Play held-out episodes and return their sums of rewards (visits,). ``decide`` maps observations and tables to actions.

    Tables leave when their episode ends, because an opponent would otherwise continue on them."""
    seeds = tables_of(options["layout"], visits)
    sums, here, steps = np.zeros(visits), np.arange(visits), 0
    tables = SnookerVectorEnv(visits, threads=threads, **options)
    seen, _ = tables.reset(seed=[*seeds])
    while True:
        seen, rewards, terminated, truncated, _ = tables.step(decide(seen, tables))
        sums[here] += rewards
        going, steps = ~(terminated | truncated), steps + 1
        if options.get("task") == "frame" and steps == MOST_STEPS:  # states do not count steps
            going[:] = False
        if not going.all():
            states = [state for state, goes in zip(tables.get_state(), going, strict=True) if goes]
            tables.close()
            if not states:
                return sums
            here = here[going]
            tables = SnookerVectorEnv(len(here), threads=threads, **options)
            seen, _ = tables.reset(options={"states": states})


def play_nothing(place: str, visits: int, threads: int | None) -> np.ndarray:
    """The return of the action of zeros in each held-out episode."""
    return play(PLACES[place].judged_options, lambda seen, _: np.zeros((len(seen), 4)), visits, threads)
