"""Do whole frames end by the rules, and is every point and ball accounted for? Random and ghost-ball players, each stroke checked.

    python -m benchmarks.frames [--frames 2000] [--jobs N]

Checked at every stroke: the scores against a count of its own of what was potted and given, no visit above 155, no ball lost, doubled,
overlapping or off the table; and once a frame, that the state written as JSON and read again plays on identically, bit for bit.
Nobody concedes, claims or is stopped: a frame ends by its last black, by a re-spotted black, or by a third miss ("clear_path").
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

import numpy as np

from snooker_env.game.balls import BALL_RADIUS, COLOURS_MASK, CUE_BIT, REDS_MASK, VALUES, BallOn, ids_of
from snooker_env.game.layouts import break_off
from snooker_env.tasks.frame_table import FrameTable
from snooker_env.tasks.opponents import GhostBall, RandomPlayer
from snooker_env.tasks.stroke import mask, shooter_of

from ._common.command import at_least, command, run

MOST_STROKES = 20_000
"""A frame that is longer counts as a failure."""
REPLAYED = 20
"""Strokes played again from the JSON."""
PLAYERS = {"random": RandomPlayer(), "ghost_ball": GhostBall()}
KINDS = (("random", "off"), ("random", "clear_path"), ("ghost_ball", "off"))


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


def fair_points(played, free_ball):
    """What a fair stroke scores, counted from the balls that went down: reds 1 each, else the ball on once; a free ball for the ball on."""
    potted = played.stroke.potted & ~CUE_BIT
    if played.ball_on == BallOn.RED:
        reds, others = bin(potted & REDS_MASK).count("1"), bin(potted & COLOURS_MASK).count("1")
        check(others <= free_ball, "colours potted with reds on", ids_of(potted))
        return reds + others
    if played.ball_on == BallOn.ANY_COLOUR:
        return sum(int(VALUES[i]) for i in ids_of(potted))
    return int(played.ball_on) if potted else 0


def check_stroke(table, before, played):
    """Points and balls of one stroke; ``before``: the ``Frame`` before it."""
    frame, verdict, me = table.frame, played.verdict, played.striker
    gained = frame.scores[me] - before.scores[me], frame.scores[1 - me] - before.scores[1 - me]
    if verdict.fouls:
        check(gained[0] == 0 and gained[1] == verdict.penalty and 4 <= verdict.penalty <= 7, "a foul", gained, verdict)
    else:
        check(gained == (fair_points(played, before.free_ball), 0), "a fair stroke", gained, played)
    reds = before.on_table & REDS_MASK & ~played.stroke.potted
    if not table.over:
        check_table(table)
        check(frame.on_table & REDS_MASK == reds, "reds", ids_of(frame.on_table), ids_of(reds))


def check_table(table):
    """No ball lost or doubled: the balls on the table are those of the frame, apart from each other and between the cushions."""
    frame, here = table.frame, mask(table.on_table)
    check(here == frame.on_table | CUE_BIT, "balls", ids_of(here), ids_of(frame.on_table))
    if frame.ball_on <= BallOn.RED:
        check(here & COLOURS_MASK == COLOURS_MASK, "colours", ids_of(here))
    else:
        left = sum(1 << (on + 14) for on in range(frame.ball_on, BallOn.BLACK + 1))
        check(here == left | CUE_BIT, "the sequence", ids_of(here), frame.ball_on)
    placed = table.positions[table.on_table]
    far = np.hypot(*(placed[:, None] - placed[None]).T) + 9.0 * np.eye(len(placed))
    check(far.min() > 2 * BALL_RADIUS - 1e-6, "two balls in one place", far.min())
    table.shooter.table.check(table.positions, BALL_RADIUS, "positions", table.on_table)


def as_json(table, rng):
    """Everything that decides how the frame goes on."""
    return json.dumps({"table": table.get_state(), "rng": rng.bit_generator.state})


def turn(table, player, rng):
    """One turn, or None where the table was only handed over."""
    return player.play(table, lambda: None, rng, False)


def check_replay(text, wanted, player, fresh):
    """The saved state, in a new table, leads to the same states."""
    table, rng, saved = fresh(), np.random.default_rng(), json.loads(text)
    table.set_state(saved["table"])
    rng.bit_generator.state = saved["rng"]
    for want in wanted:
        turn(table, player, rng)
        check(as_json(table, rng) == want, "played on otherwise")


def ending(table, played):
    """How the frame ended."""
    if not played.verdict.over:
        return "third miss"
    if table.frame.respotted_black:
        return "re-spotted black"
    return "foul on the black" if played.verdict.fouls else "black potted"


def play_frame(seed, kind, miss):
    """One frame from the break to its end, everything checked; returns its ``Tally``. Raises AssertionError."""
    player, rng, tally = PLAYERS[kind], np.random.default_rng(seed), Tally()
    shooter = shooter_of("target", False, True, True, "none", "paper", "match", "standard")
    fresh = partial(FrameTable, shooter, miss=miss)
    table = fresh()
    table.start(*break_off(rng), breaker=int(rng.integers(2)), in_hand=True)
    save_at, saved, following, visit, given = int(rng.integers(5, 50)), None, [], 0, [0, 0]
    while not table.over:
        if tally.strokes == save_at and saved is None:
            saved = as_json(table, rng)
        before = table.frame
        played = turn(table, player, rng)
        if saved is not None and len(following) < REPLAYED:
            following.append(as_json(table, rng))
        if played is None:
            continue
        if before.phase == "choice":
            before = before.choose("play")  # the only decision with a stroke in the same turn
        tally.strokes += 1
        tally.fouls += bool(played.verdict.fouls)
        check_stroke(table, before, played)
        given[played.striker] += played.verdict.points
        given[1 - played.striker] += played.verdict.penalty
        visit += played.verdict.points
        check(visit <= 155, "a visit", visit)
        if not played.verdict.points:
            tally.breaks += [visit] if visit else []
            visit = 0
        elif not table.over and not table.frame.respotted_black:
            check(table.frame.break_points == visit, "the break", table.frame.break_points, visit)
        check(tally.strokes < MOST_STROKES, "a frame without end", seed)
        if table.over:
            tally.ending = ending(table, played)
    tally.breaks += [visit] if visit else []
    check(tuple(given) == table.frame.scores, "the scores", given, table.frame.scores)
    leader = int(given[1] > given[0])
    check(tally.ending == "third miss" or (given[0] != given[1] and table.frame.winner == leader), "the winner", table.frame.winner)
    if saved is not None:
        check_replay(saved, following, player, fresh)
    return tally


def row(kind, miss, tallies, seconds):
    """A line of the table."""
    strokes, breaks = [t.strokes for t in tallies], [b for t in tallies for b in t.breaks]
    ends, fouls = Counter(t.ending for t in tallies), 100 * sum(t.fouls for t in tallies) / sum(strokes)
    return (
        f"{kind:<11}{miss:<11}{len(tallies):>7}{np.mean(strokes):>9.1f}{max(strokes):>7}{fouls:>8.1f}"
        f"{np.mean(breaks):>8.2f}{max(breaks):>6}{seconds:>8.1f}   {', '.join(f'{end} {n}' for end, n in ends.most_common())}"
    )


def main():
    """Command line."""
    parser = command("frames", __doc__)
    parser.add_argument("--frames", type=at_least(1), default=2000, help="of each kind")
    parser.add_argument("--jobs", type=at_least(1), default=os.cpu_count() or 1, help="processes")
    args = parser.parse_args()
    print("players    miss rule   frames  strokes   most  fouls %  break  best seconds   endings")
    quiet = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_DFL)}  # Ctrl-C ends them without a word
    with ProcessPoolExecutor(args.jobs, mp_context=get_context("spawn"), **quiet) as pool:
        for kind, miss in KINDS:
            start = time.perf_counter()
            tallies = list(pool.map(partial(play_frame, kind=kind, miss=miss), range(args.frames), chunksize=10))
            print(row(kind, miss, tallies, time.perf_counter() - start), flush=True)
    print("every stroke checked: points, balls, breaks; every frame that lasted so long played on from its JSON identically")


if __name__ == "__main__":
    run(main)
