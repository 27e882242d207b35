"""Which fixtures do tests of play share?"""

import pytest

from tests.playing import Asked, served


@pytest.fixture
def game():
    asked = Asked()
    yield asked
    asked.service.close()


@pytest.fixture(scope="module")
def line():
    with served() as one:
        yield one
