"""What does a stroke do without errors? ``Intention``: its kind, its ball and pocket, and its words."""

from dataclasses import replace
from math import hypot
from typing import NamedTuple

import numpy as np

from ..game.balls import CUE
from ..geometry import BALL_RADIUS, BAULK_Y
from ..planning import Outcomes, Positions, clear_paths
from ..planning.pot_geometry import obstructions
from ..planning.worth import lead_of, left_of
from ..players.cue_stroke import CueStroke
from . import stroke_words as say
from .practice import Practice, Room, arrive, find_arrivals, join, room_for, start_from

FOULS = ("foul", "in-off")  # kinds of strokes that are fouls without errors


class Intention(NamedTuple):
    """A stroke of a ranking, and what it does without errors."""

    stroke: CueStroke
    start: Positions  # the position that it is played from
    kind: str
    ball: int
    pocket: int
    first: int
    words: str  # what it does and how it is struck, in words
    alike: str  # the same without what the room does: strokes with equal ones are one stroke to a player
    room: Room
    spends: bool  # whether it pots a ball that the striker needs to lay snookers on
    idea: tuple[str, str | int, int]  # what other ways of playing it share with it


def intend(practice: Practice, at: Positions, strokes: list[CueStroke]) -> list[Intention]:
    """What strokes do without errors in the one position ``at``."""
    starts = join([start_from(at, stroke) for stroke in strokes])
    stops = practice.play(starts, np.arange(len(strokes)), np.stack([stroke.numbers() for stroke in strokes]))
    hidden = ~clear_paths(starts)
    lies = _say_lies(stops) if at.of_frames else [""] * len(strokes)
    seen = zip(strokes, hidden.tolist(), lies, strict=True)
    made = [_intend(practice, starts, stops, k, *one) for k, one in enumerate(seen)]
    return _count_snookers(at, stops.afterstates, made) if at.of_frames else made


def _intend(
    practice: Practice, starts: Positions, stops: Outcomes, k: int, stroke: CueStroke, hidden: bool, lie: str
) -> Intention:
    """Stroke k; ``hidden``: no straight path leads to a ball on; ``lie``: where it leaves the cue ball, in words."""
    room = room_for(stroke.numbers(), starts[k : k + 1], practice.options.rules)
    first, pocket, how = int(stops.first[k]), -1, ""
    ball, (x, y) = first, starts.positions[k, CUE].tolist()
    dx, dy = (starts.positions[k, max(0, first)] - (x, y)).tolist()
    down = [ball for ball in np.flatnonzero(stops.potted[k] >= 0).tolist() if ball != CUE]
    if stops.points[k] > 0 and down:
        kind, ball = "pot", first if first in down else down[0]
        pocket = int(stops.potted[k, ball])
    elif stops.penalty[k]:
        kind = "in-off" if stops.potted[k, CUE] >= 0 else "foul"
    elif hidden:
        kind, how = "escape", say.cushion_words(x, y, stroke.aim) if room.elevation < say.RAISED else ""
    else:
        kind, on = "safety" if starts.of_frames else "contact", starts.balls_on[k]
        if first >= 0 and on[first]:
            how = say.contact_words(dx, dy, stroke.aim)
        else:  # fair without a contact: it is played away from a ball on that it touches
            gaps = np.hypot(*(starts.positions[k] - (x, y)).T)
            ball = int(np.where(on, gaps, np.inf).argmin())
    distance = None if first < 0 else max(0.0, hypot(dx, dy) - 2.0 * BALL_RADIUS)
    what, physics = say.what_words(kind, ball, pocket, first, how), practice.options.rules.physics
    played = replace(stroke, side=room.side, top=room.top)  # its spin is that of the tip that is reached
    how_played = (say.stroke_words(played, distance, physics, way) for way in (room, None))
    push = say.push_words(dx, dy, stroke.aim, first) if first >= 0 else ""
    words, alike = (", ".join(filter(None, (what, how, lie, push))) for how in how_played)
    idea = kind, ball, pocket
    if kind != "pot":  # a red is as good as another; where the cue ball goes tells safeties apart
        third = int(np.digitize(stops.places[k, CUE, 1], (BAULK_Y, -BAULK_Y)))
        idea = kind, say.ball_name(ball), third
    return Intention(stroke, starts[k : k + 1], kind, ball, pocket, first, words, alike, room, False, idea)


def _count_snookers(at: Positions, after: Positions, strokes: list[Intention]) -> list[Intention]:
    """Strokes of a frame, which say whether the striker needs snookers, and what a pot of the last red or a colour leaves then."""
    needs, out = bool((lead_of(at) + left_of(at))[0] < 0.0), []
    fewer = after.on_table[:, 1:].sum(axis=1) < at.on_table[0, 1:].sum()
    last = ~after.on_table[:, 1:16].any(axis=1)
    for one, lead, left, spends in zip(strokes, lead_of(after), left_of(after), fewer & last, strict=True):
        behind = int(-lead) if one.kind == "pot" and lead + left < 0.0 else 0
        words = ", ".join(filter(None, (one.words, say.snookers_words(needs, behind, int(left)))))
        out.append(one._replace(words=words, spends=needs and one.kind == "pot" and bool(spends)))
    return out


def drop_alike(strokes: list[Intention]) -> list[Intention]:
    """Only the first of several strokes with equal descriptions, apart from the speed of a pot."""
    first = {}
    for one in strokes:
        speed = f"{one.stroke.speed:.1f} m/s" if one.kind == "pot" else ""
        first.setdefault(one.alike.replace(speed, ""), one)
    return list(first.values())


def _say_lies(stops: Outcomes) -> list[str]:
    """Where strokes that leave the table to the other put the cue ball, in words; "" elsewhere."""
    out, after = [""] * len(stops.first), stops.afterstates
    rows = np.flatnonzero(find_arrivals(after) & (stops.penalty == 0))
    theirs = arrive(after[rows])
    seen = clear_paths(theirs)
    for j, k in enumerate(rows.tolist()):
        x, y = theirs.positions[j, CUE].tolist()
        ball = -1 if seen[j] else _nearest_in_the_way(theirs, j)
        gap = 0.0 if ball < 0 else hypot(*(theirs.positions[j, ball] - (x, y)).tolist())
        out[k] = say.lie_words(x, y, ball, gap)
    return out


def _nearest_in_the_way(at: Positions, k: int) -> int:
    """The ball nearest to the cue ball of those on its straight lines to the balls on; -1 if there is none."""
    here, on = at.positions[k], np.flatnonzero(at.balls_on[k])
    many, starts = np.arange(len(on)), np.repeat(here[None, CUE], len(on), 0)
    hit = obstructions(at, np.full(len(on), k), starts, here[on], np.array([CUE]))
    hit[many, on] = False
    way = np.flatnonzero(hit.any(axis=0))
    if not len(way):
        return -1
    return int(way[np.hypot(*(here[way] - here[CUE]).T).argmin()])
