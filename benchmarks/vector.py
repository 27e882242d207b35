"""How fast are whole steps, and what are they spent on? The vector environment on one and two threads, single
tables, and PPO's split.

    python -m benchmarks.vector [--seconds 2] [--repeats 5] [--tables 1024] [--seed 0] [--only-cue]
    [--json FILE] [--out FOLDER]

Random actions on opened 22-ball tables; a step is one shot with everything around it (SAME_STEP: a visit that
ends is followed by a new one within the step, so every step holds a shot). Frames: the agent plays alone,
from the same tables. Steps a second are medians over ``--repeats`` rounds in which the kinds take turns, so
that a busy machine slows all alike. Outside the engine: the same shots, from the same strikes, by the
engine's kernel alone, and what is left of the step. A real cue: the time of a step over that with a free cue,
neighbouring steps; ``--only-cue`` measures nothing else. Threads: what two threads give must be read against the
control, plain arithmetic on two threads at the same time.
"""

import threading
import time
from typing import Any

import gymnasium
import numba
import numpy as np
from gymnasium.vector import AutoresetMode

import snooker_env
from commands import provenance
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.tasks import STROKES, stroke
from snooker_env.tasks.stroke import ShotBuffers

from ._common.command import Command, at_least, run, save_json

FRAMES, SINGLE_FRAME, GHOST = (
    "frames, one thread",
    "frames, single table",
    "frames against ghost_ball, one thread",
)
SLOWER, SINGLE_SLOWER = "a frame's step over a visit's", "the same on a single table"
SIZES = (1, 4, 16, 64, 256, 1024, 4096)


@numba.njit(nogil=True)
def _spin(n):
    x = 0.5
    for _ in range(n):
        x = np.sin(x) + 0.1
    return x


def control(n=3_000_000):
    """How many times as much plain arithmetic two threads do in the time of one."""
    _spin(1)
    times = []
    for count in (1, 2):
        threads = [threading.Thread(target=_spin, args=(n,)) for _ in range(count)]
        start = time.perf_counter()
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        times.append(time.perf_counter() - start)
    return 2.0 * times[0] / times[1]


def rate(step, tables, seconds):
    """Steps of a table a second; ``step(k)`` plays all tables once."""
    start, k = time.perf_counter(), 0
    while True:
        step(k)
        k += 1
        took = time.perf_counter() - start
        if took >= seconds:
            return k * tables / took


def stepper(env, seed):
    """``step(k)`` of a vector environment with random actions, drawn beforehand."""
    env.reset(seed=seed)
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, (16, *env.action_space.shape)).astype(np.float32)
    env.step(actions[0])
    return lambda k: env.step(actions[k % 16])


FRAME = {"task": "frame", "layout": "opened"}


def single(seed, **options):
    """``step(k)`` of one ``SnookerEnv``, with a reset after each end."""
    env = SnookerEnv(**options)
    env.reset(seed=seed)
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, (1024, 4)).astype(np.float32)

    def step(k):
        _, _, terminated, truncated, _ = env.step(actions[k % 1024])
        if terminated or truncated:
            env.reset()

    step(0)
    return step


def native(n, threads, **options):
    """The vector environment of n tables."""
    return SnookerVectorEnv(n, threads=threads, autoreset_mode=AutoresetMode.SAME_STEP, **options)


def rates(tables, seconds, repeats, seed):
    """Medians of steps a second of every kind, the kinds taking turns."""
    mode = {"autoreset_mode": AutoresetMode.SAME_STEP}
    sync = gymnasium.make_vec("Snooker-v0", 16, vectorization_mode="sync", vector_kwargs=mode)
    kinds = {
        "one thread": (stepper(native(tables, 1), seed), tables),
        "two threads": (stepper(native(tables, 2), seed), tables),
        "SyncVectorEnv, 16 tables": (stepper(sync, seed), 16),
        "single table": (single(seed), 1),
        FRAMES: (stepper(native(tables, 1, **FRAME), seed), tables),
        SINGLE_FRAME: (single(seed, **FRAME), 1),
        GHOST: (stepper(native(tables, 1, opponent="ghost_ball", **FRAME), seed), tables),
    }
    rounds = [
        {name: rate(step, n, seconds) for name, (step, n) in kinds.items()} | {"control": control()}
        for _ in range(repeats)
    ]
    out = {name: float(np.median([r[name] for r in rounds])) for name in rounds[0]}
    for name, one, other in ((SLOWER, FRAMES, "one thread"), (SINGLE_SLOWER, SINGLE_FRAME, "single table")):
        out[name] = float(np.median([r[other] / r[one] for r in rounds]))
    out["two threads over one"] = float(np.median([r["two threads"] / r["one thread"] for r in rounds]))
    return out


