"""Do whole frames end by the rules, and is every point and ball accounted for? Random and ghost-ball players,
each stroke checked.

    python -m benchmarks.frames [--frames 2000] [--nomination | --attempt] [--jobs N] [--seed 0] [--json FILE]
    [--out FOLDER]

Checked at every stroke: the scores against a count of its own of what was potted and given, no visit above
155, no ball lost, doubled, overlapping or off the table; and once a frame, that the state written as JSON and
read again plays on identically, bit for bit. No player concedes or is stopped: a frame ends by its last
black, by a re-spotted black, by a third miss ("clear_path"), or, where players nominate and declare ("said"),
by a claim.

``--nomination``: instead, how many strokes at a colour after a red are judged otherwise where the player must
name it. Each of ghost_ball's strokes at a club player's errors is judged twice, with the colour that it aims
at and with the one that it strikes first.

``--attempt``: instead, what miss="attempt" decides: of the failures of snookered strikers, the share that was
no attempt, and the share called a miss (the scores keep the others from being called). Nobody has the balls
replaced, so that each position counts once.
"""

import json
import os
import signal
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np

from snooker_env.game.balls import COLOURS_MASK, CUE_BIT, REDS_MASK, VALUES, BallOn, ids_of, mask_of_present
from snooker_env.game.frame import Frame
from snooker_env.game.ruling import Foul
from snooker_env.geometry import BALL_RADIUS
from snooker_env.players.opponents import drawn, opponent_of
from snooker_env.tasks.carry_out import carry_out
from snooker_env.tasks.frame import AGENT, Frames, Seat
from snooker_env.tasks.options import Options
from snooker_env.tasks.stroke import ATTEMPT, CLEAR_PATH, DOWN, FOULS, ShotBuffers
from snooker_env.tasks.tables import I_BALL_ON, I_FOULS, I_PENALTY, I_POINTS, Crew

from ._common.command import Command, at_least, run, save_json

MOST_STROKES = 20_000
"""A frame that is longer counts as a failure."""
REPLAYED = 20
"""Strokes played again from the JSON."""
PLAYERS = ("random", "ghost_ball")
SAID = {"says": ["nominate", "decision", "concede", "claim", "lot"]}
KINDS = (
    ("random", "off"),
    ("random", "clear_path"),
    ("ghost_ball", "off"),
    ("ghost_ball", "clear_path"),
    ("random", "said"),
)
"""Who plays, and the miss rule; "said": without misses, but with everything that a player may say."""


@dataclass
class Tally:
    """What one frame was like."""

    strokes: int = 0
    fouls: int = 0
    breaks: list = field(default_factory=list)
    """Points of every visit that scored."""
    ending: str = ""


def check(true, what, *values):
    """An assertion that optimised Python keeps."""
    if not true:
        raise AssertionError(f"{what}: {values}")


class Turn(NamedTuple):
    """One stroke."""

    striker: int
    ball_on: int
    """What was on before it, a ``BallOn``."""
    potted: int
    """Mask of the balls that went down."""
    points: int
    penalty: int
    fouls: int


