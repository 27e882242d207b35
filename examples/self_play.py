"""How does an agent learn whole frames only from itself? PPO plays both sides of native tables, on the menu of strokes.

    pip install -e ".[train]"
    python -m examples.self_play --out runs/self_play   # trains, then plays 1,000 frames per opponent
    python -m examples.self_play --out runs/self_play   # continues an interrupted run

The agent learns from every stroke of both sides. The next state's value counts for a player if the same player strikes next,
and against that player otherwise; this sign is the only difference from PPO for one player. The reward is the growth of the
lead, plus a bonus for the frame. Training starts from the package's ``strokes`` for visits (single turns at the table) unless
you pass --fresh.
"""

import argparse
import io
import pickle
import shlex
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import torch

import snooker_env
from agents._lib.files import seal, unseal, write_atomic, write_json
from agents._lib.provenance import provenance
from agents.learning.export import layers_of_menu
from agents.learning.frame_self_play import win_share
from snooker_env.players import SeenPlayer, player
from snooker_env.players.seen import MenuNetwork
from snooker_env.players.weights import learned_menu
from snooker_env.progress import Progress
from snooker_env.sb3 import StrokesPolicy

GAME: dict[str, Any] = {"action": "strokes", "observation": "strokes", "noise": "professional", "cue": "real"}
GAME |= {"miss": "clear_path", "max_strokes": 200}
STEPS, BATCH, EPOCHS = 32, 512, 4
RATE, GAMMA, LAMBDA, CLIP = 5e-4, 0.97, 0.5, 0.2
"""Learning rates: the final rate is a twentieth of the first."""
ENTROPY, VALUE, GRADIENT = 0.002, 0.05, 0.5
LEAD, WON = 0.1, 2.0
"""The rewards for a point of lead and for the frame."""
CRITIC = 8
"""Rollouts that train only the value, which starts out less accurate than the policy."""
JUDGED, OPPONENTS = 10, ("ghost_ball", "best_pot", "search")
"""How often a run is evaluated during training, and the opponents at its end."""
CHECKPOINT = "checkpoint.pkl"


def make_policy(tables, *, fresh: bool = False) -> StrokesPolicy:
    """The initial policy: untrained, or with the layers of the package's ``strokes``, which reads only the state of a
    visit."""
    policy = StrokesPolicy(tables.single_observation_space, tables.single_action_space, lambda _: RATE)
    net = policy.mlp_extractor
    if not fresh:
        (first, bias), second, score = learned_menu("visits")
        columns = net.of_stroke.weight.shape[1]
        with torch.no_grad():
            net.of_state.weight.zero_()
            net.of_state.weight[:, : first.shape[1] - columns] = torch.as_tensor(first[:, columns:])
            for layer, (weight, shift) in (
                (net.of_stroke, (first[:, :columns], bias)),
                (net.second, second),
                (net.score, score),
            ):
                layer.weight[:], layer.bias[:] = torch.as_tensor(weight), torch.as_tensor(shift)
    return policy


def player_of(policy: StrokesPolicy) -> SeenPlayer:
    """A player of frames that takes the policy's most probable choices."""
    return SeenPlayer(MenuNetwork(layers_of_menu(policy.state_dict()), "frame"), name="self_play")


def advantages_of(rewards, values, signs, last):
    """Generalised advantages, (steps, tables). ``signs``: 1 if the same player strikes next, -1 if the opponent does, 0 at the
    end of a frame; ``last``: the next striker's values after the last step."""
    advantages, running, after = np.zeros_like(rewards), np.zeros_like(last), last
    for t in reversed(range(len(rewards))):
        surprise = rewards[t] + GAMMA * signs[t] * after - values[t]
        running = surprise + GAMMA * LAMBDA * signs[t] * running
        advantages[t], after = running, values[t]
    return advantages


