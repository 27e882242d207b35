"""What does ``pip install`` alone give? Run by a Python that has the wheel and nothing else, in an empty folder.

    python wheel_alone.py

Each part is a user's first try of it. Only the standard library and the wheel's own requirements are imported.
"""

import json
import subprocess
import sys
import time
import urllib.request
from importlib import metadata, util
from pathlib import Path

EXTRAS = {
    "render": "import snooker_env as sn; e = sn.SnookerEnv(render_mode='rgb_array'); e.reset(seed=0); e.render()",
    "train": "import snooker_env.sb3",
    "multi": "import snooker_env as sn; sn.match_env()",
    "plot": "import snooker_env as sn; sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0, 0, 0)]).plot()",
}
"""Extra -> what needs it."""


def run(*words):
    """What ``python WORDS`` prints."""
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, (words, done.stdout[-500:], done.stderr[-2000:])
    return done.stdout


def environments():
    import gymnasium

    env = gymnasium.make("snooker_env:Snooker-v0", aim="target")
    env.reset(seed=0)
    assert env.step([-0.4, 0.0, 0.0, 0.0])[0].shape == env.observation_space.shape
    tables = gymnasium.make_vec("Snooker-v0", num_envs=8, vectorization_mode="vector_entry_point")
    assert tables.reset(seed=0)[0].shape == (8, *env.observation_space.shape)


def simulate():
    import snooker_env as sn

    v, w = sn.strike(2.0, 0.1)
    assert sn.simulate([(0.0, 0.0), (0.5, 0.05)], [v[:2], (0, 0)], [w, (0, 0, 0)]).at(0.5)[0].shape == (2, 2)


def advice_of_the_planner():
    import snooker_env as sn

    position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605), reds=[(-0.3, 1.2), (0.5, 0.4)], on="red")
    words = str(sn.advise(position, agent="planner"))
    assert words.count("\n1. ") == 1


def watch():
    words = run("-m", "snooker_env.watch", "--agent", "planner", "--at-least", "20", "--out", "break.html")
    assert "written: break.html" in words and "<html" in Path("break.html").read_text("utf-8")


def page():
    command = [sys.executable, "-m", "snooker_env.play", "--no-browser", "--agent", "planner"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            address = next(line.strip() for line in server.stdout if line.strip().startswith("http://127."))
            with urllib.request.urlopen(address, timeout=60) as page:
                assert page.status == 200 and b"<html" in page.read()
        finally:
            server.terminate()


def benchmark():
    assert "SnookerBreak-v0" in run("-m", "snooker_env.benchmark", "tasks")
    words = ["SnookerEscape-v0", "--agent", "ghost_ball", "--episodes", "3", "--out", "result.json"]
    run("-m", "snooker_env.benchmark", "run", *words)
    assert "sound" in run("-m", "snooker_env.benchmark", "check", "result.json")
    assert json.loads(Path("result.json").read_text("utf-8"))["agent"]["label"] == "ghost_ball"


def missing_extras():
    for extra, code in EXTRAS.items():
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
        line = done.stderr.strip().splitlines()[-1]
        assert line.endswith(f'install it with: pip install "snooker-env[{extra}]"'), (extra, line)


def main():
    """All parts, with their times."""
    have = {
        name
        for name in ("torch", "stable_baselines3", "pygame", "agents", "benchmarks")
        if util.find_spec(name)
    }
    assert not have, f"this environment holds more than the wheel: {sorted(have)}"
    assert not any(Path().iterdir()), "this folder is not empty"
    print("snooker-env", metadata.version("snooker-env"), "on Python", sys.version.split()[0], flush=True)
    for part in (environments, simulate, advice_of_the_planner, watch, page, benchmark, missing_extras):
        begun = time.perf_counter()
        part()
        print(f"{part.__name__.replace('_', ' '):24} {time.perf_counter() - begun:6.1f} s", flush=True)


if __name__ == "__main__":
    main()
