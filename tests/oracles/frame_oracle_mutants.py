"""Would the oracle of frames see a referee's error? Errors are put into the oracle's rules, one at a time;
each must lead to disagreements.

Two sides that compute the same are compared. So an error in the oracle that is seen is an error of the same
kind in the environment that would be seen, on the same strokes.
"""

from __future__ import annotations

import re
import sys
import types
from collections.abc import Callable

from . import frame_oracle_geometry, frame_oracle_rules

RULES = {
    "no least penalty of four": ("base = max(4, von)", "base = von"),
    "the penalty of the ball on alone": ("verdict.penalty = max(costs)", "verdict.penalty = base"),
    "the lowest penalty": ("verdict.penalty = max(costs)", "verdict.penalty = min(costs)"),
    "seven is not asked of a colour that nobody named": ("else 7\n    base", "else 4\n    base"),
    "one point for several reds": ("worth = len(good)", "worth = min(1, len(good))"),
    "free ball and ball on both count": ("worth = von if good else 0", "worth = von * len(good)"),
    "a potted free ball stays down": ("stays |= set(real)", "stays |= set(good)"),
    "a colour potted in a foul stays down": (
        "if not costs and state.ball_on >= YELLOW",
        "if state.ball_on >= YELLOW",
    ),
    "spots from the lowest value up": (
        "waiting = sorted(colours, reverse=True)",
        "waiting = sorted(colours)",
    ),
    "the same player goes on after a miss": (
        "after.striker, after.ball_on = other, after.next_on()",
        "after.ball_on = after.next_on()",
    ),
    "a red again after a red": ("after.ball_on = ANY\n", "after.ball_on = RED\n"),
    "the ball on stays when it went down": ("or real:", "or False:"),
    "a foul keeps the break": (
        "after.break_points, after.miss_called, after.saved = 0",
        "after.break_points, after.miss_called, after.saved = 1",
    ),
    "level scores at the end": ("if after.scores[0] == after.scores[1]", "if False"),
    "the winner of a foul on the black": (
        "int(after.scores[1] > after.scores[0])",
        "int(after.scores[0] > after.scores[1])",
    ),
    "a foul on the last black does not end the frame": (
        "if state.ball_on == BLACK:\n        _last",
        "if False:\n        _last",
    ),
    "a free ball after every foul": (
        "after.free_ball = _snookered(after, verdict)",
        "after.free_ball = True",
    ),
    "no free ball in hand": ("return hidden", "return False"),
    "a touching ball is not seen": ("TOUCH = 50e-6", "TOUCH = 0.0"),
    "a touching ball met later is pushed": (
        "if i in touched and _into(state.positions[i], stroke, time)",
        "if i in touched",
    ),
    "a touching ball counts as struck when it is moved": ("if pushed:", "if False:"),
    "a snooker behind the free ball is fair": (
        "    if answer:\n        verdict.fouls.add(BEHIND)",
        "    if False:\n        pass",
    ),
    "behind the free ball after a scoring stroke too": ("and not costs and not worth", "and not costs"),
    "a miss whatever the score": ("poor and (again or not needed)", "poor"),
    "no miss when level with what is left": (
        "lead > for_both or abs(lead) == available(state)",
        "lead > for_both",
    ),
    "a miss for a wrong pot": ("{NO_CONTACT, WRONG_FIRST})", "{NO_CONTACT, WRONG_FIRST, WRONG_POT})"),
    "a part of a ball is enough for the third miss": ("if full else 0\n", "\n"),
    "points available without the colour after a red": (
        "seven = 7 if state.ball_on == ANY else 0",
        "seven = 0",
    ),
}
"""Errors in ``frame_oracle_rules``: what is replaced, and by what."""
GEOMETRY = {
    "snookered only if both edges are hidden": (
        "for direction, length in edges(cue, ball):\n        for jaw",
        "for direction, length in edges(cue, ball)[:1]:\n        for jaw",
    ),
    "balls seem 2 mm wider": ("D2 = 2 * R", "D2 = 2 * R + 0.002"),
    "only the line of centres counts": (
        "far = float(np.hypot(*to))\n    if far <= D2:\n        return []",
        "return []",
    ),
    "a clear path to the middle only": (
        "marks = {-half, half}",
        "marks = {-1e-6, 1e-6}\n        half = 1e-6",
    ),
    "cushions do not stop a clear path": ("return None if outside else hit", "return hit"),
    "spots are never occupied": ("return not len(others) or", "return True or"),
}
"""Errors in ``frame_oracle_geometry``."""


def _module(source: types.ModuleType, change, **names):
    with open(source.__file__, encoding="utf-8") as file:
        text = file.read()
    if change is not None:
        old, new = change
        assert text.count(old) == 1, f"{text.count(old)} places to change: {old}"
        text = text.replace(old, new)
    text = re.sub(r"^from \. import .*$", "", text, flags=re.MULTILINE)
    module = types.ModuleType(source.__name__)
    module.__file__ = source.__file__
    module.__dict__.update(names, __package__=source.__package__)
    # dataclasses look their module up
    known, sys.modules[source.__name__] = sys.modules.get(source.__name__), module
    try:
        exec(compile(text, source.__file__, "exec"), module.__dict__)
    finally:
        sys.modules[source.__name__] = known
    return module


def mutants() -> dict[str, Callable[[], types.ModuleType]]:
    """For each error, what makes the rules with it."""
    made = {
        name: lambda change=change: _module(frame_oracle_rules, change, geometry=frame_oracle_geometry)
        for name, change in RULES.items()
    }
    for name, change in GEOMETRY.items():
        made[name] = lambda change=change: _module(
            frame_oracle_rules, None, geometry=_module(frame_oracle_geometry, change)
        )
    return made


def strokes_to_see(name: str, cases) -> int | None:
    """After how many of the recorded strokes an error is seen; None if it is not."""
    rules = mutants()[name]()
    for k, case in enumerate(cases, 1):
        try:
            _, _, names = case.compare(rules)
        except Exception:  # an error of the rules that makes no sense of a table is seen, too
            return k
        if names:
            return k
    return None
