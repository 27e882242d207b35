"""Which tests need a trainer that others do not? Skipped without it, unless ``.ci/run`` forbids that."""

import importlib
import os

import pytest


def needed(name):
    """The module of that name; with SNOOKER_TRAINERS in the environment it must not be missing."""
    if os.environ.get("SNOOKER_TRAINERS"):
        return importlib.import_module(name)
    return pytest.importorskip(name, exc_type=ImportError)  # also where Ray is there without RLlib
