"""Which requests does the server answer, and how? ``docs/play/protocol.md`` describes every route.

A handler takes the checked fields of a request and returns JSON types; a ValueError names an invalid field."""

import re
from collections.abc import Callable
from functools import partial
from math import atan2
from typing import Any, NamedTuple, cast

import numpy as np

from .._lib.check import choice, integer, number, refuse, truth
from .._lib.types import CueKind
from ..advice import CueStroke, Suggestion, advise, coach, destinations
from ..advice.review import SAMPLES, read_frame
from ..game.balls import CUE, NAMES
from ..game.fouls import AUTO
from ..game.frame import CHOICES
from ..geometry import POCKETS
from ..physics.engine import EventKind
from ..planning.position import Position
from ..players.cue_stroke import STROKE, read_colour, read_place, read_stroke
from ..render.scene import trace_paths
from ..replays import Replay
from ..replays.encode import pack
from ..simulation.shot import Shot
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from ..tasks.states import MOST
from .link import check_course, open_link, write_link
from .report import MOST_SAMPLES, MOST_SUGGESTIONS, report, scene, stroke_report, table_after
from .service import LINKED, Reviewing, Service, StaleError
from .session import Session, read_levels

Handler = Callable[[Service, dict[str, Any]], Any]


class Route(NamedTuple):
    """What answers a route, with JSON types or a ``str``, an HTML page; and the fields a request may have."""

    handler: Handler
    fields: tuple[str, ...] = ()
    friend: bool = False  # whether not the host alone may post it, but a friend, too


def _state(service: Service, fields: dict[str, Any]) -> None:
    if "after" in fields:
        after, seconds = fields["after"], number("wait", fields.get("wait", 0.0), 0.0, 60.0)
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
    strikes = any(name in fields for name in STROKE)
    if not strikes and "choice" not in fields:
        raise refuse("speed", None, 'must be given, with "aim" or "aim_at"; or "choice" after a foul')
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
    with service.reading():
        return {"stroke": struck, "state": report(service)}


