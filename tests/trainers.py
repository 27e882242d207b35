"""Which tests need a trainer that others do not? Skipped without it, unless ``.ci/run`` forbids that."""

import importlib
import os

import pytest


def needed(name):
    """The module of that name; with SNOOKER_TRAINERS in the environment it must not be missing."""
    return importlib.import_module(name) if os.environ.get("SNOOKER_TRAINERS") else pytest.importorskip(name)
