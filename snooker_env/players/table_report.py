"""What is on the table, and what may be done? As JSON types and in words, for programs and the page (docs/play/protocol.md)."""

from dataclasses import asdict, dataclass
from math import acos, atan2, degrees, hypot, radians
from typing import Any

import numpy as np

from .._lib.types import NoiseName
from ..game.balls import CUE, NAMES, SPOTS, YELLOW, BallOn, ids_of, mask_of_present
from ..game.frame import Frame
from ..game.snookered import is_snookered
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS, POCKETS
from ..physics.table import Table
from ..planning.positions import Positions
from ..planning.pot_geometry import obstructions, pots
from ..tasks.noise import LEVELS
from ..tasks.pot_chance import chance_at

MOST = 126  # largest number of lines: from 21 balls to 6 pockets


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
        names = {"ball": NAMES[self.ball], "pocket": POCKETS[self.pocket]}
        return asdict(self) | names | {"blocked_by": list(self.blocked_by)}

    @property
    def words(self) -> str:
        way = f"{POCKETS[self.pocket]}: "
        if not self.open:
            return way + (", ".join(self.blocked_by) + " in the way" if self.blocked_by else self.why)
        cut = "straight" if self.cut < radians(1.0) else f"cut {degrees(self.cut):.0f} deg"
        likely = "" if self.chance is None else f", chance {100 * self.chance:.0f} %"
        far = f"cue ball {self.to_ball:.2f} m, ball {self.to_pocket:.2f} m, aim {self.aim:.4f} rad"
        return f"{way}open, {cut}, {far}, may err {degrees(self.tolerance):.2f} deg{likely}"


def find_lines(positions: list[Positions], on: int, noise: str) -> list[Line]:
    """Lines to pockets for the balls ``on``; ``positions``: the table, with a free ball also for colours."""
    errors = LEVELS[noise]
    spread = None if errors.silent else errors.spread()
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
    skip = np.column_stack([np.full(len(ways), CUE), balls])
    barred = obstructions(at, rows, places[balls], aims.copy(), skip)
    barred |= obstructions(at, rows, np.broadcast_to(places[CUE], ghosts.shape).copy(), ghosts, skip)
    lines = []
    for way, ghost, aim, others in zip(ways, ghosts, aims, barred, strict=True):
        run, onward = ghost - places[CUE], aim - places[way[0]]
        far, on_far = hypot(*run), hypot(*onward)
        cos_cut = float(run @ onward / max(far * on_far, 1e-12))
        cut, tolerance = acos(min(1.0, max(-1.0, cos_cut))), tolerances.get(way, 0.0)
        blocked = () if tolerance else tuple(NAMES[i] for i in np.flatnonzero(others))
        why = "cut too thin" if cos_cut <= 0.05 else "pocket too narrow from there"
        chance = None
        if spread is not None and tolerance:
            chance = chance_at(tolerance, far + on_far, spread)
        seen = tolerance > 0.0, blocked, "" if tolerance or blocked else why
        lines.append(Line(*way, *seen, cut, far, on_far, atan2(run[1], run[0]), tolerance, chance))
    return lines


_ALONG = (
    (BAULK_Y, "in baulk"),
    (-0.35, "between baulk and the middle"),
    (0.35, "about the middle of the table"),
    (COLOUR_SPOTS[4, 1], "between the middle and the pink spot"),
    (COLOUR_SPOTS[5, 1], "between the pink and the black spot"),
    (np.inf, "behind the black spot"),
)


def _say_turn(frame: Frame, labels: tuple[str, str]) -> str:
    """What the rules ask for next, in a sentence; ``labels``: the names of both players."""
    who = labels[frame.striker]
    yours = "Your stroke" if who == "You" else f"{who}'s stroke"
    if frame.winner is not None:
        return f"Frame over: {labels[frame.winner]} won."
    if frame.phase == "choice":
        miss = " and a miss" if frame.miss_called else ""
        return f"Foul{miss} by {labels[1 - frame.striker]}: {'choose' if who == 'You' else f'{who} chooses'}."
    on, free = frame.ball_on.name.lower().replace("_", " "), ", and a free ball are"
    placing = "; the cue ball is in hand" if frame.in_hand else ""
    return f"{yours}: {on}{free if frame.free_ball else ' is'} on{placing}."


def where(ball: int, x: float, y: float) -> str:
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


def visit_of(frame: Frame, at: Positions, *, free_ball: bool = False) -> Positions:
    """The one position ``at`` of a frame as one of a visit; with ``free_ball`` every colour is on instead."""
    on = BallOn.ANY_COLOUR if free_ball else frame.ball_on
    game = [[int(on), int(frame.in_hand), frame.break_points, 0, 0]]
    return Positions(at.positions, at.on_table, game, None, at.conditions)


