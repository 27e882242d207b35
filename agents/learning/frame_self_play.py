"""How is a round of self-play played, here or by many workers? Each part plays some frames with its own errors and the
worth learned so far. The opponent is the player itself, a past self or a player of the package.

*Search*, not the outcome, judges a position: the best stroke found is repeated with fresh noise samples, and their mean
is the worth of the position. Outcomes of frames vary by 60 points, too much to see differences between positions. A
search exploits errors of the worth, so positions that the best strokes leave are judged as well, in ``REPLIES`` cases."""

from typing import Any

import numpy as np

from snooker_env import Options
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Positions
from snooker_env.planning.worth import last_of, lead_of, left_of
from snooker_env.players import FRAMES, decision_seeds
from snooker_env.players import player as snooker_player
from snooker_env.players.search_player import Tactician
from snooker_env.tasks.frames import Asked, Frames, Seat
from snooker_env.tasks.threads import Threads

FRAME = {"cue": "real", "miss": "clear_path", "max_strokes": 200}
"""Options of the frames."""
TABLES = 16
"""Frames that one part plays side by side."""
FRESH = 8
"""Noise samples that judge the best stroke of a position."""
TEACHER, TAUGHT = 8, 0.1
"""The teacher's budget relative to the player's, and the share of positions in which the teacher is asked."""
PAIRS, CLEAR = 24, 2.0
"""Common errors for both strokes, and the number of standard errors by which the teacher's must be better."""
REPLIES, FINALISTS = (1, 6), 6
"""Number of positions left by the best strokes that are judged, if a pot is likely and otherwise; and the number of best
strokes that they come from."""


def frames(shared, args, threads):
    """Run a part: play frames, and judge each position of the player's own side.

    ``shared``: "options" of the frames, "layers" of the worth (None: only the value of the visit), "chance" (None or
    its numbers), "budget", "explore" (share of strokes that are not the best), "replies" (whether positions left by
    strokes are judged as well), "taught" (whether a teacher is asked). ``args``: "noise", "seed" of the first table,
    "many" frames, "other": the opponent's name, or layers and chance of a past self; None: itself, and both sides count.

    Returns a row for each stroke in the order of play: "seen" (m, SIZE) float32 with the cue ball where it was played
    from, "hand" (m, SIZE) float32 with the cue ball in hand (or the same), "worth" (m,) by search, "swing" (m,) points of
    the striker minus the opponent's until the next stroke, "same" (m,): 1 if the striker plays that stroke, -1 if the
    opponent does, 0 if there is none; "next" (m,), the row of that stroke; "explored" (m,); "lead", "left", "won" (m,):
    the striker's lead, the points on the table, whether the striker won; "decided": whether anybody won; "equals":
    whether it played against itself; "frame" and "striker" (m,), -1 in the rows of replies, which come last and have no
    next stroke."""
    options = Options(**{"task": "frame", **FRAMES, **shared["options"], "noise": args["noise"]})
    rules, many = options.rules, args["many"]
    known = options.but(conditions="fixed")  # a player does not know the constants of a table
    learned = shared["layers"], shared["chance"]
    player = Tactician(shared["budget"], learned).at(known)
    teacher = Tactician(TEACHER * shared["budget"], learned).at(known) if shared.get("taught") else None
    other = args["other"]
    if isinstance(other, str):
        other = snooker_player(other).at(known)
    elif other is not None:
        other = Tactician(shared["budget"], other).at(known)
    rng, rows, beside, held, last = np.random.default_rng([args["seed"], 7]), [], [], 0, np.full(many, -1)

    def act(tables, mine, at, keys):
        nonlocal held
        decided, here, row = _judge_strokes(player, at, keys, rng, teacher)
        strokes, tried, start = decided
        if len(here):
            which = mine[here]
            if shared["replies"]:
                replies, first = _replies(player, decided, here, rng)
                beside.append(replies | {"frame": which[first]})
            explored = rng.random(len(here)) < shared["explore"]
            for k in here[explored].tolist():
                met = max(1, int((tried[k].samples > 0).sum()))
                strokes.values[k] = tried[k].strokes.values[rng.integers(met)]
            rows.append(
                row
                | {
                    "explored": explored,
                    "lead": lead_of(start)[here],
                    "left": left_of(start)[here],
                    "last": last_of(start)[here],
                    "frame": which,
                    "striker": tables.game[which, columns.STRIKER],
                    "led": tables.lead()[which],
                    "before": last[which],
                }
            )
            last[which] = held + np.arange(len(here))
            held += len(here)
        return strokes

    tables = play_frames(rules, args["seed"], many, act, other, threads)
    played = _follow(_concatenate(rows), tables)
    played["equals"] = np.full(len(played["won"]), other is None)
    return _with(played, _concatenate(beside)) if beside else played


