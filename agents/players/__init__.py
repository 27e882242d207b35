"""Which players does the repository add to the package? Its trained models.

``pyproject.toml`` names them as entry points, so that ``snooker_env.player`` finds them in a clone.
"""

from .._lib.lifecycle import what_is_missing


def read_model(path):
    """The player of a model or run of ``train.py``, otherwise None. An entry point of ``snooker_env.models``."""
    try:
        from .trained import read_model
    except ModuleNotFoundError as error:
        raise ImportError(what_is_missing(error)) from None
    return read_model(path)


def __getattr__(name):
    """Make a constructor for a pre-trained model, which needs other libraries."""
    if name.startswith("__"):
        raise AttributeError(name)
    try:
        from ..learning.models import PRETRAINED, pretrained_names
    except ModuleNotFoundError as error:
        raise ImportError(what_is_missing(error)) from None
    if name in pretrained_names():
        return lambda: read_model(PRETRAINED / f"{name}.zip")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = ["read_model"]
