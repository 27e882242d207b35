"""What did everything give before it was moved? One digest a set of results, kept in ``golden.json``; a
redesign changes none of them.

    python -m tests.golden            compare
    python -m tests.golden --make     keep what comes out now, on purpose: the physics, the rules or what a step returns has changed

A digest is the SHA-256 of all numbers of its set, rounded to 1e-9. The sets use public names only, and none
depends on another.
"""

import argparse
import hashlib
import json
import sys
from pathlib import Path

import gymnasium
import numpy as np

import snooker_env as sn

KEPT = Path(__file__).with_name("golden.json")
FIDELITIES = ("fast", "standard", "reference", "euler:300")
PHYSICS = {
    "paper": "paper",
    "match": "match",
    "marlow": {"preset": "paper", "mu_bb": "marlow"},
    "nap": {"preset": "match", "nap": 0.01},
}


class Digest:
    """Takes in numbers, arrays, and dicts of them."""

    def __init__(self):
        self._hash = hashlib.sha256()

    def add(self, *values):
        """Everything given, in order; the keys of a dict sorted."""
        for value in values:
            if isinstance(value, dict):
                for key in sorted(value):
                    self._hash.update(key.encode())
                    self.add(value[key])
            else:
                rounded = np.round(np.asarray(value, np.float64), 9) + 0.0  # no negative zero
                self._hash.update(repr(rounded.shape).encode() + np.ascontiguousarray(rounded).tobytes())

    def text(self):
        """The digest."""
        return self._hash.hexdigest()


