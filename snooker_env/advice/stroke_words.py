"""How is a stroke described in words? Seen from the baulk end: right is the yellow side (+x)."""

from bisect import bisect_left
from math import copysign, cos, degrees, hypot, sin, sqrt

from ..game.balls import REFEREE_TOUCH
from ..geometry import BALL_RADIUS, BAULK_Y, HALF_LENGTH, HALF_WIDTH
from ..physics.parameters import Physics
from ..players.cue_stroke import CueStroke
from ..replays.referee_words import ball_name
from .practice import Room

POCKET_WORDS = ("green pocket", "yellow pocket", "right middle", "top right", "top left", "left middle")
"""Names of ``snooker_env.POCKETS`` in words: baulk corners by the colour beside them, black's "top"."""
_STILL = 0.1  # tip offsets over R up to this count as the middle of the ball
_FAR_OFF = 0.3  # from this offset on: "deep" screw, and "top" instead of follow
_STUN = 0.25  # A ball whose rotation is within this share of its speed arrives without spin
_SIDE = 0.05  # tip offsets over R from which side is mentioned
_FULLNESS = (0.38, 0.62, 0.87)  # offsets over the diameter up to which a hit is three-quarter, half, quarter
RAISED = 0.05  # elevation [rad] from which a raised cue is mentioned
TIGHT = 0.05  # largest gap [m] to a ball that the cue ball lies tight behind
NEARLY = 0.002  # gap [m] below which the tip is still on the cue ball when it meets a ball (docs/physics/limits.md)
RISKY = 0.2  # share of fouls from which a stroke of a frame is said to foul
AT_CUSHION = 0.15  # largest gap [m] to the cushion at an end that the cue ball is played to


def rolling(speed: float, top: float, distance: float, physics: Physics) -> float:
    """R w / v of a struck ball after a distance [m]: 1 for rolling, 0 for stun, < 0 for backspin."""
    # It slides until it rolls: v falls by mu_s g t, and R w, at first 5/2 v times the tip's height, grows by
    # 5/2 mu_s g t.
    brake = physics.mu_s * physics.g
    v, roll = speed, 2.5 * top * speed
    way = 1.0 if roll < v else -1.0  # too much top: the rotation falls, the ball gains speed
    t, inside = abs(v - roll) / (3.5 * brake), v * v - way * 2.0 * brake * distance
    if inside > 0.0:  # else it rolls before it arrives
        t = min(t, way * (v - sqrt(inside)) / brake)
    return (roll + way * 2.5 * brake * t) / max(v - way * brake * t, 1e-9)


def spin_words(stroke: CueStroke, distance: float | None, physics: Physics) -> str:
    """The spin of a stroke when it reaches the ball on, ``distance`` [m] away; None: nothing is struck."""
    # Below the middle: backspin is left (screw), none (stun), or it rolls already (drag). On the middle:
    # plain, or stun if it slides.
    top = stroke.top
    arrives = None if distance is None else rolling(stroke.speed, top, distance, physics)
    if top > _STILL:
        word = "top" if top > _FAR_OFF else "follow"
    elif top >= -_STILL:
        word = "plain" if arrives is None or arrives > _STUN else "stun"
    elif arrives is not None and arrives >= -_STUN:
        word = "stun" if arrives <= _STUN else "drag"
    else:
        word = "deep screw" if top < -_FAR_OFF else "screw"
    if abs(stroke.side) > _SIDE:
        word += " with right side" if stroke.side > 0 else " with left side"
    return word


def place_words(x: float, y: float) -> str:
    """The place of a cue ball in the D, relative to the brown spot."""
    across, back = round(100.0 * abs(x)), round(100.0 * (BAULK_Y - y))
    parts = [f"{across} cm {'right' if x > 0 else 'left'} of"] if across else []
    parts += [f"{back} cm behind"] if back else []
    return f"from {' and '.join(parts)} the brown spot" if parts else "from the brown spot"


def stroke_words(stroke: CueStroke, distance: float | None, physics: Physics, way: Room | None = None) -> str:
    """Speed, spin, elevation and place in words; ``way``: the room of the cue, which is said if it matters."""
    words = f"{stroke.speed:.1f} m/s, {spin_words(stroke, distance, physics)}"
    if way is not None and (way.moved or (way.raised and way.elevation >= RAISED)):
        words += f", {way.words}"
    elif stroke.elevation >= RAISED:
        words += f", cue raised {degrees(stroke.elevation):.0f} degrees"
    return words if stroke.place is None else f"{words}, {place_words(*stroke.place)}"


def lie_words(x: float, y: float, ball: int, apart: float) -> str:
    """Where a cue ball lies: behind a ``ball`` (-1: none) ``apart`` [m] away, in baulk, at an end; "" elsewhere."""
    if ball >= 0:
        return f"{'tight ' if apart - 2.0 * BALL_RADIUS <= TIGHT else ''}behind the {ball_name(ball)}"
    if HALF_LENGTH - BALL_RADIUS - abs(y) <= AT_CUSHION:
        return f"to the {'top' if y > 0 else 'baulk'} cushion"
    return "to baulk" if y < BAULK_Y else ""


