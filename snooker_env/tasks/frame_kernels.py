"""What happens to frames inside a step? Decisions, the referee, observations, rewards and infos. Arrays come as plain tuples of
the fields of ``TableArrays``, ``Layouts``, ``PlayedArrays``, ``OutputArrays`` and ``Setting``; shot j is on table which[j]."""

from typing import NamedTuple

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats, Ints
from ..game import frame_columns as columns
from ..game.apply_ruling import settle
from ..game.attempt import ATTEMPT_GAP, closest_approach
from ..game.balls import BLACK, CUE, N_BALLS, SPOTS, YELLOW, available, bits
from ..game.fouls import AUTO, FLAG, OUTCOME, Before, Facts, ruling
from ..game.paths import best_paths
from ..game.philox import pair
from ..game.rule_sets import SHOOT_OUT, SIX_RED
from ..game.shut_in import shut_in
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.cue import squirt
from ..physics.engine import EventKind, Status
from . import declarations, stroke
from .box_actions import tip_on_disc
from .kernel_arrays import C_END_MASS, C_MAX_OFFSET, OutputArrays, PlayedArrays, StruckArrays, TableArrays
from .observations import FRAME_SIZE, REPLACED_SIZE, SIZE, observe_into
from .rewards import FRAMES_PAID, frame_reward_of
from .tables import COUNTS, I_BREAK, I_FOULS, REALS, Tables, write_empty_info, write_stroke_info

AGENT = 0
_OK, _BALL_BALL = int(Status.OK), int(EventKind.BALL_BALL)
(I_SCORE, I_OPPONENT_SCORE, I_CLOCK) = range(len(REALS), len(REALS) + 3)
(I_STROKES, I_REPLIES, I_WINNER) = range(len(COUNTS), len(COUNTS) + 3)
(I_CHOICE, I_FREE_BALL, I_NEEDS_SNOOKERS, I_ANYWHERE, I_WARNED) = range(len(COUNTS) + 3, len(COUNTS) + 8)
(I_MISSES, I_FAILURES) = range(len(COUNTS) + 8, len(COUNTS) + 10)
(I_FRAMES_WON, I_OPPONENT_FRAMES, I_FRAME) = range(len(COUNTS) + 10, len(COUNTS) + 13)
"""Entries of a match only."""


class Setting(NamedTuple):
    """The constants of all frames of some tables."""

    rules: int  # code of the rule set, as in ``frame_columns.Conditions``
    miss: int
    time_to_play: int
    reward: int  # its code
    limit: int  # steps after which an episode is truncated
    max_strokes: int  # strokes after which a frame is stopped
    one_stroke: bool  # whether an episode ends with its first stroke that is no foul
    frames: int  # frames that win a match
    clock: int  # time of a frame [ms]; 0: no clock
    lot: bool  # whether the winner of the lot for a re-spotted black says who begins
    jaws: Floats  # (m, 3): see ``snookered.NO_JAWS``


@kernel
def give_up(row, reward):
    """Charge whoever gave a frame up, or lost by a third miss, with the points left, S4 R5(b)."""
    if reward != FRAMES_PAID:
        left = available(row[columns.ON_TABLE], -1, 0)
        row[columns.PAID] += -left if row[columns.WINNER] == AGENT else left


@kernel
def say(k, declared, decision, reward, tables, saved):
    """Carry out what the striker may say, and says, before a stroke; whether one of the same player follows."""
    row = tables.game[k]
    if declared == declarations.CONCEDES:
        columns.concede(row)
        give_up(row, reward)
    elif declared == declarations.CLAIMS:
        columns.claim(row)
    elif row[columns.PHASE] == columns.LOT:
        other = declared == declarations.OTHER_BEGINS
        columns.draw(row, 1 - row[columns.STRIKER] if other else row[columns.STRIKER])
    elif row[columns.PHASE] == columns.CHOICE:
        columns.choose(row, decision)
        if decision == columns.REPLACE:
            p, on = tables.positions[k], tables.on_table[k]
            back, back_on = saved.positions[k], saved.on_table[k]
            for i in range(N_BALLS):
                p[i, 0], p[i, 1], on[i] = back[i, 0], back[i, 1], back_on[i]
        return decision == columns.PLAY or decision == columns.PLACE_ANYWHERE
    return declared == declarations.SAYS_NOTHING


@entry(what="what actions say", seconds=1)
def read_sayings(actions, options, game, rules, nominated, decisions, declared):
    """What the strikers of n frames say with their actions: nominations, decisions and declarations (n,)."""
    for k in range(len(game)):
        row, a = game[k], actions[k]
        declared[k] = declarations.declaration_of(a, options, row)
        decisions[k] = declarations.decision_of(a, options, row, rules)
        nominated[k] = declarations.nomination_of(a, options, row)