def _place(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.acting() as session:
        place = list(session.place(*read_place("place", fields.get("place"))))
    with service.reading():
        return {"place": place, "state": report(service)}


def _set_up(service: Service, fields: dict[str, Any]) -> dict[str, Any] | None:
    check, scores = truth("check", fields.get("check", False)), fields.get("scores", [0, 0])
    try:
        if not isinstance(scores, list) or len(scores) != 2:
            raise refuse("scores", scores, "must be two integers")
        one, other = (integer(f"scores[{k}]", score, 0, MOST) for k, score in enumerate(scores))
        striker = integer("striker", fields.get("striker", 0), 0, 1)
        free = truth("free_ball", fields.get("free_ball", False))
        position = position_of(fields.get("position"))
        with service.asking() if check else service.acting(pause=True, any_turn=True) as session:
            session.set_up(position, scores=(one, other), striker=striker, free_ball=free)
    except ValueError as error:
        if not check:
            raise
        return {"sound": False, "error": parts_of(error)}
    return {"sound": True, "error": None} if check else None


def position_of(fields: Any) -> Position:
    """The ``Position`` of JSON types; ValueError names the ball or the field that is invalid."""
    position = Position.from_dict(fields)
    if position.over:
        raise refuse("over", True, "must be false: there is no stroke to play")
    return position


def _move(service: Service, fields: dict[str, Any], move: Callable[[Session], bool]) -> None:
    """Undo or redo until a person has a stroke or decision to make."""
    with service.acting(pause=True, any_turn=True) as session:
        people, before = not all(map(service.seats.is_agent, (0, 1))), session.at
        while move(session) and people and service.agent_to_play():
            pass
        session.undone += session.at < before


def _new(service: Service, fields: dict[str, Any]) -> None:
    by_link, follows = (truth(name, fields.pop(name, False)) for name in ("by_link", "next"))
    if not isinstance(fields.get("layout", ""), str):
        raise refuse("layout", fields["layout"], "must be the name of a layout")
    if by_link and (follows or fields.get("best_of", 1) != 1):
        raise refuse("by_link", True, "must be left out in a match: a link holds one frame")
    with service.acting(anew=True) as session:
        noise = list(session.noise)
        if follows:
            for name in set(fields) - {"seed"}:
                raise refuse(name, fields[name], "must be left out with next: the match goes on as it is")
            session.next_frame(**fields)
        else:
            session.new(**fields)
        if by_link:
            session.noise[1], session.practice = session.noise[0], False
            service.seats.share(0, noise)
        elif (before := service.seats.share_no_more()) is not None:
            session.noise[:] = before


def _players(service: Service, fields: dict[str, Any]) -> None:
    noise = read_levels("noise", fields["noise"]) if "noise" in fields else None
    practice = truth("practice", fields["practice"]) if "practice" in fields else None
    cue = choice("cue", fields["cue"], CUES) if "cue" in fields else None
    with service.acting(any_turn=True, anew="players" in fields) as session:
        if "players" in fields:
            seats, own = service.seats, service.seats.errors_of_host(session)
            agents = [seats.is_agent(k) for k in (0, 1)]
            seats.sit(fields["players"])
            service.vacant = False
            for k in (0, 1):  # a person does not take over the errors of an agent
                mine = own if agents[k] and not seats.is_agent(k) else session.noise[k]
                session.noise[k] = seats.usual_noise(k, mine)
        if noise is not None:
            session.noise[:] = noise
        session.practice = session.practice if practice is None else practice
        session.cue = cast(CueKind, cue) or session.cue


def _concede(service: Service, fields: dict[str, Any]) -> None:
    with service.acting() as session:
        session.concede()


def _pass_on(service: Service, fields: dict[str, Any], form: Callable[[Session], Any]) -> Any:
    with service.reading() as session:
        return form(session)


def _load(service: Service, fields: dict[str, Any]) -> None:
    seat, by_link = fields.get("seat"), "seat" in fields
    if seat is not None:
        integer("seat", seat, 0, 1)
    if by_link and "link" not in fields:
        raise refuse("seat", seat, "must be left out without a link")
    with service.acting(pause=True, anew=True) as session:
        noise, played = list(session.noise), session.acts[: session.at] if LINKED in service.seats.who else []
        if "link" not in fields:
            session.load(fields.get("saved"))
        else:
            open_link(session, fields["link"], agreed=by_link)
        if not by_link:
            service.seats.share_no_more()
            return
        check_course(played, session.acts)
        if seat is None:  # who opens it is not who played last
            last, frame = session.acts[-1].player, session.frame
            seat = frame.striker if frame.phase != "over" or last is None else 1 - last
        service.seats.share(seat, noise)


def _advise(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    n, seats = integer("n", fields.get("n", 5), 1, MOST_SUGGESTIONS), service.seats
    with service.asking(_revision(fields)) as session:
        agent = choice("agent", fields.get("agent", seats.advisers(session.practice)[0]), seats.players)
        errors = _errors(fields, 200, seats.level(session))
        session.noise[:] = [errors["noise"]] * 2  # the question's own: nothing is played
        answer: dict[str, Any] = {"choice": None, "choices": []}
        if session.frame.phase == "choice":
            answer["choice"] = CHOICES[int(seats.decide(agent, session).decision[0])]
            wins, choices = service.choice_chances(session, errors["noise"]), session.frame.choices
            answer["choices"] = [{"choice": x, "win": win} for x, win in zip(choices, wins, strict=True)]
            session.choose("play")  # the strokes are those of a player who plays the table as it lies
        at = session.as_visit() if session.practice else session.position  # alone at the table nobody wins
        advice = advise(at, agent=seats.players[agent], n=n, options=session.options, **errors)
        answer |= {"agent": agent, "order": advice.order, "noise": advice.noise}
        answer["suggestions"] = [_draw_suggestion(session, one) for one in advice]
    with service.reading() as now:
        seat = session.frame.striker
        shown = now.begun == session.begun and _revision(fields) in (None, service.revision)
        if shown and not now.practice and seats.who[seat] == service.me:
            now.hints[seat] += 1
    return answer


def _draw_suggestion(session: Session, one: Suggestion) -> dict[str, Any]:
    """A suggestion in words, data and paths."""
    names = {"pocket": POCKETS[one.pocket] if one.pocket >= 0 else None}
    names |= {key: NAMES[k] if k >= 0 else None for key, k in (("ball", one.ball), ("first", one.first))}
    return one.to_dict() | names | _draw(session, one.stroke)


def _play_exactly(session: Session, stroke: CueStroke) -> Shot:
    """The stroke without execution errors, on a copy of the table."""
    twin = session.twin()
    twin.noise = ["none", "none"]
    if stroke.place is not None:
        twin.place(*stroke.place)
    played = twin.play(stroke).played
    assert played is not None
    return played.shot


def _hits(shot: Shot) -> Any:
    """The events in which the cue ball met a ball."""
    return shot.events[(shot.events["kind"] == EventKind.BALL_BALL) & (shot.events["i"] == CUE)]


def _draw(session: Session, stroke: CueStroke) -> dict[str, Any]:
    return _paths(_play_exactly(session, stroke))


def _paths(shot: Shot) -> dict[str, Any]:
    """Paths of a shot's balls [m], rounded to 0.1 mm; the ball struck first, the pots and the duration."""
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
        return _draw(session, stroke) | vars(stops) | places


def _room(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    with service.reading(_revision(fields)) as session:  # at once: it does not wait for long questions
        twin = session.twin()
    stroke = take_stroke(twin, fields)
    room = twin.room(stroke).to_dict()
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


def _replay(service: Service, fields: dict[str, Any], form: Callable[[Replay], Any]) -> Any:
    with service.reading() as session:
        strokes = [played for k in session.strokes if (played := session.acts[k].played) is not None]
        labels, judge = service.labels, service.judge()
        luck = session.luck if judge is not None and any(session.luck) else None
    if not strokes:
        raise refuse("strokes", 0, "must be at least one: nothing has been played yet")
    title = f"{labels[0]} - {labels[1]}"
    return form(Replay(strokes, title=title, players=labels, judge=judge, luck=luck))


def _review(service: Service, fields: dict[str, Any]) -> dict[str, Any]:
    """Begin a review of what was played, or stop the one that is being made."""
    with service.reading() as session:
        if service.reviewing:
            service.reviewing.running = False
        if not truth("stop", fields.get("stop", False)):
            if session.practice:
                raise refuse("practice", True, "must be false: alone at the table nobody wins")
            advisers = service.seats.advisers(practice=False)
            agent = service.seats.players[choice("agent", fields.get("agent", advisers[0]), advisers)]
            people = [seat for seat in (0, 1) if not service.seats.is_agent(seat)] or (0, 1)
            frame = read_frame(_replay(service, {}, Replay.to_dict))
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
        session.go_to(reviewing.acts, k)
        played, best = _paths(act.played.shot), _draw(session, one.best.stroke)
        best["paths"] = {k: best["paths"][k] for k in map(str, (CUE, one.best.ball)) if k in best["paths"]}
        return {"played": played, "best": best} | {"table": table_after(before, service.labels, chance)}


def _again(service: Service, fields: dict[str, Any]) -> None:
    with service.acting(pause=True, any_turn=True) as session:
        reviewing = service.own_review()
        session.go_to(reviewing.acts, reviewing.act_of(fields.get("stroke"))[0])
        session.undone += 1


ERRORS = ("noise", "samples", "seed", "revision")
GET: dict[str, Route] = {
    "scene": Route(lambda service, fields: scene(service)),
    "state": Route(_state, ("after", "wait")),
    "strokes": Route(_strokes, ("from",)),
    "replay": Route(partial(_replay, form=Replay.to_dict)),
    "replay.html": Route(partial(_replay, form=Replay.html)),
}
POST: dict[str, Route] = {
    "stroke": Route(_stroke, (*STROKE, "choice", "nominate", "revision"), True),
    "person": Route(_person, ("name", "delete")),
    "coach": Route(_coach),
    "place": Route(_place, ("place",), True),
    "advise": Route(_advise, ("agent", "n", *ERRORS), True),
    "destinations": Route(_destinations, (*STROKE, *ERRORS), True),
    "room": Route(_room, (*STROKE, "revision"), True),
    "position": Route(_set_up, ("position", "scores", "striker", "free_ball", "check")),
    "undo": Route(partial(_move, move=Session.undo)),
    "redo": Route(partial(_move, move=Session.redo)),
    "new": Route(_new, ("layout", "seed", "breaker", "game", "best_of", "next", "by_link")),
    "players": Route(_players, ("players", "noise", "practice", "cue")),
    "go": Route(lambda service, fields: service.go_on()),
    "concede": Route(_concede, friend=True),
    "sit": Route(lambda service, fields: service.sit_down(), friend=True),
    # both hold the random stream: the host's alone
    "link": Route(partial(_pass_on, form=lambda session: {"link": write_link(session)})),
    "save": Route(partial(_pass_on, form=Session.save)),
    "load": Route(_load, ("saved", "link", "seat")),
    "review": Route(_review, ("agent", "stop", *ERRORS[:3])),
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
        reply = route.handler(service, fields)
    except StaleError:
        return {"stale": True}
    if reply is not None:
        return reply
    with service.reading():
        return report(service)
