"""Which constants suit a table best? One set shared by all its shots is fitted, while each shot keeps its own strike.

A Gauss-Newton step adjusts the constants and all strikes at once. Each shot's strike is eliminated from the normal
equations, so a step takes a few dozen simulations per shot. Between steps every strike is refined alone, and sometimes
searched again, because a shot with wrong contacts reveals nothing about the constants.
"""

import dataclasses
import time

import numpy as np

from .paths import Judge
from .strikes import SCALE, bounds, clip, costs, fit, refit, settle_strike, weights

SEARCHED = {
    "mu_s": (0.06, 0.40),
    "mu_r": (0.0036, 0.0060),
    "roll_drag": (0.0, 0.03),
    "spin_decel": (0.5, 40.0),
    "e_b": (0.85, 1.0),
    "mu_bb": (0.0, 0.20),
    "e_c": (0.70, 1.0),
    "e_c_knee": (0.2, 3.0),
    "e_c_power": (0.0, 0.5),
    "mu_c": (0.03, 0.45),
    "sin_theta": (0.05, 0.45),
}
"""The fitted fields, and the range of each."""
MIDDLING = 0.15
"""An error that counts half [m], so that one shot on a different path does not decide."""
_LEAST = 0.01
"""Errors below this count equally [m]."""
_STEP = 2e-4
"""Step of the difference quotients: this share of a range, and 100 times this share of a strike's scale."""


def rms(judge, strike):
    """Root mean square distance of the cue ball from its samples [m]."""
    return float(np.sqrt(judge.squares(strike[None])[0, : judge.offsets[1]].mean()))


def loss(errors):
    """The objective for the constants: the mean over shots of e / (1 + e / MIDDLING)."""
    errors = np.asarray(errors)
    return float((errors / (1 + errors / MIDDLING)).mean())


def _slopes(judge, strike, physics, names, low, high):
    """Differences from the samples (2 m,), and their derivatives by the scaled strike (2 m, 6) and constants (2 m, p)."""
    h = 100 * _STEP
    around = np.concatenate([strike + h * np.diag(SCALE), strike - h * np.diag(SCALE), strike[None]])
    found = judge.differences(around).reshape(len(around), -1)
    by_strike = (found[:6] - found[6:12]).T / (2 * h)
    by_constant = []
    for k, name in enumerate(names):
        sides = []
        for sign in (1, -1):
            value = np.clip(getattr(physics, name) + sign * _STEP * (high[k] - low[k]), low[k], high[k])
            judge.use(dataclasses.replace(physics, **{name: float(value)}))
            sides.append((judge.differences(strike[None]).ravel(), value))
        by_constant.append((sides[0][0] - sides[1][0]) / (sides[0][1] - sides[1][1]) * (high[k] - low[k]))
    judge.use(physics)
    return found[12], by_strike, np.array(by_constant).T


def step(judges, strikes, physics, names, damping):
    """The change of constants (p,), as a share of their ranges, and of each strike, in its scale; and the constants' curvature."""
    low, high = (np.array([SEARCHED[name][k] for name in names]) for k in (0, 1))
    p = len(names)
    S, g, kept = np.zeros((p, p)), np.zeros(p), []
    for judge, strike in zip(judges, strikes, strict=True):
        r, by_strike, by_constant = _slopes(judge, strike, physics, names, low, high)
        squares = (r.reshape(-1, 2) ** 2).sum(1)
        weight = weights(judge) / (1 + squares / 0.3**2) ** 2
        e = max(np.sqrt(squares[: judge.offsets[1]].mean()), _LEAST)
        weight = np.repeat(weight / (e * (1 + e / MIDDLING) ** 2), 2)
        # a slope of metres per step is chaos and carries no information
        weight = weight / (1 + (np.abs(by_constant).max(1) / 30.0) ** 2)
        Js, Jc = by_strike * weight[:, None], by_constant * weight[:, None]
        Ass = by_strike.T @ Js
        Ass[np.diag_indices(6)] += damping * np.diag(Ass) + 1e-9
        Asc, gs = Js.T @ by_constant, Js.T @ r
        solved = np.linalg.solve(Ass, np.column_stack([Asc, gs]))
        S += by_constant.T @ Jc - Asc.T @ solved[:, :p]
        g += Jc.T @ r - Asc.T @ solved[:, p]
        kept.append(solved)
    curvature = S.copy()
    S[np.diag_indices(p)] += damping * np.diag(S) + 1e-9
    change = -np.linalg.solve(S, g)
    return change, [-(s[:, p] + s[:, :p] @ change) for s in kept], curvature


