"""A window with a table. Its last line says what it waits for and which ``KEYS`` it reads."""

import os
import sys
from typing import TYPE_CHECKING

from .._lib.check import number
from .palette import PALETTE
from .pygame_balls import BOLD, MEDIUM, pygame_, typeset
from .pygame_view import draw
from .scene import Film, Scene
from .table_picture import SIZE, Size, View, check_size

if TYPE_CHECKING:
    from pygame import Surface

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)  # that the user can choose, in multiples of the caller's
KEYS = "space: pause    right: step    enter: skip    up/down: speed    esc: close"
WAITING = "waiting for the next stroke"
_HINT = 0.026  # part of the window's height for the line with its status
_INVISIBLE = ("dummy", "offscreen")  # drivers of SDL


def display_missing() -> bool:
    """Whether nobody could see a window. ``SDL_VIDEODRIVER=dummy`` allows one without a screen, for tests."""
    linux = not (sys.platform.startswith("win") or sys.platform == "darwin")
    return linux and not any(map(os.environ.get, ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY")))


def require_display() -> None:
    """Raise RuntimeError if nobody could see a window; the message says what to do."""
    if display_missing():
        raise _no_display("neither DISPLAY nor WAYLAND_DISPLAY is set")


def _no_display(why):
    return RuntimeError(
        f'a window (render_mode="human") needs a display, and there is none ({why}): use render_mode="rgb_array" for'
        ' pictures or "ansi" for text, or set SDL_VIDEODRIVER=dummy for a window that nobody sees'
    )


class Window:
    """A window with a table. The first ``draw`` opens it. A window that its user closed stays shut until ``close``."""

    def __init__(self, *, size: Size | None = None):
        self._size = None if size is None else check_size(size)
        self._screen: Surface | None = None
        self.speed: float = 1.0  # as the user has chosen; in multiples of that of ``play``
        self.paused: bool = False
        self._shut, self._steps, self._skip, self._hint = False, 0, False, 0

    @property
    def is_open(self) -> bool:
        """False before the first ``draw`` and after the window was closed."""
        return self._screen is not None

    def draw(self, scene: Scene, status: str = WAITING) -> bool:
        """Show a scene and the status; False if the user has closed the window, which then shows nothing."""
        if self._screen is not None:
            self._listen()
        if self._shut:
            return False
        if self._screen is None:
            self._open()
        self._show(scene, status)
        return True

    def play(self, film: Film, fps: float = 30.0, *, speed: float = 1.0) -> bool:
        """Show a film in real time; False if the user has closed the window."""
        fps, clock = number("fps", fps, 0.0, open_low=True), pygame_().time.Clock()
        step = number("speed", speed, 0.0, open_low=True) / fps
        self._skip, time = False, film.begin
        while self.draw(film.at(time), "paused" if self.paused else f"playing {self.speed:g}x"):
            stands = self.paused and not self._steps and not self._skip
            if time >= film.duration and not stands:
                return True
            if self._skip:
                time = film.duration
            elif not stands:
                self._steps = max(0, self._steps - 1)
                time += step * (min(self.speed, 1.0) if self.paused else self.speed)
            time = min(time, film.duration)
            clock.tick(fps)
        return False

    def close(self) -> None:
        """Close the window if it is open. A later ``draw`` opens it again."""
        self._shut = self.paused = False
        if self._screen is not None:
            self._screen = None
            pygame_().display.quit()

    def _open(self):
        pygame = pygame_()
        require_display()
        try:
            pygame.display.init()
            driver = pygame.display.get_driver()
            if driver in _INVISIBLE and not os.environ.get("SDL_VIDEODRIVER"):
                raise pygame.error(f"SDL found only its driver {driver!r}")
            pygame.display.set_caption("snooker")
            width, height = self._size or SIZE
            if self._size is None:
                desk_width, desk_height = pygame.display.get_desktop_sizes()[0]
                part = min(1.0, 0.92 * desk_width / SIZE[0], 0.88 * desk_height / SIZE[1])
                width, height = round(part * width), round(part * height)
            self._hint = max(14, round(_HINT * height))
            self._screen = pygame.display.set_mode((width, height + self._hint), pygame.RESIZABLE)
        except pygame.error as error:
            pygame.display.quit()
            raise _no_display(error) from None

    def _listen(self):
        pygame = pygame_()
        for event in pygame.event.get():
            key = event.key if event.type == pygame.KEYDOWN else None
            if event.type == pygame.QUIT or key == pygame.K_ESCAPE:
                self.close()
                self._shut = True
                return
            if key == pygame.K_SPACE:
                self.paused, self._steps = not self.paused, 0
            elif key == pygame.K_RIGHT and self.paused:
                self._steps += 1
            elif key in (pygame.K_RETURN, pygame.K_KP_ENTER):
                self._skip = True
            elif key in (pygame.K_UP, pygame.K_DOWN):
                k = SPEEDS.index(self.speed) + (1 if key == pygame.K_UP else -1)
                self.speed = SPEEDS[min(max(k, 0), len(SPEEDS) - 1)]

    def _show(self, scene, status):
        pygame, hint = pygame_(), self._hint
        screen = self._screen = pygame.display.get_surface()  # a new one after the window was resized
        width, height = screen.get_size()
        pixels = draw(scene, View.of(scene.table, size=(max(width, 100), max(height - hint, 100))))
        screen.fill(PALETTE["floor"])
        screen.blit(pygame.image.frombuffer(pixels, pixels.shape[1::-1], "RGB"), (0, 0))
        words = typeset(status, PALETTE["text"], 0.62 * hint, BOLD)
        screen.blit(words, words.get_rect(midleft=(hint, height - hint / 2)))
        keys = typeset(KEYS, PALETTE["text_quiet"], 0.58 * hint, MEDIUM)
        if words.get_width() + keys.get_width() < width - 4 * hint:
            screen.blit(keys, keys.get_rect(midright=(width - hint, height - hint / 2)))
        pygame.display.flip()
