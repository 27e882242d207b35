"""Which tests need a trainer that is no dependency of the others? Skipped without it, unless ``.ci/run`` says
that it must be there."""

import importlib
import os

import pytest


def needed(name):
    """The module of that name. With SNOOKER_TRAINERS in the environment a missing one is an error and no
    reason to skip."""
    return importlib.import_module(name) if os.environ.get("SNOOKER_TRAINERS") else pytest.importorskip(name)
