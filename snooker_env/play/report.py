"""What is on the table, and what may be done? The game as JSON types for page and programs, and as text."""

from typing import Any

from ..advice import POCKET_WORDS
from ..game.balls import CUE, NAMES, YELLOW, ids_of
from ..game.frame import Frame
from ..game.rule_sets import RULES, rule_set
from ..game.snookered import is_snookered
from ..geometry import POCKET_AIMS
from ..physics.cue_room import BUTT, LENGTH, RAIL, TIP
from ..planning.stroke_columns import FARTHEST
from ..render.scene import scene_data
from ..replays.encode import encode_stroke
from ..replays.words import ERRORS, errors_words
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, Actions
from ..tasks.options import CUES
from .questions import MOST_SAMPLES, MOST_SUGGESTIONS
from .service import Service
from .session import Act, Session
from .words import asked_words, freedom, last_words, lines_of, table_text


def scene(service: Service) -> dict[str, Any]:
    """The constant part: the table as it is drawn, limits of strokes, available players."""
    with service.reading() as session:
        rules = session.options_with("none").rules
    assert isinstance(rules.actions, Actions)
    limits = {"speed": [MIN_SPEED, MAX_SPEED], "offset": FARTHEST, "elevation": [0.0, rules.actions.steepest]}
    pockets = zip(POCKET_WORDS, POCKET_AIMS[:, :2].tolist(), strict=True)
    return {
        "scene": scene_data(rules.table),
        "R": rules.physics.R,
        "spin_decel": rules.physics.spin_decel,
        "cue": {"tip": TIP, "butt": BUTT, "length": LENGTH, "rail": RAIL},
        "limits": limits | {"samples": MOST_SAMPLES, "suggestions": MOST_SUGGESTIONS},
        "pockets": [{"name": name, "x": x, "y": y} for name, (x, y) in pockets],
        "players": service.seats.names,
        "noise": ERRORS,
        "cues": list(CUES),
        "games": list(RULES),
    }


def table_after(
    act: Act, labels: tuple[str, str], win_chance: float | None, before: Act | None = None
) -> dict[str, Any]:
    """The table and the scoreboard after an act; ``win_chance``: of seat 0; ``before``: the act before it."""
    state, frame = act.state, Frame.from_dict(act.state["frame"])
    present = [ball for ball, on in enumerate(state["on_table"]) if on]
    over = frame.phase == "over"
    names = ("phase", "striker", "breaker", "free_ball", "in_hand", "anywhere", "winner")
    return {name: getattr(frame, name) for name in names} | {
        "scores": list(frame.scores),
        "win_chance": win_chance,
        "break": frame.break_points,
        "ball_on": None if over else frame.ball_on.name.lower(),
        "reds": sum(0 < ball < YELLOW for ball in present),
        "available": 0 if over else frame.available,
        "time_left": (clock - frame.clock) / 1000 if (clock := rule_set(frame.rules).clock) else None,
        "positions": {NAMES[ball]: list(state["positions"][ball]) for ball in present},
        "words": asked_words(frame, labels),
        "last": last_words(act, labels, before),
    }


def stroke_report(service: Service, k: int) -> dict[str, Any]:
    """The act with this index, which is a stroke: as in a replay, with the tables before and after it."""
    acts, labels = service.session.acts, service.labels
    played = acts[k].played
    assert played is not None
    before, both = acts[k - 2] if k > 1 else None, acts[k - 1 : k + 1]
    chances = service.win_chances(both)
    tables = [table_after(act, labels, chance, before) for act, chance in zip(both, chances, strict=True)]
    return encode_stroke(played, labels) | {"tables": tables}


def report(service: Service) -> dict[str, Any]:
    """The current state of the game."""
    session, seats = service.session, service.seats
    frame, tables = session.frame, session.tables
    on = tables.on(0) if frame.phase == "stroke" else 0
    hidden, lines = False, []
    if on:
        present = tables.on_table[0].copy()
        present[CUE] = not frame.in_hand
        hidden = is_snookered(tables.positions[0], present, on, jaws=tables.rules.table.jaws[:, :3])[0]
        positions = [session.planned(free_ball=free) for free in (False, True)[: 1 + frame.free_ball]]
        lines = lines_of(positions, on, session.noise[frame.striker])
    act = session.acts[session.at - 1]
    before = session.acts[session.at - 2] if session.at > 1 else None
    state = table_after(act, service.labels, service.win_chances([act])[0], before)
    waits = f"{seats.label(frame.striker)} {'waits: press Continue.' if service.paused else 'is thinking.'}"
    of_session = ("begun", "practice", "game", "best_of", "frames", "match_over", "cue")
    state |= {name: getattr(session, name) for name in of_session}
    state |= {name: getattr(service, name) for name in ("revision", "thinking", "trouble")}
    state |= {
        "players": list(seats.who),
        "labels": list(service.labels),
        "advisers": seats.advisers(session.practice),
        "level": seats.level(session),
        "noise": list(session.noise),
        "balls_on": [NAMES[i] for i in ids_of(on)],
        "snookered": hidden,
        "miss_called": frame.miss_called,
        "choices": list(frame.choices),
        "nominations": [NAMES[i] for i in session.nominations()],
        "needs_snookers": frame.phase != "over" and frame.needs_snookers(frame.striker),
        "lines": [line.to_dict() for line in lines],
        "paused": service.paused and service.agent_to_play(),
        "strokes": len(session.strokes),
        "undo": session.at > 1,
        "redo": session.at < len(session.acts),
        "words": (service.trouble or waits) if service.agent_to_play() else state["words"],
    }
    places = {NAMES.index(name): (x, y) for name, (x, y) in state["positions"].items()}
    return state | {"text": table_text(places, on, lines, _facts(session, state, places))}


def _facts(session: Session, state: dict[str, Any], places: dict[int, tuple[float, float]]) -> list[str]:
    """The sentences before the list of balls."""
    facts, ((one, other), reds) = [state["last"], state["words"]], (state["labels"], state["reds"])
    facts.append(f"Score: {one} {state['scores'][0]}, {other} {state['scores'][1]}; break {state['break']}.")
    if state["phase"] == "over":
        return facts
    if (chance := state["win_chance"]) is not None:
        sure = chance in (0.0, 1.0)  # by the rules; as the page shows it, rounding makes nothing certain
        share = round(100 * chance) if sure else min(99, max(1, round(100 * chance)))
        errors = errors_words(state["level"])
        facts.append(f"Chance to win, both {errors}: {one} {share} %, {other} {100 - share} %.")
    left = f"{state['available']} points are left on the table"
    facts.append(f"{left}, {reds} red{'' if reds == 1 else 's'} among the balls.")
    if state["needs_snookers"]:
        facts.append("The striker needs penalty points to win.")
    if state["phase"] == "choice":
        facts.append("Choices: " + ", ".join(state["choices"]) + ".")
        return facts
    if state["nominations"]:
        colours = ", ".join(state["nominations"])
        facts.append(f"May be nominated: {colours}; without a nomination it is the colour first struck.")
    if state["in_hand"]:
        where = "x^2 + (y + 1.0475)^2 <= 0.292^2 and y <= -1.0475"
        facts.append(f"The cue ball may be placed anywhere in the D ({where}).")
    if state["snookered"]:
        facts.append("The cue ball is snookered: no ball on can be struck at both edges in a straight line.")
    return facts + freedom(places)
