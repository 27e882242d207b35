"""Watch an agent play a visit or a frame: printed stroke by stroke, and written as a replay or a film."""

import argparse
import tempfile
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._lib.check import integer, number, refuse
from ._lib.command import exit_code
from .benchmark import HELD_OUT_SEED
from .envs.snooker import SnookerEnv
from .planning import Positions
from .players import FRAMES, VISITS, Player, decision_seeds, player
from .players.resolver import players_of
from .players.saved_models import add_model_options, of_others, options_of_words
from .replays import replay
from .replays.document import FILMS, SUFFIXES
from .replays.film import encoder_file

NAME = "snooker_env.watch"
USUAL, TACTICIAN = "planner", "tactician"  # who plays a visit and a frame unless someone is named
FRAME = {"task": "frame", "cue": "real", "miss": "clear_path"}  # options of a frame that is watched


def play_episode(who: Player, seed: int, **options: object) -> SnookerEnv:
    """A ``SnookerEnv`` after a whole visit or frame, with its history; visits are those of ``play_visits``."""
    reads = VISITS if options.get("task", "visit") == "visit" else FRAMES
    every: dict[str, Any] = {**options, "action": "box", "observation": "flat", **reads}
    env = SnookerEnv(**every)
    bound, decision, ended = who.at(env), 0, False
    env.keep_history = True
    env.reset(seed=seed)
    while not ended:
        at = Positions.of(env)
        strokes = bound.play(at, decision_seeds(0, np.array([seed]), decision))
        _, _, terminated, truncated, _ = env.step(strokes.actions(env.options, at)[0].astype(np.float32))
        ended, decision = terminated or truncated, decision + 1
    return env


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog=f"python -m {NAME}", description=__doc__)
    add = p.add_argument
    add("--agent", help=f"player: a name, a model's .zip or MODULE:CLASS [{USUAL}; with --frame {TACTICIAN}]")
    add("--frame", action="store_true", help="play a whole frame against --opponent")
    add("--opponent", help="the other player of the frame [the agent itself]")
    add("--out", type=Path, help="write FILE.html, .json, .mp4 or .gif instead of opening the browser")
    add("--layout", default="held_out", help="layout of the tables [%(default)s: those of the benchmark]")
    add("--noise", default="professional", help="execution errors [%(default)s]")
    add("--seed", type=int, default=HELD_OUT_SEED, help="seed of the first table [%(default)s]")
    least = "show the first visit with so many points, else the best one"
    add("--at-least", type=int, default=0, metavar="POINTS", help=least)
    add("--tries", type=int, default=200, help="most visits played to find it [%(default)s]")
    add("--speed", type=float, help="speed of a film, as a multiple of real time")
    add_model_options(p)
    return p


def _film_options(args: argparse.Namespace) -> dict[str, Any]:
    """The options of a film, {} for a page; ValueError if arguments conflict."""
    suffix = args.out.suffix.lower() if args.out else ".html"
    if suffix not in SUFFIXES:
        raise refuse("out", str(args.out), f"must end in {', '.join(SUFFIXES)}")
    if suffix in FILMS:
        encoder_file()  # what is missing is said before anything is played
    film = {} if args.speed is None else {"speed": number("speed", args.speed, 0.0, 100.0, open_low=True)}
    if film and suffix not in FILMS:
        raise refuse("out", str(args.out), "must be a film (.mp4, .gif) with --speed")
    if args.opponent and not args.frame:
        raise refuse("opponent", args.opponent, "must be left out without --frame")
    if args.frame and args.at_least:
        raise refuse("at_least", args.at_least, "must be left out with --frame")
    integer("seed", args.seed, 0, 2**63)
    integer("tries", args.tries, 1, 10**9)
    if args.out and args.out.is_dir():
        raise refuse("out", str(args.out), "must be a file, not a folder")
    if args.out:
        args.out.parent.mkdir(parents=True, exist_ok=True)
    return film


def find_episode(args: argparse.Namespace) -> tuple[SnookerEnv, int, list[str]]:
    name = args.agent or (TACTICIAN if args.frame else USUAL)
    other = args.opponent or name
    # a model of others opposite acts as it was trained to, not as the table's options say
    names: list[str] = [name, other] if args.frame and other != name and of_others(other) else [name]
    players = dict(zip(names, players_of(names, args.trust, options_of_words(args.options)), strict=True))
    who, label = players[name], name.rpartition(":")[2]
    if args.frame:
        opposite = players[other] if of_others(other) else other
        options: dict[str, Any] = {**FRAME, "noise": args.noise, "opponent": opposite, "trust": args.trust}
        env = play_episode(who, args.seed, **options)
        return env, args.seed, [f"{label} A", f"{label} B"] if other == name else [label, other]
    best, its = None, args.seed
    for seed in range(args.seed, args.seed + args.tries):
        env = play_episode(who, seed, layout=args.layout, noise=args.noise, cue="real")
        if best is None or env.points > best.points:
            best, its = env, seed
        if env.points >= args.at_least:
            break
    assert best is not None  # there is one try at least
    return best, its, [label]


def watch(args: argparse.Namespace, film: dict[str, Any]) -> None:
    env, seed, names = find_episode(args)
    made, where = f"{names[0]}: {env.points} points", f"table {seed}, layout {args.layout}"
    if args.frame:
        scores = env.tables.standing(0)["scores"]
        made, where = f"{names[0]} {scores[0]} - {scores[1]} {names[1]}", f"frame {seed}"
    title = f"{' - '.join(names)}, {args.noise}'s errors, {where.split(',')[0]}"  # without the result
    judge: Any = player(TACTICIAN).at(env) if args.frame else None
    played = replay(env, title=title, players=names, judge=judge)
    for k, stroke in enumerate(played.to_dict()["strokes"], 1):
        speed, side, top = (stroke["cue"][name] for name in ("speed", "side", "top"))
        how = f"{speed:.2f} m/s, side {side:+.2f}, top {top:+.2f}"
        print(f"{k:3}  {stroke['ball_on']:<10}  {how}   {stroke['words']}")
    print(f"{made} in {len(played)} stroke{'s' * (len(played) > 1)} ({where}, noise {args.noise})")
    if env.points < args.at_least:
        print(f"No visit reached {args.at_least} points in {args.tries} tries; this is the best one.")
    file = args.out or Path(tempfile.mkdtemp(prefix="snooker-")) / "replay.html"
    played.save(file, **film)
    print(f"written: {file}", flush=True)
    if not args.out and not webbrowser.open(file.as_uri()):
        print("No browser was found. Open this file in one, or choose where to write it with --out.")


def main(argv: Sequence[str] | None = None) -> int:
    """Play, print, write. Exit code 0; 1: failed; 2: wrong arguments; 130: Ctrl-C."""
    p = parser()

    def play() -> int:
        args = p.parse_args(argv)
        try:
            watch(args, _film_options(args))
        except ValueError as error:
            p.error(str(error))
        return 0

    return exit_code(NAME, play)


if __name__ == "__main__":
    raise SystemExit(main())
