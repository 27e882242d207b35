"""How does pygame-ce draw a scene, without a display? The cached picture of the table, the balls and lines on it, and
a score bar as on television."""

from functools import lru_cache
from typing import TYPE_CHECKING

from .._lib.types import Bytes
from ..game.balls import COLOUR_NAMES, YELLOW
from .palette import PALE, PALETTE
from .pygame_balls import BOLD, MEDIUM, dot, draw_balls, draw_cue, draw_lines, line_width, pygame_, typeset
from .scene import Scene, ScoreBar
from .table_picture import SIZE as SIZE
from .table_picture import Size, table_picture
from .table_picture import View as View

if TYPE_CHECKING:
    from pygame import Surface

_ROWS = 72  # lengths in this file are those of a bar 72 pixels high, as in a picture of 1080
_SMALLEST = 36  # a lower bar is one line of text [pixels]
_EDGE = 28
_GAP = 30
_STRIP = 7  # height of the shares of the chance to win, at the upper edge


@lru_cache(maxsize=64)
def score_bar(bar: ScoreBar | None, text: str, width: int, height: int) -> "Surface":
    """The bar, or without one the text, as a surface of this size [pixels]. It is cached: do not draw on it."""
    pygame = pygame_()
    page = _Page(pygame.Surface((width, height), 0, 24), height / _ROWS)
    page.surface.fill(PALETTE["bar"])
    page.box(0, 0, width / page.unit, 2, "bar_edge")
    if bar is not None and bar.win_chance is not None:
        first = bar.win_chance * width / page.unit
        page.box(0, 0, first, _STRIP, "first")
        page.box(first, 0, width / page.unit - first, _STRIP, "other")
    if bar is None or height < _SMALLEST:
        words, size = in_words(bar) if bar is not None else text, 33 if height >= _SMALLEST else 44
        page.text(words, size, (_EDGE, 36), room=width / page.unit - 2 * _EDGE)
        return page.surface
    right = _right(page, bar, width / page.unit)
    middle = _players(page, bar, width / page.unit) if bar.players else right
    _break(page, bar, min(middle, right) - _GAP)
    return page.surface


def in_words(bar: ScoreBar) -> str:
    """The bar as one line of text: its parts, separated by " · "."""
    names = ", ".join(f"{name} {score}" for name, score in zip(bar.players, bar.scores, strict=True))
    parts = [
        names,
        f"{bar.players[bar.striker]} to play" if bar.striker is not None and len(bar.players) > 1 else "",
        "" if bar.break_points is None else f"break {bar.break_points}",
        bar.ball_on and f"{bar.ball_on} on",
        "" if bar.points_on is None else f"{bar.points_on} left",
        bar.words,
    ]
    return " · ".join(part for part in parts if part)


class _Page:
    """A surface on which lengths are those of a bar ``_ROWS`` high."""

    def __init__(self, surface, unit):
        self.surface, self.unit = surface, unit

    def box(self, x, y, width, height, ink):
        u = self.unit
        left, right = round(x * u), round((x + width) * u)
        self.surface.fill(PALETTE[ink], (left, round(y * u), right - left, max(1, round(height * u))))

    def text(self, text, size, place=None, *, ink="text", file=MEDIUM, anchor="midleft", room=None):
        """Write a line with its middle at the height of a place (x, y), if any; one that is too long ends in "…". Its width."""
        u, keep = self.unit, len(text)
        line = typeset(text, PALETTE[ink], 0.82 * size * u, file)
        while room is not None and keep > 1 and line.get_width() > room * u:
            keep = min(keep - 1, int(keep * room * u / line.get_width()) + 1)
            line = typeset(text[:keep].rstrip() + "…", PALETTE[ink], 0.82 * size * u, file)
        if place is not None:
            self.surface.blit(line, line.get_rect(**{anchor: tuple(round(part * u) for part in place)}))
        return line.get_width() / u

    def ball(self, ball, x, y, radius):
        image, u = dot(ball, radius * self.unit), self.unit
        place = (round(x * u - image.get_width() / 2), round(y * u - image.get_height() / 2))
        self.surface.blit(image, place)


def _break(page, bar, end):
    """On the left: the break, the balls potted in it, and the referee's words."""
    x = _EDGE
    if bar.break_points is not None:
        page.text("BREAK", 17, (x, 17), ink="text_quiet", file=BOLD)
        x += max(page.text(str(bar.break_points), 46, (x, 46), file=BOLD), 62) + _GAP
    room, balls = end - x, len(bar.potted)
    lines = bool(balls) + bool(bar.words)
    if balls:
        step = min(22.0, (room - 18) / max(balls - 1, 1))
        for k, ball in enumerate(bar.potted):
            page.ball(ball, x + 9 + k * step, 36 if lines == 1 else 24, 9)
    if bar.words:
        y, ink = (36, "text") if lines == 1 else (52, "text_quiet")
        page.text(bar.words, 24, (x, y), ink=ink, room=room)


