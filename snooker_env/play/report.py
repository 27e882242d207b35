"""What is on the table, and what may be done? The game as JSON types for the page and for programs, and as plain text."""

from typing import Any

import numpy as np

from ..advice import POCKET_WORDS
from ..advice.strokes import FARTHEST
from ..game.balls import CUE, NAMES, REDS_MASK, YELLOW, BallOn, ids_of
from ..game.frame import Frame
from ..game.snookered import is_snookered
from ..geometry import POCKET_AIMS
from ..render.scene import scene_data
from ..tasks.box_actions import MAX_ELEVATION, MAX_SPEED, MIN_SPEED
from ..tasks.noise import LEVELS
from .lines import Line, lines_of
from .questions import MOST_SAMPLES, MOST_SUGGESTIONS
from .service import Service, last_words
from .words import freedom, on_words, table_text


def scene(service: Service) -> dict[str, Any]:
    """The constant part: the table as it is drawn, limits of strokes, available players."""
    rules = service.session.rules_with("none")
    return {
        "scene": scene_data(rules.table), "R": rules.physics.R, "spin_decel": rules.physics.spin_decel,
        "limits": {
            "speed": [MIN_SPEED, MAX_SPEED], "offset": FARTHEST, "elevation": [0.0, MAX_ELEVATION], "samples": MOST_SAMPLES,
            "suggestions": MOST_SUGGESTIONS,
        },
        "pockets": [{"name": name, "x": float(x), "y": float(y)} for name, (x, y) in zip(POCKET_WORDS, POCKET_AIMS[:, :2], strict=True)],
        "agents": service.seats.agents, "players": service.seats.names, "noise": list(LEVELS),
    }  # fmt: skip


def report(service: Service) -> dict[str, Any]:
    """The current state of the game."""
    session, seats = service.session, service.seats
    frame, tables = session.frame, session.tables
    labels = (seats.label(0), seats.label(1))
    on = tables.on(0) if frame.phase == "stroke" else 0
    hidden = _snookered(session, frame, on)
    lines = _lines(session, frame, on)
    there = np.flatnonzero(tables.on_table[0]).tolist()
    places = {ball: tuple(tables.positions[0, ball].tolist()) for ball in there}
    return {
        "revision": service.revision, "phase": frame.phase, "striker": frame.striker, "players": list(seats.who), "labels": list(labels),
        "noise": list(session.noise), "practice": session.practice, "scores": list(frame.scores), "break": frame.break_points,
        "ball_on": None if frame.phase == "over" else frame.ball_on.name.lower(), "balls_on": [NAMES[i] for i in ids_of(on)],
        "free_ball": frame.free_ball, "in_hand": frame.in_hand, "snookered": hidden, "miss_called": frame.miss_called,
        "choices": list(frame.choices), "nominations": [NAMES[i] for i in session.nominations()],
        "reds": sum(0 < ball < YELLOW for ball in there), "available": 0 if frame.phase == "over" else frame.available,
        "needs_snookers": frame.phase != "over" and frame.needs_snookers(frame.striker), "winner": frame.winner,
        "positions": {NAMES[ball]: list(place) for ball, place in places.items()}, "lines": [line.to_dict() for line in lines],
        "thinking": service.thinking, "paused": service.paused and service.agent_to_play(), "trouble": service.trouble,
        "strokes": len(session.strokes), "undo": session.at > 1, "redo": session.at < len(session.acts),
        "words": _asked(service, frame, labels), "last": last_words(session.acts[session.at - 1], labels),
        "text": table_text(places, on, lines, _facts(service, frame, labels, hidden, places)),
    }  # fmt: skip


def _snookered(session, frame: Frame, on: int) -> bool:
    if not on:
        return False
    tables = session.tables
    present = tables.on_table[0].copy()
    present[CUE] = not frame.in_hand
    return is_snookered(tables.positions[0], present, on, jaws=tables.rules.table.jaws[:, :3])[0]


def _lines(session, frame: Frame, on: int) -> list[Line]:
    if not on:
        return []
    positions = [session.planned()]
    if frame.free_ball:
        positions.append(session.planned(free_ball=True))
    return lines_of(positions, on, session.noise[frame.striker])


def _asked(service: Service, frame: Frame, labels: tuple[str, str]) -> str:
    """What the game waits for, in a sentence."""
    who = labels[frame.striker]
    yours = "Your stroke" if who == "You" else f"{who}'s stroke"
    if frame.phase == "over":
        winner, scores = frame.winner or 0, frame.scores
        return f"Frame over: {labels[winner]} won {scores[winner]}-{scores[1 - winner]}."
    if service.trouble:
        return service.trouble
    if service.agent_to_play():
        return f"{who} waits: press Continue." if service.paused else f"{who} is thinking."
    if frame.phase == "choice":
        miss = " and a miss" if frame.miss_called else ""
        return f"Foul{miss} by {labels[1 - frame.striker]}: {'choose' if who == 'You' else f'{who} chooses'}."
    what = on_words(frame.ball_on, frame.free_ball)
    placing = "; the cue ball is in hand" if frame.in_hand else ""
    return f"{yours}: {what} {'are' if frame.free_ball else 'is'} on{placing}."


def _facts(service: Service, frame: Frame, labels, hidden: bool, places) -> list[str]:
    """The sentences before the list of balls."""
    session = service.session
    said = [last_words(session.acts[session.at - 1], labels), _asked(service, frame, labels)]
    said.append(f"Score: {labels[0]} {frame.scores[0]}, {labels[1]} {frame.scores[1]}; break {frame.break_points}.")
    if frame.phase == "over":
        return said
    reds = bin(frame.on_table & REDS_MASK).count("1")
    said.append(f"{frame.available} points are left on the table, {reds} red{'' if reds == 1 else 's'} among the balls.")
    if frame.needs_snookers(frame.striker):
        said.append("The striker needs penalty points to win.")
    if frame.phase == "choice":
        said.append("Choices: " + ", ".join(frame.choices) + ".")
        return said
    if frame.ball_on == BallOn.ANY_COLOUR or frame.free_ball:
        named = [NAMES[i] for i in session.nominations()]
        said.append(f"May be nominated: {', '.join(named)}; without a nomination it is the colour first struck.")
    if frame.in_hand:
        said.append("The cue ball may be placed anywhere in the D (x^2 + (y + 1.0475)^2 <= 0.292^2 and y <= -1.0475).")
    if hidden:
        said.append("The cue ball is snookered: no ball on can be struck at both edges in a straight line.")
    return said + freedom(places)