class Run:
    """A training, new or from its checkpoint: the policy, the tables and the progress."""

    def __init__(self, args: argparse.Namespace):
        self.args, self.asked = args, (args.shots, args.tables, args.seed, args.fresh)
        self.tables = snooker_env.MatchVectorEnv(args.tables, threads=args.threads, **GAME)
        torch.manual_seed(args.seed)
        self.policy = make_policy(self.tables, fresh=args.fresh)
        self.optimizer = torch.optim.Adam(self.policy.parameters(), lr=RATE, eps=1e-5)
        self.shots, self.curve, self.spent = 0, [], 0.0
        file, options = args.out / CHECKPOINT, None
        if file.is_file():
            options = {"states": self._restore(file)}
        self.seen, _ = self.tables.reset(seed=None if options else args.seed, options=options)
        self.began = time.perf_counter()

    @property
    def rollout(self) -> int:
        """Shots between two updates."""
        return self.args.tables * STEPS

    @property
    def total(self) -> int:
        """All shots, in whole rollouts."""
        return self.rollout * -(-self.args.shots // self.rollout)

    def _restore(self, file: Path) -> list[dict[str, Any]]:
        """Restore the state of a checkpoint. Returns the state of the tables."""
        try:
            state = pickle.loads(unseal(file.read_bytes(), CHECKPOINT))
        except ValueError as error:
            raise SystemExit(f"{file}: {error}; remove it to start again") from None
        if state["asked"] != self.asked:
            words = "--shots, --tables, --seed and --fresh"
            raise SystemExit(
                f"{file} was made with {words} {state['asked']}: use these options, or another --out"
            )
        self.policy.load_state_dict(state["policy"])
        self.optimizer.load_state_dict(state["optimizer"])
        torch.set_rng_state(state["random"])
        self.shots, self.curve, self.spent = state["shots"], state["curve"], state["seconds"]
        return state["tables"]

    @property
    def seconds(self) -> float:
        """Duration so far [s], including the time before a resume."""
        return self.spent + time.perf_counter() - self.began

    def save(self) -> None:
        """Write the checkpoint, which is complete between two rollouts."""
        state = {"asked": self.asked, "shots": self.shots, "curve": self.curve, "seconds": self.seconds}
        state |= {"policy": self.policy.state_dict(), "optimizer": self.optimizer.state_dict()}
        state |= {"tables": self.tables.get_state(), "random": torch.get_rng_state()}
        write_atomic(self.args.out / CHECKPOINT, seal(pickle.dumps(state), CHECKPOINT))

    def train(self) -> None:
        """Train rollout by rollout, with evaluations and checkpoints in between."""
        with Progress("self-play", self.total, "shots", done=self.shots, to=sys.stdout) as progress:
            while self.shots < self.total:
                if self.shots >= len(self.curve) * self.total // JUDGED:
                    won, _ = win_share(
                        player_of(self.policy), player("best_pot"), 5 * 10**6, self.args.judged
                    )
                    self.curve.append({"shots": self.shots, "seconds": round(self.seconds), "best_pot": won})
                    print(
                        f"{self.shots:,} shots: {won:.1%} of {self.args.judged} won against best_pot",
                        flush=True,
                    )
                    self.save()
                self._learn(*self._play())
                progress.at(self.shots)
        self.save()

    def _play(self):
        """Play a rollout. Returns (observations, actions, log probabilities, advantages, returns), one row per stroke."""
        n, rows = self.args.tables, np.arange(self.args.tables)
        seen = np.empty((STEPS, n, self.seen.shape[1]), np.float32)
        actions = np.empty((STEPS, n), np.int64)
        logs, values, rewards, signs = np.empty((4, STEPS, n), np.float32)
        for t in range(STEPS):
            seen[t], before = self.seen, self.tables.strikers
            with torch.no_grad():
                chosen, value, log = self.policy(torch.from_numpy(self.seen))
            actions[t], logs[t], values[t] = chosen.numpy(), log.numpy(), value[:, 0].numpy()
            self.seen, gained, ended, cut, infos = self.tables.step(actions[t])
            over = ended | cut
            ahead = np.sign(infos["score"] - infos["opponent_score"]) * (1 - 2 * before)
            rewards[t] = LEAD * gained[rows, before] + WON * ended * ahead
            signs[t] = np.where(over, 0, np.where(self.tables.strikers == before, 1, -1))
            if over.any():
                self.seen, _ = self.tables.reset(options={"reset_mask": over})
        with torch.no_grad():
            last = self.policy.predict_values(torch.from_numpy(self.seen))[:, 0].numpy()
        self.shots += STEPS * n
        advantages = advantages_of(rewards, values, signs, last)
        parts = seen, actions, logs, advantages, advantages + values
        return [torch.from_numpy(part.reshape(STEPS * n, *part.shape[2:])) for part in parts]

    def _learn(self, seen, actions, logs, advantages, returns) -> None:
        """Update the policy by PPO on a rollout."""
        for group in self.optimizer.param_groups:
            group["lr"] = RATE * max(0.05, 1.0 - self.shots / self.total)
        known = self.shots > CRITIC * self.rollout or self.args.fresh
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(seen)).split(BATCH):
                values, new, entropy = self.policy.evaluate_actions(seen[rows], actions[rows])
                error = (values[:, 0] - returns[rows]).square().mean()
                gain = advantages[rows]
                gain = (gain - gain.mean()) / (gain.std() + 1e-8)
                ratio = (new - logs[rows]).exp()
                better = torch.min(gain * ratio, gain * ratio.clamp(1 - CLIP, 1 + CLIP)).mean()
                loss = VALUE * error - ENTROPY * entropy.mean() - (better if known else 0.0)
                self.optimizer.zero_grad()
                loss.backward()
                torch.nn.utils.clip_grad_norm_(self.policy.parameters(), GRADIENT)
                self.optimizer.step()


def parse(argv) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("--shots", type=int, default=1_000_000, help="strokes of both sides [1000000: an hour on one core]")
    add("--frames", type=int, default=1000, help="frames against each opponent at the end [1000]")
    add("--judged", type=int, default=300, help="frames of each evaluation during training [300]")
    add("--tables", type=int, default=128, help="tables side by side [128]")
    add("--threads", type=int, help="threads of the tables [all processors]")
    add("--seed", type=int, default=0)
    add("--fresh", action="store_true", help="start from scratch")
    add("--out", type=Path, default=Path("runs", "self_play"), help="folder of the run [runs/self_play]")
    return parser.parse_args(argv)


def main(argv=None):
    """Train, evaluate, and write results.json and the weights."""
    args = parse(argv)
    args.out.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)
    run = Run(args)
    run.train()
    judged = {}
    for name in OPPONENTS:
        won, error = win_share(player_of(run.policy), player(name), 10**6, args.frames)
        judged[name] = {"won": won, "error": error, "frames": args.frames}
        print(f"won {won:.1%} ± {1.96 * error:.1%} of {args.frames} frames against {name}")
    command = ["python", "-m", "examples.self_play", *(sys.argv[1:] if argv is None else argv)]
    results = provenance(shlex.join(command), args.seed) | {
        "shots": run.shots,
        "seconds": round(run.seconds),
        "judged": judged,
        "curve": run.curve,
        "game": GAME,
    }
    file = io.BytesIO()
    torch.save(run.policy.state_dict(), file)
    write_atomic(args.out / "weights.pt", file.getvalue())
    write_json(args.out / "results.json", results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
