"""How many lengths of the table does a stroke travel? The cue ball alone, up and down the long axis, with
several sets of constants.

Measured: I. Stevenage, The Amateur Billiard Player, October 1996 (https://www.eaba.co.uk/?p=4149), on
full-size tables. A ball thrown from the baulk end as hard as possible goes 4.25 to 4.75 lengths on nine
tables, 4.75 on a heated one with new cloth and steel-block cushions; there a ball from a test ramp 3.5 inches
high comes back from the top cushion to 6 inches past the pink's spot. Players say about five lengths for the
hardest stroke. A thrown ball starts without spin, as one struck at its middle does; its speed was not
measured. Two experienced players close to their maximum stayed under 13.4 m/s (Carroll and Stevenage,
Billiards Quarterly Review, July 1993).
"""

from math import pi, sqrt

import numpy as np

import snooker_env as sn

LENGTH = 3.569
BAULK_END = -LENGTH / 2.0
PINK = LENGTH / 4.0
SPEEDS = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 13.0)
RAMP = sqrt(10.0 / 7.0 * 9.81 * 3.5 * 0.0254)
"""Speed [m/s] of a ball that has rolled down 3.5 inches."""
QUICK = 0.010
"""A rolling resistance below the measured one of the presets: that of a quick cloth."""


def path(speed, physics, rolling=False, start=0.05):
    """Heights y [m] of the cue ball at the start, at each event and at rest; start: from the baulk cushion's
    nose [m]."""
    v, w = sn.strike(speed, pi / 2.0, physics=physics)
    if rolling:
        w = np.array((-speed / physics.R, 0.0, 0.0))
    shot = sn.simulate([(0.0, BAULK_END + start)], [v[:2]], [w], physics=physics)
    return shot.at(np.concatenate(([0.0], shot.events["time"], [shot.duration])))[0][:, 0, 1]


def lengths(speed, physics):
    """Distance travelled over the table's length, for a stroke at the middle of the ball at this speed
    [m/s]."""
    return float(np.abs(np.diff(path(speed, physics))).sum()) / LENGTH


def past_pink(physics, start):
    """How far [m] beyond the pink's spot the ball of the test ramp stops on its way back."""
    return PINK - float(path(RAMP, physics, rolling=True, start=start)[-1])


def print_lengths(ends):
    """Print the table of lengths and give it, {speed: {constants: lengths}}.

    ends: (knee, power) at the two ends of the interval of the power.
    """
    match, (livelier, deader) = (
        sn.Physics.preset("match"),
        ({"e_c_knee": knee, "e_c_power": power} for knee, power in ends),
    )
    laws = {
        "paper": sn.Physics(),
        "match": match,
        f"power {livelier['e_c_power']:.2f}": sn.Physics.preset("match", **livelier),
        f"power {deader['e_c_power']:.2f}": sn.Physics.preset("match", **deader),
        f"mu_r {QUICK:.3f}": sn.Physics.preset("match", mu_r=QUICK),
        "both livelier": sn.Physics.preset("match", mu_r=QUICK, **livelier),
    }
    print(
        f"\nlengths of the table travelled ({LENGTH} m each), struck at the middle from the baulk cushion along the long axis"
    )
    print("m/s   " + "".join(f"{name:>15s}" for name in laws))
    table = {speed: {name: lengths(speed, physics) for name, physics in laws.items()} for speed in SPEEDS}
    for speed, row in table.items():
        print(f"{speed:4.0f}  " + "".join(f"{value:15.2f}" for value in row.values()))
    print(
        f"\nball off a 3.5 inch ramp ({RAMP:.2f} m/s, rolling): where it stops past the pink's spot; measured 0.15 m, on new cloth"
    )
    for mu_r in (match.mu_r, QUICK):
        far, near = (past_pink(sn.Physics.preset("match", mu_r=mu_r), start) for start in (0.05, 0.35))
        print(
            f"  mu_r {mu_r:.4f}: {far:+.2f} m from the baulk cushion, {near:+.2f} m where the ramp ends 0.3 m further up the table"
        )

    def between(law, soft, hard):
        return f"{table[soft][law]:.1f} to {table[hard][law]:.1f}"

    shipped, quick, both, paper = (
        (between(law, 7.0, 9.0), between(law, 10.0, 13.0))
        for law in ("match", f"mu_r {QUICK:.3f}", "both livelier", "paper")
    )
    print(f"""
Players say about 5 lengths for the hardest stroke; a ball thrown as hard as possible was measured to go 4.25 to 4.75 (Stevenage 1996).
"match" is short of that: {shipped[0]} at 7 to 9 m/s, {shipped[1]} at 10 to 13, which is a maximum. Part of it is the cloth: with this
cushion the ramp needs a rolling resistance of about {QUICK:g}, which gives {quick[0]} and {quick[1]}. With the livelier end of the
power's interval as well it is {both[0]} and {both[1]}: the measured lengths, if balls were thrown at 10 to 13 m/s. "paper" has
{paper[0]} and {paper[1]}, by a restitution that does not fall, which the rebounds above 2.5 m/s contradict.
The constants are not bent to these lengths.""")
    return table
