"""How does a stroke turn out under execution errors? Chances, points and stops, on common noise samples."""

from dataclasses import replace
from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from .._types import Bools, Floats
from ..game.balls import CUE
from ..game.frame_columns import Layouts
from ..geometry import BALL_RADIUS
from ..planning import Outcomes, Positions, clear_paths
from ..players.cue_stroke import CueStroke
from . import words as say
from .frames import Outlook, Z, lies, outlooks, rest_of
from .practice import JUDGING, Practice, keys, played_from
from .room import Room, room_for
from .suggestions import Suggestion

FOULS = ("foul", "in-off")  # kinds of strokes that are fouls without errors
RIVALS = 4  # strokes of the other kind, pots or not, that the best of a frame is compared with
SELDOM = 0.05  # chance of a pot below which it is no suggestion where there are others
OFTEN = 0.05  # share of misses from which is said what a missed pot leaves


def wilson(made: int, tries: int) -> tuple[float, float]:
    """The 95 % interval of a probability with ``made`` successes in ``tries`` samples (Wilson 1927)."""
    share, z2 = made / tries, Z * Z / tries
    middle = (share + 0.5 * z2) / (1.0 + z2)
    half = Z * sqrt(share * (1.0 - share) / tries + 0.25 * z2 / tries) / (1.0 + z2)
    return max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half))


def points_expected(points: Floats, goes_on: Bools, rest: Floats) -> tuple[float, tuple[float, float]]:
    """Mean points of a visit and its 95 % interval: first strokes (samples,), and the ``rest`` (visits,)."""
    n, follows = len(points), float(rest.mean()) if len(rest) else 0.0
    share, each = float(goes_on.mean()), points + goes_on * follows
    mean = float(each.mean())
    # delta method: the samples' part, then that of the rest
    variance = float(each.var(ddof=1)) / n if n > 1 else 0.0
    variance += share * share * float(rest.var(ddof=1)) / len(rest) if len(rest) > 1 else 0.0
    half = Z * sqrt(variance)
    return mean, (max(0.0, mean - half), mean + half)


class Tried(NamedTuple):
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


def tried(practice: Practice, at: Positions, strokes: list[CueStroke]) -> list[Tried]:
    """What strokes do without errors in the one position ``at``."""
    starts = joined([played_from(at, stroke) for stroke in strokes])
    stops = practice.play(starts, np.arange(len(strokes)), np.stack([stroke.numbers() for stroke in strokes]))
    hidden = ~clear_paths(starts).any_part
    ends = lies(stops) if at.of_frames else [""] * len(strokes)
    return [_trial(practice, starts, stops, k, one, hidden[k], ends[k]) for k, one in enumerate(strokes)]


def joined(positions: list[Positions]) -> Positions:
    """Several positions of one table as the rows of one."""
    places, present, game = zip(*((one.positions, one.on_table, one.game) for one in positions), strict=True)
    own = [one.conditions for one in positions if one.conditions is not None]
    saved = [one.saved for one in positions if one.saved is not None]
    layouts = Layouts(*map(np.concatenate, zip(*saved, strict=True))) if saved else None
    tables = np.concatenate(own) if own else None
    return Positions(np.concatenate(places), np.concatenate(present), np.concatenate(game), layouts, tables)


def _trial(
    practice: Practice, starts: Positions, trial: Outcomes, k: int, stroke: CueStroke, hidden: Bools, lie: str
) -> Tried:
    """Stroke k; ``hidden``: no straight path leads to a ball on; ``lie``: where it leaves the cue ball, in words."""
    room = room_for(stroke.numbers(), starts[k : k + 1], practice.options.rules)
    first, pocket, how = int(trial.first[k]), -1, ""
    ball, (x, y) = first, starts.positions[k, CUE].tolist()
    dx, dy = (starts.positions[k, max(0, first)] - (x, y)).tolist()
    down = [ball for ball in np.flatnonzero(trial.potted[k] >= 0).tolist() if ball != CUE]
    if trial.points[k] > 0 and down:
        kind, ball = "pot", first if first in down else down[0]
        pocket = int(trial.potted[k, ball])
    elif trial.penalty[k]:
        kind = "in-off" if trial.potted[k, CUE] >= 0 else "foul"
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
    return Tried(stroke, starts[k : k + 1], kind, ball, pocket, first, words, alike, room)


def distinct(strokes: list[Tried]) -> list[Tried]:
    """Only the first of several strokes with equal descriptions, apart from the speed of a pot."""
    first = {}
    for one in strokes:
        speed = f"{one.stroke.speed:.1f} m/s" if one.kind == "pot" else ""
        first.setdefault(one.alike.replace(speed, ""), one)
    return list(first.values())


