"""What do the paper's equations give for its own shots? Tables 1 and 2, models without friction or spin,
Figs. 1, 4 and 6.

Paper: Mathavan, Jackson & Parkin (2014), constants of ``Physics.preset("paper")``. Used by
``python -m benchmarks.paper``. Frame of a shot: the cue ball comes along +x and cuts the object ball to its
left, angles in degrees from +x; units SI.
"""

from pathlib import Path

import numpy as np

import snooker_env as sn

TABLES = Path(__file__).parents[1] / "data" / "paper_tables.csv"
QUANTITIES = ("v_c", "v_o", "angle_c", "angle_o")
"""Speeds [m/s] of cue and object ball once they roll, and the angles [deg] they then have to the cue ball's
incoming path."""
MEASURED_TO = {"v_c": 0.011, "v_o": 0.011, "angle_c": 0.1}
"""The paper's own accuracy of its measurements [m/s, deg] (section 3). The object ball's angle is not among
them: in all five shots the "measured" one is the cut angle, by which the shot was defined, so it tests no
model."""
PAPER = sn.Physics.preset("paper")
R, E_B, MU_BB = PAPER.R, PAPER.e_b, PAPER.friction_law[0]


def tables():
    """The rows of Tables 1 and 2 as printed."""
    return np.genfromtxt(TABLES, delimiter=",", names=True)


def impact(v0, topspin, cut, physics=PAPER, fidelity="reference"):
    """v1, w1, v2, w2 just after a cue ball with ``topspin`` [rad/s] has met a resting ball at ``cut``
    [deg]."""
    c = np.radians(cut)
    return sn.collide_balls(
        (v0, 0, 0), (0, topspin, 0), (0, 0, 0), (0, 0, 0), (np.cos(c), np.sin(c), 0), physics, fidelity
    )


def rolling(v, w, radius=R):
    """Velocity (2,) at the end of the slip on the cloth: v - (2/7) u, u = v + w x (-R z) (section 2.5)."""
    return v[:2] - (v[:2] + radius * np.array([-w[1], w[0]])) / 3.5


def _speeds_and_angles(v_c, v_o):
    both = np.hypot(*v_c), np.hypot(*v_o)
    return np.array([*both, *(abs(np.degrees(np.arctan2(v[1], v[0]))) for v in (v_c, v_o))])


def make_solved_model(fidelity):
    """A model for ``MODELS``: the package's impact at this fidelity, then the cloth until both balls roll."""

    def model(v0, topspin, cut):
        v1, w1, v2, w2 = impact(v0, topspin, cut, fidelity=fidelity)
        return _speeds_and_angles(rolling(v1, w1), rolling(v2, w2))

    return model


def make_closed_form(e, mu, cloth):
    """A model for ``MODELS`` in closed form: the impact does not feel the cue ball's roll. c the cut, per
    unit mass

    normal impulse P = (1+e)/2 v0 cos c, friction F = min(mu P, v0 sin c / 7) against the tangential slip v0
    sin c; along the line of centres v_C = (1-e)/2 v0 cos c, v_O = P; across it v_C = v0 sin c - F, v_O = F.
    Without ``cloth`` that is all (the balls are pucks); with it both end up rolling, v = (5/7) v + (2/7) R w
    x z, the cue ball with the spin it came with, the object ball with none (friction F turns both about the
    vertical only).
    """

    def model(v0, topspin, cut):
        c = np.radians(cut)
        centres, across = np.array([np.cos(c), np.sin(c)]), np.array([np.sin(c), -np.cos(c)])
        p = 0.5 * (1 + e) * v0 * np.cos(c)
        f = min(mu * p, v0 * np.sin(c) / 7)
        v_c, v_o = (v0 * np.cos(c) - p) * centres + (v0 * np.sin(c) - f) * across, p * centres + f * across
        if cloth:
            v_c, v_o = (5 * v_c + 2 * R * topspin * np.array([1.0, 0.0])) / 7, 5 * v_o / 7
        return _speeds_and_angles(v_c, v_o)

    return model


