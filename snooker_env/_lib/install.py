"""How is a missing library reported? With the line that installs it, in a clone or from a wheel."""

from pathlib import Path

_CLONE = Path(__file__).parents[2]


def missing(what: str, extra: str) -> ImportError:
    """The error for a library that an extra of the package brings; not raised."""
    if (_CLONE / "pyproject.toml").is_file():
        return ImportError(
            f'{what}; install it, in the clone {_CLONE}, with: pip install -c constraints.txt -e ".[{extra}]"'
        )
    return ImportError(f'{what}; install it with: pip install "snooker-env[{extra}]"')
