"""What is published about how well people and a robot play, and which execution errors would do the same on
these pockets?"""

from dataclasses import replace

import numpy as np

from snooker_env.tasks.noise import Noise

from .pot_shots import DERIVED, LONG, MODERATE, aimed, of_direction, rolls

AIM = {"professional": (0.02, 0.03), "amateur": (0.05, 0.05), "club": (0.08, 0.12)}
"""Total errors of direction [deg] that were derived from pot rates, with a corner pocket whose effective half
window is 22 mm."""
CHOSEN, LONG_POTS = (0.88, 0.95), (0.50, 0.65)
"""Shares of pots that professionals make: of what they choose, of long ones."""
ROBOT_POTS, ROBOT_PLACES = 0.90, (0.1, 0.2)
"""Share of pots that the robot made, and how far from its target it left the cue ball [m]."""
LIKELY = 0.5
"""A player of a match would rather play safe than try what is made less often than this."""
_LEAST, _MOST = 0.004, 0.6


def by_derivation(level, pots=DERIVED):
    """(lowest, highest) mean share of these pots made with the level's published errors, by geometry."""
    low, high = AIM[level]
    return tuple(float(np.mean([pot.rate(deg) for pot in pots])) for deg in (high, low))


def of_pot(pot, level):
    """(lowest, highest) share of a pot made by a level; None where nothing is published."""
    if level == "professional" and pot in LONG:
        return LONG_POTS
    return by_derivation(level, (pot,)) if level in AIM and pot.pocket == 3 else None


def mean_rate(shots, level, strokes, physics, table):
    """Mean share made of these shots; the errors are the same for every level."""
    return float(
        np.mean([rolls(shot, level, strokes, k, physics, table).rate for k, shot in enumerate(shots)])
    )


def mean_place(shots, level, strokes, physics, table):
    """Mean over these shots of the root mean square distance [m] from where the cue ball would stop without
    errors."""
    return float(
        np.mean([rolls(shot, level, strokes, k, physics, table).placement[0] for k, shot in enumerate(shots)])
    )


def _where(function, target, steps=14):
    """Where a monotone function meets a target, by halving on a scale of ratios."""
    low, high = _LEAST, _MOST
    rises = function(high) > function(low)
    for _ in range(steps):
        middle = (low * high) ** 0.5
        low, high = (low, middle) if (function(middle) > target) == rises else (middle, high)
    return (low * high) ** 0.5


def _directions(pots, targets, like, strokes, physics, table, in_off=False):
    """The total direction errors [deg] with which these shares are made."""
    shots = [aimed(pot, physics, table, in_off=in_off) for pot in pots]

    def rate(deg):
        return mean_rate(shots, of_direction(deg, like, physics), strokes, physics, table)

    return [_where(rate, target) for target in targets]


def fit_published(strokes, physics, table):
    """Rows (what, values): the total direction errors [deg] that meet the published figures, in the middle
    and at both ends."""
    rows, targets = [], [("professional", LONG, *LONG_POTS, "the long pots")]
    targets += [(level, DERIVED, *by_derivation(level), "black, red, blue, long 2.4 m") for level in AIM]
    for level, pots, low, high, what in targets:
        for in_off in (False, True):
            found = _directions(pots, ((low + high) / 2, high, low), level, strokes, physics, table, in_off)
            end = ", in-offs counted as made" if in_off else ""
            rows.append((f"{level}: {(low + high) / 2:.1%} [{high:.1%}, {low:.1%}] of {what}{end}", found))
    shots, robot, middle = (
        [aimed(pot, physics, table) for pot in MODERATE],
        Noise.of("robot"),
        sum(ROBOT_PLACES) / 2,
    )
    speeds = []
    for _ in range(2):  # the speed hardly changes the pots, and the direction hardly the place
        robot = of_direction(
            _directions(MODERATE, (ROBOT_POTS,), robot, strokes, physics, table)[0], robot, physics
        )

        def place(share, robot=robot):
            return mean_place(shots, replace(robot, speed_rel=share), strokes, physics, table)

        speeds = [_where(place, distance) for distance in (middle, *ROBOT_PLACES)]
        robot = replace(robot, speed_rel=speeds[0])
    rows.append(
        (f"robot: {ROBOT_POTS:.0%} of the pots of moderate difficulty", [robot.direction_deg(physics)])
    )
    rows.append(
        (
            f"robot, share of the speed: {middle:.2f} [{ROBOT_PLACES[0]}, {ROBOT_PLACES[1]}] m from the target",
            speeds,
        )
    )
    return rows
