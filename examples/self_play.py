"""How does an agent learn to play frames from itself alone? MaskablePPO on native tables, against a pool of
its past selves.

    pip install -e ".[train]"
    python -m examples.self_play --out runs/self_play   # trains, then judges 1,000 frames an opponent
    python -m examples.self_play --out runs/self_play   # the same again goes on where it was stopped

A choice is one of 540: a pot, a speed, a side and a top; without a direct pot another line of the cue ball
stands for it. The networks are those of ``train.py`` (``agents.learning.networks``). The reward is the growth
of the lead. The built-in opponents are not trained against.
"""

import argparse
import io
import math
import pickle
import platform
import shlex
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Discrete
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.utils import LinearSchedule

import snooker_env
from agents._lib.files import seal, unseal, write_atomic, write_json
from agents.learning.networks import TablePolicy, TableReader
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from snooker_env.planning.learned.pot_view import with_pots
from snooker_env.players import OpponentPool, SeenPlayer
from snooker_env.progress import Progress
from snooker_env.sb3 import SnookerVecEnv
from snooker_env.tasks import (
    CHOICES,
    OBSERVATION_SIZE,
    SIDES,
    SPEEDS,
    TOPS,
    choice_of,
    observation_space,
)

GAME: dict[str, Any] = {"task": "frame", "action": "discrete", "noise": "professional", "reward": "points"}
LEARNING: dict[str, Any] = {
    "n_steps": 64,
    "n_epochs": 2,
    "gamma": 0.95,
    "gae_lambda": 0.5,
    "vf_coef": 0.01,
    "ent_coef": 0.003,
}
"""As masked PPO needs it over 540 strokes: many tables, few strokes of each, and little credit for what comes later."""
RATE = 2e-3
"""Learning rate at the beginning; it falls to nearly 0."""
SELVES = 20
"""Size of the pool at the end: one more past self for every twentieth of the shots."""
MODEL, CHECKPOINT = Path(__file__).with_suffix(".pt"), "checkpoint.pkl"


def view(observations):
    """What the network reads: the table and its four widest pots; without a pot, the way to the nearest ball
    on as the first."""
    shown = with_pots(observations[:, :OBSERVATION_SIZE])
    balls = shown[:, :110].reshape(-1, 22, 5)  # x, y, on the table, value, on
    way = (balls[:, 1:, :2] - balls[:, :1, :2]) * (HALF_WIDTH, HALF_LENGTH)
    far = np.where(balls[:, 1:, 2] * balls[:, 1:, 4] > 0.0, np.hypot(way[..., 0], way[..., 1]), np.inf)
    rows, near = np.flatnonzero((shown[:, OBSERVATION_SIZE] == 0.0) & np.isfinite(far.min(1))), far.argmin(1)
    pot = shown[:, OBSERVATION_SIZE:]
    pot[rows, 0] = 1.0
    pot[rows, 1:3] = way[rows, near[rows]] / far[rows, near[rows], None]
    pot[rows, 5] = far[rows, near[rows]] / HALF_LENGTH - 1.0
    return shown


class FrameReader(TableReader):
    """Reads the observations of frames."""

    def forward(self, seen):
        """One pass."""
        return super().forward(torch.as_tensor(view(seen.numpy())))


class FramePolicy(TablePolicy):
    """Scores all strokes of a frame's table."""

    reader = FrameReader


class SelfPlayed:
    """The trained agent as a player of frames, for example with ``--agent examples.self_play:SelfPlayed``."""

    options = {"task": "frame", "action": "discrete"}  # noqa: RUF012

    def __init__(self, weights=MODEL):
        self.policy = policy_of(torch.load(weights, weights_only=True))

    def act(self, observations, masks, seeds):
        """The most probable choice on each table."""
        return self.policy.predict(
            observations[:, :OBSERVATION_SIZE], action_masks=masks, deterministic=True
        )[0]


def weights(policy):
    """A copy of the weights of a policy."""
    # the same again
    return {
        name: part.clone()
        for name, part in policy.state_dict().items()
        if not name.startswith(("pi_", "vf_"))
    }


def load(policy, weights):
    """Give a policy these weights."""
    policy.load_state_dict(weights, strict=False)


def policy_of(weights):
    """A policy with these weights, for the entries of the observation that frames share with visits: the
    network reads no others."""
    policy = FramePolicy(observation_space("flat"), Discrete(CHOICES), lambda _: 0.0)
    load(policy, weights)
    return policy