def _unit(rng):
    angle = rng.uniform(-np.pi, np.pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def ball_impacts(physics, fidelity):
    """Two balls with spin: any, head-on along an axis, and grazing."""
    out, rng = Digest(), np.random.default_rng(1)
    for k in range(60):
        normal = _unit(rng) if k % 3 else np.array([1.0, 0.0, 0.0])
        v1, v2 = rng.normal(0, 1.5, 3) * (1, 1, 0), rng.normal(0, 1.5, 3) * (1, 1, 0) * (k % 2)
        if k % 3 == 0:
            v1, v2 = 2.0 * normal, 0.0 * normal
        out.add(
            *sn.collide_balls(
                v1,
                rng.normal(0, 60, 3) * (k % 5 > 0),
                v2,
                rng.normal(0, 60, 3) * (k % 2),
                normal,
                physics,
                fidelity,
            )
        )
    return out.text()


def cushion_impacts(physics, fidelity):
    """A ball with spin into a cushion."""
    out, rng = Digest(), np.random.default_rng(2)
    for k in range(60):
        normal = _unit(rng) if k % 3 else np.array([0.0, -1.0, 0.0])
        v = rng.normal(0, 2.0, 3) * (1, 1, 0) - 0.5 * normal
        out.add(*sn.collide_cushion(v, rng.normal(0, 80, 3) * (k % 5 > 0), normal, physics, fidelity))
    return out.text()


def shots(physics, fidelity):
    """Whole shots: end states, logs and a moment in between, on three tables, of 1 to 22 balls, with spin; in
    threads the same."""
    out, rng = Digest(), np.random.default_rng(3)
    env = gymnasium.make("Snooker-v0").unwrapped
    for k in range(8 if fidelity.startswith("euler") else 24):
        env.reset(seed=k)
        r, here = env.positions, env.on_table
        here[22 - k % 15 :] = False
        v, w = np.zeros((22, 2)), np.zeros((22, 3))
        speed, spin = sn.strike(
            rng.uniform(0.3, 6.5),
            rng.uniform(-np.pi, np.pi),
            *rng.uniform(-0.3, 0.3, 2),
            elevation=0.1,
            physics=physics,
        )
        v[0], w[0] = speed[:2], spin
        if k % 4 == 3:
            v[5], w[5] = (0.7, -0.4), (10.0, 20.0, 30.0)
        table = ("match", "tight", None)[k % 3]
        shot = sn.simulate(r, v, w, table, physics, fidelity, on_table=here)
        out.add(
            shot.positions,
            shot.potted,
            shot.on_table,
            shot.duration,
            *(shot.events[name] for name in ("time", "kind", "i", "j")),
        )
        out.add(*shot.at(0.37 * shot.duration))
        both = sn.simulate_batch(
            np.stack([r, r]),
            np.stack([v, 0.5 * v]),
            np.stack([w, w]),
            table,
            physics,
            fidelity,
            on_table=np.stack([here, here]),
            threads=2,
        )
        out.add(both.positions, both.potted, both.duration, both.event_count)
    return out.text()


def gaussian(times):
    """Errors without lapses, as a law that stays: the golden states are of the kernels, not of the levels."""
    return {
        "aim_deg": 0.027 * times,
        "speed_rel": 0.01 * times,
        "offset_mm": 0.164 * times,
        "elevation_deg": 0.2 * times,
        "growth": 1.0,
    }


FORM = {"aim": "absolute", "observation": "flat"}  # unless a set says otherwise
VISITS = {
    "plain": {},
    "target": {"aim": "target", "noise": gaussian(1.0), "elevation": True},
    "discrete": {"action": "discrete", "noise": gaussian(4.0), "layout": "random:6"},
    "break_off": {"layout": "break_off", "placement": True},
    "balls": {
        "observation": "balls",
        "layout": "line_up",
        "reward": "points_and_fouls",
        "aim": "target",
        "physics": "match",
    },
    "fast": {"fidelity": "fast", "table": "tight", "layout": "colours", "aim": "target", "reward": "pots"},
    "reference": {"fidelity": "reference", "aim": "target", "layout": "pots:easy", "noise": "olympiad"},
}


def visits(options):
    """Visits on single tables: observations, rewards, ends and infos."""
    out, rng = Digest(), np.random.default_rng(4)
    env = gymnasium.make("Snooker-v0", **FORM | options)
    for k in range(12):
        observation, info = env.reset(seed=k)
        out.add(observation, info)
        for _ in range(6):
            a = rng.uniform(-1, 1, 7).astype(np.float32)
            masks = env.unwrapped.action_masks() if options.get("action") == "discrete" else None
            action = (
                a[: env.action_space.shape[0]]
                if masks is None
                else int(np.flatnonzero(masks)[int((a[0] + 1) * 0.5 * (masks.sum() - 1))])
            )
            observation, reward, ended, cut, info = env.step(action)
            out.add(observation, reward, ended, cut, info)
            if ended:
                break
    return out.text()


def many_visits(mode):
    """Visits side by side in the native vector environment, on two threads."""
    out, rng = Digest(), np.random.default_rng(5)
    env = gymnasium.make_vec(
        "Snooker-v0",
        24,
        vectorization_mode="vector_entry_point",
        aim="target",
        observation="flat",
        noise=gaussian(2.0),
        layout="random:4",
        threads=2,
        autoreset_mode=mode,
        max_episode_steps=4,
    )
    observation, info = env.reset(seed=7)
    out.add(observation, info)
    for _ in range(12):
        observation, rewards, ended, cut, info = env.step(rng.uniform(-1, 1, (24, 4)).astype(np.float32))
        if "final_obs" in info:
            out.add(*(row for row in info.pop("final_obs") if row is not None))
        out.add(observation, rewards, ended, cut, info)
        if mode == "Disabled" and (ended | cut).any():
            env.reset(options={"reset_mask": ended | cut})
    return out.text()


FRAMES = {
    "plain": {"aim": "target"},
    "placed": {"aim": "target", "placement": True, "says": ["decision"]},
    "missed": {
        "aim": "target",
        "placement": True,
        "says": ["decision"],
        "miss": "clear_path",
        "reward": "win",
    },
    "absolute": {
        "elevation": True,
        "observation": "balls",
        "miss": "clear_path",
        "max_strokes": 60,
        "physics": "match",
    },
}
GIVEN = {"layout": "break_off", "noise": "none"}
"""Frames without chance: nothing is drawn but who breaks, which changes no figure here, and where the first
cue ball lies."""


def _first_place(env, options):
    """A state of the start with the cue ball at its usual place."""
    state = json.loads(json.dumps(env.get_state()))
    state["positions"][0] = [0.146, -1.0475]
    return {"state": state, **options}


def frames(options):
    """Frames that the agent plays alone."""
    out, rng = Digest(), np.random.default_rng(6)
    env = gymnasium.make("Snooker-v0", task="frame", opponent="none", **GIVEN, **FORM | options)
    for k in range(3):
        env.reset(seed=k)
        observation, info = env.reset(options=_first_place(env.unwrapped, {}))
        out.add(observation, info)
        for _ in range(150):
            observation, reward, ended, cut, info = env.step(
                rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
            )
            out.add(observation, reward, ended, cut, info)
            if ended or cut:
                break
    return out.text()


def matches(options):
    """Frames of two players, each figure as the player who broke sees it."""
    out, rng = Digest(), np.random.default_rng(8)
    options = {name: value for name, value in options.items() if name != "layout"}
    env = sn.match_env(noise="none", **FORM | options)
    for k in range(3):
        env.reset(seed=k)
        env.reset(options=_first_place(env, {}))
        first = env.agent_selection
        for _ in range(150):
            if not env.agents:
                break
            name = env.agent_selection
            observation, reward, ended, cut, info = env.last()
            shared = {
                key: info[key]
                for key in (
                    "points",
                    "penalty",
                    "fouls",
                    "score",
                    "opponent_score",
                    "strokes",
                    "break",
                    "choice",
                )
            }
            out.add(float(name == first), observation, reward, ended, cut, shared)
            size = env.action_space(name).shape
            env.step(None if ended or cut else rng.uniform(-1, 1, size).astype(np.float32))
    return out.text()


def _sets():
    """Every set by its name."""
    for name, physics in PHYSICS.items():
        for fidelity in FIDELITIES:
            yield f"ball impacts, {name}, {fidelity}", lambda p=physics, f=fidelity: ball_impacts(p, f)
            yield f"cushion impacts, {name}, {fidelity}", lambda p=physics, f=fidelity: cushion_impacts(p, f)
            yield f"shots, {name}, {fidelity}", lambda p=physics, f=fidelity: shots(p, f)
    for name, options in VISITS.items():
        yield f"visits, {name}", lambda o=options: visits(o)
    for mode in ("NextStep", "SameStep", "Disabled"):
        yield f"many visits, {mode}", lambda m=mode: many_visits(m)
    for name, options in FRAMES.items():
        yield f"frames, {name}", lambda o=options: frames(o)
        yield f"matches, {name}", lambda o=options: matches(o)


SETS = dict(_sets())


def main(argv=None):
    """Compare or keep; exit code 1 if a set differs."""
    parser = argparse.ArgumentParser(
        "python -m tests.golden", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--make", action="store_true", help="keep what comes out now")
    made = parser.parse_args(argv).make
    now = {name: compute() for name, compute in SETS.items()}
    if made:
        KEPT.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")
        print(f"{len(now)} digests kept in {KEPT}")
        return 0
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    differ = [name for name in {**kept, **now} if kept.get(name) != now.get(name)]
    print("\n".join(f"differs: {name}" for name in differ) or f"all {len(now)} sets as kept")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