class FrameTable:
    """One frame in progress, played turn by turn by the same player on both sides, the rules' own arrays
    behind it."""

    def __init__(self, kind, **more):
        rules = SAID if kind == "said" else {"miss": kind}
        given: dict[str, Any] = {
            "task": "frame",
            "aim": "target",
            "placement": True,
            "says": ["decision"],
            "max_strokes": None,
        }
        options = Options(**given | rules | more)
        self.tables = Frames(options, seats=[Seat.of(options.rules)] * 2)
        self.buffers, self.generator = ShotBuffers(1), np.random.default_rng()
        self.ghost_ball = opponent_of("ghost_ball", options)

    def start(self, seed):
        """Deal a new frame."""
        self.generator = np.random.default_rng(seed)
        self.tables.seed(0, self.generator)
        self.tables.deal(np.zeros(1, np.int64), drawn=True)

    @property
    def frame(self) -> Frame:
        """As it stands."""
        return self.tables.frame(0)

    @property
    def over(self):
        """Whether it has ended."""
        return bool(self.tables.ended()[0])

    def turn(self, player):
        """One turn of a player of ``PLAYERS``: what was ``Turn``, or None where the table was only handed over."""
        striker, out = self.frame.striker, self.tables.output()
        crew = Crew(self.buffers)

        def prepare(which, buffers):
            if player == "random":
                return self.tables.prepare(which, self.uniform(which), buffers)
            asked = self.ghost_ball.strokes(self.tables, which, crew)
            return carry_out(self.tables, which, asked, buffers, AGENT)

        if not self.tables.turn(prepare, out, crew)[0]:
            return None
        counts, potted = out.counts[0].tolist(), int(self.buffers.enlarged.get(0, self.buffers).seen[0, DOWN])
        return Turn(
            striker,
            counts[I_BALL_ON],
            potted,
            int(out.reals[0, I_POINTS]),
            counts[I_PENALTY],
            counts[I_FOULS],
        )

    def uniform(self, which):
        """A uniform action, but that it never concedes, by a seed of the table's own stream."""
        reads = self.tables.rules.actions
        rng = np.random.default_rng(int(drawn(self.tables, which)[0] * 2**32))
        action = rng.uniform(-1.0, 1.0, (1, reads.size))
        if "concede" in reads.says:
            action[:, -1] = (5.0 * action[:, -1] + 1.0) / 6.0  # [-1, 1) becomes [-2/3, 1)
        return action

    def as_json(self):
        """Everything that decides how the frame goes on."""
        return json.dumps(self.tables.get_state(0) | {"rng": self.generator.bit_generator.state})

    def take(self, text):
        """Take over what ``as_json`` gave."""
        self.tables.set_state(0, self.tables.check_state(json.loads(text), self.generator, either=True))


def fair_points(played, free_ball):
    """What a fair stroke scores, counted from the balls that went down: reds 1 each, else the ball on once; a
    free ball for the ball on."""
    potted = played.potted & ~CUE_BIT
    if played.ball_on == BallOn.RED:
        reds, others = bin(potted & REDS_MASK).count("1"), bin(potted & COLOURS_MASK).count("1")
        check(others <= free_ball, "colours potted with reds on", ids_of(potted))
        return reds + others
    if played.ball_on == BallOn.ANY_COLOUR:
        return sum(int(VALUES[i]) for i in ids_of(potted))
    return int(played.ball_on) if potted else 0


def check_stroke(table, before, played):
    """Points and balls of one stroke; ``before``: the ``Frame`` before it."""
    frame, me = table.frame, played.striker
    gained = frame.scores[me] - before.scores[me], frame.scores[1 - me] - before.scores[1 - me]
    if played.fouls:
        check(
            gained[0] == 0 and gained[1] == played.penalty and 4 <= played.penalty <= 7,
            "a foul",
            gained,
            played,
        )
    else:
        check(gained == (fair_points(played, before.free_ball), 0), "a fair stroke", gained, played)
    reds = before.on_table & REDS_MASK & ~played.potted
    if not table.over:
        check_table(table)
        check(frame.on_table & REDS_MASK == reds, "reds", ids_of(frame.on_table), ids_of(reds))


def check_table(table):
    """No ball lost or doubled: the balls on the table are those of the frame, apart from each other and
    between the cushions."""
    frame, positions, on_table = table.frame, table.tables.positions[0], table.tables.on_table[0]
    here = mask_of_present(on_table)
    check(here == frame.on_table | CUE_BIT, "balls", ids_of(here), ids_of(frame.on_table))
    if frame.ball_on <= BallOn.RED:
        check(here & COLOURS_MASK == COLOURS_MASK, "colours", ids_of(here))
    else:
        left = sum(1 << (on + 14) for on in range(frame.ball_on, BallOn.BLACK + 1))
        check(here == left | CUE_BIT, "the sequence", ids_of(here), frame.ball_on)
    placed = positions[on_table]
    far = np.hypot(*(placed[:, None] - placed[None]).T) + 9.0 * np.eye(len(placed))
    check(far.min() > 2 * BALL_RADIUS - 1e-6, "two balls in one place", far.min())
    table.tables.rules.table.check(positions, BALL_RADIUS, "positions", on_table)


