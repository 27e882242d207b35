"""Which players does the repository add? Geometry with solved aims, a rule with foresight, trained models.

``pyproject.toml`` names them as entry points, so that ``snooker_env.player`` finds them in a clone.
"""

from .aim_search import Geometric


def read_model(path):
    """The player of a model or run of ``train.py``, else None. An entry point of ``snooker_env.models``."""
    from .trained import read_model

    return read_model(path)


def __getattr__(name):
    """What needs other libraries: the rule with foresight, and a maker of each pre-trained model."""
    if name == "ForesightRule":
        from .foresight import ForesightRule

        return ForesightRule
    if name.startswith("__"):
        raise AttributeError(name)
    from ..learning.models import PRETRAINED, pretrained

    if name in pretrained():
        return lambda: read_model(PRETRAINED / f"{name}.zip")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = ["ForesightRule", "Geometric", "read_model"]