@entry(what="the decisions of frames", seconds=2)
def decide(which, actions, options, tables, saved, setting, plays):
    """What strikers say before a stroke; ``plays[j]``: one follows."""
    tables, saved, setting = TableArrays(*tables), columns.Layouts(*saved), Setting(*setting)
    for j in range(which.shape[0]):
        k = which[j]
        row, a = tables.game[k], actions[k]
        declared = declarations.declaration_of(a, options, row)
        decision = declarations.decision_of(a, options, row, setting.rules)
        plays[j] = say(k, declared, decision, setting.reward, tables, saved)
        if plays[j] and options[declarations.A_NOMINATE] >= 0:
            tables.nominated[k] = declarations.nomination_of(a, options, row)


@entry(what="the strokes of players in frames", seconds=3)
def carry_out(which, asked, tables, saved, setting, packed, shots, playing):
    """Strokes ``asked`` (``frames.Asked``) of the tables ``which``: shots 0 to m - 1, on the tables ``playing[:m]``; returns m."""
    values, places, nominate, decisions, declared = asked
    tables, saved, shots = TableArrays(*tables), columns.Layouts(*saved), StruckArrays(*shots)
    setting, (cues, noise), m = Setting(*setting), packed, 0
    for k in which:
        row, p, on = tables.game[k], tables.positions[k], tables.on_table[k]
        cue_row = cues[stroke.row_of(k, cues)]
        says = declared[k] if declarations.may_declare(declared[k], row) else declarations.SAYS_NOTHING
        decision = columns.allowed_choice(row, decisions[k], setting.rules)
        if not say(k, says, decision, setting.reward, tables, saved):
            continue
        colour = max(0, nominate[k] - YELLOW + 1)
        tables.nominated[k] = AUTO if nominate[k] < 0 else declarations.nominated_ball(colour, row)
        if row[columns.IN_HAND] and not np.isnan(places[k, 0]):
            stroke.place(p, on, places[k, 0], places[k, 1], row[columns.ANYWHERE] != 0)
        speed, aim, elevation = values[k, 0], values[k, 3], values[k, 4]
        side, top = tip_on_disc(values[k, 1], values[k, 2], cue_row[C_MAX_OFFSET])
        intended = (speed, side, top, aim - squirt(side, cue_row[C_END_MASS]), elevation)
        stroke.strike(intended, p, on, tables.streams[k], cue_row, noise, m, shots)
        playing[m] = k
        m += 1
    return m


@entry
def hold_late(which, game, rules, time_to_play, v, w, aloft, shots):
    """Shots that would not be begun within the shot clock are not played: the cue ball is not struck."""
    for j in range(which.shape[0]):
        if columns.is_late(game[which[j]], rules, time_to_play):
            v[j, CUE, 0] = v[j, CUE, 1] = aloft[j, CUE, 1] = 0.0
            w[j, CUE, 0] = w[j, CUE, 1] = w[j, CUE, 2] = 0.0
            for c in range(stroke.VX, stroke.WZ + 1):
                shots[j, c] = 0.0


