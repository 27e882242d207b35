"""What would a stroke do, and which ones would an agent play? Answered on copies of the table."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..advice import CueStroke, Suggestion, advise, destinations
from ..game.balls import CUE, NAMES
from ..game.frame import CHOICES
from ..geometry import BAULK_Y, POCKETS
from ..physics.engine import EventKind
from ..render.scene import trace_paths
from ..replays.encode import pack
from ..simulation.shot import Shot
from .service import Seats, Service
from .session import Session

MOST_SAMPLES = 2000  # largest number of samples in one question: 40 ms of computing
MOST_SUGGESTIONS = 10
RIVALS = 2  # further strokes judged for each suggestion after the first: many are other ways of one pot


def exact(session: Session, stroke: CueStroke) -> Shot:
    """The stroke without execution errors."""
    twin = session.twin()
    twin.noise = ["none", "none"]
    played = twin.play(stroke).played
    assert played is not None
    return played.shot


def paths(shot: Shot) -> dict[str, Any]:
    """Paths of a shot's balls [m], rounded to 0.1 mm; the ball struck first, the pots and the duration."""
    events = shot.events
    hits = events[(events["kind"] == EventKind.BALL_BALL) & (events["i"] == CUE)]
    lines = trace_paths(shot, range(len(shot.positions)), step=0.04)
    return {
        "paths": {str(ball): np.round(points, 4).tolist() for ball, (points, _) in lines.items()},
        "first": NAMES[hits["j"][0]] if len(hits) else None,
        "pots": [[NAMES[ball], POCKETS[shot.potted[ball]]] for ball in np.flatnonzero(shot.potted >= 0)],
        "duration": shot.duration,
    }


def scatter(session: Session, stroke: CueStroke, **errors: Any) -> dict[str, Any]:
    """Where cue ball and object ball stop with ``errors`` (noise, samples, seed), and the paths without them."""
    shot = exact(session, stroke)
    stops = destinations(session.as_visit(), stroke, **errors, options={"cue": session.cue})
    figures = {
        name: getattr(stops, name) for name in ("samples", "potted", "in_off", "foul", "scored", "points")
    }
    return paths(shot) | figures | {"cue": pack(stops.cue, "f4"), "ball": pack(stops.ball, "f4")}


def decision(session: Session, service: Service, agent: str) -> dict[str, Any]:
    """What an agent would choose after the foul, and how likely the striker wins after each choice."""
    seat, found = session.frame.striker, []
    for what in session.frame.choices:
        (chance,) = service.win_chances([session.twin().choose(what)], session.noise[seat])
        win = chance if chance is None or seat == 0 else 1.0 - chance
        found.append({"choice": what, "win": win})
    decided = service.seats.decide(agent, session)
    return {"choice": CHOICES[int(decided.decision[0])], "choices": found}


def suggestions(session: Session, seats: Seats, *, agent: str, n: int, **errors: object) -> dict[str, Any]:
    """At most n strokes of the agent, the best of each ``_idea``, in words, data and paths; their order."""
    how = {**errors, "n": n + RIVALS * (n - 1), "options": {"cue": session.cue}}
    at = session.as_visit()
    if not session.practice:  # alone at the table nobody wins
        at, how["options"] = (
            session.position,
            {"cue": session.cue, "miss": session.miss, "game": session.game},
        )
    advice, best, out = advise(at, agent=seats.players[agent], **how), {}, []
    for one in advice:
        best.setdefault(_idea(one), one)
    advice = replace(advice, suggestions=tuple(best.values())[:n])
    for one in advice:
        twin = session.twin()
        if one.place is not None:
            twin.place(*one.place)
        names = {"pocket": POCKETS[one.pocket] if one.pocket >= 0 else None}
        names |= {key: NAMES[k] if k >= 0 else None for key, k in (("ball", one.ball), ("first", one.first))}
        out.append(one.to_dict() | names | paths(exact(twin, one.stroke)))
    return {"agent": agent, "order": advice.order, "noise": advice.noise, "suggestions": out}


def _idea(one: Suggestion) -> tuple[Any, ...]:
    """What ways of one stroke share: ball and pocket of a pot; else kind, red or colour, third of the table."""
    if one.kind == "pot":
        return one.ball, one.pocket
    third = None if one.stops is None else int(np.digitize(one.stops[1], (BAULK_Y, -BAULK_Y)))
    return one.kind, NAMES[one.ball].split()[0] if one.ball >= 0 else None, third
