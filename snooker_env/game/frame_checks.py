"""Which frames are impossible? The checks of a ``Frame`` from a dict beyond each field's type and range."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from typing import Any

from .._check import refuse, refuse_what
from .balls import BLACK, REDS_MASK, BallOn, next_on

MOST_BREAK = 155
"""The highest break (a free ball and the colour after it, then 147), points still on the table included."""

SETTLED: dict[str, Any] = {"ball_on": BallOn.NOTHING, "failures": 0, "saved": None, "misses": 0}
SETTLED |= dict.fromkeys(("free_ball", "miss_called", "warned", "anywhere"), False)
"""The fields of a frame that is over."""

REPLACED = ("on_table", "ball_on", "in_hand", "free_ball", "anywhere")
"""The fields that are restored with a position that is replaced."""


def is_plain(value: Any, high: int) -> bool:
    """Whether it is an int in [0, high]: a quick test that nearly always spares the full check."""
    return type(value) is int and 0 <= value <= high


def faults(frame: Any) -> Iterator[tuple[bool, str, str]]:
    """Pairs of fields that the rules forbid: (whether this is so, the field, what is allowed)."""
    stroke, after_foul, missing = frame.phase == "stroke", frame.phase == "choice", frame.miss != "off"
    rules = frame.rule_set
    known = frame.on_table | (0 if frame.saved is None else frame.saved.on_table)
    yield bool(known & ~frame.rack), "rack", "must hold the balls of on_table, and of saved"
    if frame.phase == "over":
        for name, value in SETTLED.items():
            yield getattr(frame, name) != value, name, f'must be {value!r} in phase "over"'
        return
    lowest, left = next_on(frame.on_table), MOST_BREAK - frame.available
    allowed = f'must be {lowest}, the lowest on_table, except in phase "stroke"'
    yield not stroke and frame.ball_on != lowest, "ball_on", allowed
    allowed = f"must be 0 (any colour) or {lowest}, the lowest on_table"
    yield frame.ball_on not in (BallOn.ANY_COLOUR, lowest), "ball_on", allowed
    allowed = f"must be at most {left}: on_table and ball_on offer {frame.available} more"
    yield frame.break_points > left, "break_points", allowed
    new, allowed = frame.free_ball or not stroke, 'must be 0 except in phase "stroke" without free_ball'
    yield new and frame.break_points != 0, "break_points", allowed
    level = frame.on_table == 1 << BLACK and frame.scores[0] == frame.scores[1]
    allowed = "must be False except with level scores and only the black on_table"
    yield frame.respotted_black and not level, "respotted_black", allowed
    lot = frame.phase == "lot" and not frame.respotted_black
    yield lot, "phase", 'must not be "lot" without respotted_black'
    called = after_foul and missing and frame.saved is not None
    allowed = 'must be False except in phase "choice" with a miss rule and saved'
    yield frame.miss_called and not called, "miss_called", allowed
    counting = missing and frame.saved is not None and (stroke or frame.miss_called)
    allowed = 'must be 0 except with a miss rule, saved, and either miss_called or phase "stroke"'
    yield frame.failures > 0 and not counting, "failures", allowed
    warned = stroke and frame.failures == 2
    allowed = f'must be {warned}: True in phase "stroke" with two failures, else False'
    yield frame.warned != warned, "warned", allowed
    yield frame.anywhere and not frame.in_hand, "anywhere", "must be False except with in_hand"
    placed, these = rules.anywhere or rules.most_misses > 0, f"with rules = {frame.rules!r}"
    yield frame.anywhere and not placed, "anywhere", f"must be False {these}"
    yield frame.clock > 0 and not rules.clock, "clock", f"must be 0 {these}, which has no clock"
    late = 0 < rules.clock <= frame.clock and not frame.respotted_black
    yield late, "clock", f"must be below {rules.clock} ms, when the frame ends"
    allowed = f'must not be "choice" {these}: the opponent has nothing to choose'
    yield rules.anywhere and after_foul, "phase", allowed
    yield rules.anywhere and frame.free_ball, "free_ball", f"must be False {these}"
    counted = rules.most_misses and missing and (stroke or frame.miss_called)
    allowed = 'must be 0 except in six-red snooker after a miss: miss_called, or in phase "stroke"'
    yield frame.misses > 0 and not counted, "misses", allowed
    uncounted = frame.miss_called and rules.most_misses > 0 and not frame.misses
    yield uncounted, "misses", "must be above 0 in six-red snooker with miss_called"
    if frame.saved is not None:
        allowed = 'must be None except in phase "choice", or in phase "stroke" with a miss rule'
        yield not (after_foul or (stroke and missing)), "saved", allowed
        gone = frame.saved.on_table ^ frame.on_table
        lost = gone & ~REDS_MASK or gone & frame.on_table
        allowed = "must have the balls on_table after the foul, and no others except reds"
        yield after_foul and lost, "saved", allowed
        for name in REPLACED:
            other = getattr(frame.saved, name) != getattr(frame, name)
            allowed = f'must have the present {name}: in phase "stroke" it has just been restored'
            yield stroke and other, "saved", allowed


def check_fit(frame: Any) -> None:
    """Raise ValueError if the rules forbid a combination of the fields of a ``Frame``."""
    for wrong, name, allowed in faults(frame):
        if wrong:
            raise refuse_what(name, "a position" if name == "saved" else repr(getattr(frame, name)), allowed)


def check_fields(field: str, plain: Any, kind: type) -> None:
    """Raise ValueError unless ``plain`` is a dict with exactly the fields of the dataclass ``kind``."""
    names = [part.name for part in fields(kind)]
    if not isinstance(plain, dict):
        raise refuse(field, plain, "must be a dict with the fields " + ", ".join(names))
    if set(plain) != set(names):
        what = f"a dict without {[n for n in names if n not in plain]} and with the others {[n for n in plain if n not in names]}"
        raise refuse_what(field, what, "must have exactly the fields " + ", ".join(names))


@contextmanager
def within(field: str) -> Iterator[None]:
    """Prefix the message of a ValueError with ``field``."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{field}.{error}") from None


def tuples(value: Any) -> Any:
    """Nested lists, as JSON returns them, as nested tuples."""
    return tuple(map(tuples, value)) if isinstance(value, list | tuple) else value
