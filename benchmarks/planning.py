"""What does planning cost beside the kernels? ``Planner.play`` against the same kernel calls alone, on arrays
that are there already.

    python -m benchmarks.planning [--strokes 1000] [--repeats 15] [--cue 0] [--seed 0] [--json FILE]
    [--out FOLDER]

Strokes on opened 22-ball tables under professional noise, one thread. The calls that ``play`` makes of
compiled kernels (address, engine, referee) are noted, and then repeated from the same state without anything
in between. Both take turns; the overhead is the median of the ratios of neighbours. One position: all strokes
are played on it, as a search does; many: each on its own.

With ``--cue N`` instead: what is the room of a cue worth? The player ``planner`` on N held-out tables under a
professional's errors: with a free cue; with a real one, for which it plans; with a real one, while it plans for a
free one. Points a visit, and the share of the strokes meant that need a cue raised above 5, 10, 20 degrees.
"""

import time
from dataclasses import replace

import numpy as np

import snooker_env as sn
from snooker_env._lib.jit import ENTRIES
from snooker_env.benchmark import play_visits
from snooker_env.physics import engine
from snooker_env.planning import Planner, Positions
from snooker_env.planning.trials import NO_NOISE, TrialVisits
from snooker_env.players.search import SearchPlayer
from snooker_env.tasks import stroke, visit

from ._common.command import Command, at_least, run, save_json


class Noted:
    """Notes which kernels are called from Python while it lasts, with what; ``again`` repeats the calls from
    where they began."""

    def __init__(self):
        self._calls, self._before, self._kernels = [], {}, []

    def __enter__(self):
        known = set(map(id, ENTRIES))
        for module in (stroke, visit, engine):
            for name, kernel in list(vars(module).items()):
                if id(kernel) in known:
                    self._kernels.append((module, name, kernel))
                    setattr(module, name, self._noting(kernel))
        return self

    def _noting(self, kernel):
        def call(*arguments):
            for a in arguments:
                base = a if not isinstance(a, np.ndarray) or a.base is None else a.base
                if isinstance(base, np.ndarray) and base.flags.writeable and id(base) not in self._before:
                    self._before[id(base)] = base, base.copy()  # as it is before any kernel has seen it
            self._calls.append((kernel, arguments))
            return kernel(*arguments)

        return call

    def __exit__(self, *_):
        for module, name, kernel in self._kernels:
            setattr(module, name, kernel)

    def again(self):
        """Seconds that the calls take, one after the other."""
        for base, before in self._before.values():
            base[...] = before
        start = time.perf_counter()
        for kernel, arguments in self._calls:
            kernel(*arguments)
        return time.perf_counter() - start


def measured(planner, at, rows, actions, keys, repeats):
    """Median microseconds a stroke by ``play`` and by the kernels alone, and the median overhead."""
    with Noted() as noted:
        # the kernels repeated write over it
        first = planner.play(at, rows, actions, keys).observations.copy()
    pairs = []
    for _ in range(repeats):
        alone = noted.again()
        start = time.perf_counter()
        outcomes = planner.play(at, rows, actions, keys)
        pairs.append((time.perf_counter() - start, alone))
    assert np.array_equal(first, outcomes.observations)
    whole, alone = np.array(pairs).T
    us = 1e6 / len(rows)
    return {
        "play_us": us * float(np.median(whole)),
        "kernels_us": us * float(np.median(alone)),
        "overhead": float(np.median(whole / alone)) - 1.0,
    }


def figures(strokes, repeats, seed=0):
    """Of every kind: name -> ``measured``."""
    rng, found = np.random.default_rng(seed), {}
    for kind in ("box", "discrete"):
        env = sn.SnookerVectorEnv(strokes, action=kind, noise="professional")
        env.reset(seed=seed)
        planner, at = Planner(env, threads=1), Positions.of(env)
        keys = rng.integers(0, 2**64 - 1, strokes, dtype=np.uint64)
        actions = rng.uniform(-1.0, 1.0, (strokes, 4)) if kind == "box" else rng.integers(0, 135, strokes)
        for where, rows in (
            ("many positions", np.arange(strokes)),
            ("one position", np.zeros(strokes, np.int64)),
        ):
            found[f"{kind} actions, {where}"] = measured(planner, at, rows, actions, keys, repeats)
    return found


ABOVE = (5.0, 10.0, 20.0)
"""Elevations of the cue [deg] whose shares are printed."""
CUES = {"free": ("free", "free"), "real": ("real", "real"), "real, planned as free": ("real", "free")}
"""The cue that plays, and the one that is planned for."""


class Noting(SearchPlayer):
    """``planner``, which plans for the cue ``planned`` and notes the elevation [deg] that each stroke needs."""

    def __init__(self, planned):
        super().__init__("planner")
        self.planned, self.needed = planned, []

    def _bind(self, options):
        super()._bind(options.but(cue=self.planned))
        self._real = replace(options.but(cue="real").rules, noise=NO_NOISE)

    def play(self, positions, seeds):
        chosen, at = super().play(positions, seeds), Positions.of(positions).as_visits().copy()
        trial, shots = TrialVisits(self._real, 0), stroke.ShotBuffers(len(at), 0)
        trial.lay(at, np.zeros((len(at), 2), np.uint64), np.zeros((len(at), 5)))
        trial.address(np.arange(len(at)), chosen.values, shots)
        self.needed.append(np.degrees(shots.shots[:, stroke.ELEVATION]))
        return chosen


def worth_of_room(tables, seed):
    """By how it is planned and played: points a visit, their standard error, strokes, shares above ``ABOVE``."""
    found = {}
    for name, (played, planned) in CUES.items():
        player = Noting(planned)
        log = play_visits(player, tables, cue=played, seed=seed)
        points, needed = log.a_visit(log.points), np.concatenate(player.needed)
        found[name] = {
            "points": float(points.mean()),
            "error": float(points.std(ddof=1) / np.sqrt(tables)) if tables > 1 else 0.0,
            "strokes": len(needed),
            "above": {str(least): float((needed > least).mean()) for least in ABOVE},
        }
        shares = ", ".join(
            f"{100 * found[name]['above'][str(least)]:.1f} % above {least:.0f}" for least in ABOVE
        )
        figures = f"{found[name]['points']:6.1f} +- {found[name]['error']:.1f} points a visit"
        print(f"cue {name + ':':23s} {figures}, {len(needed)} strokes, {shares} degrees", flush=True)
    return found


def main():
    """Measure and print."""
    parser = Command("planning", __doc__, seed=0)
    parser.add_argument("--strokes", type=at_least(1), default=1000, help="strokes a call [1000]")
    parser.add_argument("--repeats", type=at_least(1), default=15, help="pairs of runs [15]")
    parser.add_argument("--cue", type=at_least(0), default=0, metavar="N", help="held-out tables [0: none]")
    args = parser.options()
    if args.cue:
        save_json(args.json, worth_of_room(args.cue, args.seed))
        return 0
    found = figures(args.strokes, args.repeats, args.seed)
    print(f"{args.strokes} strokes a call, one thread; us a stroke")
    for name, f in found.items():
        print(
            f"{name:32s} play {f['play_us']:6.1f}   kernels {f['kernels_us']:6.1f}   overhead {100 * f['overhead']:+5.1f} %"
        )
    save_json(args.json, found)
    return 0


if __name__ == "__main__":
    run(main)
