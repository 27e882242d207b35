"""What happens to frames inside a step? Decisions, the referee, observations, rewards and infos, as kernels over tables.

``tasks.frame`` calls them in the order of a turn. ``which``: the tables concerned; row j of a shot's arrays belongs to which[j].
"""

from .._jit import entry, kernel
from ..game.apply_ruling import settle
from ..game.balls import CUE, N_BALLS, SPOTS, bits
from ..game.frame_columns import (
    BALL_ON,
    CHOICE,
    FREE_BALL,
    IN_HAND,
    LOT,
    MISS_CALLED,
    ON_TABLE,
    OVER,
    PHASE,
    PLAY,
    PLAY_AGAIN,
    POINTS,
    REPLACE,
    RESPOTTED_BLACK,
    SCORE_0,
    SCORE_1,
    STEPS,
    STRIKER,
    STROKES,
    WINNER,
    after_stroke,
    available,
    begin_frame,
    choose,
    draw,
    lead_of,
    strikeable,
)  # fmt: skip
from ..game.paths import clear_path, full_ball_path
from ..game.philox import pair
from ..game.rule_sets import SNOOKER
from ..geometry import BALL_RADIUS
from ..physics.engine import Status
from .observations import SIZE, observe_into
from .rewards import frame_reward_of
from .stroke import CLEAR_PATH, DOWN, FIRST, FULL_PATH, MOVED, TOUCHING, place, see, write_ruling
from .tables import COUNTS, I_BREAK, REALS, keep_last, write_empty_info, write_stroke_info

AGENT = 0
_OK = int(Status.OK)
(I_SCORE, I_OPPONENT_SCORE) = range(len(REALS), len(REALS) + 2)
(I_STROKES, I_REPLIES, I_WINNER, I_CHOICE, I_FREE_BALL, I_NEEDS_SNOOKERS) = range(len(COUNTS), len(COUNTS) + 6)


@entry(what="the decisions after a foul", seconds=1)
def decide(which, actions, decision, positions, on_table, game, saved, plays):
    """The strikers' decisions on the tables ``which`` where the opponent has fouled.

    ``decision``: the last component of the action decides. Below -1/3 the offender plays again; above 1/3 from the position before, if a
    miss was called. ``plays[j]``: whether a stroke follows.
    """
    for j in range(which.shape[0]):
        k = which[j]
        row, plays[j] = game[k], True
        if row[PHASE] != CHOICE:
            continue
        wish = actions[k, actions.shape[1] - 1] if decision else 0.0
        what = PLAY_AGAIN if wish < -1.0 / 3.0 else REPLACE if wish > 1.0 / 3.0 and row[MISS_CALLED] else PLAY
        choose(row, what)
        plays[j] = what == PLAY
        if what == REPLACE:
            for i in range(N_BALLS):
                positions[k, i, 0], positions[k, i, 1] = saved.positions[k, i, 0], saved.positions[k, i, 1]
                on_table[k, i] = saved.on_table[k, i]


@entry(what="the paths of the miss rule", seconds=2)
def remember(which, positions, on_table, game, saved, nominated, seen):
    """Record what the miss rule needs of the tables ``which`` before their strokes: the position, and which paths are clear.

    ``nominated`` (n,): the colour that each striker has nominated, the only one that he may then strike first, or AUTO.
    """
    for j in range(which.shape[0]):
        k = which[j]
        on = 1 << nominated[k] if nominated[k] > 0 else strikeable(game[k], bits(on_table[k]) & ~1)
        seen[j, CLEAR_PATH] = clear_path(positions[k], on_table[k], on, BALL_RADIUS)
        seen[j, FULL_PATH] = full_ball_path(positions[k], on_table[k], on, BALL_RADIUS)
        for i in range(N_BALLS):
            saved.positions[k, i, 0], saved.positions[k, i, 1] = positions[k, i, 0], positions[k, i, 1]
            saved.on_table[k, i] = on_table[k, i]


@kernel
def _hand_back(row):
    """Return the table to the agent, who plays alone."""
    if not row[OVER] and row[STRIKER] != AGENT:
        if row[PHASE] == CHOICE:
            choose(row, PLAY_AGAIN)
        row[STRIKER] = AGENT  # ``after_stroke`` has ended the break already


@entry(what="the referee of frames", seconds=6)
def conclude(which, positions, on_table, game, streams, nominated, r, potted, status, duration, event_time, event_what, n_events, shots,
              seen, jaws, miss, own, alone, played, reals, counts):  # fmt: skip
    """Judge the shots that came to rest and update tables and frames. ``own``: infos report the strokes; ``played`` counts them.

    ``nominated`` (n,): the colour that each striker has nominated, or AUTO: the one first struck.
    """
    for j in range(which.shape[0]):
        if status[j] != _OK:
            continue
        k = which[j]
        p, on, row = positions[k], on_table[k], game[k]
        see(j, event_time, event_what, n_events, potted, p, on, shots, seen)
        for i in range(N_BALLS):
            p[i, 0], p[i, 1] = r[j, i, 0], r[j, i, 1]
        ball_on = row[BALL_ON]
        result = settle(
            p, on, ball_on, row[FREE_BALL], lead_of(row, row[STRIKER]), seen[j, FIRST], seen[j, TOUCHING], seen[j, MOVED], seen[j, DOWN],
            0, nominated[k], 0, jaws, BALL_RADIUS,
        )  # fmt: skip
        write_ruling(j, row[STRIKER], ball_on, row[FREE_BALL], row[POINTS], result, seen)
        after_stroke(row, result, SNOOKER, miss, seen[j, CLEAR_PATH], seen[j, FULL_PATH], True, miss, 0, 0)
        row[STROKES] += 1
        if row[PHASE] == LOT:  # the winner of the lot is assumed to play first
            u, _ = pair(streams[k])
            draw(row, int(2.0 * u))
        if row[IN_HAND] and not row[OVER]:
            place(p, on, SPOTS[CUE, 0], SPOTS[CUE, 1])
        played[k] += 1
        if own:
            write_stroke_info(j, k, result, ball_on, seen, duration, n_events, reals, counts)
        if alone:
            _hand_back(row)


@kernel
def observe_frame_into(out, positions, on_table, row, player):
    """Write the observation of ``player``, float32 (FRAME_SIZE,): that of a visit, then ``observations.FRAME_ENTRIES``."""
    on = strikeable(row, bits(on_table) & ~1)
    observe_into(out, positions, on_table, row[BALL_ON], on, row[IN_HAND], row[POINTS])
    mine, other = row[SCORE_0 + player], row[SCORE_1 - player]
    to_play = not row[OVER] and row[STRIKER] == player
    more = (
        mine / 155.0, other / 155.0, (mine - other) / 155.0, available(row[ON_TABLE], row[BALL_ON]) / 147.0, 1.0 if to_play else 0.0,
        1.0 if row[FREE_BALL] else 0.0, 1.0 if row[PHASE] == CHOICE else 0.0, 1.0 if row[MISS_CALLED] else 0.0,
        1.0 if row[RESPOTTED_BLACK] else 0.0,
    )  # fmt: skip
    for c in range(len(more)):
        out[SIZE + c] = min(1.0, max(-1.0, more[c]))


@entry(what="the observations of frames", seconds=1)
def observe(which, player, positions, on_table, game, out):
    """The observations of ``player`` on the tables ``which``: one row of ``out`` each."""
    for j in range(which.shape[0]):
        k = which[j]
        observe_frame_into(out[j], positions[k], on_table[k], game[k], player)


@kernel
def _write_frame_info(k, row, replies, reals, counts):
    """Write the entries of the info that concern the frame."""
    mine, other = row[SCORE_0 + AGENT], row[SCORE_1 - AGENT]
    reals[k, I_BREAK], reals[k, I_SCORE], reals[k, I_OPPONENT_SCORE] = row[POINTS], mine, other
    counts[k, I_STROKES], counts[k, I_REPLIES], counts[k, I_WINNER] = row[STROKES], replies[k], row[WINNER]
    counts[k, I_CHOICE], counts[k, I_FREE_BALL] = row[PHASE] == CHOICE, row[FREE_BALL]
    counts[k, I_NEEDS_SNOOKERS] = other - mine > available(row[ON_TABLE], row[BALL_ON])


@entry(what="the steps of frames", seconds=1)
def finish(which, positions, on_table, game, lead, replies, played, kind, limit, max_strokes, observations, rewards, terminated, truncated,
            reals, counts):  # fmt: skip
    """Write the results of a step for the tables ``which``; ``lead`` (n,): before it, ``played`` (n,): whether the agent had a stroke."""
    for j in range(which.shape[0]):
        k = which[j]
        row = game[k]
        row[STEPS] += 1
        rewards[k] = frame_reward_of(kind, lead_of(row, AGENT) - lead[k], row[WINNER] if row[OVER] else -1, AGENT)
        terminated[k] = row[OVER]
        truncated[k] = (not row[OVER] and row[STROKES] >= max_strokes) or row[STEPS] >= limit
        if not played[k]:
            write_empty_info(k, row[BALL_ON], reals, counts)
        _write_frame_info(k, row, replies, reals, counts)
        observe_frame_into(observations[k], positions[k], on_table[k], row, AGENT)


@entry(what="the start of a frame", seconds=1)
def begin(which, drawn, in_hand, on_table, game, streams):
    """New frames on the tables ``which``, already dealt. ``drawn``: who breaks is drawn, otherwise it is the agent."""
    for j in range(which.shape[0]):
        k = which[j]
        breaker = AGENT
        if drawn:
            u, _ = pair(streams[k])
            breaker = int(2.0 * u)
        begin_frame(game[k], bits(on_table[k]), breaker, in_hand)


@entry(what="the resets of frames", seconds=1)
def show(which, fresh, positions, on_table, game, replies, out):
    """Write the results of a reset for the tables ``which``; with ``fresh``, the last arrays of ``out`` first keep the previous rows."""
    observations, reals, counts, _, _, _ = out
    for j in range(which.shape[0]):
        k = which[j]
        if fresh:
            keep_last(k, out)
        write_empty_info(k, game[k, BALL_ON], reals, counts)
        _write_frame_info(k, game[k], replies, reals, counts)
        observe_frame_into(observations[k], positions[k], on_table[k], game[k], AGENT)