def play_frames(rules, seed, many, act, other, threads):
    """Play frames from the tables ``seed``, ``seed + 1``, ... to their ends. Returns the ``Frames``.

    ``act(tables, which, at, keys)`` returns the ``Strokes`` of the strikers on the tables ``which``, seen as ``at``. If
    ``other``, a bound player, is given, it is player 1 of all frames and ``act`` is player 0."""
    tables, crew, step = Frames(rules, many, seats=[Seat.of(rules)] * 2), Threads(threads or 1), 0
    for k in range(many):
        tables.seed(k, np.random.default_rng(seed + k))
    tables.deal(np.arange(many), drawn=True, breakers=np.arange(many) % 2)
    out = tables.output()
    while len(going := np.flatnonzero(~tables.are_over())):
        theirs = (tables.game[going, columns.STRIKER] == 1) & (other is not None)
        keys, mine = decision_seeds(seed, going, step), going[~theirs]
        made = [(mine, act(tables, mine, _seen_by_strikers(tables, mine), keys[~theirs]))]
        if other is not None and theirs.any():
            made.append((going[theirs], other.play(_seen_by_strikers(tables, going[theirs]), keys[theirs])))
        parts: Any = tuple(np.zeros((many, *part.shape[1:]), part.dtype) for part in made[0][1].parts)
        for who, said in made:
            for whole, part in zip(parts, said.parts, strict=True):
                whole[who] = part
        asked: Asked = parts  # type: ignore[assignment]
        tables.turn(lambda which, b, asked=asked: tables.carry_out(which, asked, b, 0), out, crew, going)
        step += 1
    return tables


def _judge_strokes(player, at, keys, rng, teacher=None):
    """Decide in n positions. Returns the strokes, the positions in which the player strikes (m,), and the features and
    worth (by search) of these positions."""
    decided, worth = player.decide_frames(at, keys), player.judge.worth
    here = np.flatnonzero([one is not None for one in decided.tried])
    if teacher is not None:
        _teach(player.judge, teacher, decided, here[rng.random(len(here)) < TAUGHT], rng)
    seen = [worth.features_of(each[here]) for each in (decided.start, at)]
    again, errors = np.repeat(here, FRESH), player.judge.noise.draw_errors(rng, FRESH * len(here))
    strokes = np.repeat(decided.strokes.values[here], FRESH, 0)
    judged = player.judge.gains(decided.start, again, strokes, errors)[:, 1]
    return decided, here, {"seen": seen[0], "hand": seen[1], "worth": judged.reshape(-1, FRESH).mean(axis=1)}


