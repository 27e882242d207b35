"""How does a simulated shot compare with its samples? By errors of paths, the order of contacts and runs across the table."""

import numpy as np

from .paths import _BALL_BALL, _CUSHION, _ROOM, START

FIRST = 3.0
"""Seconds of the beginning that is judged separately."""
CONTACTS = 4
UNSURE = 0.03
"""Two measured contacts closer than this [s] may have either order, because samples are 0.02 s apart."""
NOSES = ("left", "right", "near", "far")
"""The cushions in the engine's order: x -, x +, y -, y +."""
ACROSS = {"left": "right", "right": "left", "near": "far", "far": "near"}


def played_contacts(run):
    """The contacts of the simulated cue ball, [(time, what)], as in ``tracks.contacts``: the first with each ball."""
    found, hit = [], set()
    for m in range(int(run.n_events[0])):
        kind, i, j = run.event_what[0, m].tolist()
        time = float(run.event_time[0, m])
        if kind == _CUSHION and i == 0:
            if not found or found[-1][1] != NOSES[j] or time > found[-1][0] + UNSURE:
                found.append((time, NOSES[j]))
        elif kind == _BALL_BALL and i == 0 and j not in hit:
            hit.add(j)
            found.append((time, f"ball {j}"))
    return found


def same_order(measured, simulated, first=CONTACTS):
    """Whether the first contacts agree in order; measured ones within ``UNSURE`` may swap."""
    want = measured[:first]
    have = [what for _, what in simulated[: len(want)]]
    names = [what for _, what in want]
    if have == names:
        return True
    for k in range(len(want) - 1):
        if measured[k + 1][0] - measured[k][0] < UNSURE:
            other = names[:]
            other[k], other[k + 1] = other[k + 1], other[k]
            if have == other:
                return True
    if len(measured) > first == len(want) and measured[first][0] - measured[first - 1][0] < UNSURE:
        return have == [*names[:-1], measured[first][1]]
    return False


def across(contacts):
    """Runs from cushion to cushion and back without other contacts: [(from [s], to [s], crossings)], until the next contact."""
    found, k = [], 0
    while k < len(contacts):
        last = k
        while last + 1 < len(contacts) and ACROSS.get(contacts[last][1]) == contacts[last + 1][1]:
            last += 1
        if last - k >= 2:
            end = contacts[last + 1][0] if last + 1 < len(contacts) else contacts[last][0] + 1.5
            found.append((contacts[k][0], end, last - k))
        k = max(last, k + 1)
    return found


def _rms(squares):
    return float(np.sqrt(squares.mean())) if len(squares) else float("nan")


def judge_shot(judge, strike):
    """The figures of one shot with its strike: errors in metres, contacts, the strike in words."""
    shot = judge.shot
    squares = judge.squares(strike[None])[0]
    run = judge.run(strike[None])
    if run.n_events[0] > run.event_time.shape[1] or run.n_segments[0] > _ROOM:
        raise RuntimeError(f"shot {shot.id}: its log is too short")
    a = judge.offsets
    t, cue = judge.times[: a[1]], squares[: a[1]]
    simulated = [(time + float(strike[START]), what) for time, what in played_contacts(run)]
    runs = [(x, y, n, _rms(cue[(t >= x) & (t <= y)])) for x, y, n in across(shot.contacts)]
    return {
        "id": shot.id,
        "seconds": float(t[-1]),
        "samples": len(t),
        "wild": [b.wild for b in shot.balls],
        "cue_rms": _rms(cue),
        "cue_mean": float(np.sqrt(cue).mean()),
        "cue_rms_3s": _rms(cue[t <= shot.moved + FIRST]),
        "balls_rms": _rms(squares[a[1] :]),
        "order": bool(same_order(shot.contacts, simulated)),
        "measured": [(round(time, 3), what) for time, what in shot.contacts],
        "simulated": [(round(time, 3), what) for time, what in simulated],
        "across": runs,
        "strike": dict(
            zip(("speed", "aim", "side", "top", "elevation", "start"), map(float, strike), strict=True)
        ),
    }


def medians(shots):
    """The figures of many shots: medians, the 90 % quantile of the cue ball's error, and the share with the right order."""
    if not shots:
        return {}
    found = {
        key: float(np.median([s[key] for s in shots]))
        for key in ("cue_rms", "cue_mean", "cue_rms_3s", "balls_rms")
    }
    found["cue_rms_90"] = float(np.quantile([s["cue_rms"] for s in shots], 0.9))
    found["order"] = float(np.mean([s["order"] for s in shots]))
    found["shots"] = len(shots)
    return found
