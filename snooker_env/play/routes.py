"""Which requests does the server answer, and how? ``docs/play/protocol.md`` describes every route. A handler takes the fields of
a request and returns JSON types; a ValueError names an invalid field."""

import re
from collections.abc import Callable
from functools import partial
from math import atan2
from typing import Any, NamedTuple, cast

import numpy as np

from .._lib.check import choice, integer, number, refuse, truth
from .._lib.types import CueKind
from ..advice import POCKET_WORDS, CueStroke, advise, coach, destinations
from ..advice.practice import room_for
from ..advice.review import SAMPLES, read_frame
from ..game.balls import CUE, NAMES
from ..game.fouls import AUTO
from ..game.frame import Frame
from ..game.rule_sets import RULES
from ..geometry import POCKET_AIMS, POCKETS
from ..physics.cue_room import BUTT, LENGTH, RAIL, TIP
from ..physics.engine import EventKind
from ..planning.position import Position
from ..planning.stroke_columns import FARTHEST
from ..players.cue_stroke import STROKE, read_colour, read_place, read_stroke
from ..players.table_report import report_game, report_turn, say_score, say_table
from ..render.scene import scene_data, trace_paths
from ..replays import Replay
from ..replays.encode import encode_stroke, pack
from ..replays.referee_words import ERRORS, sentence
from ..simulation.shot import Shot
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, Actions
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from ..tasks.states import MOST
from .link import open_link, write_link
from .person import BY_NAME
from .service import LINKED, PERSON, Reviewing, Service, StaleError
from .session import Act, Session, read_levels

MOST_SAMPLES = 2000  # largest number of samples in one question: 40 ms of computing
MOST_SUGGESTIONS = 10
IN_SESSION = ("begun", "practice", "cue", "breaks", "hints", "undone")


class Route(NamedTuple):
    """What answers a route, with JSON types, and the fields a request may have."""

    handler: Callable[[Service, dict[str, Any]], Any]
    fields: tuple[str, ...] = ()
    friend: bool = False  # whether not the host alone may post it, but a friend, too


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
        "levels": [level._asdict() for level in BY_NAME.values()],
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
    return report_game(frame, *table, labels) | {"win_chance": win_chance, "last": last_words(act, labels)}


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
            waits = "is waiting for Continue." if service.paused else "is thinking."
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


def _state(service: Service, fields: dict[str, Any]) -> None:
    if "after" in fields:
        after, seconds = fields["after"], number("wait", fields.get("wait", 0.0), 0.0, 25.0)
        service.wait(integer("after", after, 0, MOST), seconds)


