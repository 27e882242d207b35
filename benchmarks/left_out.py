"""How large is what the model leaves out? The sizes in docs/physics/limits.md that can be computed.

    python -m benchmarks.left_out [--json FILE] [--out FOLDER]

Each is a closed form or one impact, with its inputs in the line above its figures. What these are set beside:
the rolling resistance, and a professional whose direction errs by 0.068 deg in all at 1.5 m/s: with the cue ball 0.5 m
from contact the object ball's direction errs by 0.65 deg, so much that whatever is below 0.06 deg there is
below a tenth of it. The nap has a command of its own: ``python -m benchmarks.nap``.
"""

from math import asin, cos, degrees, log, log1p, pi, radians, sin, sqrt

import snooker_env as sn

from ._common.command import Command, run, save_json

PAPER = sn.Physics()
R, M, G = PAPER.R, PAPER.M, PAPER.g
SLOWS = PAPER.mu_r * G
LENGTH = 2 * (1.7845 - R)
"""From cushion to cushion along the table [m], for a ball's centre."""
AIR, VISCOSITY, DRAG = 1.2, 1.5e-5, 0.45
"""Density [kg/m^3], kinematic viscosity [m^2/s]; drag coefficient of a sphere at Reynolds numbers of 1e3 to
1e5: 0.4 to 0.5."""
SEEN = 0.01
"""A shift that is seen in play [m]; a professional's scatter of a ball that rolls a metre is 20 mm."""
CAROM = 0.0151
"""Growth of the rolling resistance measured on heated carom cloth [1/m] (docs/physics/limits.md)."""
BOUNCE = 0.5
"""Restitution of a ball that falls on cloth over slate: an assumption."""
TIP_TIME = 1.5e-3
"""s that the tip stays on the ball: 1 to 2 ms (Alciatore,
billiards.colostate.edu/faq/cue-tip/contact-time)."""


def air():
    """Deceleration by the air, over the rolling resistance, and what it takes off the way."""
    per_metre = 0.5 * AIR * DRAG * pi * R * R / M
    metre, length = (f"{100 * per_metre * way:.2g} %" for way in (1.0, LENGTH))
    print(f"AIR: a drag coefficient of {DRAG} takes {metre} of the speed a metre, {length} a table length")
    shorter = lambda ratio: 1 - log(1 + ratio) / ratio  # noqa: E731
    print("rolling at m/s  Reynolds  drag/rolling resistance  way to rest, shorter by", end="")
    print(f"  with roll_drag {CAROM} by")
    found = {}
    for v in (0.5, 1, 2, 4, 6):
        ratio, carom = (per_metre * v * v / SLOWS, CAROM * v * v / SLOWS)
        found[v] = {
            "drag over rolling resistance": ratio,
            "shorter by": shorter(ratio),
            "with roll_drag": shorter(carom),
        }
        row = f"{v:14g}{2 * R * v / VISCOSITY:10.0f}{ratio:25.3f}{100 * shorter(ratio):23.1f} %"
        print(f"{row}{100 * shorter(carom):25.1f} %")
    stun = 5.0
    slow = sn.Physics.preset("match").mu_r * G
    found["matters from"] = {
        "air": from_where(per_metre, slow),
        "roll_drag": from_where(CAROM, slow),
    }
    print(f"A ball that rolls to rest on the cloth of match stops {1e3 * SEEN:g} mm shorter", end=" ")
    air_alone, carom = found["matters from"].values()
    print(f"from {air_alone:.2f} m/s by the air alone, from {carom:.2f} m/s with roll_drag {CAROM}")
    of_friction = per_metre * stun * stun / (PAPER.mu_s * G)
    slides = stun * stun * (1 - 25 / 49) / (2 * PAPER.mu_s * G)
    found["sliding"] = {"drag over friction": of_friction, "of the speed": per_metre * slides}
    print(f"Sliding at {stun:g} m/s: drag is {100 * of_friction:.1f} % of the friction;", end=" ")
    print(f"a stun shot at that speed would lose {100 * per_metre * slides:.1f} % of it until it rolls")
    return found


