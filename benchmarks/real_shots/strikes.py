"""Which strike makes a simulated shot follow a measured one? A search extends from the first contact to the whole shot.

The cost function is rough, because narrowly missing a ball changes everything that follows. A population of strikes
(differential evolution) is therefore fitted to the path up to the second contact, then up to the third, and so on to the
end. The best strike and others that differ are then refined (CMA-ES). Both are cheap: a strike takes 20 to 50 us.
"""

from itertools import pairwise

import numpy as np

from .cma import Cma
from .paths import ELEVATION, SIDE, SPEED, TOP, Judge

OTHERS = 0.1
"""Weight of the other balls' mean squared error relative to the cue ball's."""
MOST_ELEVATION = 0.6
SCALE = np.array([0.02, 0.004, 0.03, 0.03, 0.02, 0.002])
"""Steps of a strike that shift its path by a few centimetres; the step of the speed is relative."""
_QUOTIENT = 0.02
"""Step of the difference quotients of a path by its strike, in units of these steps."""


def _robust(squares, cap):
    return squares / (1.0 + squares / cap**2)


def costs(judge, strikes, horizon=np.inf, cap=1.0, others=OTHERS, **how):
    """The cost of strikes (b, 6): mean over the cue ball's samples of the squared distance d^2 / (1 + d^2/cap^2), and
    ``others`` times the same of the other balls."""
    squares = _robust(judge.squares(strikes, horizon, **how), cap)
    a = judge.offsets
    counted = judge.times <= horizon
    found = np.zeros(len(strikes))
    first = counted[: a[1]]
    found += squares[:, : a[1]] @ first / max(first.sum(), 1)
    rest = counted[a[1] :]
    found += others * (squares[:, a[1] :] @ rest) / max(rest.sum(), 1)
    return found


def bounds(shot, physics):
    """Lowest and highest strikes (6,) of the search, from the first samples; side and top also lie in a
    disc."""
    cue = shot.balls[0]
    first = shot.contacts[0][0] if shot.contacts else cue.t[-1]
    moving = cue.t >= shot.moved
    before = moving & (cue.t <= min(first - 0.005, shot.moved + 0.25))
    n = min(int(before.sum()), 6)
    t, xy = cue.t[moving][: max(n, 4)], cue.xy[moving][: max(n, 4)]
    if n >= 4:
        speed = np.hypot(*(xy[n - 1] - xy[0])) / (t[n - 1] - t[0])
        slowest, fastest, turn = 0.88 * speed, 1.12 * speed + 0.1, 0.03
    elif n == 3:
        speed = np.hypot(*(xy[2] - xy[0])) / (t[2] - t[0])
        slowest, fastest, turn = 0.8 * speed, 1.2 * speed + 0.1, 0.06
    else:  # another ball or a cushion is hit at once, so the samples after the hit bound the speed
        steps = np.hypot(*np.diff(xy, axis=0).T) / np.diff(t) if len(t) > 1 else np.array([1.0])
        slowest, fastest, turn = 0.6 * steps.max(), 2.2 * steps.max() + 0.3, 0.15
    gone = xy[max(n, 1) - 1] - shot.places[0]
    aim = np.arctan2(gone[1], gone[0])
    turn += 0.004 / max(np.hypot(*gone), 0.03)
    most = physics.max_offset
    low = np.array([slowest, aim - turn, -most, -most, 0.0, max(shot.still, shot.moved - 0.06)])
    return low, np.array([fastest, aim + turn, most, most, MOST_ELEVATION, shot.moved])


def clip(strikes, low, high):
    """Move strikes (b, 6) into the bounds, and tips on to the disc."""
    found = np.clip(strikes, low, high)
    offset = np.hypot(found[:, SIDE], found[:, TOP])
    most = high[SIDE]
    over = offset > most
    found[over, SIDE] *= most / offset[over]
    found[over, TOP] *= most / offset[over]
    return found


def _draw(rng, low, high, n):
    found = rng.uniform(low, high, (n, 6))
    radius, angle = high[SIDE] * np.sqrt(rng.uniform(0, 1, n)), rng.uniform(-np.pi, np.pi, n)
    found[:, SIDE], found[:, TOP] = radius * np.cos(angle), radius * np.sin(angle)
    found[:, ELEVATION] = np.minimum(rng.exponential(0.07, n), high[ELEVATION])
    return found


def horizons(shot):
    """Successive horizons of the fit [s]: shortly before each contact except the first, and the end."""
    times = [t for t, _ in shot.contacts]
    end = max(b.t[-1] for b in shot.balls)
    found = [max(b - 0.02, a + 0.05) for a, b in pairwise(times)]
    kept = []
    for h in found:
        if not kept or h > kept[-1] + 0.2:
            kept.append(h)
    return [*kept[:7], end]