class PastSelf(SelfPlayed):
    """A past self as an opponent: it draws its choices from its own policy."""

    def __init__(self, weights):
        self.weights, self.policy = weights, policy_of(weights)

    def act(self, observations, masks, seeds):
        """Its choices, each drawn by the seed of its table."""
        draws = np.array([np.random.default_rng(seed).random() for seed in seeds.tolist()])
        seen = torch.as_tensor(observations[:, :OBSERVATION_SIZE])
        with torch.no_grad():
            shares = (
                self.policy.get_distribution(seen, action_masks=masks)
                .distribution.probs.double()
                .cumsum(1)
                .numpy()
            )
        return (shares < draws[:, None] * shares[:, -1:]).sum(axis=1)


def add(pool, weights):
    """Add the self with these weights to the pool. The newest plays half of the frames that begin now; the
    others share the rest."""
    for k in range(len(pool.members)):
        pool.set_weight(k, 1.0)
    pool.add(SeenPlayer(PastSelf(weights)), max(1, len(pool.members)))


def judge(policy, opponent, frames, threads):
    """Frames won against an opponent by the most probable choices. The agent breaks in every other
    frame."""
    tables = snooker_env.SnookerVectorEnv(frames, opponent=opponent, threads=threads, **GAME)
    breaker = np.arange(frames) % 2
    observations, _ = tables.reset(seed=10**9, options={"breaker": breaker})
    going, won, lead, strokes = (
        np.ones(frames, bool),
        np.zeros(frames, int),
        np.zeros(frames),
        np.zeros(frames),
    )
    while going.any():
        choices, _ = policy.predict(observations, action_masks=tables.action_masks(), deterministic=True)
        observations, _, terminated, truncated, info = tables.step(choices)
        ended = going & (terminated | truncated)
        won[ended], lead[ended] = info["winner"][ended] == 0, (info["score"] - info["opponent_score"])[ended]
        strokes[ended], going = info["strokes"][ended], going & ~ended
    tables.close()
    return {
        "frames": frames,
        "won": won.mean(),
        "interval": wilson(won.sum(), frames),
        "won_breaking": won[breaker == 0].mean(),
        "won_otherwise": won[breaker == 1].mean(),
        "lead": lead.mean(),
        "strokes": strokes.mean(),
    }


def wilson(won, n, z=1.96):
    """The 95 % interval of a share [Wilson 1927]."""
    middle, half = (
        (won + z * z / 2) / (n + z * z),
        z * math.sqrt(won * (n - won) / n + z * z / 4) / (n + z * z),
    )
    return middle - half, middle + half


class Softly:
    """For comparison: the widest pot at 2.3 m/s, whatever the table looks like. The environment solves the
    aim for it, too."""

    def predict(self, observations, action_masks, deterministic):
        """The same choice on each table."""
        return np.full(
            len(observations), choice_of(0, SPEEDS.index(2.3), SIDES.index(0.0), TOPS.index(0.0))
        ), None