def check_replay(text, wanted, player, miss):
    """The saved state, in a new table, leads to the same states."""
    table = FrameTable(miss)
    table.take(text)
    table.generator.bit_generator.state = json.loads(text)["rng"]
    for want in wanted:
        table.turn(player)
        check(table.as_json() == want, "played on otherwise")


def ending(before, played, frame):
    """How the frame ended."""
    if played is not None and before.warned and played.fouls and frame.on_table:
        return "third miss"
    if frame.respotted_black:
        return "re-spotted black"
    if played is None:
        return "claimed"
    return "foul on the black" if played.fouls else "black potted"


def play_frame(seed, kind, miss):
    """One frame from the break to its end, everything checked; returns its ``Tally``. Raises
    AssertionError."""
    player, rng, tally, table = kind, np.random.default_rng(seed), Tally(), FrameTable(miss)
    table.start(seed)
    save_at, saved, following, visit, given = int(rng.integers(5, 50)), None, [], 0, [0, 0]
    while not table.over:
        if tally.strokes == save_at and saved is None:
            saved = table.as_json()
        before = table.frame
        played = table.turn(player)
        if saved is not None and len(following) < REPLAYED:
            following.append(table.as_json())
        if played is None:
            tally.ending = ending(before, played, table.frame) if table.over else ""
            continue
        if before.phase == "choice":
            before = before.choose("play")  # the only decision with a stroke in the same turn
        tally.strokes += 1
        tally.fouls += bool(played.fouls)
        check_stroke(table, before, played)
        given[played.striker] += played.points
        given[1 - played.striker] += played.penalty
        visit += played.points
        check(visit <= 155, "a visit", visit)
        if not played.points:
            tally.breaks += [visit] if visit else []
            visit = 0
        elif not table.over and not table.frame.respotted_black:
            check(table.frame.break_points == visit, "the break", table.frame.break_points, visit)
        check(tally.strokes < MOST_STROKES, "a frame without end", seed)
        if table.over:
            tally.ending = ending(before, played, table.frame)
    tally.breaks += [visit] if visit else []
    frame = table.frame
    check(tuple(given) == frame.scores, "the scores", given, frame.scores)
    leader = int(given[1] > given[0])
    check(
        tally.ending == "third miss" or (given[0] != given[1] and frame.winner == leader),
        "the winner",
        frame.winner,
    )
    if saved is not None:
        check_replay(saved, following, player, miss)
    return tally


def judged_otherwise(seed):
    """One frame of ghost_ball against itself at club noise: strokes at a colour after a red, and those judged
    otherwise by nomination."""
    player, named, plain = (
        "ghost_ball",
        FrameTable("off", noise="club", says=["nominate", "decision"]),
        FrameTable("off", noise="club"),
    )
    named.start(seed)
    strokes = other = 0
    while not named.over:
        plain.take(named.as_json())
        asked = named.frame.ball_on == BallOn.ANY_COLOUR
        one, two = named.turn(player), plain.turn(player)
        if asked:
            check(
                (one is None, one and one.potted) == (two is None, two and two.potted),
                "another stroke",
                one,
                two,
            )
            strokes += 1
            other += (
                one is not None and two is not None and (one.points, one.penalty) != (two.points, two.penalty)
            )
    return strokes, other


def escapes(seed, kind, noise):
    """One frame with miss="attempt": failures of snookered strikers, those that were no attempt, and those
    called a miss."""
    player, table = kind, FrameTable("attempt", noise=noise, says=[])
    table.start(seed)
    failed = poor = called = 0
    while not table.over:
        if table.turn(player) is None:
            continue
        seen = table.buffers.enlarged.get(0, table.buffers).seen[0]
        if seen[FOULS] & (Foul.NO_CONTACT | Foul.WRONG_FIRST) and not seen[CLEAR_PATH]:
            failed += 1
            poor += not seen[ATTEMPT]
            called += table.frame.miss_called
    return failed, poor, called


