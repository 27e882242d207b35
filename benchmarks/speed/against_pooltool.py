"""How long does pooltool take for the same shots? Installs it in a virtual environment of its own and plays
them there.

Part of ``python -m benchmarks.speed --against pooltool``. Both get the same balls at the same places, with
the same velocities and spins, on a bed of the same size with the same constants; then each plays by its own
models, pockets and cushions. Only times are compared. The child (this file, run by the other Python) plays
some shots first, to compile, and times ``pooltool.simulate`` alone, each shot once.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

VERSION = "0.6.0"
NEEDS = (
    "numpy>=1.26",
    "numba>=0.59,<0.63",
    "llvmlite>=0.44,<0.46",
    "scipy>=1.12",
    "attrs>=21.3",
    "cattrs>=22.1",
    "msgpack>=1.0",
    "msgpack-numpy>=0.4.8",
    "pyyaml>=5.2",
    "click>=8.0",
    "pillow>=6.2",
    "h5py>=3.10",
    "h11>=0.16",
    "rich>=14,<15",
    "numpy-quaternion",
    "panda3d>=1.10.13",
    "panda3d-gltf>=1.2",
    "panda3d-simplepbr>=0.12",
)
"""Its wheel's requirements; of panda3d (its window) the wheel pins a development build that is not on PyPI,
so any release is taken."""

_MAX_EVENTS = 20_000
_WARM_UP = 5  # shots of each kind
_CHILD_SECONDS = 1500


class PeerError(RuntimeError):
    """The peer cannot be installed or run here; the message says why, in one line."""


def _pip(python, *arguments):
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        errors = (
            [text for text in done.stderr.splitlines() if text.startswith("ERROR")]
            or done.stderr.splitlines()
            or ["no message"]
        )
        raise PeerError(f"pooltool {VERSION} cannot be installed here: {errors[-1]}")


def environment():
    """The Python of a virtual environment that holds pooltool; made on first use."""
    from .._common.kept import BUILD  # not at the top: pooltool's Python runs this file alone

    folder = BUILD / f"pooltool_{VERSION}_py{sys.version_info[0]}{sys.version_info[1]}"
    python, ready = folder / "bin" / "python", folder / "ready"
    if os.name == "nt":
        python = folder / "Scripts" / "python.exe"
    if not ready.exists():
        venv.create(folder, with_pip=True, clear=True)
        _pip(python, "--no-deps", f"pooltool-billiards=={VERSION}")
        _pip(python, *NEEDS)
        ready.touch()
    return python


def _constants(physics):
    """The constants of our physics by pooltool's names; its spinning friction decays spin at (5/2) u_sp g /
    R."""
    return {
        "m": physics.M,
        "R": physics.R,
        "g": physics.g,
        "u_s": physics.mu_s,
        "u_r": physics.mu_r,
        "u_b": physics.mu_bb,
        "e_b": physics.e_b,
        "e_c": physics.e_c,
        "f_c": physics.mu_c,
        "u_sp_proportionality": physics.spin_decel / (2.5 * physics.g),
    }


def play(file, physics):
    """Play the shots of an npz file (kind_p, kind_v, kind_w for each kind) with pooltool and our constants:
    the child's JSON."""
    python = environment()
    # pooltool reads its models from the home folder: in an empty one it has its defaults
    with tempfile.TemporaryDirectory() as home:
        command = [str(python), str(Path(__file__).resolve()), str(file), json.dumps(_constants(physics))]
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                timeout=_CHILD_SECONDS,
                env=os.environ | {"HOME": home},
                cwd=home,
            )
        except subprocess.TimeoutExpired as slow:
            raise PeerError(
                f"pooltool {VERSION} did not end within {_CHILD_SECONDS} s; try fewer --peer-shots"
            ) from slow
    if done.returncode:
        raise PeerError(
            f"pooltool {VERSION} does not run here: {(done.stderr.strip().splitlines() or ['no message'])[-1]}"
        )
    return json.loads(done.stdout.splitlines()[-1])


def _child(file, constants):
    import attrs
    import numpy as np
    import pooltool as pt
    from pooltool.objects.table.collection import TABLE_SPECS, TableName

    specs = attrs.evolve(TABLE_SPECS[TableName.SNOOKER_GENERIC], w=1.778, l=3.569)
    params, sliding = pt.BallParams(**constants), pt.constants.sliding

    def system(p, v, w):
        balls = {}
        for i in range(len(p)):
            ball = pt.Ball.create(str(i), xy=(p[i, 0] + 0.5 * specs.w, p[i, 1] + 0.5 * specs.l), ballset=None)
            ball.params = params
            ball.state.rvw[0, 2] = params.R
            if v[i].any() or w[i].any():
                ball.state.rvw[1, :2], ball.state.rvw[2], ball.state.s = v[i], w[i], sliding
            balls[str(i)] = ball
        return pt.System(cue=pt.Cue(cue_ball_id="0"), table=pt.Table.from_table_specs(specs), balls=balls)

    found = {}
    with np.load(file) as sets:
        kinds = {
            name[:-2]: [sets[name[:-1] + part] for part in "pvw"]
            for name in sets.files
            if name.endswith("_p")
        }
        for p, v, w in kinds.values():
            for k in range(min(_WARM_UP, len(p))):
                pt.simulate(system(p[k], v[k], w[k]), inplace=True, max_events=_MAX_EVENTS)
        for kind, (p, v, w) in kinds.items():
            microseconds, events, failed = [], [], 0
            for k in range(len(p)):
                shot = system(p[k], v[k], w[k])
                start = time.perf_counter()
                try:
                    pt.simulate(shot, inplace=True, max_events=_MAX_EVENTS)
                except Exception:  # whatever stops it, the shot has no time
                    failed += 1
                    continue
                microseconds.append((time.perf_counter() - start) * 1e6)
                events.append(len(shot.events))
            found[kind] = {"us": microseconds, "events": events, "failed": failed}
    print(json.dumps(found))


if __name__ == "__main__":
    _child(sys.argv[1], json.loads(sys.argv[2]))
