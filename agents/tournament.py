"""Who plays whole frames better? A round robin: every player meets every other and each seed is played twice, so that
both players break off.

    python -m agents.tournament random ghost_ball ppo_value --frames 200
    python -m agents.tournament "mine=runs/0" search_2000 --out ladder.json --resume
    python -m agents.tournament planner search --match 7 --frames 40 --noise amateur
    python -m agents.tournament --check ladder.json

A player is a NAME (of ``snooker_env.players()``), a model's .zip or run folder, LABEL=PATH, or MODULE:CLASS for
your own player, whose module is imported. --trust and --options work as in ``python -m agents.evaluate``.
docs/agents/tournament.md explains the frames and figures.
"""

import shlex
import sys
import time
from pathlib import Path
from typing import Any

from agents._lib.lifecycle import INTERRUPTED, command, needs, parser_of

with needs("agents.tournament"):
    import snooker_env
    from agents._lib.files import writable, write_atomic
    from agents._lib.noise_option import noise_option
    from agents._lib.physics_option import physics_option
    from agents._lib.tables import show
    from snooker_env import Options
    from snooker_env.benchmark.provenance import machine
    from snooker_env.benchmark.results import read_result, write_result
    from snooker_env.benchmark.statistics import RESAMPLES
    from snooker_env.checks import integer, refuse
    from snooker_env.players import FRAMES
    from snooker_env.players.saved_models import add_model_options
    from snooker_env.progress import Progress

    from .cluster import ClusterError, Here, add_ray, checked_ray, place
    from .evaluation.entrants import entrants_of
    from .evaluation.tournament_figures import ANCHOR_ELO, PRIOR, schedule
    from .evaluation.tournament_file import faults, read_incomplete, result_of, seeds_of
    from .evaluation.tournament_play import CHUNK, TABLES, play, seed_of_draws
    from .evaluation.tournament_report import markdown, parts
    from .evaluation.travel import pack

ANCHOR = "ghost_ball"
"""The anchor if it plays; otherwise the first player."""
SPENT = ("decisions", "seconds", "shots")
"""The cost of each player's decisions."""
SAVED = 60.0
"""Seconds between writes of the file."""


def parser():
    p = parser_of("python -m agents.tournament", __doc__)
    what = f"NAME, MODEL, LABEL=PATH or MODULE:CLASS; NAME: {', '.join(snooker_env.players())}"
    p.add_argument("players", nargs="*", metavar="PLAYER", help=what)
    what = "frames per pair, or matches with --match; even [100]"
    p.add_argument("--frames", type=int, default=100, metavar="N", help=what)
    what = "play matches of best of N frames; odd [1]"
    p.add_argument("--match", type=int, default=1, metavar="BEST_OF", help=what)
    p.add_argument("--noise", default="professional", help="errors: LEVEL or LEVEL*SCALE [professional]")
    what = "paper, match, or one with changes: paper,mu_bb=marlow [paper]"
    p.add_argument("--physics", default="paper", help=what)
    p.add_argument("--miss", default="off", help="rule for a foul and a miss [off]")
    p.add_argument("--cue", default="real", help="option cue of frames: free or real [real]")
    p.add_argument("--rules", default="snooker", help="option game of frames: the rules [snooker]")
    what = "strokes after which a frame ends as a draw [1000]"
    p.add_argument("--max-strokes", type=int, default=1000, help=what)
    p.add_argument("--seed", type=int, default=0, help="seed of each pair's first match [0]")
    p.add_argument("--resamples", type=int, default=RESAMPLES, help=f"bootstrap samples [{RESAMPLES}]")
    add_model_options(p)
    p.add_argument("--threads", type=int, help="threads that play the tables [one per core]")
    add_ray(p)
    p.add_argument("--out", type=Path, metavar="FILE", help="write every frame and figure here, as JSON")
    p.add_argument("--markdown", type=Path, metavar="FILE", help="write the tables here")
    what = "continue an incomplete --out; keep a complete one"
    p.add_argument("--resume", action="store_true", help=what)
    what = "only verify tournament files; exit code 1 if one is invalid"
    p.add_argument("--check", nargs="+", type=Path, metavar="FILE", help=what)
    return p


