"""Which fixtures and settings do all tests share? A window that needs no display; drawn cases that are the
same in every run."""

import gc
import os
import warnings

import pytest
from hypothesis import settings

# A change is judged by what it changes: new cases are drawn weekly (--hypothesis-profile=default), not in
# every run.
settings.register_profile("same_cases", derandomize=True)
settings.load_profile("same_cases")

# what tests read on stderr must not depend on what was compiled before
os.environ.setdefault("SNOOKER_ENV_QUIET", "1")


def pytest_sessionstart(session):
    """Of two workers the first compiles the stroke of an environment while the other compiles that of a shot."""
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw0":
        from snooker_env import SnookerEnv

        env = SnookerEnv(layout="random:1")
        env.reset(seed=0)
        env.step([0.0, 0.0, 0.0, 0.0])


def pytest_collection_finish(session):
    """What collecting has made stays until the end: no later garbage collection has to look through it."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def strict():
    """Every warning is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.fixture
def screen(monkeypatch):
    """A display that is none; shots are drawn without waiting for the clock."""
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    shown = []

    def play(self, film, fps=30.0, *, speed=1.0):
        shown.append((len(list(film.scenes(fps, speed))), fps))
        return True

    monkeypatch.setattr("snooker_env.render.window.Window.play", play)
    yield shown
    pygame.display.quit()  # Gymnasium's checks close no environment that they make