@entry(what="the referee of frames", seconds=6)
def conclude(which, tables, shots, setting, reported, alone, played, output):
    """Judge the shots that came to rest. ``reported``: infos report them; ``alone``: the agent plays on."""
    tables, shots, setting = TableArrays(*tables), PlayedArrays(*shots), Setting(*setting)
    out = OutputArrays(*output)
    rules, conditions = setting.rules, columns.Conditions(setting.rules, setting.miss, setting.time_to_play)
    for j in range(which.shape[0]):
        if shots.status[j] != _OK:
            continue
        k = which[j]
        p, on, row, seen = tables.positions[k], tables.on_table[k], tables.game[k], shots.seen[j]
        first, touching, moved, potted, off = stroke.see(j, shots, p, on)
        for i in range(N_BALLS):
            p[i, 0], p[i, 1] = shots.r[j, i, 0], shots.r[j, i, 1]
        ball_on, flags = row[columns.BALL_ON], FLAG.JUMP if seen[stroke.JUMPED] else 0
        if rules == SIX_RED:
            flags |= FLAG.SIX_RED
        elif rules == SHOOT_OUT:
            flags |= FLAG.SHOOT_OUT
            if columns.is_late(row, rules, setting.time_to_play):
                flags |= FLAG.LATE
            if not stroke.reached_cushion(shots.event_what[j], shots.n_events[j]):
                flags |= FLAG.NO_CUSHION
        situation = ball_on, row[columns.FREE_BALL], columns.lead_of(row, row[columns.STRIKER])
        facts = Facts(first, touching, moved, potted, off, tables.nominated[k])
        result = settle(p, on, situation, facts, flags, setting.jaws, BALL_RADIUS)
        tables.nominated[k] = AUTO
        striker, free, points = row[columns.STRIKER], row[columns.FREE_BALL], row[columns.POINTS]
        stroke.write_ruling(seen, striker, ball_on, free, points, result)
        reached = seen[stroke.CLEAR_PATH] != 0, seen[stroke.FULL_PATH] != 0, seen[stroke.ATTEMPT] != 0
        effort = columns.Effort(*reached)
        lasted = int(1000.0 * shots.duration[j] + 0.5)
        columns.after_stroke(row, result, conditions, effort, setting.miss != columns.NO_MISSES, lasted)
        row[columns.STROKES] += 1
        if row[columns.OVER] and result.outcome == OUTCOME.PLAYING and rules != SHOOT_OUT:  # by a third miss
            give_up(row, setting.reward)
        if row[columns.PHASE] == columns.LOT:
            for i in range(1, N_BALLS):  # more were on the table if the time was up
                on[i] = i == BLACK
            p[BLACK, 0], p[BLACK, 1] = SPOTS[BLACK, 0], SPOTS[BLACK, 1]
            u, _ = pair(tables.streams[k])
            row[columns.STRIKER] = int(2.0 * u)  # the winner of the lot
            if alone or not setting.lot:
                columns.draw(row, row[columns.STRIKER])  # who begins
        if row[columns.IN_HAND] and not row[columns.OVER]:
            lies = row[columns.ANYWHERE] and not (potted | off) & 1  # it stays where it came to rest
            x, y = (p[CUE, 0], p[CUE, 1]) if lies else (SPOTS[CUE, 0], SPOTS[CUE, 1])
            stroke.place(p, on, x, y, row[columns.ANYWHERE] != 0)
        played[k] += 1
        if reported:
            write_stroke_info(k, out, j, shots, ball_on, result)
        if alone and not row[columns.OVER] and row[columns.STRIKER] != AGENT:
            if row[columns.PHASE] == columns.CHOICE:
                columns.choose(row, columns.PLAY_AGAIN)
            row[columns.STRIKER] = AGENT  # ``after_stroke`` has ended the break already


@kernel
def _share(number, scale):
    """A number of any size as one in (-1, 1), monotone."""
    return number / (abs(number) + scale)


@kernel
def observe_frame_into(out, k, tables, saved, setting, player):
    """Write what ``player`` observes: as in a visit, ``FRAME_ENTRIES`` and, with room, the saved layout."""
    row, present = tables.game[k], tables.on_table[k]
    on = columns.strikeable(row, bits(present) & ~1)
    in_hand, points = row[columns.IN_HAND], row[columns.POINTS]
    observe_into(out, tables.positions[k], present, row[columns.BALL_ON], on, in_hand, points)
    mine, other = row[columns.SCORE_0 + player], row[columns.SCORE_1 - player]
    to_play = not row[columns.OVER] and row[columns.STRIKER] == player
    left = available(row[columns.ON_TABLE], row[columns.BALL_ON], row[columns.FREE_BALL])
    clock = min(1.0, row[columns.CLOCK] / setting.clock) if setting.clock else 0.0
    more = out[SIZE:FRAME_SIZE]
    more[0], more[1], more[2] = _share(mine, 147.0), _share(other, 147.0), _share(mine - other, 147.0)
    more[3], more[4], more[5] = left / 155.0, to_play, row[columns.FREE_BALL] != 0
    more[6], more[7] = row[columns.PHASE] == columns.CHOICE, row[columns.MISS_CALLED] != 0
    more[8], more[9] = row[columns.RESPOTTED_BLACK] != 0, row[columns.BREAKER] == player
    more[10], more[11] = row[columns.FAILURES] / 2.0, row[columns.WARNED] != 0
    more[12], more[13] = row[columns.PHASE] == columns.LOT, _share(row[columns.FRAMES_0 + player], 1.0)
    more[14], more[15] = _share(row[columns.FRAMES_1 - player], 1.0), _share(setting.frames, 1.0)
    more[16], more[17], more[18] = clock, _share(row[columns.MISSES], 5.0), row[columns.ANYWHERE] != 0
    if out.shape[0] < FRAME_SIZE + REPLACED_SIZE:
        return
    for i in range(N_BALLS):
        at, back = FRAME_SIZE + 3 * i, row[columns.MISS_CALLED] and saved.on_table[k, i]
        out[at] = saved.positions[k, i, 0] / HALF_WIDTH if back else 0.0
        out[at + 1] = saved.positions[k, i, 1] / HALF_LENGTH if back else 0.0
        out[at + 2] = 1.0 if back else 0.0


