"""What would a stroke do, and which ones would an agent play? Answered on copies of the table."""

from math import atan2
from typing import Any

import numpy as np

from ..advice import CueStroke, advise, destinations
from ..game.balls import CUE, NAMES
from ..game.frame import CHOICES
from ..geometry import POCKETS
from ..physics.engine import EventKind
from ..render.scene import trace_paths
from ..replays.encode import pack
from ..simulation.shot import Shot
from .service import Seats, Service
from .session import Session

MOST_SAMPLES = 2000  # largest number of samples in one question: 40 ms of computing
MOST_SUGGESTIONS = 10


def exact(session: Session, stroke: CueStroke) -> Shot:
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


def leaving(session: Session, stroke: CueStroke) -> dict[str, Any]:
    """Which ball the stroke strikes first without errors, and the direction in which it leaves [rad], throw included."""
    events = (shot := exact(session, stroke)).events
    hits = events[(events["kind"] == EventKind.BALL_BALL) & (events["i"] == CUE)][:1]
    heads = [
        atan2(*shot.at(at)[1][ball, 1::-1].tolist()) for at, ball in zip(hits["time"], hits["j"], strict=True)
    ]
    return {"first": NAMES[hits["j"][0]] if heads else None, "heads": heads[0] if heads else None}


def draw(session: Session, stroke: CueStroke) -> dict[str, Any]:
    """The paths of a stroke without errors from its own place."""
    twin = session.twin()
    if stroke.place is not None:
        twin.place(*stroke.place)
    return paths(exact(twin, stroke))


def scatter(session: Session, stroke: CueStroke, **errors: Any) -> dict[str, Any]:
    """Where cue ball and object ball stop with ``errors`` (noise, samples, seed), and the paths without them."""
    shot = exact(session, stroke)
    stops = destinations(session.as_visit(), stroke, **errors, options=session.options)
    figures = {
        name: getattr(stops, name) for name in ("samples", "potted", "in_off", "foul", "scored", "points")
    }
    return paths(shot) | figures | {"cue": pack(stops.cue, "f4"), "ball": pack(stops.ball, "f4")}


def decision(session: Session, service: Service, agent: str) -> dict[str, Any]:
    """What an agent would choose after the foul, and how likely the striker wins after each choice."""
    decided = service.seats.decide(agent, session)
    chances = service.choice_chances(session, session.noise[0])
    found = [{"choice": what, "win": win} for what, win in zip(session.frame.choices, chances, strict=True)]
    return {"choice": CHOICES[int(decided.decision[0])], "choices": found}


def suggestions(session: Session, seats: Seats, *, agent: str, n: int, **errors: Any) -> dict[str, Any]:
    """At most n strokes of the agent, in words, data and paths; their order."""
    at = session.as_visit() if session.practice else session.position  # alone at the table nobody wins
    advice = advise(at, agent=seats.players[agent], n=n, options=session.options, **errors)
    out = []
    for one in advice:
        names = {"pocket": POCKETS[one.pocket] if one.pocket >= 0 else None}
        names |= {key: NAMES[k] if k >= 0 else None for key, k in (("ball", one.ball), ("first", one.first))}
        out.append(one.to_dict() | names | draw(session, one.stroke))
    return {"agent": agent, "order": advice.order, "noise": advice.noise, "suggestions": out}