def parse_tournament(args):
    """Read (entrants, protocol, game) from the command line. Raises ValueError before anything is played."""
    if len(args.players) < 2:
        raise refuse("players", " ".join(args.players), "must be two or more")
    entrants = entrants_of(args.players, args, "player")
    labels = [entrant.label for entrant in entrants]
    for entrant, text in zip(entrants, args.players, strict=True):
        if len(entrant.runs) > 1:
            single = "must be one player or model: give each training seed its own label"
            raise refuse("player", text, single)
    protocol = {
        "first_seed": integer("seed", args.seed, 0, 2**53),
        "matches": integer("frames", args.frames, 2, 2**20),
        "best_of": integer("match", args.match, 1, 99),
        "tables": TABLES,
        "chunk": CHUNK,
        "resamples": integer("resamples", args.resamples, 100, 10**6),
        "prior": PRIOR,
        "anchor": ANCHOR if ANCHOR in labels else labels[0],
        "anchor_elo": ANCHOR_ELO,
    }
    if args.frames % 2:
        raise refuse(
            "frames", args.frames, "must be even: each seed is played twice, and each player breaks off once"
        )
    if args.match % 2 == 0:
        raise refuse("match", args.match, "must be odd, for a best of N frames")
    game = {
        "noise": noise_option(args.noise),
        "physics": args.physics,
        "miss": args.miss,
        "max_strokes": args.max_strokes,
    }
    game |= {} if args.rules == "snooker" else {"game": args.rules}
    game |= {} if args.cue == "free" else {"cue": args.cue}
    for entrant in entrants:
        meeting: dict[str, Any] = {**game, "physics": physics_option(args.physics)}
        entrant.player(0).at(Options(task="frame", **FRAMES, **meeting))  # checks that they can meet
    checked_ray(args.ray)
    if args.ray and args.threads is not None:
        raise refuse("threads", args.threads, "must be left out with --ray, where a part has one core")
    if args.threads is not None:
        integer("threads", args.threads, 1, 1024)
    if args.out and args.out.exists() and not args.resume:
        raise refuse("out", str(args.out), "must be a new file; --resume continues an incomplete one")
    if args.resume and not args.out:
        raise refuse("resume", True, "must be given together with --out")
    for name in ("out", "markdown"):
        writable(name, getattr(args, name))
    return entrants, protocol, game


class Tournament:
    """The round robin so far; ``before`` holds the content of an incomplete file to continue."""

    def __init__(self, entrants, protocol, game, command, before=None):
        self.entrants, self.protocol, self.game, self.command = entrants, protocol, game, command
        self.labels, self.load = [entrant.label for entrant in entrants], machine()
        self.rows, self.spent = [], [dict.fromkeys(SPENT, 0) for _ in entrants]
        if before:
            self.rows = list(before["rows"])
            self.spent = [{name: player[name] for name in SPENT} for player in before["players"]]

    @property
    def parts(self):
        """The parts in order: a pair and some of its seeds each."""
        p, parts = self.protocol, []
        for pair in schedule(self.labels):
            seeds = seeds_of(p)
            for some in (seeds[k : k + CHUNK] for k in range(0, len(seeds), CHUNK)):
                first, second = (self.labels[k] for k in pair)
                draws = [seed_of_draws(first, second, some[0]), seed_of_draws(second, first, some[0])]
                args = {"pair": list(pair), "seeds": some, "draws": draws}
                args |= {"game": self.game, "best_of": p["best_of"]}
                parts.append(args)
        return parts

    @property
    def ended(self):
        """Number of matches in the rows."""
        return len({tuple(row[:4]) for row in self.rows})

    def play(self, where, threads, tick, saved):
        """Play all parts that are missing in the rows.

        ``tick`` is called with the number of matches that have ended, ``saved`` after each part.
        """
        done = {tuple(row[:3]) for row in self.rows}
        played = lambda part: all((*part["pair"], seed) in done for seed in part["seeds"])  # noqa: E731
        parts = [part for part in self.parts if not played(part)]
        shared = {"players": [pack(entrant, 0) for entrant in self.entrants]}
        here = self._here(parts, shared, threads, tick)
        far = where.play_parts(play, [(shared, part) for part in parts])
        for k, result in here if isinstance(where, Here) else far:
            self.rows = sorted([*self.rows, *result["rows"].tolist()], key=lambda row: row[:5])
            for side, player in enumerate(parts[k]["pair"]):
                for name in SPENT:
                    self.spent[player][name] += result[name][side].item()
            tick(self.ended)
            saved()

    def _here(self, parts, shared, threads, tick):
        """Count each match as it ends, if played in this process."""
        for k, part in enumerate(parts):
            counted = lambda n, before=self.ended: tick(before + n)  # noqa: E731
            yield k, play(shared, part, threads, counted)

    def result(self, incomplete=None):
        """The content of the file; ``incomplete`` says why frames are missing."""
        players = [
            {"label": entrant.label, "source": entrant.runs[0], "training": entrant.trained()[0]} | spent
            for entrant, spent in zip(self.entrants, self.spent, strict=True)
        ]
        about = {"command": self.command, "load": self.load, "incomplete": incomplete}
        return result_of(self.protocol, self.game, players, self.rows, **about)


