"""What can happen in a shot, in the order in which simultaneous events are handled, and how can it end?"""

from enum import IntEnum


class EventKind(IntEnum):
    """The kind of an event in the log of a shot; simultaneous ones are handled in the order of their numbers.

    ``i`` is the ball; ``j`` is the other ball (i < j), the nose, the jaw or the pocket, or -1.

    ========= ====== ================================================================================
    BALL_BALL 0      Balls i and j struck each other.
    CUSHION   1      Ball i struck nose j.
    JAW       2      Ball i struck jaw j.
    POT       3      Ball i was potted in pocket j.
    ROLL      4      Ball i stopped sliding; it rolls from now on.
    STOP      5      Ball i stopped; it may still spin on the spot.
    DROP      6      Ball i flies over the edge of pocket j towards a jaw: a POT or RETURN follows.
    RETURN    7      Ball i came back on to the bed, over the edge of pocket j.
    BEND      8      Ball i rolls on: its path's next piece. Only with ``Physics.nap`` or ``roll_drag``.
    LAND      9      Ball i comes down on the bed. This and the next two only with ``Physics.flight``.
    RAIL      10     Ball i comes down on the top of a cushion and bounces there.
    OFF       11     Ball i is forced off the table.
    ========= ====== ================================================================================

    Examples
    --------
    >>> import snooker_env as sn
    >>> sn.EventKind(3).name
    'POT'
    """

    BALL_BALL = 0
    CUSHION = 1
    JAW = 2
    POT = 3
    ROLL = 4
    STOP = 5
    DROP = 6
    RETURN = 7
    BEND = 8
    LAND = 9
    RAIL = 10
    OFF = 11


class Status(IntEnum):
    """How a run ended.

    ================= ============================================================================
    OK                All balls came to rest.
    TOO_MANY_EVENTS   More events than allowed.
    LOG_FULL          The log was too short; run the shot again with more.
    IMPACT_UNSOLVED   An impact did not end.
    ASTRAY            A ball on the bed was where none can be: in a cushion, or off the table.
    UNSOUND           It was not played: a place, a speed or a spin is none that a shot may begin with.
    ================= ============================================================================
    """

    OK = 0
    TOO_MANY_EVENTS = 1
    LOG_FULL = 2
    IMPACT_UNSOLVED = 3
    ASTRAY = 4
    UNSOUND = 5


# The same as plain integers, because kernels compare them with numbers in integer arrays.
BALL_BALL, CUSHION, JAW, POT, ROLL, STOP, DROP, RETURN, BEND, LAND, RAIL, OFF = (
    int(kind) for kind in EventKind
)
OK, TOO_MANY_EVENTS, LOG_FULL, IMPACT_UNSOLVED, ASTRAY, UNSOUND = (int(status) for status in Status)

NONE = len(EventKind)
"""No event; its number is higher than that of every kind."""

OFF_TABLE = -2
"""In place of a pocket: the ball was forced off the table."""

LOG_KIND, LOG_I, LOG_J = range(3)
"""Columns of the event log."""
