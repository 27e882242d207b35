"""How fast are whole steps? This measures the vector environment on one and two threads, and single tables.

It plays random actions on opened 22-ball tables. A step is one shot with everything around it (SAME_STEP: after the
end of a visit, a new one starts within the step, so every step has a shot). In frames, the agent plays alone from the
same tables. Steps per second are medians over the repeats, in which the kinds take turns, so that a busy machine slows
all equally. Compare the gain of two threads with the control, plain arithmetic on two threads at the same time.
"""

import threading
import time
from typing import Any

import gymnasium
import numba
import numpy as np
from gymnasium.vector import AutoresetMode

import snooker_env
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv

FRAMES, SINGLE_FRAME, GHOST = (
    "frames, one thread",
    "frames, single table",
    "frames against ghost_ball, one thread",
)
PLANAR, FLYING, FLIGHT = (
    "match, one thread",
    "match, balls fly, one thread",
    "balls that fly over balls that do not",
)
SLOWER, SINGLE_SLOWER = "a frame's step over a visit's", "the same on a single table"
SECONDS = 2.0
"""Duration of each timing [s]."""
SIZES = (1, 4, 16, 64, 256, 1024, 4096)


@numba.njit(nogil=True)
def _spin(n):
    x = 0.5
    for _ in range(n):
        x = np.sin(x) + 0.1
    return x


def control(n=3_000_000):
    """The gain of two threads over one in plain arithmetic."""
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
    """Steps of a table per second; ``step(k)`` plays all tables once."""
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


FORM: dict[str, Any] = {
    "aim": "absolute",
    "observation": "flat",
}  # measure the shot, not the solution of its aim
FRAME = {"task": "frame", "layout": "opened"}


def single(seed, **options):
    """``step(k)`` of one ``SnookerEnv``, with a reset after each end."""
    env = SnookerEnv(**FORM, **options)
    env.reset(seed=seed)
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, (1024, 4)).astype(np.float32)

    def step(k):
        _, _, terminated, truncated, _ = env.step(actions[k % 1024])
        if terminated or truncated:
            env.reset()

    step(0)
    return step


def native(n, threads, **options):
    """Make the vector environment of n tables."""
    return SnookerVectorEnv(n, threads=threads, autoreset_mode=AutoresetMode.SAME_STEP, **FORM, **options)


def rates(tables, seconds, repeats, seed):
    """Medians of steps per second of every kind, with the kinds taking turns."""
    mode = {"autoreset_mode": AutoresetMode.SAME_STEP}
    sync = gymnasium.make_vec("Snooker-v0", 16, vectorization_mode="sync", vector_kwargs=mode, **FORM)
    kinds = {
        "one thread": (stepper(native(tables, 1), seed), tables),
        "two threads": (stepper(native(tables, 2), seed), tables),
        "SyncVectorEnv, 16 tables": (stepper(sync, seed), 16),
        "single table": (single(seed), 1),
        FRAMES: (stepper(native(tables, 1, **FRAME), seed), tables),
        SINGLE_FRAME: (single(seed, **FRAME), 1),
        PLANAR: (stepper(native(tables, 1, physics="match"), seed), tables),
        FLYING: (stepper(native(tables, 1, physics={"preset": "match", "flight": True}), seed), tables),
        GHOST: (stepper(native(tables, 1, opponent="ghost_ball", **FRAME), seed), tables),
    }
    rounds = [
        {name: rate(step, n, seconds) for name, (step, n) in kinds.items()} | {"control": control()}
        for _ in range(repeats)
    ]
    out = {name: float(np.median([r[name] for r in rounds])) for name in rounds[0]}
    slower = (
        (SLOWER, FRAMES, "one thread"),
        (SINGLE_SLOWER, SINGLE_FRAME, "single table"),
        (FLIGHT, FLYING, PLANAR),
    )
    for name, one, other in slower:
        out[name] = float(np.median([r[other] / r[one] for r in rounds]))
    out["two threads over one"] = float(np.median([r["two threads"] / r["one thread"] for r in rounds]))
    return out


def sizes(seconds, seed):
    """Steps per second on one thread by number of tables."""
    return {n: rate(stepper(native(n, 1), seed), n, seconds) for n in SIZES}


def show(found):
    """Print the figures."""
    r = found["rates"]
    print(f"random actions, opened 22-ball tables, {found['tables']} tables           steps/s")
    for name in list(r)[: list(r).index("control")]:
        print(f"  {name:<58}{r[name]:>9,.0f}")
    both, control = r["two threads over one"], r["control"]
    print(f"  two threads over one {both:.2f} (plain arithmetic on two threads over one: {control:.2f})")
    alone, single = r[SLOWER], r[SINGLE_SLOWER]
    print(
        f"  time of a frame's step, the agent alone, over a visit's: {alone:.2f}, on a single table {single:.2f}"
    )
    print(f"  time of a step where balls may fly over one where they may not: {r[FLIGHT]:.3f}")
    print("tables:  " + "".join(f"{n:>9}" for n in found["sizes"]))
    print("steps/s: " + "".join(f"{x:>9,.0f}" for x in found["sizes"].values()))


def measure(tables, repeats, seed):
    """Measure and print the figures, with ``tables`` at once."""
    snooker_env.warmup()
    found = {
        "tables": tables,
        "rates": rates(tables, SECONDS, repeats, seed),
        "sizes": sizes(SECONDS, seed),
    }
    show(found)
    return found