@command("agents.tournament")
def main(argv=None):
    """Check, play, report. Exit code 0; 1: an invalid file; 2: invalid arguments; 130: interrupted, with frames kept."""
    p = parser()
    argv = sys.argv[1:] if argv is None else argv
    args = p.parse_intermixed_args(argv)
    if args.check:
        return _check(args.check)
    try:
        entrants, protocol, game = parse_tournament(args)
        before = None
        if args.resume and args.out.exists():
            before = read_incomplete(args.out, protocol, game, [(e.label, e.runs[0]) for e in entrants])
    except ValueError as error:
        p.error(str(error))
    if before is not None and before["incomplete"] is None:
        return _print_tables(before, args.markdown)
    line = "python -m agents.tournament " + shlex.join(argv)
    tournament = Tournament(entrants, protocol, game, line, before)
    snooker_env.warmup()
    why, code = _play(tournament, args)
    if why is not None:
        print(f"agents.tournament: {why}", file=sys.stderr)
    if not tournament.rows:
        return code
    content = tournament.result(why)
    if args.out:
        write_result(args.out, content)
    _print_tables(content, args.markdown)
    if args.out:
        print(f"out: {args.out}")
    return code


def _play(tournament, args):
    """Play with a progress display. Returns why the tournament is incomplete, or None, and the exit code."""
    last = [time.monotonic()]

    def save_file():
        if args.out and time.monotonic() - last[0] > SAVED:
            write_result(args.out, tournament.result("it was still running"))
            last[0] = time.monotonic()

    total = sum(2 * len(part["seeds"]) for part in tournament.parts)
    units = "frames" if args.match == 1 else "matches"
    try:
        with place(args.ray) as where:
            what = f"tournament{where.says}"
            with Progress(what, total, units, done=tournament.ended) as progress:
                tournament.play(where, args.threads, progress.at, save_file)
    except (KeyboardInterrupt, ClusterError) as error:
        stopped, number = isinstance(error, KeyboardInterrupt), tournament.ended
        why = f"{'interrupted' if stopped else error} after {number:,} of {total:,} {units}"
        return f"{why}: {'these are kept' if number else 'nothing is kept'}", INTERRUPTED if stopped else 1
    except BaseException as error:
        # an error in a player's own code: its author needs the traceback; finished frames are kept
        if args.out and tournament.rows:
            write_result(args.out, tournament.result(f"{type(error).__name__}: {error}"))
        raise
    return None, 0


def _print_tables(content, file):
    """Print the tables and write them as Markdown."""
    show(parts(content))
    if file:
        write_atomic(file, markdown(content))
        print(f"markdown: {file}")
    return 0


def _read(file):
    """Read a file and find its faults."""
    try:
        content = read_result(file)
        return content, faults(content)
    except ValueError as error:
        return {}, [str(error)]
    except OSError as error:
        return {}, [f"cannot be read: {error.strerror}"]


def _check(files):
    code = 0
    for file in files:
        content, wrong = _read(file)
        lines = wrong
        if not wrong:
            state = "complete" if content["incomplete"] is None else "sound, incomplete"
            lines = [f"{state}, {len(content['players'])} players, {len(content['rows']):,} frames"]
        print("\n".join(f"{file}: {line}" for line in lines))
        code |= bool(wrong)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
