"""How is a stroke said? Balls, pockets, spin and chances in the words of the game: "blue, right middle, 1.8 m/s, screw, chance 87 %".

Left and right are as seen from baulk, looking to the black end: right is the yellow side (+x), left the green side.
"""

from math import degrees, sqrt

from ..game.balls import NAMES
from ..geometry import BAULK_Y
from ..physics.parameters import Physics
from .strokes import CueStroke

POCKET_WORDS = ("green pocket", "yellow pocket", "right middle", "top right", "top left", "left middle")
"""What each of ``snooker_env.POCKETS`` is called: the corners at the baulk end by the colours beside them, those at the black end "top"."""
_STILL = 0.1
"""A tip offset over R up to this is the middle of the ball."""
_FAR_OFF = 0.3
"""From this offset on: "deep" screw, and "top" in place of follow."""
_STUN = 0.25
"""A ball whose roll is within so much of its speed, over it, arrives as if without spin."""
_SIDE = 0.05


def ball_words(ball: int) -> str:
    """The colour of a ball.

    Examples
    --------
    >>> from snooker_env.advice.words import ball_words
    >>> ball_words(7), ball_words(19)
    ('red', 'blue')
    """
    return "red" if 1 <= ball <= 15 else NAMES[ball].replace("_", " ")


def rolling(speed: float, top: float, distance: float, physics: Physics) -> float:
    """How much a struck ball rolls when it has run that far [m]: surface speed of its roll over its speed; 1 rolls, 0 is stun, < 0 screw.

    It slides until it rolls: the speed v falls by mu_s g t, the roll R w, 5/2 v times the tip's height at first, grows by 5/2 mu_s g t.
    """
    brake = physics.mu_s * physics.g
    v, roll = speed, 2.5 * top * speed
    way = 1.0 if roll < v else -1.0  # too much top: the roll falls, the ball gains speed
    slip = abs(v - roll)
    until = slip / (3.5 * brake)
    t = until
    if way > 0.0:
        inside = v * v - 2.0 * brake * distance
        t = min(until, (v - sqrt(inside)) / brake) if inside > 0.0 else until
    else:
        t = min(until, (sqrt(v * v + 2.0 * brake * distance) - v) / brake)
    return (roll + way * 2.5 * brake * t) / max(v - way * brake * t, 1e-9)


def spin_words(stroke: CueStroke, distance: float | None, physics: Physics) -> str:
    """The spin of a stroke: "deep screw", "screw", "drag", "stun", "plain", "follow" or "top", with "left side" or "right side".

    Below the middle it depends on what is left of the backspin when the ball on is reached, ``distance`` [m] away: screw, none (stun), or
    the ball rolls already (drag). A blow on the middle is plain, or stun where the ball still slides. None: nothing is struck.
    """
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
    """Where in the D a cue ball lies, from the middle of the baulk line.

    Examples
    --------
    >>> from snooker_env.advice.words import place_words
    >>> place_words(-0.12, -1.0475)
    'from 12 cm left of the brown spot'
    """
    across, back = round(100.0 * abs(x)), round(100.0 * (BAULK_Y - y))
    parts = [f"{across} cm {'right' if x > 0 else 'left'} of"] if across else []
    parts += [f"{back} cm behind"] if back else []
    return f"from {' and '.join(parts)} the brown spot" if parts else "from the brown spot"


def stroke_words(stroke: CueStroke, distance: float | None, physics: Physics) -> str:
    """Speed, spin, raised cue and place."""
    words = f"{stroke.speed:.1f} m/s, {spin_words(stroke, distance, physics)}"
    if stroke.elevation > 0.05:
        words += f", cue raised {degrees(stroke.elevation):.0f} degrees"
    return words if stroke.place is None else f"{words}, {place_words(*stroke.place)}"


def what_words(kind: str, ball: int, pocket: int, first: int) -> str:
    """What a stroke does when it comes out as intended.

    Examples
    --------
    >>> from snooker_env.advice.words import what_words
    >>> what_words("pot", 19, 2, 19), what_words("pot", 2, 5, 1), what_words("safety", 3, -1, 3)
    ('blue, right middle', 'red by a plant, left middle', 'safety off the red')
    """
    if kind == "pot":
        how = "" if ball == first else " by a plant" if first <= 15 and ball <= 15 else f" off the {ball_words(first)}"
        return f"{ball_words(ball)}{how}, {POCKET_WORDS[pocket]}"
    if kind == "foul":
        return "foul, nothing struck" if first < 0 else f"foul off the {ball_words(first)}"
    return f"{kind} {'off' if kind == 'safety' else 'to'} the {ball_words(ball)}"


def figures_words(kind: str, chance: float, points: float) -> str:
    """Chance and points expected."""
    share = f"{'chance' if kind == 'pot' else 'fair'} {100.0 * chance:.0f} %"
    scored = f"{points:.0f}" if points >= 9.5 or points == round(points) else f"{points:.1f}"
    return f"{share}, {scored} point{'' if scored == '1' else 's'} expected"