def fair(practice: Practice, strokes: list[Tried], n: int, **how: int) -> list[Suggestion]:
    """The first n strokes that are fair without errors and in most samples, the preferred kind first.

    Pots that hardly ever go are none of them, unless nothing else is, or in a frame none of the others wins so often."""
    waiting, out, unlikely = [one for one in strokes if one.kind not in FOULS], [], []
    while waiting and len(out) < n:
        some, waiting = waiting[: n - len(out)], waiting[n - len(out) :]
        for one in judged(practice, some, **how):
            if one.foul <= 0.5:
                (unlikely if one.kind == "pot" and one.chance < SELDOM else out).append(one)
    most = max([one.win for one in out if one.win is not None], default=-1.0)
    if not out or out[0].win is not None:
        out += [_needed(one) for one in unlikely if not out or one.win > most][: max(1, n - len(out))]
    if out and out[0].win is not None:
        out = sorted(out, key=lambda one: -one.figure)[:n]
        pot = out[0].kind == "pot"
        others = [one for one in waiting if (one.kind == "pot") != pot][:RIVALS]
        others = judged(practice, others, **how | {"visits": 0}) if others else []
        return [_compared(out, [one for one in out[1:] + others if one.foul <= 0.5]), *out[1:]]
    return sorted(out, key=lambda one: ((one.kind == "pot") != (out[0].kind == "pot"), -one.figure))


def _needed(one: Suggestion) -> Suggestion:
    """A pot that hardly ever goes, with the words why it is suggested."""
    return replace(one, words=f"{one.words}; hardly ever made, but no better stroke was found")


def _compared(best: list[Suggestion], others: list[Suggestion]) -> Suggestion:
    """The best stroke of a frame, compared with the best of the other kind, a pot or none, or the next best."""
    one = best[0]
    rivals = [other for other in others if (other.kind == "pot") != (one.kind == "pot")]
    if not (rivals or best[1:]):
        return one
    rival = max(rivals or best[1:], key=lambda other: other.figure)
    kind = rival.kind if rivals else ""
    return replace(one, against=rival.win, words=one.words + say.against_words(rival.figure, kind))


def least_bad(practice: Practice, strokes: list[Tried], **how: int) -> Suggestion:
    """The stroke that is fair in most samples, where none is fair."""
    best = min(judged(practice, strokes, **how), key=lambda one: one.foul)
    return replace(best, words=f"no fair stroke found: {best.words}")


def judged(
    practice: Practice, strokes: list[Tried], *, samples: int, visits: int, seed: int
) -> list[Suggestion]:
    """Strokes with their outcomes under execution errors, in their order."""
    n = len(strokes)
    tries, again = (1, min(1, visits)) if practice.sure else (samples, visits)
    rows, starts = [one.stroke.numbers() for one in strokes], joined([one.start for one in strokes])
    each, noise = np.repeat(np.arange(n), tries), np.tile(keys(seed, JUDGING, tries), n)
    stops = practice.play(starts, each, np.repeat(rows, tries, 0), noise)
    groups = [k * tries + np.flatnonzero(stops.goes_on[k * tries : (k + 1) * tries]) for k in range(n)]
    rest = rest_of(practice, stops.afterstates, groups, again, seed)
    looks = outlooks(practice, starts, each, stops, n, again, seed) if starts.of_frames else None
    out = []
    for k, one in enumerate(strokes):
        mine = slice(k * tries, (k + 1) * tries)
        look = None if looks is None else looks[k]
        no_foul = stops.penalty[mine] == 0
        made = no_foul & (stops.potted[mine, one.ball] == one.pocket) if one.kind == "pot" else no_foul
        chance = float(made.mean())
        points, interval = points_expected(stops.points[mine], stops.goes_on[mine], rest[k])
        stayed = stops.potted[mine, CUE] < 0
        middle, spread = _cloud(stops.places[mine, CUE][stayed])
        out.append(
            Suggestion(
                **vars(one.stroke),
                **{name: getattr(one, name) for name in ("room", "kind", "ball", "pocket", "first")},
                **(look._asdict() if look else {}),
                chance=chance,
                chance_interval=(chance, chance) if practice.sure else wilson(int(made.sum()), tries),
                points=points,
                points_interval=interval,
                foul=float((~no_foul).mean()),
                in_off=float((~stayed).mean()),
                stops=middle,
                spread=spread,
                words=f"{one.words}, {say.figures_words(one.kind, chance, points, look is not None)}"
                + (_why(one.kind, chance, look) if look else ""),
            )
        )
    return out


def _cloud(places: Floats) -> tuple[tuple[float, float] | None, float | None]:
    """The mean of points (m, 2) and their root mean square distance from it; None, None without points."""
    if not len(places):
        return None, None
    x, y = places.mean(axis=0).tolist()
    return (x, y), float(np.sqrt(((places - (x, y)) ** 2).sum(axis=1).mean()))


def _why(kind: str, chance: float, look: Outlook) -> str:
    """The words of what a stroke of a frame leads to."""
    seldom = kind == "pot" and 1.0 - chance < OFTEN
    reply = "" if seldom else say.reply_words(kind, look.replies, look.leaves, look.snookers)
    return f"{reply and f', {reply}'}; win chance {say.percent(look.win)}"
