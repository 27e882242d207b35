"""How far does the cloth's nap turn a slow ball, and does it show beside a player's execution errors?

    python -m benchmarks.nap [--json FILE] [--out FOLDER]

The equation is dv/dt = -mu_r g v/|v| + nap y (snooker_env/physics/cloth.py). It is integrated here by SciPy,
apart from the engine; the last column of the first table says how far the engine's ball is from that. No
drift was found published, in mm or otherwise. What bounds the nap: rolling decelerations were measured as
0.124 to 0.126 m/s^2. If the nap alone made that range, rolling with it and against it, it would be 0.001
m/s^2.

The player is ``noise="professional"``: the direction errs by 0.038 deg in all in slow strokes, by 0.068 at 1.5 m/s (aim,
and squirt of the tip's error), the speed by 1 %. Each ball is taken to be struck at the speed that it has.

* Pots: a ball rolls from rest at the start to a pocket and arrives there at the speed given. ``drift``: how
  far to the side of its line it is at the pocket. ``scatter``: the standard deviation of the same by his
  errors, for a straight pot with the cue ball 0.5 m from contact (an error of the cue ball's direction is 0.5
  m / 2R times as large in the object ball's).
* Positions: a ball rolls to rest across the table and along it. ``scatter``: the direction's error to the
  side, the speed's along the way.
"""

from math import atan2, cos, hypot, pi, radians, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp

import snooker_env as sn
from snooker_env.physics.table import UNBOUNDED
from snooker_env.tasks.noise import LEVELS

from ._common.command import Command, run, save_json

NAPS = (0.0005, 0.001, 0.002, 0.005)
BOUND = 0.001
"""The most [m/s^2] that the measured rolling decelerations allow."""
PLAYER = LEVELS["professional"]
SPEED, CUE_BALL = PLAYER.speed_rel, 0.5
SEEN = 0.010
"""A drift [m] that players see."""
R, SLOWS = sn.Physics().R, sn.Physics().mu_r * sn.Physics().g

_CORNER = np.array([0.889, 1.7845])
POTS = {
    "across into a middle pocket": ((0.0, 0.0), (0.889, 0.0)),
    "1 m into a black-end corner": (_CORNER - sqrt(0.5), _CORNER),
    "2 m into a black-end corner": (_CORNER - sqrt(2), _CORNER),
    "brown spot to such a corner": ((0.0, -1.0475), _CORNER),
}
ARRIVALS = (0.1, 0.5, 1.0)


def turned(speed):
    """The player's error of direction in a stroke at that speed [rad]."""
    return radians(PLAYER.direction_deg(speed=speed))


def integrated(v, nap, length=np.inf):
    """A ball rolls from the origin at v until it has gone ``length`` [m] in v's first direction, or stopped:
    its place by DOP853."""
    along = np.divide(v, hypot(*v))

    def rate(_, z):
        speed = hypot(z[2], z[3])
        return z[2], z[3], -SLOWS * z[2] / speed, -SLOWS * z[3] / speed + nap

    def slow(_, z):
        return hypot(z[2], z[3]) - 1e-8

    def there(_, z):
        return z[:2] @ along - length if length < np.inf else 1.0

    slow.terminal = there.terminal = True
    out = solve_ivp(rate, (0, 1e3), (0, 0, *v), "DOP853", events=(slow, there), rtol=1e-12, atol=1e-14)
    return out.y[:2, -1]


def aside(place, v):
    """How far a place is to the left of the line through the origin along v."""
    return (v[0] * place[1] - v[1] * place[0]) / hypot(*v)


def played(v, nap):
    """The same roll to rest by the engine: its ``Shot``."""
    w = -v[1] / R, v[0] / R, 0.0
    return sn.simulate([(0.0, 0.0)], [v], [w], UNBOUNDED, {"nap": nap})  # pyright: ignore[reportArgumentType]