def _try(judges, strikes, physics):
    """Refine the strikes with these constants. Returns strikes and errors [m]."""
    found = []
    for judge, strike in zip(judges, strikes, strict=True):
        judge.use(physics)
        found.append(settle_strike(judge, strike)[0])
    return found, [rms(judge, strike) for judge, strike in zip(judges, found, strict=True)]


def fit_real_shots(physics, shots, minutes, seed=0, names=tuple(SEARCHED), say=print, strikes=None):
    """Fit the constants to ``shots`` for ``minutes``, starting from ``physics``. Returns constants and strikes."""
    began = time.monotonic()
    low, high = (np.array([SEARCHED[name][k] for name in names]) for k in (0, 1))
    judges = [Judge(shot, physics) for shot in shots]
    strikes = [fit(judge, seed, runs=2)[0] for judge in judges] if strikes is None else strikes
    strikes, errors = _try(judges, strikes, physics)
    best = loss(errors)
    say(f"start: {100 * best:.3f} median {100 * np.median(errors):.2f} cm")
    damping, rounds = 0.1, 0
    while time.monotonic() - began < 60 * minutes:
        rounds += 1
        change, moves, _ = step(judges, strikes, physics, names, damping)
        better = False
        for share in (1.0, 0.4, 0.15):
            values = np.array([getattr(physics, name) for name in names]) + share * change * (high - low)
            values = np.clip(values, low, high)
            other = dataclasses.replace(physics, **dict(zip(names, values.tolist(), strict=True)))
            moved = []
            for judge, strike, move in zip(judges, strikes, moves, strict=True):
                lo, hi = bounds(judge.shot, other)
                moved.append(clip((strike + share * move * SCALE)[None], lo, hi)[0])
            # keep the better strike of each shot: the old one or the moved one
            for judge in judges:
                judge.use(other)
            moved = [
                min((s, m), key=lambda x, j=judge: float(costs(j, x[None])[0]))
                for judge, s, m in zip(judges, strikes, moved, strict=True)
            ]
            found, errors = _try(judges, moved, other)
            if loss(errors) < best:
                physics, strikes, best, better = other, found, loss(errors), True
                break
        damping = damping * 0.5 if better else min(damping * 3, 100.0)
        words = ", ".join(f"{name} {getattr(physics, name):.4g}" for name in names)
        errors = [rms(judge, strike) for judge, strike in zip(_use(judges, physics), strikes, strict=True)]
        say(
            f"{rounds}: {100 * best:.3f} median {100 * np.median(errors):.2f} cm, damping {damping:.2g}; {words}"
        )
        if rounds % 8 == 0 or damping >= 30:
            for k, judge in enumerate(_use(judges, physics)):
                tried = [strikes[k], refit(judge, strikes[k], seed + rounds)[0]]
                if rounds % 16 == 0:
                    tried.append(fit(judge, seed + rounds, runs=1)[0])
                strikes[k] = min(tried, key=lambda s, j=judge: float(costs(j, s[None])[0]))
            best, damping = loss([rms(j, s) for j, s in zip(judges, strikes, strict=True)]), min(damping, 1.0)
            say(f"new strikes: {100 * best:.3f}")
    return physics, strikes


def _use(judges, physics):
    for judge in judges:
        judge.use(physics)
    return judges