class Recorded:
    """Notes what the engine is given, so that the same shots can be played by it alone."""

    def __init__(self):
        self.original, self.shots = stroke.run, []

    def __enter__(self):
        def run(buffers, m, rules, phys):
            self.shots.append([a[:m].copy() for a in (buffers.r, buffers.v, buffers.w, buffers.here)])
            self.original(buffers, m, rules, phys)

        setattr(stroke, "run", run)  # noqa: B010 - a type checker must not think that it is always so
        return self

    def __exit__(self, *_):
        setattr(stroke, "run", self.original)  # noqa: B010


def outside(tables, repeats, seed):
    """Microseconds of a step, of the same shots by the engine alone, and the share outside it; medians of
    neighbouring timings."""
    env = native(tables, 1)
    step, pairs = stepper(env, seed), []
    for k in range(1, repeats + 1):
        visits = env.tables
        before = [a.copy() for a in (visits.positions, visits.on_table, visits.game, visits.streams)]
        with Recorded() as recorded:
            step(k)
        for a, old in zip(
            (visits.positions, visits.on_table, visits.game, visits.streams), before, strict=True
        ):
            a[:] = old
        work = ShotBuffers(len(recorded.shots[0][0]))
        engine = 0.0
        for shots in recorded.shots:
            for target, source in zip((work.r, work.v, work.w, work.here), shots, strict=True):
                target[: len(source)] = source
            start = time.perf_counter()
            stroke.run(work, len(shots[0]), visits.rules, visits.phys)
            engine += time.perf_counter() - start
        start = time.perf_counter()
        step(k)
        whole = time.perf_counter() - start
        pairs.append((whole / tables * 1e6, engine / tables * 1e6, 1.0 - engine / whole))
    step_us, engine_us, share = np.median(pairs, axis=0).tolist()
    return {"step [us]": step_us, "engine alone [us]": engine_us, "outside the engine": share}


CUES = {
    "aim target": {"aim": "target"},
    "discrete": {"action": "discrete"},
    "masked": {"action": "discrete", "observation": "masked"},
}


def real_cue(tables, repeats, seed):
    """By kind of action: the time of a step with ``cue="real"`` over that with "free", median of neighbours.
    Processor time: other processes of a busy machine do not count."""
    found = {}
    for name, options in CUES.items():
        free, real = (native(tables, 1, cue=cue, **options) for cue in ("free", "real"))
        rng, ratios = np.random.default_rng(seed), []
        for env in (free, real):
            env.reset(seed=seed)
        for k in range(8 * repeats + 1):
            took = []
            actions: Any = rng.integers(0, STROKES, tables)
            if name == "aim target":
                actions = rng.uniform(-1.0, 1.0, (tables, 4)).astype(np.float32)
            for env in (free, real) if k % 2 else (real, free):
                start = time.process_time()
                env.step(actions)
                took.append(time.process_time() - start)
            if k:  # the first step compiles
                ratios.append(took[1] / took[0] if k % 2 else took[0] / took[1])
        found[name] = float(np.median(ratios))
    return found


def sizes(seconds, seed):
    """Steps a second on one thread by number of tables."""
    return {n: rate(stepper(native(n, 1), seed), n, seconds) for n in SIZES}


