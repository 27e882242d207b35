"""How does one compile everything in advance? ``warmup`` calls each kernel of this package once; a command does it."""

import argparse
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._lib.cache import CACHE_FOLDER
from .._lib.command import exit_code
from .._lib.jit import ENTRIES, collecting_no_garbage, warming_up
from ..advice.practice import room_for
from ..envs.snooker import SnookerEnv
from ..game.apply_ruling import settle_table
from ..game.balls import REDS_MASK
from ..game.frame import Frame
from ..game.in_hand import place_cue
from ..game.pots import pots as pots_of
from ..game.referee import Situation, Stroke
from ..game.snookered import is_snookered
from ..planning import Planner, Position, Positions
from ..planning.pot_geometry import obstructions
from ..planning.worth import best_places
from ..players import player
from ..progress import ticking
from ..simulation import simulate
from ..simulation.impacts import collide_balls, collide_cushion, strike
from ..tasks.noise import Spread
from ..tasks.options import Options
from ..tasks.pot_chance import chance_at


class _Still:
    """Sees observations and plays one stroke; with ``options`` of a frame it says something beside it."""

    def __init__(self, **options: Any):
        self.options = options

    def act(self, observations: Any, masks: Any, seeds: Any) -> list[list[float]]:
        """The same stroke for each observation."""
        return [[0.0] * (4 + len(self.options["says"]))] * len(seeds)


def warmup() -> None:
    """Compile every kernel of the package, or load it from the cache.

    Call it in the parent process before worker processes start; otherwise each worker compiles for itself.
    Progress is reported on stderr, on a terminal by a bar, unless everything comes from the cache or ``SNOOKER_ENV_QUIET=1`` is set.

    Examples
    --------
    >>> import snooker_env as sn
    >>> sn.warmup()  # doctest: +SKIP
    """
    kernels = [kernel for kernel in ENTRIES if kernel.__module__.startswith("snooker_env.")]
    with collecting_no_garbage(), ticking("compiling", "kernels") as tick, warming_up(kernels, tick):
        simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)]).at(0.1)
        strike(1.0, 0.0)
        collide_balls((1, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0))
        collide_cushion((1, 0, 0), (0, 0, 0), (1, 0, 0))
        _ask(_play())


def _play() -> SnookerEnv:
    """Visits, and frames against opponents, who break off in one of three; the last frame."""
    words: dict[str, Any] = {"aim": "absolute", "placement": True, "says": ["decision"], "miss": "attempt"}
    env = SnookerEnv(task="frame", opponent="ghost_ball", **words)
    snookered = Position(cue=(0.0, 0.0), pink=(0.0, 1.0), black=(0.0, 0.5), on="pink")
    env.reset(seed=0, options={"position": snookered})
    env.step([0.0] * 7)
    options: list[Any] = [{"action": "discrete", "conditions": "drawn"}]
    options += [{"action": "strokes", "observation": "strokes", "cue": "real"}]
    options += [{"task": "frame", "game": "shoot_out", "action": "discrete"}]
    options += [{"task": "frame", "opponent": "random", "action": "discrete"}]
    for some in options:
        env = SnookerEnv(**some)
        for seed in range(3):
            env.reset(seed=seed)
            env.action_masks()
            env.step(0)
    env.reset(seed=0, options={"breaker": 0})
    return env


def _ask(env: SnookerEnv) -> None:
    """The referee and the rules, planning, players and advice, about the table of a frame."""
    frame = Frame.start()
    frame.play(Stroke())
    frame.concede(0)
    frame.needs_snookers(0)
    pots_of(env.positions, env.on_table, REDS_MASK)
    place_cue(env.positions, env.on_table, 0.0, 0.0)
    settle_table(env.positions, env.on_table, Situation(), Stroke())
    is_snookered(env.positions, env.on_table, REDS_MASK)
    env.reset(seed=0)
    at = Positions.of(env)
    Planner({"action": "discrete"}).pot_aim(at, [0], [1], [(0.0, 0.0)], 1.0)
    Planner({"noise": "club"}).play_strokes(at, [0], [[1.0, 0.0, 0.0, 0.0, 0.0]], [0])
    obstructions(at, np.zeros(1, np.int64), np.zeros((1, 2)), np.ones((1, 2)), np.zeros((1, 1), np.int64))
    room_for(np.zeros(5), at, Options(cue="real").rules)
    chance_at(1.0, 1.0, Spread(1e-3))
    player(_Still(task="frame", says=["decision"])).at({"task": "frame"}).play(at, [0])
    for name in ("search_30", "planner_30", "stroke_value"):
        player(name).at({"noise": "club"}).play(at, [0])
    for name in ("tactician_30", "stroke_value"):
        player(name).at({"task": "frame", "noise": "club", "miss": "clear_path"}).play(at, [0])
    best_places(lambda some: np.zeros(len(some)), at)
    _ = at.balls_on


def main(argv: Sequence[str] | None = None) -> int:
    """Compile everything, and say how long it took and where the machine code is kept."""
    about = "Compile every kernel once (a minute or two) or load it from the cache (seconds), so that no later command has to wait."
    argparse.ArgumentParser("python -m snooker_env warmup", description=about).parse_args(argv)

    def compile_all() -> int:
        start = time.perf_counter()
        warmup()
        kept = f"is kept in {CACHE_FOLDER}" if CACHE_FOLDER else "is not kept: see the warning"
        print(f"Everything is ready after {time.perf_counter() - start:.0f} s. The machine code {kept}.")
        return 0

    return exit_code("error", compile_all)