def from_where(drag, slows):
    """The speed [m/s] from which a drag [1/m] beside ``slows`` [m/s^2] shortens the way to rest by ``SEEN``."""
    low, high = 0.0, 10.0
    for _ in range(60):
        v = 0.5 * (low + high)
        shorter = v * v / (2 * slows) - log1p(drag * v * v / slows) / (2 * drag)
        low, high = (v, high) if shorter < SEEN else (low, v)
    return high


def level():
    """A bed that slopes: a rolling ball feels 5/7 of gravity's part along it."""
    print("\nLEVEL: a ball that rolls 1 m to rest across the slope ends to the side by")
    found = {}
    for slope in (0.05e-3, 0.1e-3, 0.5e-3):
        push = 5 / 7 * G * slope
        found[slope] = push / (2 * SLOWS)
        print(f"{1e3 * slope:8.2f} mm/m (as a nap of {push:.4f} m/s^2){1e3 * found[slope]:8.1f} mm")
    return found


def unequal():
    """Balls of different mass and size."""
    e, lighter, smaller = PAPER.e_b, 0.5e-3, 0.1e-3
    full, light = (1 + e) / 2, (1 + e) * (M - lighter) / (2 * M - lighter)
    on, back = (1 - e) / 2, (M - lighter - e * M) / (2 * M - lighter)
    print(
        f"\nUNEQUAL BALLS: cue ball {1e3 * lighter:g} g lighter, full contact: object ball {100 * (light / full - 1):+.2f} % of its speed"
    )
    print(f"cue ball keeps {back:.4f} of its speed, {on:.4f} if the balls are equal")
    turned = {}
    for cut in (15, 30, 60):
        turned[cut] = degrees(asin(2 * R * sin(radians(cut)) / (2 * R - smaller / 2))) - cut
        print(
            f"cue ball {1e3 * smaller:g} mm smaller in diameter, cut {cut} deg: object ball turned by {turned[cut]:.3f} deg"
        )
    return {
        "object ball faster by": light / full - 1,
        "cue ball keeps": back,
        "keeps if equal": on,
        "turned by cut [deg]": turned,
    }


def kicks():
    """A contact of far more friction than usual."""
    print(
        "\nKICKS: object ball's throw [deg] and speed by the friction at the contact; stun at 2 m/s, constants of the preset paper"
    )
    print("friction   cut 15  speed   cut 30  speed   cut 45  speed")
    found = {}
    for mu in (PAPER.mu_bb, 0.1, 0.2, 0.5):
        row, throws = "", []
        for cut in (15, 30, 45):
            turn = radians(cut)
            _, _, v, _ = sn.collide_balls(
                (2, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0), (cos(turn), sin(turn), 0), {"mu_bb": mu}
            )
            across, along = v[0] * sin(turn) - v[1] * cos(turn), v[0] * cos(turn) + v[1] * sin(turn)
            speed = sqrt(across**2 + along**2)
            throws.append({"cut": cut, "throw [deg]": degrees(asin(across / speed)), "speed": speed})
            row += f"{throws[-1]['throw [deg]']:9.2f}{speed:7.3f}"
        found[str(mu)] = throws
        print(f"{mu:8g}{row}")
    return found


def airborne():
    """The cue drives the ball into the bed, from where it hops."""
    print(
        f"\nAIRBORNE: height and length [mm] of the cue ball's first hop, by elevation of the cue; rebound from the bed {BOUNCE}"
    )
    print("ball at m/s" + "".join(f"{e:14d} deg" for e in (2, 5, 10, 20)))
    hops = []
    for v in (1, 2, 4, 7):
        row = ""
        for elevation in (2, 5, 10, 20):
            up, on = BOUNCE * v * sin(radians(elevation)), v * cos(radians(elevation))
            hops.append(
                {
                    "speed": v,
                    "elevation": elevation,
                    "height [mm]": 1e3 * up * up / (2 * G),
                    "length [mm]": 2e3 * up * on / G,
                }
            )
            row += f"{hops[-1]['height [mm]']:9.2f}{hops[-1]['length [mm]']:9.1f}"
        print(f"{v:11g}{row}")
    most = 0.0
    for cut in range(0, 90, 5):
        turn = radians(cut)
        v1, _, v2, _ = sn.collide_balls(
            (2, 0, 0), (0, 2 / R, 0), (0, 0, 0), (0, 0, 0), (cos(turn), sin(turn), 0)
        )
        most = max(most, v1[2], v2[2])
    hop = f"{1e3 * most * most / (2 * G):.2f} mm and {2e3 * most / G:.0f} ms"
    print(
        f"Friction at the contact throws the upper ball up: after a ball that rolls at 2 m/s by {hop} at the most, over all cuts."
    )
    up = sqrt(2 * G * 2 * R)
    print(
        f"To clear a ball the cue ball must leave the bed at {up:.2f} m/s: struck at {up / BOUNCE:.2f} m/s downwards."
    )
    return {"hops": hops, "thrown up at most": most, "speed to clear a ball": up}