def _teach(judge, teacher, decided, rows, rng):
    """In the positions ``rows``, play the teacher's stroke if it is clearly better on the same errors. Choosing the best of
    many strokes by few samples would do worse, because it favours lucky strokes."""
    if not len(rows):
        return
    ranked = teacher.search.rank(decided.start[rows], rng.integers(2**32, size=len(rows)))
    theirs = np.array([one.strokes.values[0] for one in ranked])
    each, errors = np.repeat(rows, PAIRS), judge.noise.draw_errors(rng, PAIRS * len(rows))
    gains = [
        judge.gains(decided.start, each, np.repeat(strokes, PAIRS, 0), errors)[:, 0 if judge.chance else 1]
        for strokes in (theirs, decided.strokes.values[rows])
    ]
    more = (gains[0] - gains[1]).reshape(-1, PAIRS)
    clear = more.mean(axis=1) > CLEAR * more.std(axis=1, ddof=1) / np.sqrt(PAIRS)
    decided.strokes.values[rows[clear]] = theirs[clear]


def win_share(player, other, seed, many, threads=None):
    """The share of frames that a player wins against another, both unbound, with a professional's errors, and its standard
    error. Each player breaks off half of the frames."""
    options = Options(**{"task": "frame", **FRAMES, **FRAME, "noise": "professional"})
    mine, theirs = player.at(options), other.at(options)
    tables = play_frames(
        options.rules, seed, many, lambda _tables, _which, at, keys: mine.play(at, keys), theirs, threads
    )
    won = (tables.game[:, columns.WINNER] == 0)[tables.game[:, columns.WINNER] >= 0]
    return float(won.mean()), float(won.std() / np.sqrt(len(won)))


def _replies(player, decided, here, rng):
    """Judge positions that the best strokes of the positions ``here`` may leave. Returns their features, their worth to the
    player who is next, and the index of each in ``here``."""
    rows, best = [], []
    for j, k in enumerate(here.tolist()):
        tried = decided.tried[k]
        many, hard = min(FINALISTS, max(1, int((tried.samples > 0).sum()))), bool((tried.kinds > 0).any())
        picks = rng.integers(many, size=REPLIES[hard])
        picks[rng.random(len(picks)) < 0.5] = 0  # half of them are left by the best stroke
        rows += [j] * len(picks)
        best += [tried.strokes.values[pick] for pick in picks.tolist()]
    rows, errors = np.array(rows), player.judge.noise.draw_errors(rng, len(rows))
    left = player.judge.outcomes(decided.start, here[rows], np.array(best), errors)
    left.game[:] = columns.strikers_own(left.game)
    on = np.flatnonzero(left.game[:, columns.OVER] == 0)
    _, played, row = _judge_strokes(player, left[on], rng.integers(2**31, size=len(on)), rng)
    return row, rows[on[played]]


def _concatenate(parts):
    """Concatenate rows."""
    return {name: np.concatenate([one[name] for one in parts]) for name in parts[0]}


def _with(rows, beside):
    """The rows of the strokes played, and rows of positions without a next stroke."""
    n = len(beside["worth"])
    empty = {name: np.zeros((n, *part.shape[1:]), part.dtype) for name, part in rows.items()}
    more = empty | beside | {"next": np.full(n, -1), "striker": np.full(n, -1), "explored": np.ones(n, bool)}
    return _concatenate([rows, more])


def _seen_by_strikers(tables, which):
    """The positions of the tables ``which`` from their strikers' side."""
    saved = columns.Layouts(tables.layouts_before.positions[which], tables.layouts_before.on_table[which])
    game = columns.strikers_own(tables.game[which])
    return Positions(tables.positions[which], tables.on_table[which], game, saved)


def _follow(rows, tables):
    """The rows, including what followed each stroke."""
    frame, striker, before = rows["frame"], rows["striker"], rows.pop("before")
    after = np.full(len(frame), -1)
    after[before[before >= 0]] = np.flatnonzero(before >= 0)
    led = rows.pop("led")
    later = np.where(after >= 0, led[after], tables.lead()[frame])
    rows["swing"] = np.where(striker == 0, 1.0, -1.0) * (later - led)
    rows["same"] = np.where(after < 0, 0, np.where(striker[after] == striker, 1, -1))
    winner = tables.game[frame, columns.WINNER]
    return rows | {"next": after, "won": winner == striker, "decided": winner >= 0}