@entry(what="the observations of frames", seconds=1)
def observe(which, player, tables, saved, setting, rows):
    """The observations of ``player`` on the tables ``which``: one of ``rows`` each."""
    tables, saved, setting = TableArrays(*tables), columns.Layouts(*saved), Setting(*setting)
    for j in range(which.shape[0]):
        observe_frame_into(rows[j], which[j], tables, saved, setting, player)


@kernel
def _write_frame_info(k, row, player, replies, out):
    """Write the info of the frame as ``player`` sees it: break, choice, free ball are the striker's."""
    reals, counts = out.reals, out.counts
    mine, other = row[columns.SCORE_0 + player], row[columns.SCORE_1 - player]
    at_table = row[columns.STRIKER] == player
    reals[k, I_BREAK], reals[k, I_SCORE] = row[columns.POINTS] if at_table else 0, mine
    reals[k, I_OPPONENT_SCORE] = other
    counts[k, I_STROKES], counts[k, I_REPLIES] = row[columns.STROKES], replies
    counts[k, I_WINNER] = row[columns.WINNER]
    counts[k, I_CHOICE] = at_table and row[columns.PHASE] == columns.CHOICE
    counts[k, I_FREE_BALL] = at_table and row[columns.FREE_BALL]
    counts[k, I_NEEDS_SNOOKERS] = columns.needs_snookers(row, player)
    reals[k, I_CLOCK] = row[columns.CLOCK] / 1000.0
    counts[k, I_ANYWHERE], counts[k, I_WARNED] = row[columns.ANYWHERE], row[columns.WARNED]
    counts[k, I_MISSES], counts[k, I_FAILURES] = row[columns.MISSES], row[columns.FAILURES]
    if counts.shape[1] > I_FRAME:
        counts[k, I_FRAMES_WON] = row[columns.FRAMES_0 + player]
        counts[k, I_OPPONENT_FRAMES] = row[columns.FRAMES_1 - player]
        # from 0: the last one of a match that is over, too
        counts[k, I_FRAME] = row[columns.FRAMES_0] + row[columns.FRAMES_1] - row[columns.OVER]


MOST_STEPS = 20  # steps of an episode of one stroke at most: a player who fouls, or is sent back, plays again


@entry(what="the steps of frames", seconds=1)
def finish(which, tables, saved, setting, due, through, replies, played, output):
    """Write a step's results; ``played``: whether the agent had a stroke; ``through``: whether its only one was. No end stays ``due``."""
    tables, saved, setting = TableArrays(*tables), columns.Layouts(*saved), Setting(*setting)
    out = OutputArrays(*output)
    for j in range(which.shape[0]):
        k = which[j]
        row = tables.game[k]
        row[columns.STEPS] += 1
        worth = columns.lead_of(row, AGENT)
        if setting.reward == FRAMES_PAID:
            worth = row[columns.FRAMES_0 + AGENT] - row[columns.FRAMES_1 - AGENT]
        winner = row[columns.WINNER] if row[columns.OVER] else -1
        out.rewards[k] = frame_reward_of(setting.reward, worth - row[columns.PAID], winner, AGENT)
        row[columns.PAID], due[k] = worth, False
        if not played[k]:
            write_empty_info(k, out, row[columns.BALL_ON])
        fair = played[k] and not out.counts[k, I_FOULS]  # its stroke was no foul
        fair = setting.one_stroke and fair and row[columns.PHASE] != columns.CHOICE
        spent = setting.one_stroke and row[columns.STEPS] >= MOST_STEPS
        stopped = row[columns.STROKES] >= setting.max_strokes or (spent and not fair)
        through[k] = fair or spent
        out.terminated[k] = row[columns.OVER] or fair
        out.truncated[k] = (stopped and not row[columns.OVER]) or row[columns.STEPS] >= setting.limit
        _write_frame_info(k, row, AGENT, replies[k], out)
        observe_frame_into(out.observations[k], k, tables, saved, setting, AGENT)


@entry(what="the start of a frame", seconds=1)
def begin(which, breakers, in_hand, on_table, game):
    """New frames on tables already dealt; ``breakers`` (m,): who breaks on each."""
    for j in range(which.shape[0]):
        k = which[j]
        columns.begin_frame(game[k], bits(on_table[k]), breakers[j], in_hand)
        game[k, columns.FIRST_BREAK] = breakers[j]