def print_escapes(frames, seed):
    """The table of ``escapes``; its rows."""
    rows = []
    print("players    noise          frames  failures of snookered strikers   no attempt   called a miss")
    for kind in PLAYERS:
        for noise in ("club", "professional"):
            failed, poor, called = np.sum(
                [escapes(seed + k, kind, noise) for k in range(frames)], axis=0
            ).tolist()
            rows.append(
                {
                    "player": kind,
                    "noise": noise,
                    "frames": frames,
                    "failures": failed,
                    "no_attempt": poor,
                    "misses": called,
                }
            )
            shares = [f"{100 * part / max(failed, 1):>11.0f} %" for part in (poor, called)]
            print(f"{kind:<11}{noise:<13}{frames:>8}{failed:>32}{shares[0]}{shares[1]:>16}", flush=True)
    return rows


def figures_of(kind, miss, tallies, seconds):
    """A row of the table."""
    strokes, breaks = [t.strokes for t in tallies], [b for t in tallies for b in t.breaks]
    return {
        "player": kind,
        "miss": miss,
        "frames": len(tallies),
        "strokes": float(np.mean(strokes)),
        "most_strokes": max(strokes),
        "fouls_percent": 100 * sum(t.fouls for t in tallies) / sum(strokes),
        "break": float(np.mean(breaks)),
        "best_break": max(breaks),
        "seconds": seconds,
        "endings": dict(Counter(t.ending for t in tallies).most_common()),
    }


def line(row):
    """The row in print."""
    return (
        f"{row['player']:<11}{row['miss']:<11}{row['frames']:>7}{row['strokes']:>9.1f}{row['most_strokes']:>7}{row['fouls_percent']:>8.1f}"
        f"{row['break']:>8.2f}{row['best_break']:>6}{row['seconds']:>8.1f}   {', '.join(f'{end} {n}' for end, n in row['endings'].items())}"
    )


def main():
    """Command line."""
    parser = Command("frames", __doc__, seed=0)
    parser.add_argument("--frames", type=at_least(1), default=2000, help="of each kind")
    parser.add_argument("--jobs", type=at_least(1), default=os.cpu_count() or 1, help="processes")
    other_figures = parser.add_mutually_exclusive_group()
    other_figures.add_argument("--nomination", action="store_true", help="measure what nomination changes")
    other_figures.add_argument("--attempt", action="store_true", help='measure what miss="attempt" decides')
    args = parser.options()
    rows = []
    if args.attempt:
        save_json(args.json, {"seed": args.seed, "escapes": print_escapes(args.frames, args.seed)})
        return
    if args.nomination:
        strokes, other = np.sum(
            [judged_otherwise(seed) for seed in range(args.seed, args.seed + args.frames)], axis=0
        ).tolist()
        print(
            f"{other} of {strokes} strokes at a colour after a red ({100 * other / strokes:.2f} %) are judged otherwise by nomination"
        )
        save_json(
            args.json,
            {"seed": args.seed, "frames": args.frames, "strokes": strokes, "judged_otherwise": other},
        )
        return
    print("players    miss rule   frames  strokes   most  fouls %  break  best seconds   endings")
    # Ctrl-C ends them without a word
    quiet = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_DFL)}
    with ProcessPoolExecutor(args.jobs, mp_context=get_context("spawn"), **quiet) as pool:
        for kind, miss in KINDS:
            start = time.perf_counter()
            tallies = list(
                pool.map(
                    partial(play_frame, kind=kind, miss=miss),
                    range(args.seed, args.seed + args.frames),
                    chunksize=10,
                )
            )
            rows.append(figures_of(kind, miss, tallies, time.perf_counter() - start))
            print(line(rows[-1]), flush=True)
    print(
        "every stroke checked: points, balls, breaks; every frame that lasted so long played on from its JSON identically"
    )
    save_json(args.json, {"seed": args.seed, "frames": rows})


if __name__ == "__main__":
    run(main)
