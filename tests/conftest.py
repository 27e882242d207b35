"""Which fixtures do several test files share? A window that needs no display."""

import os

import pytest

os.environ.setdefault("SNOOKER_ENV_QUIET", "1")  # what tests read on stderr must not depend on what was compiled before


@pytest.fixture
def screen(monkeypatch):
    """A display that is none; shots are drawn without waiting for the clock."""
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    shown = []

    def play(self, film, fps=30.0, *, speed=1.0):
        shown.append((len(list(film.scenes(fps, speed))), fps))
        return True

    monkeypatch.setattr("snooker_env.render.window.Window.play", play)
    return shown
