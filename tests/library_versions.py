"""With which versions of its libraries does the package work? Lowest and newest, on each Python at hand.

    python -m tests.library_versions 3.10 3.11 3.12 3.13

Needs ``uv``. Each line of the table is an environment of its own with the wheel of this clone, in which one table
and many are played and a shot is simulated; kernels are compiled anew. It takes minutes a line.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
SMOKE = """
import gymnasium, numpy as np, snooker_env as sn
env = gymnasium.make("snooker_env:Snooker-v0", aim="target", noise="professional")
observation, _ = env.reset(seed=0)
for _ in range(5):
    observation, reward, terminated, truncated, info = env.step(np.zeros(4, np.float32))
    assert observation in env.observation_space
    if terminated:
        env.reset()
many = gymnasium.make_vec("Snooker-v0", num_envs=4, vectorization_mode="vector_entry_point")
assert many.reset(seed=0)[0].shape == (4, *env.observation_space.shape)
many.step(np.zeros((4, 4), np.float32))
v, w = sn.strike(2.0, 0.1)
assert sn.simulate([(0.0, 0.0), (0.5, 0.05)], [v[:2], (0, 0)], [w, (0, 0, 0)]).positions.shape == (2, 2)
"""
LIBRARIES = ("gymnasium", "numpy", "numba")


def tried(python, resolution, wheel):
    """A row of the table: versions, and "works" or the last line of what went wrong."""
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder, "venv")
        run = {"capture_output": True, "text": True, "cwd": folder}
        subprocess.run(["uv", "venv", "--quiet", "--python", python, here], check=True, **run)
        target = ["--python", here, "--resolution", resolution, "--only-binary", ":all:"]
        done = subprocess.run(["uv", "pip", "install", "--quiet", *target, wheel, *LIBRARIES], **run)
        if done.returncode:
            return ["", "", "", f"not installed: {done.stderr.strip().splitlines()[-1]}"]
        listed = subprocess.check_output(
            ["uv", "pip", "freeze", "--quiet", "--python", here], text=True, cwd=folder
        )
        versions = dict(line.split("==") for line in listed.split() if "==" in line)
        env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        env |= {"NUMBA_CACHE_DIR": f"{folder}/kernels", "SNOOKER_ENV_QUIET": "1"}
        done = subprocess.run([here / "bin/python", "-c", SMOKE], env=env, **run)
        seen = "works" if done.returncode == 0 else done.stderr.strip().splitlines()[-1]
        return [*(versions[name] for name in LIBRARIES), seen]


def main():
    """Print the table, line by line."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n\n")[0])
    parser.add_argument("pythons", nargs="+", metavar="VERSION", help="as 3.12")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        build = f"import hatchling.build as b; print(b.build_wheel({folder!r}))"
        name = subprocess.check_output([sys.executable, "-c", build], cwd=ROOT, text=True).split()[-1]
        print(f"| Python | versions | {' | '.join(LIBRARIES)} | seen |\n|{'---|' * 6}")
        for python in args.pythons:
            for words, resolution in (("lowest", "lowest-direct"), ("newest", "highest")):
                row = [python, words, *tried(python, resolution, Path(folder, name))]
                print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