def _players(page, bar, width):
    """In the middle: names and points, the striker emphasised. Returns the x where this begins."""
    middle, half = width / 2, 46
    if len(bar.players) == 1:
        name, score = bar.players[0], str(bar.scores[0])
        taken = page.text(name, 36, room=300)
        start = middle - (taken + 30 + 2 * half) / 2
        page.text(name, 36, (start, 37), room=300)
        _score(page, score, start + taken + 30 + half, half, True)
        return start
    begin = []
    for k, (name, score) in enumerate(zip(bar.players, bar.scores, strict=True)):
        side, on = (-1, 1)[k], bar.striker == k
        _score(page, str(score), middle + side * (half + 2), half, on)
        x = middle + side * (2 * half + 24)
        ink, file = "text" if on or bar.striker is None else "text_quiet", BOLD if on else MEDIUM
        taken = page.text(name, 36, (x, 37), ink=ink, file=file, anchor=("midright", "midleft")[k], room=300)
        if on:
            _turn(page, x + side * (taken + 26), -side)
        begin.append(x + side * (taken + 40))
    return begin[0]


def _score(page, score, middle, half, on):
    page.box(middle - half, 12, 2 * half, 50, "bar_accent" if on else "bar_edge")
    page.text(score, 44, (middle, 37), file=BOLD, anchor="center")


def _turn(page, x, side):
    """A triangle that points to the name of the player whose turn it is."""
    pygame, u = pygame_(), page.unit
    fine = pygame.Surface((40, 40), pygame.SRCALPHA, 32)
    corners = [(20 - 14 * side, 2), (20 - 14 * side, 38), (20 + 16 * side, 20)]
    pygame.draw.polygon(fine, PALETTE["bar_accent"], corners)
    small = pygame.transform.smoothscale(fine, (max(3, round(20 * u)), max(3, round(20 * u))))
    page.surface.blit(small, small.get_rect(center=(round(x * u), round(37 * u))))


def _right(page, bar, width):
    """On the right: the ball on, the reds and the points that are left. Returns the x where this begins."""
    x = width - _EDGE
    if bar.points_on is not None:
        x = _column(page, "POINTS LEFT", str(bar.points_on), x)
    if bar.reds_left is not None:
        x = _column(page, "REDS", str(bar.reds_left), x, (1,), widest="15")
    if bar.ball_on:
        x = _column(page, "BALL ON", bar.ball_on, x, _balls_on(bar.ball_on), size=30)
    return x


def _balls_on(ball_on):
    """The balls drawn for the ball on."""
    words = ball_on.lower().split()
    if "red" in words or "reds" in words:
        return (1,)
    return tuple(YELLOW + k for k, name in enumerate(COLOUR_NAMES) if name in words or "colour" in words)


def _column(page, label, value, end, balls=(), size=36, widest=""):
    """A value under its label, with room for ``widest`` so that nothing moves. Returns the next end."""
    step = 22 if len(balls) < 3 else 13
    taken = (step * (len(balls) - 1) + 30) if balls else 0
    wide = max(page.text(text, size, file=BOLD, room=220) for text in (value, widest))
    across = max(page.text(label, 17, file=BOLD), taken + wide)
    start = end - across
    page.text(label, 17, (start, 17), ink="text_quiet", file=BOLD)
    for k, ball in enumerate(balls):
        page.ball(ball, start + 9 + k * step, 47, 9)
    page.text(value, size, (start + taken, 46), file=BOLD, room=220)
    return start - _GAP


def draw(scene: Scene, view: View) -> Bytes:
    """The picture of a scene in a view of its table: uint8 (height, width, 3), a new array."""
    pixels = table_picture(scene.table, view).copy()
    surface = pygame_().image.frombuffer(pixels, (view.width, view.height), "RGB")  # draws into it
    surface.set_clip((0, 0, view.width, view.height - view.bar))
    lines = [(view(points), tuple(PALE[ball].tolist())) for ball, points in scene.paths.items()]
    draw_lines(surface, lines, line_width(view.scale))
    draw_balls(surface, scene, view)
    draw_cue(surface, scene, view)
    surface.set_clip(None)
    if scene.bar is not None or scene.text:
        surface.blit(score_bar(scene.bar, scene.text, view.width, view.bar), (0, view.height - view.bar))
    return pixels


def rgb_array(scene: Scene, *, size: Size = SIZE) -> Bytes:
    """The picture of a scene, uint8 (height, width, 3)."""
    pygame_()
    return draw(scene, View.of(scene.table, size))
