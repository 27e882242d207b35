"""How is the game described without a picture? In plain words, seen from the baulk end: right is +x."""

from math import hypot

import numpy as np

from ..game.balls import CUE, NAMES, SPOTS, YELLOW
from ..game.frame import Frame
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, HALF_LENGTH, HALF_WIDTH
from ..replays.words import on_words, sentence
from .lines import Line
from .session import Act

_ALONG = (
    (BAULK_Y, "in baulk"),
    (-0.35, "between baulk and the middle"),
    (0.35, "about the middle of the table"),
    (COLOUR_SPOTS[4, 1], "between the middle and the pink spot"),
    (COLOUR_SPOTS[5, 1], "between the pink and the black spot"),
    (np.inf, "behind the black spot"),
)


def asked_words(frame: Frame, labels: tuple[str, str]) -> str:
    """What the rules ask for next, in a sentence; ``labels``: the names of both players."""
    who = labels[frame.striker]
    yours = "Your stroke" if who == "You" else f"{who}'s stroke"
    if frame.winner is not None:
        return f"Frame over: {labels[frame.winner]} won."
    if frame.phase == "choice":
        miss = " and a miss" if frame.miss_called else ""
        return f"Foul{miss} by {labels[1 - frame.striker]}: {'choose' if who == 'You' else f'{who} chooses'}."
    on = on_words(frame.ball_on) + (", and a free ball are" if frame.free_ball else " is")
    placing = "; the cue ball is in hand" if frame.in_hand else ""
    return f"{yours}: {on} on{placing}."


def last_words(act: Act, labels: tuple[str, str]) -> str:
    """An act in a sentence."""
    who = "" if act.player is None else labels[act.player]
    if act.played is not None:
        nominated = f" ({act.detail} nominated)" if act.detail else ""
        return f"{who}{nominated}: {sentence(act.played, labels)}"
    return {
        "choice": f"{who}: {act.detail.replace('_', ' ')}.",
        "concede": f"{who} concede{'' if who == 'You' else 's'} the frame.",
        "claim": f"{who} claim{'' if who == 'You' else 's'} the frame.",
        "set_up": "Position set up.",
        "load": "Game loaded.",
        "new": "New frame.",
    }[act.what]


def where(ball: int, x: float, y: float) -> str:
    """A place in words."""
    for k, spot in enumerate(COLOUR_SPOTS):
        if hypot(x - spot[0], y - spot[1]) < 1e-3:
            return "on its spot" if ball == YELLOW + k else f"on the {NAMES[YELLOW + k]} spot"
    along = next(words for limit, words in _ALONG if y <= limit)
    side = f"{'far ' if abs(x) > 0.5 else ''}{'right' if x > 0 else 'left'}"
    across = "on the centre line" if abs(x) < 0.03 else side
    gaps = {
        "left cushion": x + HALF_WIDTH,
        "right cushion": HALF_WIDTH - x,
        "baulk cushion": y + HALF_LENGTH,
        "top cushion": HALF_LENGTH - y,
    }
    near, gap = min(gaps.items(), key=lambda item: item[1])
    gap -= BALL_RADIUS
    if gap >= 0.12:
        return f"{along}, {across}"
    return f"{along}, {across}, {f'{100 * gap:.0f} cm from' if gap >= 0.003 else 'tight on'} the {near}"


def table_text(places: dict[int, tuple[float, float]], on: int, lines: list[Line], facts: list[str]) -> str:
    """The whole description; ``places``: of the balls, ``on``: mask of those that may be struck first."""
    axes = "x to the right, y to the black end, metres from the middle of the table"
    text = [*facts, "", f"Balls ({axes}; * may be struck first):"]
    for ball, (x, y) in places.items():
        racked = 0 < ball < YELLOW and hypot(x - SPOTS[ball, 0], y - SPOTS[ball, 1]) < 1e-6
        place = "in the rack" if racked else where(ball, x, y)
        text.append(f"  {'*' if on >> ball & 1 else ' '} {NAMES[ball]}: ({x:+.3f}, {y:+.3f}), {place}")
    if lines:
        text += ["", "Lines to pockets (straight lines; throw and swerve are not in them):"]
        for ball in dict.fromkeys(line.ball for line in lines):
            mine = [line for line in lines if line.ball == ball]
            # the widest first; if none is open, the one that nearly is
            shown = sorted((line for line in mine if line.open), key=lambda line: -line.tolerance)
            shown = shown or [min(mine, key=lambda line: (len(line.blocked_by) or 9, line.cut))]
            text += [f"  {NAMES[ball]}, {line.words}" for line in shown]
    return "\n".join(text)


def freedom(places: dict[int, tuple[float, float]]) -> list[str]:
    """The surroundings of the cue ball: touching balls, and the nearest ball."""
    if CUE not in places:
        return []
    (x, y), text = places[CUE], []
    far = {ball: hypot(px - x, py - y) - 2.0 * BALL_RADIUS for ball, (px, py) in places.items()}
    near = sorted((gap, ball) for ball, gap in far.items() if ball != CUE)
    touching = [NAMES[ball] for gap, ball in near if gap < 1e-6]
    if touching:
        text.append("Touching ball: " + ", ".join(touching) + ".")
    elif near and near[0][0] < 0.2:
        gap, ball = near[0]
        text.append(f"The ball nearest to the cue ball is {NAMES[ball]}, {100 * gap:.1f} cm away.")
    return [*text, f"The cue ball lies {where(CUE, x, y)}."]
