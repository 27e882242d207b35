"""When is a ball in the air over a pocket, and its energy not all in the plane?"""

import numpy as np

from snooker_env import EventKind


def flights(shot):
    """(ball, from, until) of each flight in the log of a shot."""
    out, away = [], {}
    for event in shot.events:
        ball = int(event["i"])
        if event["kind"] == EventKind.DROP:
            away[ball] = float(event["time"])
        elif event["kind"] in (EventKind.RETURN, EventKind.POT) and ball in away:
            out.append((ball, away.pop(ball), float(event["time"])))
    assert not away, "a flight without an end"
    return out


def calm(shot, times):
    """At which of the times is no ball in the air?"""
    out = np.ones(len(times), bool)
    for _, start, end in flights(shot):
        out &= ~((start <= times) & (times < end))
    return out
