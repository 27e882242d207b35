"""What does the page show? The game as JSON types, and as text."""

from typing import Any

from ..advice import POCKET_WORDS
from ..game.balls import CUE, NAMES
from ..game.frame import Frame
from ..game.rule_sets import RULES
from ..geometry import POCKET_AIMS, POCKETS
from ..physics.cue_room import BUTT, LENGTH, RAIL, TIP
from ..planning.stroke_columns import FARTHEST
from ..players.table_report import report_game, report_turn, say_score, say_table
from ..render.scene import scene_data
from ..replays.encode import encode_stroke
from ..replays.referee_words import ERRORS, sentence
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, Actions
from ..tasks.options import CUES
from .person import LEVELS
from .service import LINKED, PERSON, Service
from .session import Act

MOST_SAMPLES = 2000  # largest number of samples in one question: 40 ms of computing
MOST_SUGGESTIONS = 10
IN_SESSION = ("begun", "practice", "cue", "breaks", "hints", "undone")


def scene(service: Service) -> dict[str, Any]:
    """The constant part: the table as it is drawn, limits of strokes, available players."""
    rules = service.session.options_with("none").rules
    assert isinstance(rules.actions, Actions)
    limits = {"speed": [MIN_SPEED, MAX_SPEED], "offset": FARTHEST, "elevation": [0.0, rules.actions.steepest]}
    pockets = zip(POCKETS, POCKET_WORDS, POCKET_AIMS[:, :2].tolist(), strict=True)
    return {
        "scene": scene_data(rules.table),
        "R": rules.physics.R,
        "spin_decel": rules.physics.spin_decel,
        "cue": {"tip": TIP, "butt": BUTT, "length": LENGTH, "rail": RAIL},
        "limits": limits | {"samples": MOST_SAMPLES, "suggestions": MOST_SUGGESTIONS},
        "pockets": [{"key": key, "name": name, "x": x, "y": y} for key, name, (x, y) in pockets],
        "players": service.seats.names,
        "levels": [level._asdict() for level in LEVELS],
        "opponents": service.seats.opponents,
        "noise": ERRORS,
        "cues": list(CUES),
        "games": list(RULES),
        "me": service.me,
        "invites": service.invites if service.me == PERSON else [],
    }


_SAID = {
    "play": "{} played on.",
    "play_again": "{} asked the opponent to play again.",
    "replace": "{} had the balls put back.",
    "anywhere": "{} took the cue ball in hand.",
    "concede": "{} conceded the frame.",
    "claim": "{} claimed the frame.",
    "set_up": "Position set up.",
    "load": "Game loaded.",
    "new": "New frame.",
}  # of an act that is no stroke, or of the decision after a foul


def last_words(act: Act, labels: tuple[str, str]) -> str:
    """An act in a sentence, after the foul that it answers."""
    who = "" if act.player is None else labels[act.player]
    if act.played is not None:
        named = act.asked["nominate"]
        nominated = f" ({NAMES[named]} nominated)" if named > CUE else ""
        return f"{who}{nominated}: {sentence(act.played, labels)}"
    foul = "" if act.answers is None or act.answers.played is None else last_words(act.answers, labels)
    return f"{foul} {_SAID[act.asked.get('choice', act.what)].format(who)}".strip()


def table_after(act: Act, labels: tuple[str, str], win_chance: float | None) -> dict[str, Any]:
    """The table and the scoreboard after an act; ``win_chance``: of seat 0."""
    frame, table = Frame.from_dict(act.state["frame"]), (act.state["positions"], act.state["on_table"])
    own = {"win_chance": win_chance, "last": last_words(act, labels)}
    return report_game(frame, *table, labels) | own


def stroke_report(service: Service, k: int) -> dict[str, Any]:
    """The act with this index, which is a stroke: as in a replay, with the tables before and after it."""
    acts, labels = service.session.acts, service.labels
    played = acts[k].played
    assert played is not None
    both = acts[k - 1 : k + 1]
    after = zip(both, service.win_chances(both), strict=True)
    tables = [table_after(act, labels, chance) for act, chance in after]
    return encode_stroke(played, labels) | {"tables": tables}


def report(service: Service) -> dict[str, Any]:
    with service.reading() as session:
        seats, labels = service.seats, service.labels
        frame, act, host = session.frame, session.acts[session.at - 1], service.me == PERSON
        state = table_after(act, labels, service.win_chances([act])[0])
        table, noise = session.tables.rules.table, session.noise[frame.striker]
        turn, lines = report_turn(frame, session.position, table, noise)
        state |= turn | {name: getattr(session, name) for name in IN_SESSION} | {"game": frame.rules}
        by_link, players = host and LINKED in seats.who, [session.acts[k].player for k in session.strokes]
        visit = max((k for k in range(1, len(players)) if players[k - 1] != players[-1]), default=0)
        state |= {
            "revision": service.revision,
            "thinking": service.thinking,
            "trouble": service.trouble,
            "players": seats.seen_by(service.me),
            "labels": list(labels),
            "advisers": seats.advisers(session.practice),
            "level": seats.level(session),
            "noise": list(session.noise),
            "choice_wins": service.choice_chances(),
            "paused": host and service.paused and service.agent_to_play(),
            "strokes": len(session.strokes),
            "undo": host and session.at > 1 and not by_link,
            "redo": host and session.at < len(session.acts),
            "by_link": {"seat": seats.who.index(PERSON), "visit": visit} if by_link else None,
        }
        if service.agent_to_play():
            waits = "is waiting: press Continue." if host else "is waiting."
            waits = waits if service.paused else "is thinking."
            state["words"] = service.trouble or f"{labels[frame.striker]} {waits}"
        if host and frame.phase != "over" and seats.who[frame.striker] == LINKED:
            state["words"] = "It is your friend's turn: send the link."
        elif by_link and act.what == "new":
            state["last"] = "New frame. Play first, then send your friend the link."
        fair = act.played is not None and not (act.played.fouls or act.played.points)
        if fair and state["snookered"]:
            state["last"] = f"{state['last'].removesuffix('.')}: {labels[frame.striker]} is snookered."
        if state["phase"] == "over":
            state["words"] = f"{state['words']} {service.unkept if host else ''}".strip()
        said = [state["last"], state["words"], say_score(state, labels)]
        return state | {"text": say_table(state, lines, said)}