MODELS = {
    "elastic pucks": make_closed_form(1.0, 0.0, cloth=False),
    "inelastic pucks": make_closed_form(E_B, 0.0, cloth=False),
    "elastic, then cloth": make_closed_form(1.0, 0.0, cloth=True),
    "inelastic, then cloth": make_closed_form(E_B, 0.0, cloth=True),
    "planar friction, then cloth": make_closed_form(E_B, MU_BB, cloth=True),
    "fast": make_solved_model("fast"),
    "euler:10000": make_solved_model("euler:10000"),
    "reference": make_solved_model("reference"),
}
"""Name -> model(v0, topspin, cut) -> the four ``QUANTITIES``. "fast" feels the spin but not the cloth during
the impact."""
FRICTIONLESS = ("elastic pucks", "inelastic pucks", "elastic, then cloth", "inelastic, then cloth")


def predictions():
    """Name -> (shots, 4): every model on the five shots."""
    rows = [(r["v0_m_s"], r["topspin_rad_s"], r["cut_deg"]) for r in tables()]
    return {name: np.array([model(*row) for row in rows]) for name, model in MODELS.items()}


def read_camera():
    """(shots, 4): what the camera saw."""
    rows = tables()
    return np.column_stack([rows[f"measured_{q}"] for q in QUANTITIES])


def paper_errors(predicted, seen):
    """Errors [%] by the paper's definitions: of speeds over the prediction (Table 1), of angles over the
    measurement (Table 2)."""
    return 100 * (predicted - seen) / np.where([True, True, False, False], predicted, seen)


def table_rows(found):
    """Tables 1 and 2, one dict a number: measured, printed, computed, errors; ``slip`` is True where a
    printed one is not borne out.

    A printed prediction is borne out if euler:10000 rounds to it, a printed error if it is right to 0.1 %:
    the speeds are given to 0.001 m/s, which is worth that much.
    """
    rows, seen = tables(), read_camera()
    errors = paper_errors(found["euler:10000"], seen)
    out = []
    for j, q in enumerate(QUANTITIES):
        for i, row in enumerate(rows):
            printed, error = float(row[f"printed_{q}"]), float(row[f"printed_error_{q}"])
            euler = float(found["euler:10000"][i, j])
            out.append(
                {
                    "quantity": q,
                    "shot": int(row["shot"]),
                    "measured": float(seen[i, j]),
                    "printed": printed,
                    "euler:10000": euler,
                    "reference": float(found["reference"][i, j]),
                    "printed_error": error,
                    "error": float(errors[i, j]),
                    "slip": round(euler, 3 if j < 2 else 2) != printed,
                    "error_slip": bool(abs(error - errors[i, j]) > 0.1),
                }
            )
    return out


def model_rows(found):
    """How each model does: errors [%] of the measurement per shot, rms of all shots and without shot 1, how
    many the camera allows."""
    seen = read_camera()
    limits = np.array(list(MEASURED_TO.values()))
    out = {}
    for name, values in found.items():
        percent, off = 100 * (values / seen - 1), values - seen
        within = np.abs(off[:, :3]) <= limits
        out[name] = {
            "error_percent": percent.T.tolist(),
            "rms_percent": np.sqrt(np.mean(percent**2, 0)).tolist(),
            "rms_percent_without_shot_1": np.sqrt(np.mean(percent[1:] ** 2, 0)).tolist(),
            "rms": np.sqrt(np.mean(off**2, 0)).tolist(),
            "within_camera": within.sum(0).tolist(),
        }
    return out


# Fig. 4
# ------------------------------------------------------------------------------------------------------------

HEAD_ON = {
    "no friction, (1+e)/2": lambda v0: 0.5 * (1 + E_B) * v0,
    "fast": lambda v0: float(impact(v0, v0 / R, 0.0, fidelity="fast")[2][0]),
    "reference": lambda v0: float(impact(v0, v0 / R, 0.0)[2][0]),
    "reference, physics match": lambda v0: float(impact(v0, v0 / R, 0.0, sn.Physics.preset("match"))[2][0]),
}
"""Speed of the object ball [m/s] just after a rolling cue ball of speed v0 has met it full."""


def head_on(speeds=(0.25, 0.5, 1.0, 1.5, 2.0)):
    """Fig. 4: v0 and, per model, the object ball's speeds just after the impact."""
    return {"v0": list(speeds), **{name: [model(v) for v in speeds] for name, model in HEAD_ON.items()}}


# Fig. 6
# ------------------------------------------------------------------------------------------------------------

CURVED = {"v0": 2.0, "cut": 40.0, "mu_bb": (0.05, 0.1, 0.2)}
"""A rolling cue ball [m/s], its cut [deg], and ball-ball frictions from the paper's constant to the chalked
ball's of section 2.4.2."""