def pots():
    """Rows: scene, speed on arrival, drifts, nap for ``SEEN``, scatter, the engine's largest distance from
    the integrated path."""
    for name, (start, pocket) in POTS.items():
        way = np.subtract(pocket, start)
        length, angle = hypot(*way), atan2(*way[::-1])
        for arrives in ARRIVALS:
            speed = sqrt(arrives**2 + 2 * SLOWS * length)
            v = speed * np.array([cos(angle), sin(angle)])
            drifts, off = [], 0.0
            for nap in NAPS:
                place = integrated(v, nap, length)
                shot = played(v, nap)
                path = shot.at(np.linspace(0, shot.duration, 20_001))[0][:, 0]
                along = path @ v / speed
                engine = np.interp(length, along, aside(path.T, v))
                drifts.append(aside(place, v))
                off = max(off, abs(engine - drifts[-1]))
            per_nap = drifts[NAPS.index(BOUND)] / BOUND
            yield name, arrives, drifts, SEEN / per_nap, turned(speed) * CUE_BALL / (2 * R) * length, off


def positions():
    """Rows: way, length, place at rest less that without a nap (by ``NAPS``), scatter."""
    for length in (0.5, 1.0, 2.0, 3.0):
        for name, angle in (("across", 0.0), ("with the nap", pi / 2), ("against it", -pi / 2)):
            v = sqrt(2 * SLOWS * length) * np.array([cos(angle), sin(angle)])
            ends = [integrated(v, nap) for nap in NAPS]
            if name == "across":
                yield name, length, [aside(end, v) for end in ends], turned(hypot(*v)) * length
            else:
                yield name, length, [hypot(*end) - length for end in ends], 2 * SPEED * length


def main():
    """Command line: print both tables and the verdict."""
    options = Command("nap", __doc__).options()
    found = {"naps": NAPS, "pots": [], "positions": []}
    naps = "".join(f"{nap:8g}" for nap in NAPS)
    print(
        "POTS: drift to the side at the pocket [mm] by nap [m/s^2]; the nap for 10 mm; a professional's scatter there [mm]"
    )
    print(f"{'':28s} at m/s{naps}   10 mm at scatter  drift/scatter at {BOUND:g}   engine off [mm]")
    over = []
    for name, arrives, drifts, seen, scatter, off in pots():
        values = "".join(f"{1e3 * d:8.2f}" for d in drifts)
        share = drifts[NAPS.index(BOUND)] / scatter
        over.append(share > 0.1)
        found["pots"].append(
            {
                "pot": name,
                "arrives": arrives,
                "drifts": drifts,
                "nap for 10 mm": seen,
                "scatter": scatter,
                "engine off": off,
            }
        )
        print(
            f"{name:28s} {arrives:6.1f}{values}{seen:11.4f}{1e3 * scatter:8.2f}{share:24.2f}{1e3 * off:18.4f}"
        )
    print(
        f"{sum(over)} of {len(over)} of them drift by more than a tenth of a professional's scatter at nap {BOUND:g}."
    )
    print(
        "\nPOSITIONS: place at rest less that without a nap [mm], to the side (across) or along the way; a professional's scatter"
    )
    print(f"{'':14s}  m of way{naps} scatter  shift/scatter at {BOUND:g}  pieces")
    for name, length, shifts, scatter in positions():
        values = "".join(f"{1e3 * d:8.2f}" for d in shifts)
        v = sqrt(2 * SLOWS * length) * np.array([(1.0, 0.0), (0.0, 1.0)][name != "across"])
        pieces = len(played(v, BOUND).events)
        found["positions"].append({"way": name, "length": length, "shifts": shifts, "scatter": scatter})
        print(
            f"{name:14s}{length:10.1f}{values}{1e3 * scatter:8.2f}{abs(shifts[NAPS.index(BOUND)]) / scatter:23.2f}{pieces:8d}"
        )
    save_json(options.json, found)


if __name__ == "__main__":
    run(main)