def _strokes(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.reading() as session:
        first = integer("from", fields.get("from", 0), 0, MOST)
        strokes = [stroke_report(service, k) for k in session.strokes[first:]]
        return {"revision": service.revision, "strokes": strokes}


def take_stroke(session: Session, fields: dict[str, Any]) -> CueStroke:
    if "place" in fields:
        session.place(*read_place("place", fields["place"]))
    return read_stroke(fields, session.as_visit(), session.options)


def _stroke(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    strikes = "choice" not in fields or any(name in fields for name in STROKE)
    nominated = read_colour("nominate", fields["nominate"]) if "nominate" in fields else AUTO
    struck = None
    with service.acting(_revision(fields)) as session:
        if "choice" in fields:
            if strikes and fields["choice"] != "play":
                allowed = 'must be "play" in a request that holds a stroke too'
                raise refuse("choice", fields["choice"], allowed)
            session.choose(fields["choice"])
        if strikes:
            session.play(take_stroke(session, fields), nominated=nominated)
            struck = stroke_report(service, session.at - 1)
    return {"stroke": struck, "state": report(service)}


def _place(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.acting() as session:
        place = session.place(*read_place("place", fields.get("place")))
    return {"place": place, "state": report(service)}


def _set_up(service: Service, fields: dict[str, Any]) -> dict[str, Any] | None:
    check = truth("check", fields.pop("check", False))
    try:
        position = Position.from_dict(fields.pop("position", None))  # type: ignore[arg-type]
        with service.asking() if check else service.acting(pause=True, any_turn=True) as session:
            session.set_up(position, **fields)
    except ValueError as error:
        if not check:
            raise
        return {"sound": False, "error": parts_of(error)}
    return {"sound": True, "error": None} if check else None


def _move(service: Service, fields: dict[str, Any], acts: int) -> None:
    """Undo or redo until a person has a stroke or decision to make."""
    with service.acting(pause=True, any_turn=True) as session:
        people, before = not all(map(service.seats.is_agent, (0, 1))), session.at
        while session.go_to(session.at + acts) and people and service.agent_to_play():
            pass
        session.undone += session.at < before


def _new(service: Service, fields: dict[str, Any]) -> None:
    by_link = truth("by_link", fields.pop("by_link", False))
    if not isinstance(fields.get("layout", ""), str):
        raise refuse("layout", fields["layout"], "must be the name of a layout")
    with service.acting(anew=True) as session:
        session.new(**fields)
        session.noise[:] = service.seats.share(0 if by_link else None, list(session.noise))
        if by_link:
            session.noise[1], session.practice = session.noise[0], False


def _players(service: Service, fields: dict[str, Any]) -> None:
    with service.acting(any_turn=True, anew="players" in fields) as session:
        session.noise[:] = read_levels("noise", fields.get("noise", session.noise))
        session.practice = truth("practice", fields.get("practice", session.practice))
        session.cue = cast(CueKind, choice("cue", fields.get("cue", session.cue), CUES))
        if "players" in fields:  # last, since seats are not given back after an error
            service.seats.sit(fields["players"])


def _concede(service: Service, fields: dict[str, Any]) -> None:
    with service.acting() as session:
        session.concede()


def _link(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.reading() as session:
        return {"link": write_link(session)}


def _load(service: Service, fields: dict[str, Any]) -> None:
    seat, by_link = fields.get("seat"), "seat" in fields
    if seat is not None:
        integer("seat", seat, 0, 1)
    with service.acting(pause=True, anew=True) as session:
        noise, played = list(session.noise), session.acts[: session.at] if LINKED in service.seats.who else []
        open_link(session, fields.get("link"), played if by_link else None)
        if by_link and seat is None:  # who opens it is not who played last
            last, frame = session.acts[-1].player, session.frame
            seat = frame.striker if frame.phase != "over" or last is None else 1 - last
        service.seats.share(seat, noise)


def _advise(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    n, seats = integer("n", fields.get("n", 5), 1, MOST_SUGGESTIONS), service.seats
    with service.asking(_revision(fields)) as session:
        agent = choice("agent", fields.get("agent", seats.advisers(session.practice)[0]), seats.players)
        errors = _errors(fields, 200, seats.level(session))
        if session.frame.phase == "choice":
            session.choose("play")  # the strokes are those of a player who plays the table as it lies
        at = session.as_visit() if session.practice else session.position  # alone at the table nobody wins
        advice = advise(at, agent=seats.players[agent], n=n, options=session.options, **errors)
        suggestions = []
        for one in advice:
            balls = ("ball", one.ball), ("first", one.first)
            names = {key: NAMES[k] if k >= 0 else None for key, k in balls}
            names |= {"pocket": POCKETS[one.pocket] if one.pocket >= 0 else None}
            suggestions.append(one.to_dict() | names | _paths(_play_exactly(session, one.stroke)))
    with service.reading(_revision(fields)) as now:  # a hint that comes too late does not count
        seat = session.frame.striker
        if now.begun == session.begun and not now.practice and seats.who[seat] == service.me:
            now.hints[seat] += 1
    return {"agent": agent, "order": advice.order, "noise": advice.noise, "suggestions": suggestions}


def _play_exactly(session: Session, stroke: CueStroke) -> Shot:
    """The stroke without execution errors, on a copy of the table."""
    twin = session.twin()
    twin.noise = ["none", "none"]
    played = twin.play(stroke).played
    assert played is not None
    return played.shot


def _hits(shot: Shot) -> Any:
    return shot.events[(shot.events["kind"] == EventKind.BALL_BALL) & (shot.events["i"] == CUE)]


def _paths(shot: Shot) -> dict[str, Any]:
    """Paths of a shot's balls [m]; the ball struck first, the pots and the duration."""
    hits, lines = _hits(shot), trace_paths(shot, range(len(shot.positions)), step=0.04)
    return {
        "paths": {str(ball): np.round(points, 4).tolist() for ball, (points, _) in lines.items()},
        "first": NAMES[hits["j"][0]] if len(hits) else None,
        "pots": [[NAMES[ball], POCKETS[shot.potted[ball]]] for ball in np.flatnonzero(shot.potted >= 0)],
        "duration": shot.duration,
    }


def _destinations(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.asking(_revision(fields)) as session:
        errors = _errors(fields, 500, session.noise[session.frame.striker])
        stroke = take_stroke(session, fields)
        stops = destinations(session.as_visit(), stroke, options=session.options, **errors)
        places = {name: pack(getattr(stops, name), "f4") for name in ("cue", "ball")}
        return _paths(_play_exactly(session, stroke)) | stops._asdict() | places


def _room(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.reading(_revision(fields)) as session:  # at once: it does not wait for long questions
        twin = session.twin()
    stroke = take_stroke(twin, fields)
    room = room_for(stroke.numbers(), twin.as_visit(), twin.options.rules).to_dict()
    if twin.frame.phase != "stroke":
        return room
    shot, first, heads = _play_exactly(twin, stroke), None, None
    for at, ball in _hits(shot)[["time", "j"]][:1].tolist():
        first, heads = NAMES[ball], atan2(*shot.at(at)[1][ball, 1::-1].tolist())
    return room | {"first": first, "heads": heads}


def _revision(fields: dict[str, Any]) -> int | None:
    return integer("revision", fields["revision"], 0, MOST) if "revision" in fields else None


def _errors(fields: dict[str, Any], samples: int, noise: str) -> dict[str, Any]:
    """Noise, samples and seed of a question; ``noise``, ``samples``: unless they are given."""
    noise = choice("noise", fields.get("noise", noise), LEVELS)
    samples = integer("samples", fields.get("samples", samples), 1, MOST_SAMPLES)
    return {"noise": noise, "samples": samples, "seed": integer("seed", fields.get("seed", 0), 0, MOST)}


def _person(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    """What the file holds, and where it lies; first a name is given, or the file deleted."""
    with service.reading():
        person = service.own_file()
        if "name" in fields:
            person.change(lambda kept: kept.update(name=fields["name"]))
        if truth("delete", fields.get("delete", False)):
            person.change(None)
        return person.read() | {"path": str(person.path)}


def _coach(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    strokes = service.own_file().strokes()
    if not strokes:
        raise refuse("strokes", 0, "must be at least one: play a frame against one of the five first")
    with service.asking():
        found = coach(strokes)
    return found.to_dict() | {"text": str(found)}


def _replay(service: Service) -> Replay:
    with service.reading() as session:
        acts, labels, judge = session.acts[: session.at], service.labels, service.judge()
        strokes = [act.played for act in acts if act.played is not None]
        known = [act.luck for act in acts if act.played is not None]
    if not strokes:
        raise refuse("strokes", 0, "must be at least one: nothing has been played yet")
    luck = known if judge is not None and any(known) else None
    return Replay(strokes, title=" - ".join(labels), players=labels, judge=judge, luck=luck)


def _review(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.reading() as session:
        if service.reviewing:
            service.reviewing.running = False
        if not truth("stop", fields.get("stop", False)):
            if session.practice:
                raise refuse("practice", True, "must be false: alone at the table nobody wins")
            advisers = service.seats.advisers(practice=False)
            agent = service.seats.players[choice("agent", fields.get("agent", advisers[0]), advisers)]
            people = [seat for seat in (0, 1) if not service.seats.is_agent(seat)] or (0, 1)
            frame = read_frame(_replay(service).to_dict())
            errors = _errors(fields, SAMPLES, service.seats.level(session))
            service.reviewing = Reviewing(session, frame, people, agent=agent, **errors)
    return service.own_review().report()


def _reviewed(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    """The review so far, or of a stroke its table, and both strokes drawn."""
    reviewing = service.own_review()
    if "stroke" not in fields:
        return reviewing.report()
    k, one, chance = reviewing.act_of(fields.get("stroke"))
    before, act = reviewing.acts[k - 1 : k + 1]
    assert act.played is not None
    with service.asking() as session:
        session.cue = act.played.cue_kind
        session.go_to(k, reviewing.acts)
        played, best = _paths(act.played.shot), _paths(_play_exactly(session, one.best.stroke))
        best["paths"] = {k: best["paths"][k] for k in map(str, (CUE, one.best.ball)) if k in best["paths"]}
        return {"played": played, "best": best} | {"table": table_after(before, service.labels, chance)}


def _again(service: Service, fields: dict[str, Any]) -> None:
    with service.acting(pause=True, any_turn=True) as session:
        reviewing = service.own_review()
        session.go_to(reviewing.act_of(fields.get("stroke"))[0], reviewing.acts)
        session.undone += 1


ASKED = ("noise", "samples", "seed", "revision")
GET: dict[str, Route] = {
    "scene": Route(lambda service, fields: scene(service)),
    "state": Route(_state, ("after", "wait")),
    "strokes": Route(_strokes, ("from",)),
    "replay": Route(lambda service, fields: _replay(service).to_dict()),
    "replay_page": Route(lambda service, fields: {"html": _replay(service).html()}),
}
POST: dict[str, Route] = {
    "stroke": Route(_stroke, (*STROKE, "choice", "nominate", "revision"), True),
    "person": Route(_person, ("name", "delete")),
    "coach": Route(_coach),
    "place": Route(_place, ("place",), True),
    "advise": Route(_advise, ("agent", "n", *ASKED), True),
    "destinations": Route(_destinations, (*STROKE, *ASKED), True),
    "room": Route(_room, (*STROKE, "revision"), True),
    "position": Route(_set_up, ("position", "scores", "striker", "free_ball", "check")),
    "undo": Route(partial(_move, acts=-1)),
    "redo": Route(partial(_move, acts=1)),
    "new": Route(_new, ("layout", "seed", "breaker", "game", "by_link")),
    "players": Route(_players, ("players", "noise", "practice", "cue")),
    "go": Route(lambda service, fields: service.go_on()),
    "concede": Route(_concede, friend=True),
    "link": Route(_link),  # it holds the random stream: the host's alone
    "load": Route(_load, ("link", "seat")),
    "review": Route(_review, ("agent", "stop", *ASKED[:3])),
    "reviewed": Route(_reviewed, ("stroke",)),
    "again": Route(_again, ("stroke",)),
}


def parts_of(error: ValueError) -> dict[str, Any]:
    """The parts of an error message that ``check.refuse`` made."""
    text = str(error)
    form = r"(?P<field>[\w\[\]., ]+?) = (?P<value>.*?): (?P<message>(must|overlaps|lies|ball).*)\Z"
    at = re.match(form, text, re.DOTALL)
    return at.groupdict() if at else {"field": None, "value": None, "message": text}


def answer(service: Service, route: Route, fields: dict[str, Any]) -> Any:
    """The answer of a route, by default the state; ValueError for an unknown or invalid field."""
    for name in fields:
        if name not in route.fields:
            some = f"must be one of {list(route.fields)}"
            raise refuse("field", name, some if route.fields else "must be left out: there are no fields")
    try:
        reply = route.handler(service, dict(fields))
    except StaleError:
        return {"stale": True}
    return report(service) if reply is None else reply
