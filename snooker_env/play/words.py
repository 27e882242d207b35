"""How is the game described without a picture? In plain words, with the straight lines to each pocket."""

from dataclasses import asdict, dataclass
from math import acos, atan2, degrees, hypot, radians
from typing import Any

import numpy as np

from ..game.balls import CUE, NAMES, SPOTS, YELLOW, ids_of, mask_of_present
from ..game.frame import Frame
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS, POCKETS
from ..planning.geometry import obstructions, pots
from ..planning.positions import Positions
from ..planning.pot_chance import pot_chances
from ..replays.words import on_words, sentence
from ..tasks.noise import LEVELS
from .session import Act

MOST = 126  # largest number of lines: from 21 balls to 6 pockets
STEEP = radians(5.0)  # elevation above which a raised cue is worth saying


@dataclass(frozen=True)
class Line:
    """A straight line from the cue ball through a ball to a pocket; lengths in metres, angles in radians."""

    ball: int
    pocket: int
    open: bool  # whether the ball can be potted straight, by the geometry of straight lines
    blocked_by: tuple[str, ...]  # names of the balls in the way of the ball, or of the cue ball to it
    why: str  # any other reason why it is not open: "cut too thin", "pocket too narrow from there"; else ""
    cut: float  # angle between the paths of the cue ball and of the ball
    to_ball: float
    to_pocket: float  # distances of the cue ball to the contact, and of the ball to the pocket
    aim: float  # direction of the cue ball's path, without throw and swerve
    tolerance: float  # largest error of the aim; 0 unless the line is open
    chance: float | None  # about how likely the seat's noise keeps within the tolerance; None without noise

    def to_dict(self) -> dict[str, Any]:
        """The line as JSON types."""
        names = {"ball": NAMES[self.ball], "pocket": POCKETS[self.pocket]}
        return asdict(self) | names | {"blocked_by": list(self.blocked_by)}

    @property
    def words(self) -> str:
        """The line in words, without the ball's name."""
        way = f"{POCKETS[self.pocket]}: "
        if not self.open:
            return way + (", ".join(self.blocked_by) + " in the way" if self.blocked_by else self.why)
        cut = "straight" if self.cut < radians(1.0) else f"cut {degrees(self.cut):.0f} deg"
        likely = "" if self.chance is None else f", chance {100 * self.chance:.0f} %"
        far = f"cue ball {self.to_ball:.2f} m, ball {self.to_pocket:.2f} m, aim {self.aim:.4f} rad"
        return f"{way}open, {cut}, {far}, may err {degrees(self.tolerance):.2f} deg{likely}"


def lines_of(positions: list[Positions], on: int, noise: str) -> list[Line]:
    """Lines to pockets for the balls ``on``; ``positions``: the table, with a free ball also for colours."""
    errors = LEVELS[noise]
    sigma = 0.0 if errors.silent else radians(errors.direction_deg())
    tolerances = {}
    for position in positions:
        some = pots(position, most=MOST)
        columns = (each[0].tolist() for each in (some.ball, some.pocket, some.tolerance))
        for ball, pocket, tolerance in zip(*columns, strict=True):
            if ball >= 0:
                tolerances[ball, pocket] = tolerance
    at = positions[0]
    places, ids = at.positions[0], ids_of(on & mask_of_present(at.on_table[0]))
    ways = [(ball, pocket) for ball in ids for pocket in range(len(POCKETS))]
    if not ways:
        return []
    balls, pockets = (np.array(column) for column in zip(*ways, strict=True))
    aims = POCKET_AIMS[pockets, :2]
    onward = aims - places[balls]
    unit = onward / np.maximum(np.hypot(*onward.T), 1e-12)[:, None]
    ghosts = places[balls] - 2.0 * BALL_RADIUS * unit
    rows = np.zeros(len(ways), np.int64)
    skip: Any = np.column_stack([np.full(len(ways), CUE), balls])
    barred = obstructions(at, rows, places[balls], aims, ignore=skip)
    barred |= obstructions(at, rows, np.broadcast_to(places[CUE], ghosts.shape).copy(), ghosts, ignore=skip)
    each = zip(ways, ghosts, aims, barred, strict=True)
    return [_line(*one, places, tolerances, sigma) for one in each]


def _line(which, ghost, aim, barred, places, tolerances, sigma):
    ball, pocket = which
    run, way = ghost - places[CUE], aim - places[ball]
    far, on = hypot(*run), hypot(*way)
    cos_cut = float(run @ way / max(far * on, 1e-12))
    cut = acos(min(1.0, max(-1.0, cos_cut)))
    tolerance = tolerances.get((ball, pocket), 0.0)
    blocked = () if tolerance else tuple(NAMES[i] for i in np.flatnonzero(barred))
    why = "cut too thin" if cos_cut <= 0.05 else "pocket too narrow from there"
    why = "" if tolerance or blocked else why
    chance = None
    if sigma and tolerance:
        chance = float(pot_chances(np.array([tolerance]), np.array([far + on]), sigma)[0])
    aim = atan2(run[1], run[0])
    return Line(ball, pocket, tolerance > 0.0, blocked, why, cut, far, on, aim, tolerance, chance)


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


_DECIDED = {
    "play": "played on",
    "play_again": "asked for another stroke from there",
    "replace": "had the balls put back",
    "anywhere": "took the cue ball in hand",
}


def last_words(act: Act, labels: tuple[str, str], before: Act | None = None) -> str:
    """An act in a sentence; ``before``: the act before it, whose foul a choice answers."""
    who = "" if act.player is None else labels[act.player]
    if act.what == "choice":
        said = f"{who} {_DECIDED[act.detail]}."
        return said if before is None or before.played is None else f"{last_words(before, labels)} {said}"
    if act.played is not None:
        nominated = f" ({act.detail} nominated)" if act.detail else ""
        said = f"{who}{nominated}: {sentence(act.played, labels)}"
        if act.room is None or not (act.room.moved or act.room.elevation > STEEP) or not act.room.words:
            return said
        return f"{said} {act.room.words[:1].upper()}{act.room.words[1:]}."
    return {
        "concede": f"{who} conceded the frame.",
        "claim": f"{who} claimed the frame.",
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