def evolve(judge, rng, low, high, population=96, generations=12, first=5):
    """Fit a population of strikes with growing horizons: (population, 6) and their costs."""
    steps = horizons(judge.shot)
    pool = _draw(rng, low, high, first * population)
    cap = 0.15
    cost = costs(judge, pool, steps[0], cap, max_events=judge.events_until(pool[:48], steps[0]), fast=True)
    best = np.argsort(cost)[:population]
    pool, cost = pool[best], cost[best]
    for k, horizon in enumerate(steps):
        last = k == len(steps) - 1
        how = {"fast": True}
        if not last:
            how["max_events"] = judge.events_until(pool[:48], horizon)
        cap_now = 2 * cap if last else cap
        cost = costs(judge, pool, horizon, cap_now, **how)
        for _ in range(2 * generations if last else generations):
            n = len(pool)
            order = np.argsort(cost)
            leader = pool[order[rng.integers(0, max(n // 8, 2), n)]]
            a, b = pool[rng.integers(0, n, n)], pool[rng.integers(0, n, n)]
            f = rng.normal(0.6, 0.2, (n, 1))
            trial = pool + f * (leader - pool) + f * (a - b)
            trial += rng.normal(0, 0.02, (n, 6)) * SCALE
            keep = rng.uniform(size=(n, 6)) > 0.9
            trial = clip(np.where(keep, pool, trial), low, high)
            found = costs(judge, trial, horizon, cap_now, **how)
            better = found < cost
            pool[better], cost[better] = trial[better], found[better]
    return pool, cost


def refine(judge, rng, start, low, high, sigma=0.5, generations=40, population=16, cap=1.0, others=OTHERS):
    """Run CMA-ES from one strike. Returns the best strike (6,) and its cost."""
    scale = SCALE.copy()
    scale[SPEED] *= start[SPEED]
    best, best_cost = start.copy(), float(costs(judge, start[None], np.inf, cap, others)[0])
    search = Cma(rng, start, scale, sigma, population)
    for _ in range(generations):
        x = clip(search.ask(), low, high)
        cost = costs(judge, x, np.inf, cap, others)
        k = int(np.argmin(cost))
        if cost[k] < best_cost:
            best, best_cost = x[k].copy(), float(cost[k])
        search.tell(x, cost)
        if search.spread < 1e-5:
            break
    return best, best_cost


def weights(judge):
    """Weights of the samples, so that the sum of weighted squares equals the cost of ``costs``."""
    a = judge.offsets
    w = np.full(len(judge.times), OTHERS / max(a[-1] - a[1], 1))
    w[: a[1]] = 1.0 / a[1]
    return w


def settle_strike(judge, strike, steps=4):
    """Refine a strike by Gauss-Newton steps, each taken only if it lowers the cost. Returns strike and cost."""
    low, high = bounds(judge.shot, judge.physics)
    weight = np.repeat(weights(judge), 2)
    best, cost = strike, float(costs(judge, strike[None])[0])
    h = _QUOTIENT
    for _ in range(steps):
        around = np.concatenate([best + h * np.diag(SCALE), best - h * np.diag(SCALE), best[None]])
        found = judge.differences(around).reshape(len(around), -1)
        J, r = (found[:6] - found[6:12]).T / (2 * h), found[12]
        A, g = J.T @ (J * weight[:, None]), J.T @ (r * weight)
        tried = []
        for damping in (1e-3, 1e-1, 1.0, 10.0):
            B = A.copy()
            B[np.diag_indices(6)] += damping * np.diag(A) + 1e-12
            tried.append(best - np.linalg.solve(B, g) * SCALE)
        tried = clip(np.array(tried), low, high)
        found = costs(judge, tried)
        k = int(np.argmin(found))
        if found[k] > 0.999 * cost:
            break
        best, cost = tried[k], float(found[k])
    return best, cost


def fit(judge: Judge, seed=0, runs=3, enough=0.03, bad=0.1):
    """Find the strike of a shot from its samples alone: (6,), and its cost [m^2].

    Repeats the search up to ``runs`` times, until the cost is below ``enough`` squared or the best was found twice; up to
    three times as often while the cost is above ``bad`` squared.
    """
    rng = np.random.default_rng([seed, judge.shot.id])
    low, high = bounds(judge.shot, judge.physics)
    found = []
    for k in range(3 * runs):
        pool, cost = evolve(judge, rng, low, high)
        cost = costs(judge, pool)
        starts = [pool[np.argmin(cost)], pool[rng.integers(len(pool))]]
        best, _ = min((refine(judge, rng, s, low, high, generations=30) for s in starts), key=lambda f: f[1])
        best, _ = settle_strike(judge, best)
        found.append(
            min((refine(judge, rng, best, low, high, s, 20) for s in (0.1, 1.5)), key=lambda f: f[1])
        )
        least = sorted(cost for _, cost in found)
        again = len(least) > 1 and least[1] < 1.05 * least[0]
        if least[0] < enough**2 or (least[0] < bad**2 and (again or k + 1 >= runs)):
            break
    return min(found, key=lambda f: f[1])


def refit(judge, strike, seed=0, sigma=0.3, generations=25, population=12):
    """Refit a strike that was fitted with other constants."""
    rng = np.random.default_rng([seed, judge.shot.id])
    low, high = bounds(judge.shot, judge.physics)
    return refine(judge, rng, strike, low, high, sigma, generations, population)
