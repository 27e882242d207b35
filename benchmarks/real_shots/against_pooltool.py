"""How near does pooltool come to the same paths? Its strikes are fitted there, in a virtual environment of its own.

Part of ``python -m benchmarks.real_shots --peer``. The child (this file, run by the other Python) plays the shots by
pooltool's models on its billiard table: once with its own constants for billiards and its own choice of models, once
with Mathavan's cushion and our constants, as far as it has them. Its strikes are searched by CMA-ES around
ours only, since one of its shots takes as long as hundred of ours or more.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

VARIANTS = ("pooltool, its own constants and models", "pooltool, our constants, Mathavan's cushion")
_GENERATIONS, _POPULATION, _SIGMAS = 10, 10, (1.5,)
_SECONDS = 3000


def _constants(physics):
    """The constants of our physics by pooltool's names; rolling resistance as ours at 0.5 m/s."""
    return {
        "m": physics.M,
        "R": physics.R,
        "g": physics.g,
        "u_s": physics.mu_s,
        "u_r": physics.mu_r + physics.roll_drag * 0.25 / physics.g,
        "u_b": physics.friction_law[0],
        "e_b": physics.e_b,
        "e_c": physics.e_c,
        "f_c": physics.mu_c,
        "u_sp_proportionality": physics.spin_decel / (2.5 * physics.g),
    }


def play(judges, strikes, physics):
    """{variant: {"cue_rms": [m or None], "failed": shots}} of these shots; ``PeerError`` if pooltool cannot be had."""
    import numpy as np

    from snooker_env.physics import cue

    from ..speed.against_pooltool import VERSION, PeerError, environment
    from .strikes import bounds

    python = environment()
    shots = []
    for judge, strike in zip(judges, strikes, strict=True):
        low, high = bounds(judge.shot, physics)
        start = strike.copy()
        turned = cue.squirt.py_func(strike[2], physics.end_mass_ratio)
        start[1] += turned
        a = judge.offsets
        shots.append(
            {
                "places": judge.shot.places.tolist(),
                "t": judge.times[: a[1]].tolist(),
                "xy": judge.xy[: a[1]].tolist(),
                "strike": start.tolist(),
                "low": (low + np.array([0, turned, 0, 0, 0, 0])).tolist(),
                "high": (high + np.array([0, turned, 0, 0, 0, 0])).tolist(),
            }
        )
    with tempfile.TemporaryDirectory() as home:
        asked = Path(home) / "shots.json"
        asked.write_text(json.dumps({"constants": _constants(physics), "shots": shots}), encoding="utf-8")
        try:
            done = subprocess.run(
                [str(python), str(Path(__file__).resolve()), str(asked)],
                capture_output=True,
                text=True,
                timeout=_SECONDS,
                env=os.environ | {"HOME": home},
                cwd=home,
            )
        except subprocess.TimeoutExpired:
            raise PeerError(
                f"pooltool {VERSION} did not end within {_SECONDS} s; try fewer --shots"
            ) from None
    if done.returncode:
        says = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise PeerError(f"pooltool {VERSION} does not run here: {says}")
    return json.loads(done.stdout.splitlines()[-1])


def _child(file):
    import attrs
    import numpy as np
    import pooltool as pt
    from pooltool.objects.ball.params import PrebuiltBallParams
    from pooltool.objects.table.collection import TABLE_SPECS, TableName
    from pooltool.physics.engine import PhysicsEngine
    from pooltool.physics.evolve import evolve_ball_motion
    from pooltool.physics.resolve.ball_ball.friction import AverageBallBallFriction
    from pooltool.physics.resolve.ball_ball.frictional_inelastic import FrictionalInelastic
    from pooltool.physics.resolve.ball_cushion import Mathavan2010Linear
    from pooltool.physics.resolve.resolver import default_resolver

    sys.path.insert(0, str(Path(__file__).parent))
    from cma import Cma  # the file beside this one

    asked = json.loads(Path(file).read_text(encoding="utf-8"))
    specs = TABLE_SPECS[TableName.BILLIARD_WIP]
    table = pt.Table.from_table_specs(specs)
    half = np.array([specs.w / 2, specs.l / 2])
    usual = default_resolver()
    mathavan = attrs.evolve(
        usual,
        ball_linear_cushion=Mathavan2010Linear(),
        ball_ball=FrictionalInelastic(friction=AverageBallBallFriction()),
    )
    ways = (
        (pt.BallParams.prebuilt(PrebuiltBallParams.BILLIARD_GENERIC), PhysicsEngine(resolver=usual)),
        (pt.BallParams(**asked["constants"]), PhysicsEngine(resolver=mathavan)),
    )
    scale = np.array([0.02, 0.004, 0.03, 0.03, 0.02, 0.002])

    def struck(strike, R):
        speed, aim, side, top, elevation, _ = strike
        c, s, ce, se = np.cos(aim), np.sin(aim), np.cos(elevation), np.sin(elevation)
        q = 2.5 * speed / R
        w = (q * (side * se * c - top * s), q * (side * se * s + top * c), q * side * ce)
        return np.array([speed * ce * c, speed * ce * s, 0.0]), np.array(w)

    def error(shot, strike, params, engine):
        balls = {}
        for i, (x, y) in enumerate(shot["places"]):
            ball = pt.Ball.create(str(i), xy=(x + half[0], y + half[1]), ballset=None)
            ball.params = params
            ball.state.rvw[0, 2] = params.R
            balls[str(i)] = ball
        state = balls["0"].state
        state.rvw[1], state.rvw[2] = struck(strike, params.R)
        state.s = pt.constants.sliding
        system = pt.System(cue=pt.Cue(cue_ball_id="0"), table=table, balls=balls)
        pt.simulate(system, engine=engine, inplace=True, max_events=200)
        history = system.balls["0"].history.states
        begins = np.array([h.t for h in history])
        total = np.empty(len(shot["t"]))
        for m, t in enumerate(shot["t"]):
            t = max(t - strike[5], 0.0)
            k = max(int(np.searchsorted(begins, t, side="right")) - 1, 0)
            h = history[k]
            rvw, _ = evolve_ball_motion(
                h.s, h.rvw.copy(), params.R, params.m, params.u_s, params.u_sp, params.u_r, params.g, t - h.t
            )
            total[m] = (rvw[0, 0] - half[0] - shot["xy"][m][0]) ** 2 + (
                rvw[0, 1] - half[1] - shot["xy"][m][1]
            ) ** 2
        return float(np.sqrt(total.mean()))

    found = {}
    for name, (params, engine) in zip(VARIANTS, ways, strict=True):
        errors = []
        for shot in asked["shots"]:
            low, high, start = (np.array(shot[key]) for key in ("low", "high", "strike"))
            best = None
            for sigma in _SIGMAS:
                search = Cma(
                    np.random.default_rng(0),
                    start,
                    scale * np.array([start[0], 1, 1, 1, 1, 1]),
                    sigma,
                    _POPULATION,
                )
                for _ in range(_GENERATIONS):
                    tried = np.clip(search.ask(), low, high)
                    costs = []
                    for strike in tried:
                        try:
                            costs.append(error(shot, strike, params, engine))
                        except Exception:  # whatever stops it, this strike is none
                            costs.append(9.0)
                    search.tell(tried, np.array(costs))
                    if min(costs) < 9.0 and (best is None or min(costs) < best):
                        best = min(costs)
            errors.append(best)
            print(name, len(errors), best, file=sys.stderr, flush=True)
        found[name] = {"cue_rms": errors, "failed": sum(e is None for e in errors)}
    print(json.dumps(found))


if __name__ == "__main__":
    _child(sys.argv[1])