def cushion_words(x: float, y: float, aim: float) -> str:
    """The cushion that a ball at (x, y) meets in the direction ``aim`` [rad]; "top" is the black end."""
    dx, dy = cos(aim), sin(aim)
    to_side = (HALF_WIDTH - x * copysign(1.0, dx)) / max(abs(dx), 1e-9)
    to_end = (HALF_LENGTH - y * copysign(1.0, dy)) / max(abs(dy), 1e-9)
    if to_side < to_end:
        return "right cushion" if dx > 0 else "left cushion"
    return "top cushion" if dy > 0 else "baulk cushion"


def contact_words(x: float, y: float, aim: float) -> str:
    """How full a ball at the offset (x, y) is struck by a cue ball running straight along ``aim`` [rad]."""
    aside = (y * cos(aim) - x * sin(aim)) / (2.0 * BALL_RADIUS)
    if abs(aside) <= 0.12:
        return "full"
    words = ("three-quarter ball", "half-ball", "quarter-ball", "thin")[bisect_left(_FULLNESS, abs(aside))]
    return f"{words} on the {'right' if aside > 0 else 'left'}"


def push_words(x: float, y: float, aim: float, ball: int) -> str:
    """What a referee would call a hit of a ``ball`` nearly touching at the offset (x, y), but for a fine edge; "" of others."""
    gap, far = hypot(x, y) - 2.0 * BALL_RADIUS, x * cos(aim) + y * sin(aim)
    fine = abs(y * cos(aim) - x * sin(aim)) > _FULLNESS[-1] * 2.0 * BALL_RADIUS
    if not (REFEREE_TOUCH <= gap < NEARLY) or far <= 0.0 or fine:
        return ""
    return f"at a real table a push stroke, a foul: the {ball_name(ball)} is {1000.0 * gap:.1f} mm away"


def snookers_words(needs: bool, behind: int, left: int) -> str:
    """That the striker needs snookers, and what a pot leaves then: ``behind`` by more than is ``left``; 0: no such pot."""
    leaves = f"{behind} behind with {left} left" if behind else ""
    if needs:
        return f"needs snookers, then {leaves}" if behind else "needs snookers"
    return f"then needs snookers: {leaves}" if behind else ""


def what_words(kind: str, ball: int, pocket: int, first: int, how: str = "") -> str:
    """What a stroke does; ``how``: an escape's cushion, how full a ball is struck, "" away from a touching one."""
    if kind == "pot":
        how = " by a plant" if first <= 15 and ball <= 15 else f" off the {ball_name(first)}"
        return f"{ball_name(ball)}{'' if ball == first else how}, {POCKET_WORDS[pocket]}"
    if kind == "in-off":
        return f"in-off from the {ball_name(first)}" if first >= 0 else "in-off, nothing struck"
    if kind == "foul":
        return f"foul, {ball_name(first)} first" if first >= 0 else "foul, nothing struck"
    if kind == "escape":
        return f"escape{f' off the {how}' if how else ''} to the {ball_name(ball)}"
    if not how:
        return f"{'safety ' if kind == 'safety' else ''}away from the touching {ball_name(ball)}"
    return f"{'safety off' if kind == 'safety' else 'contact with'} the {ball_name(ball)}, {how}"


def percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"


def points_words(points: float) -> str:
    """Points, with a digit after the point where they are few."""
    shown = f"{points:.0f}" if points >= 9.5 else f"{points:.1f}".removesuffix(".0")
    return f"{shown} point{'' if shown == '1' else 's'}"


def figures_words(kind: str, chance: float, points: float, foul: float | None = None) -> str:
    """A pot's chance and points, else how often a stroke is fair; ``foul``: in a frame, the share of fouls."""
    risk = f"fouls in {percent(foul)}" if foul is not None and foul > RISKY else ""
    if kind == "pot":
        return f"pot {percent(chance)}{risk and f', {risk}'}, {points_words(points)} expected"
    if risk:
        return risk
    unjudged = kind in ("contact", "escape") and foul is None
    no_pot = "; no pot intended, its worth as a safety is not judged" if unjudged else ""
    return f"fair {percent(chance)}{no_pot}"


def reply_words(kind: str, replies: float | None, leaves: float | None, snookers: float | None) -> str:
    """What the opponent finds where a stroke brings it to the table: "" where it never did."""
    if replies is None or leaves is None:
        return ""
    if kind == "pot":
        return f"leaves the opponent {points_words(leaves)} if missed"
    hidden = f", snookered in {percent(snookers)}" if snookers is not None and snookers >= 0.01 else ""
    return f"the opponent pots next in {percent(replies)}, leaves the opponent {points_words(leaves)}{hidden}"
