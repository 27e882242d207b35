"""How does an agent play a visit, or a frame? Printed stroke by stroke, and written as a replay or a film.

    python -m agents.watch --out break.html
    python -m agents.watch --agent search_2000 --at-least 50 --out break.mp4
    python -m agents.watch --frame --out frame.html

The replay is one HTML file that any browser plays from disk; .mp4 and .gif are films. Without --out the
replay is written to a temporary file and opened in the browser. The cue is real. Visits are played on held-out
tables, the seeds one after the other; --at-least takes the first of --tries visits with so many points. The
same seed gives the same visit as ``agents.evaluate`` plays on that table. With --frame: a whole frame, against
--opponent, with the miss rule "clear_path"; --agent is then ``tactician`` unless it is named. The replay shows
how likely each player was to win, by the ``tactician``.
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
    from snooker_env.players import FRAMES, VISITS, decision_seeds

    from .entrants import Entrant

FILMS = (".mp4", ".gif")
SUFFIXES = (".html", ".json", *FILMS)


TACTICIAN = "tactician"  # who plays a frame unless someone is named
FRAME = {"task": "frame", "cue": "real", "miss": "clear_path", **FRAMES}
"""Options of a frame that is watched."""


def episode(player, seed, **options):
    """A ``SnookerEnv`` after a whole visit or frame, with its history; a visit is that of ``play_visits``."""
    env = sn.SnookerEnv(**{**VISITS, **options})
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
    p = argparse.ArgumentParser(prog="python -m agents.watch", description=str(__doc__).split("\n\n")[0])
    add = p.add_argument
    what = "a player's name, a pre-trained model, a model's .zip or run folder"
    add("--agent", help=f"{what} [planner; with --frame {TACTICIAN}]")
    add("--frame", action="store_true", help="play a whole frame against --opponent")
    add("--opponent", help="its player [the agent itself]")
    what = "break.html, .json, .mp4 or .gif; left out: opened in the browser"
    add("--out", type=Path, help=what)
    add("--layout", default="held_out", help="of the tables, as for Snooker-v0")
    add("--noise", default="professional", help="execution noise")
    add("--seed", type=int, default=HELD_OUT_SEED, help="of the first table")
    what = "show the first visit with so many points"
    add("--at-least", type=int, default=0, metavar="POINTS", help=what)
    add("--tries", type=int, default=200, help="most visits played to find it")
    add("--speed", type=float, default=1.0, help="of a film, over that of the play")
    add("--size", help="of a film, WIDTHxHEIGHT, both even")
    add("--fps", type=float, help="pictures a second of a film")
    add("--trust", action="store_true", help="let code in a model's file run")
    return p


def _film(args):
    """The options of the film that is wanted, {} for a page."""
    suffix = args.out.suffix.lower() if args.out else ".html"
    choice("out", suffix, SUFFIXES)
    film: dict[str, Any] = {}
    for name, usual, most in (("speed", 1.0, 100.0), ("fps", None, 240.0)):
        if (value := getattr(args, name)) != usual:
            film[name] = number(name, value, 0.0, most, open_low=True)
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
    """The environment after the visit or frame that is wanted, its seed and its players. SystemExit if there is none."""
    name = args.agent or (TACTICIAN if args.frame else "planner")
    entrant = Entrant.of(name, trust=args.trust)
    if args.frame:
        other = args.opponent or name
        options: dict[str, Any] = {**FRAME, "noise": args.noise, "opponent": other, "trust": args.trust}
        env = episode(entrant.player(0), args.seed, **options)
        twins = entrant.label == other
        return (
            env,
            args.seed,
            [f"{name} {k}" if twins else name for k, name in (("A", entrant.label), ("B", other))],
        )
    longest = -1
    for seed in range(args.seed, args.seed + args.tries):
        env = episode(entrant.player(0), seed, layout=args.layout, noise=args.noise, cue="real")
        if env.points >= args.at_least:
            return env, seed, [entrant.label]
        longest = max(longest, env.points)
    why = f"no visit of {args.at_least} points in {args.tries} tries; the longest had {longest}"
    raise SystemExit(f"agents.watch: {why}")


@command("agents.watch")
def main(argv=None):
    """Play, print, write."""
    p = parser()
    args = p.parse_args(argv)
    try:
        film = _film(args)
        if args.opponent and not args.frame:
            allowed = "must be left out without --frame: nobody plays against a visit"
            raise refuse("opponent", args.opponent, allowed)
        if args.frame and args.at_least:
            raise refuse("at_least", args.at_least, "must be left out with --frame")
        integer("seed", args.seed, 0, 2**63)
        integer("tries", args.tries, 1, 10**9)
        writable("out", args.out)
        env, seed, players = sought(args)
    except ValueError as error:
        p.error(str(error))
    if args.frame:
        scores = env.tables.standing(0)["scores"]
        made = f"{players[0]} {scores[0]} - {scores[1]} {players[1]}"
        where = f"frame {seed}, noise {args.noise}"
    else:
        made = f"{players[0]}: {env.points} points"
        where = f"table {seed}, layout {args.layout}, noise {args.noise}"
    title = f"{made}, {args.noise}'s errors, {where.split(',')[0]}"
    judge: Any = sn.player(TACTICIAN).at(env) if args.frame else None
    replay = sn.replay(env, title=title, players=players, judge=judge)
    print(*described(replay), sep="\n")
    print(f"{made} in {len(replay)} strokes ({where})")
    file = args.out or Path(tempfile.mkdtemp(prefix="snooker-")) / "replay.html"
    replay.save(file, **film)
    print(f"written: {file}", flush=True)
    if not args.out and not webbrowser.open(file.as_uri()):
        print("No browser was found: open this file in one, or choose its place with --out break.html")
    return 0
