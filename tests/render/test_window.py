"""Does the window show what it is given, and does it refuse where nobody would see it?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import SPOTS
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import Film, scene
from snooker_env.render.window import Window, require_display


@pytest.fixture(scope="module")
def pot():
    """The cue ball from the middle of the table pots the one red in the middle right pocket."""
    return sn.simulate([(0.2, 0.0), (0.7, 0.0)], [(1.2, 0.0), (0.0, 0.0)], np.zeros((2, 3)))


@pytest.fixture
def dummy_screen(monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    assert not pygame.display.get_init()
    yield pygame
    pygame.display.quit()


def picture(pygame):
    return pygame.surfarray.array3d(pygame.display.get_surface()).transpose(1, 0, 2)


def test_window_opens_lazily_plays_and_closes(dummy_screen, pot):
    window = Window(size=(518, 300))
    assert not window.is_open and not dummy_screen.display.get_init()
    window.close()
    film = Film("match", pot)
    assert window.play(film, fps=1000, speed=100) and window.is_open
    assert np.array_equal(picture(dummy_screen), rgb_array(film.at(film.duration), size=(518, 300)))
    window.close()
    window.close()
    assert not window.is_open and not dummy_screen.display.get_init()
    assert window.draw(film.at(0.0)) and window.is_open
    window.close()


def test_without_a_display_it_refuses(monkeypatch):
    pytest.importorskip("pygame")
    for name in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    window = Window(size=(178, 100))
    for ask in (require_display, lambda: window.draw(scene("match", SPOTS))):
        unset = r"\(neither DISPLAY nor WAYLAND_DISPLAY is set\).*rgb_array.*SDL_VIDEODRIVER=dummy"
        with pytest.raises(RuntimeError, match=unset):
            ask()
        assert not window.is_open
    monkeypatch.setenv("DISPLAY", ":4321")  # nobody listens there
    require_display()
    with pytest.raises(RuntimeError, match=r'render_mode="rgb_array"'):
        window.draw(scene("match", SPOTS))
    assert not window.is_open
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")  # said aloud: it is wanted
    require_display()


@pytest.mark.parametrize("how", ["close button", "escape"])
def test_a_window_that_is_closed_ends_the_film_and_draws_no_more(dummy_screen, pot, how):
    event, key = dummy_screen.event, dummy_screen.K_ESCAPE
    window = Window(size=(518, 300))
    assert window.draw(scene("match", SPOTS))
    event.post(
        event.Event(dummy_screen.QUIT)
        if how == "close button"
        else event.Event(dummy_screen.KEYDOWN, key=key)
    )
    assert not window.play(Film("match", pot), fps=1000)
    assert not window.is_open and not window.draw(scene("match", SPOTS))