@entry(what="the resets of frames", seconds=1)
def show(which, player, tables, saved, setting, replies, output):
    """Write the results of a reset as ``player`` sees the tables ``which``."""
    tables, saved, setting = TableArrays(*tables), columns.Layouts(*saved), Setting(*setting)
    out = OutputArrays(*output)
    for j in range(which.shape[0]):
        k = which[j]
        write_empty_info(k, out, tables.game[k, columns.BALL_ON])
        _write_frame_info(k, tables.game[k], player, replies[k], out)
        observe_frame_into(out.observations[k], k, tables, saved, setting, player)


@entry(what="the paths of the miss rule", seconds=2)
def remember(which, tables, saved, shots, noses, jaws):
    """Record the layouts before the strokes, and which paths were clear before those that struck no ball on first; strokes
    with neither path that struck no ball that could be on are no attempts, unless ``judge_attempts`` says so. S3 R14(c)
    speaks of every ball "that is or could be on": after a red, all colours."""
    tables, saved, shots = TableArrays(*tables), columns.Layouts(*saved), PlayedArrays(*shots)
    for j in range(which.shape[0]):
        if shots.status[j] != _OK:
            continue
        k = which[j]
        positions, on_table, row = tables.positions[k], tables.on_table[k], tables.game[k]
        mask, seen = bits(on_table), shots.seen[j]
        first, touching, moved, potted, off = stroke.see(j, shots, positions, on_table)
        seen[stroke.CLEAR_PATH], seen[stroke.FULL_PATH], seen[stroke.ATTEMPT] = True, False, True
        before = Before(mask, row[columns.BALL_ON], row[columns.FREE_BALL], 0)
        facts = Facts(first, touching, moved, potted, off, tables.nominated[k])
        if ruling(before, facts, 0).fouls & columns.MISSED:
            in_hand, on = row[columns.IN_HAND] + row[columns.ANYWHERE], columns.strikeable(row, mask & ~1)
            clear, full = best_paths(positions, on_table, on, in_hand, noses, jaws, BALL_RADIUS)
            seen[stroke.CLEAR_PATH], seen[stroke.FULL_PATH] = clear, full
            seen[stroke.ATTEMPT] = clear or full or first & on != 0
        for i in range(N_BALLS):
            saved.positions[k, i, 0], saved.positions[k, i, 1] = positions[i, 0], positions[i, 1]
            saved.on_table[k, i] = on_table[i]


@entry(what="the attempts of snookered strikers", seconds=1)
def gap_of(positions, on_table, row, shots, path, j):
    """How near the cue ball came to a ball on in shot j, before it struck another or came to rest [m]."""
    shots, (segments, n_segments) = PlayedArrays(*shots), path
    until, on = shots.duration[j], columns.strikeable(row, bits(on_table) & ~1)
    for e in range(shots.n_events[j]):
        if shots.event_what[j, e, 0] == _BALL_BALL and shots.event_what[j, e, 1] == CUE:
            until = shots.event_time[j, e]
            break
    return closest_approach(segments[j], n_segments[j], until, positions, on_table, on, BALL_RADIUS)


def judge_attempts(which: Ints, b: stroke.ShotBuffers, tables: Tables) -> None:
    """Play the shots that ``remember`` took for no attempts once more, with their path, and judge them."""
    cushions, m = (tables.rules.table.noses, tables.rules.table.jaws), len(which)
    for j in np.flatnonzero((b.status[:m] == _OK) & (b.seen[:m, stroke.ATTEMPT] == 0)).tolist():
        k = int(which[j])
        p, here, row = tables.positions[k], tables.on_table[k], tables.game[k]
        one, at = b, j
        if not b.segments.shape[1]:
            one, at = tables.play_again(k, here, j, b, b.log, path=True), 0
        gap = gap_of(p, here, row, one.played, (one.segments, one.n_segments), at)
        placed, on = row[columns.IN_HAND] or row[columns.ANYWHERE], tables.on(k)
        if gap > ATTEMPT_GAP and not placed and shut_in(p, here, on, *cushions, BALL_RADIUS):
            # no ball on can be hit: those ahead stay
            ahead = (p - p[CUE]) @ b.shots[j, [stroke.VX, stroke.VY]] > 0.0
            only = here & (on >> np.arange(N_BALLS) & 1 > 0) & ahead
            only[CUE] = True
            one = tables.play_again(k, only, j, b, b.log, path=True)
            gap = gap_of(p, only, row, one.played, (one.segments, one.n_segments), 0)
        b.seen[j, stroke.ATTEMPT] = gap <= ATTEMPT_GAP
