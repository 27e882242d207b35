"""Which fixtures do tests of environments share?"""

import warnings

import pytest


@pytest.fixture
def strict():
    """Every warning is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield
