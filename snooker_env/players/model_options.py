"""How are the actions of a model of Stable-Baselines3 read? By these options, of code or of a command line."""

from argparse import ArgumentParser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .._lib.check import choice, refuse
from .._lib.files import strict_json
from ..tasks.options import Options
from .saved_models import by_train, entries

KEYS = tuple(Options.group("action"))  # what a model's file does not say
LEFT_OUT = "must be left out: it is for models of Stable-Baselines3"


def check_model_options(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """These options as a dict, {} for None; ValueError for others than ``KEYS`` or for values that they cannot have."""
    if not isinstance(options, Mapping | None):
        raise refuse("options", options, 'must be a dict such as {"aim": "absolute"}')
    read = dict(options or {})
    for key in read:
        choice("key of options", key, KEYS)
    Options(task="frame", **read)  # makes sure of the values
    return read


def options_of_words(words: Sequence[str]) -> dict[str, Any]:
    """Options from words like "aim=absolute", "placement=True" and "says=decision,lot"; ValueError for others."""
    options: dict[str, Any] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or name not in KEYS or name in options:
            raise refuse("options", word, f"must be KEY=VALUE, KEY once each of {', '.join(KEYS)}")
        options[name] = tuple(value.split(",")) if name == "says" else _value(value)
    return check_model_options(options)


def _value(text: str) -> Any:
    """A truth value or a number, else the text itself."""
    try:
        value = strict_json(text.lower())
    except ValueError:
        return text
    return value if isinstance(value, bool | int | float) else text


def add_model_options(parser: ArgumentParser) -> None:
    """Add ``--trust`` and ``--options`` to a command that takes a model's file."""
    trusts = "allow the pickled code in a model's file to run"
    parser.add_argument("--trust", action="store_true", help=trusts)
    how = "how to read the actions of a model of Stable-Baselines3, for example aim=absolute"
    parser.add_argument("--options", nargs="+", default=[], metavar="KEY=VALUE", help=how)


def of_others(path: str | Path) -> bool:
    """Whether a path is a model's ``.zip`` that ``train.py`` did not write, or a broken one."""
    try:
        return Path(path).is_file() and not by_train(entries(path))
    except Exception:  # ``SavedModel`` says what is wrong with it
        return Path(path).suffix == ".zip"
