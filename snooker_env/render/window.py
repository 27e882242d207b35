"""A window with a table. Its user closes it by its button or the escape key."""

import os
import sys
from typing import TYPE_CHECKING

from .pygame_view import draw, pygame_
from .scene import Film, Scene
from .table_picture import SIZE, Size, View, check_size

if TYPE_CHECKING:
    from pygame import Surface

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
        self._shut = False

    @property
    def is_open(self) -> bool:
        """False before the first ``draw`` and after the window was closed."""
        return self._screen is not None

    def draw(self, scene: Scene) -> bool:
        """Show a scene; False if the user has closed the window, which then shows nothing."""
        if self._screen is not None:
            self._listen()
        if self._shut:
            return False
        if self._screen is None:
            self._open()
        screen = self._screen = pygame_().display.get_surface()  # a new one after the window was resized
        width, height = screen.get_size()
        pixels = draw(scene, View.of(scene.table, size=(max(width, 100), max(height, 100))))
        screen.blit(pygame_().image.frombuffer(pixels, pixels.shape[1::-1], "RGB"), (0, 0))
        pygame_().display.flip()
        return True

    def play(self, film: Film, fps: float = 30.0, *, speed: float = 1.0) -> bool:
        """Show a film in real time; False if the user has closed the window."""
        clock = pygame_().time.Clock()
        for scene in film.scenes(fps, speed):
            if not self.draw(scene):
                return False
            clock.tick(fps)
        return True

    def close(self) -> None:
        """Close the window if it is open. A later ``draw`` opens it again."""
        self._shut = False
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
            wide, high = pygame.display.get_desktop_sizes()[0]
            part = min(1.0, 0.92 * wide / SIZE[0], 0.88 * high / SIZE[1])
            size = self._size or (round(part * SIZE[0]), round(part * SIZE[1]))
            self._screen = pygame.display.set_mode(size, pygame.RESIZABLE)
        except pygame.error as error:
            pygame.display.quit()
            raise _no_display(error) from None

    def _listen(self):
        pygame = pygame_()
        for event in pygame.event.get():
            if event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE):
                self.close()
                self._shut = True
                return