def raised():
    """A raised cue presses the ball into the bed; what the cloth's friction then does is in the model."""
    speed, gap = 3.0, 0.8
    print(
        f"\nRAISED CUE: where the cue ball rests [mm behind (-) or beyond the place of a full contact], struck at {speed:g} m/s,"
    )
    print(f"{gap:g} m from the ball's centre; with the bed's friction during the strike, and without it")
    strokes = {"draw, 0.4 R below the middle": -0.4, "stun": 0.0}
    print("preset  elevation" + "".join(f"{name:>36}" for name in strokes))
    found = {}
    for physics in ("paper", "match"):
        found[physics] = {}
        for elevation in (0, 1, 2, 4, 7, 10):
            ends, e = {}, radians(elevation)
            for name, top in strokes.items():
                v, w = sn.strike(speed, 0, 0, top, e, physics)
                bare = (speed * cos(e), 0), (0, 2.5 * speed * top / R, 0)
                ends[name] = [1e3 * _rest(gap, *one, physics) for one in ((v[:2], w), bare)]
            found[physics][elevation] = ends
            print(f"{physics:8}{elevation:5d} deg" + "".join(f"{a:26.0f}{b:10.0f}" for a, b in ends.values()))
    return found


def _rest(gap, v, w, physics):
    """Where the cue ball rests, from the place of contact [m]."""
    still = (0, 0), (0, 0, 0)
    shot = sn.simulate([(0, 0), (gap, 0)], [v, still[0]], [w, still[1]], table=None, physics=physics)
    return float(shot.positions[0, 0]) - (gap - 2 * R)


def double_hits():
    """A cue of 0.5 kg follows its ball into a ball just ahead."""
    cue, tip = 0.5, 0.73
    ball, left = (1 + tip) * cue / (cue + M), (cue - tip * M) / (cue + M)
    after = (1 - PAPER.e_b) / 2 * ball
    print(
        f"\nDOUBLE HITS: cue of {cue} kg, tip restitution {tip}: ball at {ball:.2f} of the cue's speed, cue at {left:.2f} after it"
    )
    print(
        "gap [mm]: how long after the ball ahead is hit full the tip arrives [ms], if nothing stops the cue, by the ball's speed [m/s]"
    )
    found = {}
    for gap in (2e-3, 10e-3, 50e-3):
        found[gap] = {v: gap * (1 - left / ball) / ((left - after) * v / ball) for v in (1, 2, 4)}
        print(
            f"{1e3 * gap:8.0f}"
            + "".join(f"{v:6d}: {1e3 * seconds:6.2f}" for v, seconds in found[gap].items())
        )
    print(
        f"In {1e3 * TIP_TIME} ms on the tip the ball goes {', '.join(f'{500 * TIP_TIME * v:.2f} mm at {v} m/s' for v in (1, 2, 4))}."
    )
    return {"ball over cue": ball, "cue after": left, "seconds by gap [m] and speed": found}


def main():
    """Command line: print the sizes."""
    options = Command("left_out", __doc__).options()
    parts = air, level, unequal, kicks, airborne, raised, double_hits
    save_json(options.json, {part.__name__: part() for part in parts})


if __name__ == "__main__":
    run(main)
