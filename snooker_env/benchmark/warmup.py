"""How does one compile everything in advance? ``warmup`` calls each kernel of this package once; a command does it."""

import argparse
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._lib.cache import CACHE_FOLDER
from .._lib.command import exit_code
from .._lib.jit import ENTRIES, collecting_no_garbage, warming_up
from ..advice.room import room_for
from ..envs.snooker import SnookerEnv
from ..game.apply_ruling import settle_table
from ..game.balls import REDS_MASK
from ..game.frame import Frame
from ..game.in_hand import place_cue
from ..game.pots import pots as pots_of
from ..game.referee import Situation, Stroke, judge
from ..game.snookered import is_snookered
from ..planning import Planner, Position, Positions, clear_paths, pots, prospects_of
from ..planning.judges import VisitJudge
from ..planning.pot_geometry import obstructions
from ..planning.proposals import at_balls, over_cushions
from ..planning.worth import best_places, decide
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
        env, match = _play_environments()
        _ask_rules(env)
        _plan(env, match)


def _play_environments() -> tuple[SnookerEnv, SnookerEnv]:
    """Visits, frames against opponents, a match: the last frame, and the match."""
    env = SnookerEnv(action="discrete", conditions="drawn")
    env.reset(seed=0)
    env.action_masks()
    env.step(0)
    all_of_frames: Any = {"aim": "absolute", "placement": True, "says": ["decision"], "miss": "attempt"}
    env = SnookerEnv(task="frame", opponent="ghost_ball", **all_of_frames)
    for seed in range(3):  # in one of them the opponent breaks off
        env.reset(seed=seed)
        env.step([0.0] * 7)
    snookered = Position(cue=(0.0, 0.0), pink=(0.0, 1.0), black=(0.0, 0.5), on="pink")
    env.reset(seed=0, options={"position": snookered})
    env.step([0.0] * 7)
    for task in ("visit", "frame"):
        menu: Any = {"task": task, "action": "strokes", "observation": "strokes", "cue": "real"}
        env = SnookerEnv(**menu)
        env.reset(seed=0)
        env.action_masks()
        env.step(0)
    env = SnookerEnv(task="frame", game="shoot_out")
    env.reset(seed=0)
    env.step([0.0] * 4)
    for action in (0, [0.0] * 4):
        options: Any = {"opponent": "random", "action": "discrete" if action == 0 else "box"}
        env = SnookerEnv(task="frame", **options)
        for seed in range(3):
            env.reset(seed=seed)
            env.step(action)
    env.reset(seed=0, options={"breaker": 0})
    match = SnookerEnv(task="match", opponent="ghost_ball", says=["concede"])
    match.reset(seed=0)
    match.step([0.0] * 4 + [-1.0])
    return env, match


def _ask_rules(env: SnookerEnv) -> None:
    """The referee, and what rules ask of a table."""
    frame = Frame.start()
    frame.play(Stroke())
    frame.concede(0)
    frame.needs_snookers(0)
    pots_of(env.positions, env.on_table, REDS_MASK)
    place_cue(env.positions, env.on_table, 0.0, 0.0)
    settle_table(env.positions, env.on_table, Situation(), Stroke())
    judge(Situation(), Stroke())
    is_snookered(env.positions, env.on_table, REDS_MASK)


def _plan(env: SnookerEnv, match: SnookerEnv) -> None:
    """Planning, players and advice."""
    env.reset(seed=0)
    at, both, planner = Positions.of(env), Positions.of(match), Planner({"action": "discrete"})
    planner.play(at, [0], [0])
    planner.pot_aim(at, [0], [1], [(0.0, 0.0)], 1.0)
    Planner({"noise": "club"}).play_strokes(at, [0], [[1.0, 0.0, 0.0, 0.0, 0.0]], [0])
    obstructions(at, np.zeros(1, np.int64), np.zeros((1, 2)), np.ones((1, 2)), np.zeros((1, 1), np.int64))
    room_for(np.zeros(5), at, Options(cue="real").rules)
    prospects_of(at, Spread(1e-3))
    chance_at(1.0, 1.0, Spread(1e-3))
    player("ghost_ball").at({"task": "frame"}).play(both, [0])
    player(_Still(task="frame", says=["decision"])).at({"task": "frame"}).play(both, [0])
    for name in ("search_30", "planner_30", "stroke_value"):
        player(name).at({"noise": "club"}).play(at, [0])
    for name in ("tactician_30", "stroke_value"):
        player(name).at({"task": "frame", "noise": "club", "miss": "clear_path"}).play(both, [0])
    decide(lambda some: np.zeros(len(some)), both)
    best_places(lambda some: np.zeros(len(some)), both)
    for generate in (at_balls, over_cushions):
        generate(VisitJudge({"noise": "club"}), at, 1, np.zeros(1, np.int64))
    for call in (pots, clear_paths, Positions.observations, lambda batch: batch.balls_on):
        call(at)


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
