"""How does an agent play a visit? Printed stroke by stroke, and written as a replay or a film.

    python -m agents.watch --agent ppo_foresight --out break.html
    python -m agents.watch --agent search_2000 --at-least 50 --out break.mp4

The replay is one HTML file that any browser plays from disk; .mp4 and .gif are films. Without --out the
replay is written to a temporary file and opened in the browser. Visits are played on held-out tables, the
seeds one after the other; --at-least takes the first of --tries visits with so many points. The same seed
gives the same visit as ``agents.evaluate`` plays on that table.
"""

import argparse
import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from commands.lifecycle import command, needs

with needs("agents.watch"):
    import numpy as np

    import snooker_env as sn
    from commands.files import writable
    from snooker_env.benchmark import HELD_OUT_SEED
    from snooker_env.checks import choice, integer, number, refuse
    from snooker_env.planning import Positions
    from snooker_env.players import VISITS, decision_seeds

    from .entrants import Entrant

FILMS = (".mp4", ".gif")
SUFFIXES = (".html", ".json", *FILMS)


def visit(player, seed, **options):
    """A ``SnookerEnv`` after a whole visit, with its history; the visit of ``play_visits`` for that seed."""
    env = sn.SnookerEnv(**VISITS, **options)
    bound, decision = player.at(env), 0
    env.keep_history = True
    env.reset(seed=seed)
    ended = False
    while not ended:
        at = Positions.of(env)
        strokes = bound.play(at, decision_seeds(0, np.array([seed]), decision))
        _, _, terminated, truncated, _ = env.step(strokes.actions(env.options, at)[0].astype(np.float32))
        ended, decision = terminated or truncated, decision + 1
    return env


def described(replay):
    """A line for each stroke."""
    for k, stroke in enumerate(replay.to_dict()["strokes"], 1):
        cue = stroke["cue"]
        spin = f"side {cue['side']:+.2f}, top {cue['top']:+.2f}"
        yield f"{k:3}  {stroke['ball_on']:<10}  {cue['speed']:.2f} m/s, {spin}   {stroke['words']}"


def parser():
    """The command line."""
    p = argparse.ArgumentParser(prog="python -m agents.watch", description=str(__doc__).split("\n\n")[0])
    p.add_argument(
        "--agent",
        default="ppo_foresight",
        help="a player's name, a pre-trained model, a model's .zip or run folder",
    )
    p.add_argument(
        "--out", type=Path, help="break.html, .json, .mp4 or .gif; left out: opened in the browser"
    )
    p.add_argument("--layout", default="held_out", help="of the tables, as for Snooker-v0")
    p.add_argument("--noise", default="professional", help="execution noise")
    p.add_argument("--seed", type=int, default=HELD_OUT_SEED, help="of the first table")
    p.add_argument(
        "--at-least", type=int, default=0, metavar="POINTS", help="show the first visit with so many points"
    )
    p.add_argument("--tries", type=int, default=200, help="most visits played to find it")
    p.add_argument("--speed", type=float, default=1.0, help="of a film, over that of the play")
    p.add_argument("--size", help="of a film, WIDTHxHEIGHT, both even")
    p.add_argument("--fps", type=float, help="pictures a second of a film")
    p.add_argument("--trust", action="store_true", help="let code in a model's file run")
    return p


def _film(args):
    """The options of the film that is wanted, {} for a page."""
    suffix = args.out.suffix.lower() if args.out else ".html"
    choice("out", suffix, SUFFIXES)
    film: dict[str, Any] = {}
    if args.speed != 1.0:
        film["speed"] = number("speed", args.speed, 0.0, 100.0, open_low=True)
    if args.fps is not None:
        film["fps"] = number("fps", args.fps, 0.0, 240.0, open_low=True)
    if args.size is not None:
        width, _, height = args.size.partition("x")
        if not (width.isdigit() and height.isdigit()) or int(width) % 2 or int(height) % 2:
            even = "must be WIDTHxHEIGHT such as 1280x720, both even, as video encoders want them"
            raise refuse("size", args.size, even)
        film["size"] = int(width), int(height)
    if film and suffix not in FILMS:
        raise refuse("out", str(args.out), "must be a film (.mp4, .gif) with --size, --fps or --speed")
    return film


def sought(args):
    """The environment after the visit that is wanted, and its seed. SystemExit if there is none."""
    entrant = Entrant.of(args.agent, trust=args.trust)
    longest = -1
    for seed in range(args.seed, args.seed + args.tries):
        env = visit(entrant.player(0), seed, layout=args.layout, noise=args.noise)
        if env.points >= args.at_least:
            return env, seed, entrant.label
        longest = max(longest, env.points)
    raise SystemExit(
        f"agents.watch: no visit of {args.at_least} points in {args.tries} tries; the longest had {longest}"
    )


@command("agents.watch")
def main(argv=None):
    """Play, print, write."""
    p = parser()
    args = p.parse_args(argv)
    try:
        film = _film(args)
        integer("seed", args.seed, 0, 2**63)
        integer("tries", args.tries, 1, 10**9)
        writable("out", args.out)
        env, seed, label = sought(args)
    except ValueError as error:
        p.error(str(error))
    replay = sn.replay(
        env, title=f"{label}: {env.points} points, {args.noise}'s errors, table {seed}", players=[label]
    )
    for line in described(replay):
        print(line)
    where = f"table {seed}, layout {args.layout}, noise {args.noise}"
    print(f"{label}: {env.points} points in {len(replay)} strokes ({where})")
    if args.out:
        replay.save(args.out, **film)
        print(f"written: {args.out}")
    else:
        file = Path(tempfile.mkdtemp(prefix="snooker-")) / "replay.html"
        replay.save(file)
        print(f"written: {file}", flush=True)
        if not webbrowser.open(file.as_uri()):
            print("No browser was found: open this file in one, or choose its place with --out break.html")
    return 0