class Run(BaseCallback):
    """Between two rollouts, from time to time: the pool grows, some frames are judged, and everything is
    saved."""

    def __init__(self, args, pool, curve, seconds, progress):
        super().__init__()
        self.args, self.pool, self.curve, self.progress, self.began = (
            args,
            pool,
            curve,
            progress,
            time.perf_counter() - seconds,
        )

    def _on_rollout_start(self):
        policy, shots, args = self.model.policy, self.num_timesteps, self.args
        if not self.curve or shots - self.curve[-1]["shots"] >= args.shots / SELVES:
            if self.curve:
                add(self.pool, weights(policy))
            won = {
                name: judge(policy, name, max(2, args.frames // 5), args.threads)["won"]
                for name in ("random", "ghost_ball")
            }
            self.curve.append({"shots": shots, "seconds": round(time.perf_counter() - self.began), **won})
            self.save()

    def save(self):
        """Write the checkpoint: between two rollouts it loses nothing."""
        policy, args = self.model.policy, self.args
        state = {
            "shots": self.num_timesteps,
            "policy": weights(policy),
            "optimizer": policy.optimizer.state_dict(),
            "pool": [past.seen.weights for past in self.pool.members],
            "tables": self.training_env.env_method("get_state"),
            "random": (np.random.get_state(), torch.get_rng_state()),  # noqa: NPY002
            "curve": self.curve,
            "seconds": time.perf_counter() - self.began,
            "asked": (args.shots, args.tables, args.seed),
        }
        write_atomic(args.out / CHECKPOINT, seal(pickle.dumps(state), CHECKPOINT))

    def _on_step(self):
        won = ", ".join(f"{self.curve[-1][name]:.1%} won against {name}" for name in ("random", "ghost_ball"))
        self.progress.at(self.num_timesteps, won)
        return True


def train(args):
    """Train, or go on from the checkpoint. Returns the model, the curve and the seconds of training."""
    file = args.out / CHECKPOINT
    try:
        state = pickle.loads(unseal(file.read_bytes(), CHECKPOINT)) if file.is_file() else None
    except ValueError as error:
        raise SystemExit(f"{file}: {error}; remove it to begin anew") from None
    if state and state["asked"] != (args.shots, args.tables, args.seed):
        raise SystemExit(
            f"{file} was made with --shots, --tables and --seed {state['asked']}: "
            "give these, or another --out"
        )
    pool = OpponentPool()
    tables = SnookerVecEnv(args.tables, opponent=pool, threads=args.threads, **GAME)
    rollout = args.tables * LEARNING["n_steps"]
    rate = LinearSchedule(RATE, 1e-5, 1.0)
    model = MaskablePPO(
        FramePolicy,
        tables,
        seed=None if state else args.seed,
        device="cpu",
        batch_size=min(2048, rollout),
        learning_rate=rate,
        **LEARNING,
    )
    for past in state["pool"] if state else [weights(model.policy)]:
        add(pool, past)
    if state:
        load(model.policy, state["policy"])
        model.policy.optimizer.load_state_dict(state["optimizer"])
        model.num_timesteps = state["shots"]
        tables.set_options([{"state": table} for table in state["tables"]])
        numpy_state, torch_state = state["random"]
        np.random.set_state(numpy_state)  # noqa: NPY002 - Stable-Baselines3 draws from the global one
        torch.set_rng_state(torch_state)
    goal, done = rollout * -(-args.shots // rollout), state["shots"] if state else 0
    with Progress("self-play", goal, "shots", done=done, to=sys.stdout) as progress:
        run = Run(args, pool, state["curve"] if state else [], state["seconds"] if state else 0.0, progress)
        model.learn(args.shots - model.num_timesteps, run, reset_num_timesteps=not state)
    return model, run.curve, time.perf_counter() - run.began


def main(argv=None):
    """Train, judge, write results.json and the weights."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--shots",
        type=int,
        default=800_000,
        help="the agent's shots [800000: about 10 minutes on one idle core]",
    )
    parser.add_argument(
        "--frames", type=int, default=1000, help="frames to judge against each opponent [1000]"
    )
    parser.add_argument("--tables", type=int, default=256, help="tables side by side [256]")
    parser.add_argument("--threads", type=int, help="threads of the tables [all processors]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--out", type=Path, default=Path("runs", "self_play"), help="folder of the run [runs/self_play]"
    )
    args = parser.parse_args(argv)
    args.out.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)
    # these checks cost a twentieth of the time
    torch.distributions.Distribution.set_default_validate_args(False)
    model, curve, seconds = train(args)
    judged = {
        name: {other: judge(policy, other, args.frames, args.threads) for other in ("random", "ghost_ball")}
        for name, policy in (("agent", model.policy), ("constant choice", Softly()))
    }
    for name, against in judged.items():
        for other, result in against.items():
            share, (low, high) = result["won"], result["interval"]
            print(
                f"{name}: won {share:.1%} [{low:.1%}, {high:.1%}] of {args.frames} frames "
                f"against {other}, mean lead {result['lead']:.1f}"
            )
    command = ["python", "-m", "examples.self_play", *(sys.argv[1:] if argv is None else argv)]
    results = {
        "command": shlex.join(command),
        "shots": model.num_timesteps,
        "seconds": round(seconds),
        "judged": judged,
        "curve": curve,
        "game": GAME,
        "learning": LEARNING | {"rate": RATE, "tables": args.tables, "selves": SELVES, "seed": args.seed},
        "versions": {
            "snooker_env": snooker_env.__version__,
            "torch": torch.__version__,
            "python": platform.python_version(),
        },
    }
    file = io.BytesIO()
    torch.save(weights(model.policy), file)
    write_atomic(args.out / "weights.pt", file.getvalue())
    write_json(args.out / "results.json", results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