def curved_path(mu_bb):
    """Fig. 6: the object ball's path while it slips, from ``simulate`` and from the paper's parabola (section
    2.5, misprints corrected).

    The parabola, in X'Y' turned by psi = Phi'' - 90 deg so that the slip s'' is along +Y': X' keeps its
    speed, Y' is braked by mu_s g, for T_S = 2 s'' / (7 mu_s g); the ball rolls off at psi + atan2(Y'_S,
    X'_S).
    """
    v0, cut = CURVED["v0"], CURVED["cut"]
    physics = sn.Physics.preset("paper", mu_bb=mu_bb)
    c = np.radians(cut)
    at = [(0.0, 0.0), (2 * R * np.cos(c), 2 * R * np.sin(c))]
    start = {"positions": at, "velocities": [(v0, 0), (0, 0)], "spins": [(0, v0 / R, 0), (0, 0, 0)]}
    shot = sn.simulate(**start, table=None, physics=physics, fidelity="reference")  # pyright: ignore[reportArgumentType] (None: no table)
    _, _, v, w = impact(v0, v0 / R, cut, physics)
    slip = v[:2] + R * np.array([-w[1], w[0]])
    decel = physics.mu_s * physics.g
    end = 2 * np.hypot(*slip) / (7 * decel)  # eq. 19
    psi = np.arctan2(slip[1], slip[0]) - np.pi / 2  # eq. 18
    turn = np.array([[np.cos(psi), np.sin(psi)], [-np.sin(psi), np.cos(psi)]])
    x, y = turn @ v[:2]
    t = np.linspace(0, 1.5 * end, 301)
    sliding = t <= end
    parabola = at[1] + np.column_stack([x * t, y * t - 0.5 * decel * t * t]) @ turn
    seen = shot.at(t)[0][:, 1]
    first = np.arctan2(v[1], v[0])
    along, across = np.array([np.cos(first), np.sin(first)]), np.array([-np.sin(first), np.cos(first)])
    final = np.degrees(psi + np.arctan2(y - decel * end, x))  # eq. 20b
    leaves = np.degrees(first)
    moved = seen - at[1]
    stop = np.interp(end, t, moved @ along), np.interp(end, t, moved @ across)
    return {
        "mu_bb": mu_bb,
        "T_S": float(end),
        "leaves_deg": float(leaves),
        "rolls_deg": float((final + 180) % 360 - 180),
        "cut_deg": cut,
        "length": float(stop[0]),
        "aside": float(stop[1]),
        "gap": float(np.abs(seen - parabola)[sliding].max()),
        "path": np.column_stack([moved @ along, moved @ across]),
    }


# Fig. 1
# ------------------------------------------------------------------------------------------------------------

POT = {"object": (0.62, 1.45), "cue": (0.45, 0.85), "pocket": "top right", "speed": 2.0}
"""One pot into a corner pocket [m, m/s]."""
TOPS, SIDES = (-0.4, -0.2, 0.0, 0.2, 0.4), (-0.25, 0.0, 0.25)
"""Tip offsets over R; + is top, + is right."""


def spin_shots():
    """Fig. 1: the same pot with different top and side; (top, side, the aim's shift [deg], the Shot), all of
    them potted.

    Side and throw move the aim that pots: of the aims within 3 degrees of the ghost ball's that do, the
    middle one is played.
    """
    balls, pocket = np.array([POT["cue"], POT["object"]]), sn.POCKETS.index(POT["pocket"])
    to_pocket = sn.Table.preset("match").falls[pocket, :2] - balls[1]
    ghost = balls[1] - 2 * R * to_pocket / np.hypot(*to_pocket) - balls[0]
    shifts = np.linspace(-3, 3, 601)
    out = []
    for top in TOPS:
        for side in SIDES:
            aims = np.arctan2(ghost[1], ghost[0]) + np.radians(shifts)
            struck = [sn.strike(POT["speed"], aim, side=side, top=top) for aim in aims]
            v, w = np.zeros((len(aims), 2, 2)), np.zeros((len(aims), 2, 3))
            v[:, 0], w[:, 0] = [a[:2] for a, _ in struck], [b for _, b in struck]
            batch = sn.simulate_batch(np.tile(balls, (len(aims), 1, 1)), v, w)
            good = np.flatnonzero((batch.potted[:, 1] == pocket) & batch.on_table[:, 0])
            k = good[len(good) // 2]
            out.append((top, side, float(shifts[k]), sn.simulate(balls, v[k], w[k])))
    return out
