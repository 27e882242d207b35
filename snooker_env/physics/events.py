"""What can happen in a shot, and how can it end? Kinds of events in the order in which simultaneous ones are taken, and the end of a
run."""

from enum import IntEnum


class EventKind(IntEnum):
    """What happened. In the log of events ``i`` is the ball; ``j`` the other ball (i < j), nose, jaw or pocket, or -1.

    ========= ====================================================================================================
    BALL_BALL Balls i and j struck each other.
    CUSHION   Ball i struck nose j.
    JAW       Ball i struck jaw j.
    POT       Ball i was lost in pocket j.
    ROLL      Ball i stopped sliding; it rolls from now on.
    STOP      Ball i stopped; it may still spin on the spot.
    DROP      Ball i flies over the edge of pocket j towards a jaw: a POT or a RETURN follows. A ball with no jaw on its
              way is potted at once.
    RETURN    Ball i comes back on to the bed, over the edge of pocket j.
    BEND      The nap turned rolling ball i: the next piece of its path begins. Only with ``Physics.nap``.
    ========= ====================================================================================================

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


class Status(IntEnum):
    """How a run ended.

    ================= =====================================================
    OK                All balls came to rest.
    TOO_MANY_EVENTS   More events than were allowed.
    LOG_FULL          The log was too short; the run is to be made again.
    IMPACT_UNSOLVED   An impact did not end.
    ================= =====================================================
    """

    OK = 0
    TOO_MANY_EVENTS = 1
    LOG_FULL = 2
    IMPACT_UNSOLVED = 3


# The same as plain integers: kernels compare them with what lies in integer arrays.
BALL_BALL, CUSHION, JAW, POT, ROLL, STOP, DROP, RETURN, BEND = (int(kind) for kind in EventKind)
OK, TOO_MANY_EVENTS, LOG_FULL, IMPACT_UNSOLVED = (int(status) for status in Status)

NONE = len(EventKind)
"""Nothing happens any more: later than every kind."""

LOG_KIND, LOG_I, LOG_J = range(3)
"""Columns of the event log."""