def nominations_of(frame: Frame) -> tuple[int, ...]:
    """The colours that the striker may nominate before the stroke: after a red, and as a free ball."""
    if frame.phase != "stroke":
        return ()
    if frame.ball_on == BallOn.ANY_COLOUR:
        return tuple(i for i in ids_of(frame.on_table) if i > 15)
    on = frame.ball_on + 14 if frame.ball_on > BallOn.RED else 0
    return tuple(i for i in ids_of(frame.on_table) if i > 15 and i != on) if frame.free_ball else ()


def report_game(
    frame: Frame, positions: list[list[float]], on_table: list[bool], labels: tuple[str, str]
) -> dict[str, Any]:
    """The table and the scoreboard as JSON types; ``labels``: the names of both players."""
    present, over = [ball for ball, on in enumerate(on_table) if on], frame.phase == "over"
    names = ("phase", "striker", "breaker", "free_ball", "in_hand", "anywhere", "winner")
    return {name: getattr(frame, name) for name in names} | {
        "scores": list(frame.scores),
        "break": frame.break_points,
        "ball_on": None if over else frame.ball_on.name.lower(),
        "reds": sum(0 < ball < YELLOW for ball in present),
        "available": 0 if over else frame.available,
        "time_left": (clock - frame.clock) / 1000 if (clock := frame.rule_set.clock) else None,
        "positions": {NAMES[ball]: list(positions[ball]) for ball in present},
        "words": _say_turn(frame, labels),
    }


def report_turn(
    frame: Frame, at: Positions, table: Table, noise: NoiseName
) -> tuple[dict[str, Any], list[Line]]:
    """What the striker may do in the one position ``at``, as JSON types, and the lines to pockets under the ``noise``."""
    hidden, lines, on = False, [], 0
    if frame.phase == "stroke":
        both = [visit_of(frame, at, free_ball=free) for free in (False, True)[: 1 + frame.free_ball]]
        on = mask_of_present(np.any([one.balls_on[0] for one in both], axis=0))
        present = at.on_table[0].copy()
        present[CUE] = not frame.in_hand
        hidden = is_snookered(at.positions[0], present, on, jaws=table.jaws[:, :3])[0]
        lines = find_lines(both, on, noise)
    return {
        "balls_on": [NAMES[i] for i in ids_of(on)],
        "snookered": hidden,
        "miss_called": frame.miss_called,
        "choices": list(frame.choices),
        "nominations": [NAMES[i] for i in nominations_of(frame)],
        "needs_snookers": frame.phase != "over" and frame.needs_snookers(frame.striker),
        "lines": [line.to_dict() for line in lines],
    }, lines


def say_score(state: dict[str, Any], labels: tuple[str, str]) -> str:
    (one, other), (mine, others) = labels, state["scores"]
    return f"Score: {one} {mine}, {other} {others}; break {state['break']}."


def say_table(state: dict[str, Any], lines: list[Line], said: list[str]) -> str:
    """The whole table in words, of ``report_game`` and ``report_turn``, after the sentences ``said``."""
    axes = "x to the right, y to the black end, metres from the middle of the table"
    text = [*said, *_facts(state), "", f"Balls ({axes}; * may be struck first):"]
    for name, (x, y) in state["positions"].items():
        ball = NAMES.index(name)
        racked = 0 < ball < YELLOW and hypot(x - SPOTS[ball, 0], y - SPOTS[ball, 1]) < 1e-6
        place = "in the rack" if racked else where(ball, x, y)
        text.append(f"  {'*' if name in state['balls_on'] else ' '} {name}: ({x:+.3f}, {y:+.3f}), {place}")
    if lines:
        text += ["", "Lines to pockets (straight lines; throw and swerve are not in them):"]
        for ball in dict.fromkeys(line.ball for line in lines):
            mine = [line for line in lines if line.ball == ball]
            # the widest first; if none is open, the one that nearly is
            shown = sorted((line for line in mine if line.open), key=lambda line: -line.tolerance)
            shown = shown or [min(mine, key=lambda line: (len(line.blocked_by) or 9, line.cut))]
            text += [f"  {NAMES[ball]}, {line.words}" for line in shown]
    return "\n".join(text)


def _facts(state: dict[str, Any]) -> list[str]:
    if state["phase"] == "over":
        return []
    reds, left = state["reds"], f"{state['available']} points are left on the table"
    facts = [f"{left}, {reds} red{'' if reds == 1 else 's'} among the balls."]
    if state["needs_snookers"]:
        facts.append("The striker needs penalty points to win.")
    if state["phase"] == "choice":
        return [*facts, "Choices: " + ", ".join(state["choices"]) + "."]
    if state["nominations"]:
        colours = ", ".join(state["nominations"])
        facts.append(f"May be nominated: {colours}; without a nomination it is the colour first struck.")
    if state["in_hand"]:
        where = "x^2 + (y + 1.0475)^2 <= 0.292^2 and y <= -1.0475"
        facts.append(f"The cue ball may be placed anywhere in the D ({where}).")
    if state["snookered"]:
        facts.append("The cue ball is snookered: no ball on can be struck at both edges in a straight line.")
    return facts + _surroundings({NAMES.index(name): at for name, at in state["positions"].items()})


def _surroundings(places: dict[int, Any]) -> list[str]:
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
