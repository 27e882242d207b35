"""How is bad input reported? One ValueError that names the field, the value and what is allowed."""

from collections.abc import Collection
from contextlib import suppress
from math import isinf, nan

import numpy as np

from .types import Bools, Floats


def refuse(field: str, value: object, allowed: str) -> ValueError:
    """The error for a bad value, in the one form that this package uses: ``raise refuse(...)``.

    Parameters
    ----------
    field, value, allowed
        Name of the argument, as the caller writes it; its value, shown by its ``repr``; and "must be ...".

    Returns
    -------
    ValueError
        The error.

    Examples
    --------
    >>> from snooker_env.checks import refuse
    >>> raise refuse("speed", -1.0, "must be positive")
    Traceback (most recent call last):
    ...
    ValueError: speed = -1.0: must be positive
    """
    return ValueError(f"{field} = {value!r}: {allowed}")


def refuse_what(field: str, what: str, allowed: str) -> ValueError:
    """The same error for a value that is too large to show.

    Parameters
    ----------
    field, what, allowed
        As in ``refuse``, with a description of the value.

    Returns
    -------
    ValueError
        The error.

    Examples
    --------
    >>> from snooker_env.checks import refuse_what
    >>> print(refuse_what("points", "array of shape (3, 3)", "must have shape (n, 2)"))
    points = array of shape (3, 3): must have shape (n, 2)
    """
    return ValueError(f"{field} = {what}: {allowed}")


def number(
    field: str, value: object, low: float = -np.inf, high: float = np.inf, *, open_low: bool = False
) -> float:
    """Check that a value is a finite real number in a range; a bool, a str and an array are none.

    Parameters
    ----------
    field, value, low, high, open_low
        Name of the argument, for the message; its value; the ends of the range [low, high]; True for (low, high].

    Returns
    -------
    float
        The value; ValueError for anything else.

    Examples
    --------
    >>> from snooker_env.checks import number
    >>> number("speed", 2, 0, 10)
    2.0
    """
    x = nan
    if isinstance(value, (np.ndarray, np.generic)):
        if value.ndim == 0 and value.dtype.kind in "iuf" and not np.ma.is_masked(value):
            x = float(value)
    elif not isinstance(value, (bool, str, bytes)) and value is not None:
        with suppress(TypeError, ValueError, OverflowError):
            x = float(value)  # type: ignore[arg-type]  (TypeError is meant)
    if not low <= x <= high or isinf(x) or (open_low and x == low):
        left, right = "(" if open_low or low == -np.inf else "[", ")" if high == np.inf else "]"
        raise refuse(field, value, f"must be a finite number in {left}{low:g}, {high:g}{right}")
    return x


def _shape_text(shape):
    """A shape as text, with letters for the lengths that are free."""
    free = iter("bn" if shape.count(-1) == 2 else "n")
    sizes = ", ".join(next(free) if s == -1 else str(s) for s in shape)
    return f"({sizes},)" if len(shape) == 1 else f"({sizes})"


_FLOAT = np.dtype(np.float64)


def array(
    field: str, value: object, shape: tuple[int, ...], most: float | None = np.inf, unit: str = ""
) -> Floats:
    """A new float64 array of this shape (-1: any), C-ordered, finite within ``most`` [unit]; None: not checked."""
    if type(value) is np.ndarray and value.dtype is _FLOAT:
        a = value.copy()
    else:
        try:
            raw = np.asarray(value)
        except (TypeError, ValueError):
            raise refuse(field, value, f"must be real numbers of shape {_shape_text(shape)}") from None
        if raw.dtype.kind not in "iuf" or (isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value)):
            raise refuse(field, value, f"must be real numbers of shape {_shape_text(shape)}")
        with np.errstate(over="ignore"):  # a wider number may become infinite, which is refused
            a = np.array(raw, dtype=np.float64, order="C")
    if a.ndim != len(shape) or any(s not in (-1, n) for s, n in zip(shape, a.shape, strict=True)):
        raise refuse_what(field, f"array of shape {a.shape}", f"must have shape {_shape_text(shape)}")
    if most is None:
        return a
    sound = np.isfinite(a) if most == np.inf else np.abs(a) <= most
    if not sound.all():
        at = tuple(np.argwhere(~sound)[0].tolist())
        within = f", within {most:,g} {unit} of zero" if most < np.inf else ""
        raise refuse(f"{field}{list(at)}", float(a[at]), f"must be finite{within}")
    return a


def choice(field: str, value: object, options: Collection[str]) -> str:
    """Check that a value is one of some names.

    Parameters
    ----------
    field, value, options
        Name of the argument, for the message; its value; and the names that are allowed.

    Returns
    -------
    str
        The value; ValueError for anything else.

    Examples
    --------
    >>> from snooker_env.checks import choice
    >>> choice("kind", "box", ("box", "discrete"))
    'box'
    """
    if not isinstance(value, str) or value not in options:
        raise refuse(field, value, "must be one of " + ", ".join(repr(o) for o in options))
    return value


def integer(field: str, value: object, low: float, high: float) -> int:
    """Check that a value is an integer in a range; a bool and a float are none.

    Parameters
    ----------
    field, value, low, high
        Name of the argument, for the message; its value; and the ends of the range [low, high].

    Returns
    -------
    int
        The value; ValueError for anything else.

    Examples
    --------
    >>> from snooker_env.checks import integer
    >>> integer("visits", 30, 1, 100)
    30
    """
    other = (bool, np.bool_, np.timedelta64)  # np.timedelta64 is a subclass of np.integer
    if isinstance(value, other) or not isinstance(value, (int, np.integer)) or not low <= value <= high:
        raise refuse(field, value, f"must be an integer in [{low}, {high}]")
    return int(value)


def flags(field: str, value: object, shape: tuple[int, ...]) -> Bools:
    """A bool array of the given shape, always a new C-ordered copy."""
    try:
        a = np.array(value, order="C")
    except (TypeError, ValueError):
        raise refuse(field, value, f"must be bool of shape {shape}") from None
    if a.shape != shape or a.dtype != np.bool_:
        raise refuse_what(field, f"{a.dtype} array of shape {a.shape}", f"must be bool of shape {shape}")
    return a


def truth(field: str, value: object) -> bool:
    """The value, a bool; ValueError for anything else: 0 and 1 are none."""
    if not isinstance(value, (bool, np.bool_)):
        raise refuse(field, value, "must be True or False")
    return bool(value)