def ppo(steps, envs, seed):
    """Seconds that PPO spends in the environment, in its updates and in the rest, for ``steps`` shots; None
    without SB3."""
    try:
        import torch
        from stable_baselines3 import PPO

        from snooker_env.sb3 import SnookerVecEnv
    except ImportError:
        return None
    torch.set_num_threads(1)
    spent = {"environment": 0.0, "update": 0.0, "whole": 0.0}

    class Timed(SnookerVecEnv):
        def step_wait(self):
            start = time.perf_counter()
            out = super().step_wait()
            spent["environment"] += time.perf_counter() - start
            return out

    class TimedPPO(PPO):
        def train(self):
            start = time.perf_counter()
            super().train()
            spent["update"] += time.perf_counter() - start

    tables = Timed(envs, aim="target", threads=1)
    model = TimedPPO(
        "MlpPolicy",
        tables,
        n_steps=max(8, 2048 // envs),
        batch_size=256,
        n_epochs=10,
        seed=seed,
        device="cpu",
    )
    start = time.perf_counter()
    model.learn(steps)
    spent["whole"] = time.perf_counter() - start
    spent["policy and bookkeeping"] = spent["whole"] - spent["environment"] - spent["update"]
    return {"shots": model.num_timesteps, "tables": envs, **spent}


def show(found):
    """Print the figures."""
    for name, ratio in found["real cue"].items():
        print(f"a step with a real cue over one with a free cue, {name + ':':<12}{ratio:5.2f}")
    if "rates" not in found:
        return
    r, o = found["rates"], found["outside"]
    print(f"\nrandom actions, opened 22-ball tables, {found['tables']} tables           steps/s")
    for name in (
        "one thread",
        "two threads",
        "SyncVectorEnv, 16 tables",
        "single table",
        FRAMES,
        SINGLE_FRAME,
        GHOST,
    ):
        print(f"  {name:<58}{r[name]:>9,.0f}")
    print(
        f"  two threads over one {r['two threads over one']:.2f} (plain arithmetic on two threads over one: {r['control']:.2f})"
    )
    print(
        f"  time of a frame's step, the agent alone, over a visit's: {r[SLOWER]:.2f}, on a single table {r[SINGLE_SLOWER]:.2f}"
    )
    share = 100 * o["outside the engine"]
    print(
        f"a step {o['step [us]']:.1f} us, the engine alone {o['engine alone [us]']:.1f} us: {share:.1f} % outside it"
    )
    print("tables:  " + "".join(f"{n:>9}" for n in found["sizes"]))
    print("steps/s: " + "".join(f"{x:>9,.0f}" for x in found["sizes"].values()))
    for p in found["ppo"] or ():
        parts = ", ".join(
            f"{name} {100 * p[name] / p['whole']:.0f} %"
            for name in ("environment", "policy and bookkeeping", "update")
        )
        print(f"PPO, {p['tables']:>3} tables, one thread: {p['shots'] / p['whole']:,.0f} shots/s: {parts}")


def main():
    """Command line."""
    parser = Command("vector", __doc__, seed=0)
    parser.add_argument("--seconds", type=float, default=2.0, help="of each timing")
    parser.add_argument("--repeats", type=at_least(1), default=5)
    parser.add_argument("--tables", type=at_least(1), default=1024)
    parser.add_argument("--ppo-steps", type=at_least(1), default=16384)
    parser.add_argument("--only-cue", action="store_true", help="only the cost of a real cue")
    args = parser.options()
    snooker_env.warmup()
    found = {
        "machine": provenance.machine(),
        "tables": args.tables,
        "real cue": real_cue(args.tables, args.repeats, args.seed),
    }
    found |= (
        {}
        if args.only_cue
        else {
            "rates": rates(args.tables, args.seconds, args.repeats, args.seed),
            "outside": outside(args.tables, 4 * args.repeats, args.seed),
            "sizes": sizes(args.seconds, args.seed),
            "ppo": [p for p in (ppo(args.ppo_steps, n, args.seed) for n in (16, 64)) if p],
        }
    )
    show(found)
    save_json(args.json, found)


if __name__ == "__main__":
    run(main)
