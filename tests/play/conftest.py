"""Which fixtures do tests of play share?"""

import pytest

from tests.play.shown import Shown
from tests.playing import Asked, served
from tests.web.chromium import chromium  # noqa: F401


@pytest.fixture
def game():
    asked = Asked()
    yield asked
    asked.service.close()


@pytest.fixture(scope="module")
def line():
    with served() as one:
        yield one


@pytest.fixture
def shown(chromium, line):  # noqa: F811
    one = Shown(chromium, line)
    yield one
    one.close()
