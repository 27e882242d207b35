"""How is a whole game passed on? As text: its first table, and one large number, whose digits have the base of what the rules
allow there: what was asked for, and of each ball that a stroke moved the place modulo ``NEAR`` steps. A machine whose last bits
fall otherwise takes that place, within 0.25 mm of its own; a check of all places and scores shows larger differences."""

import json
import re
import zlib
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any, TypeVar

from .. import __version__
from .._lib.check import integer, refuse, refuse_what
from .._lib.files import strict_json
from ..advice import CueStroke
from ..game.balls import CUE
from ..game.frame import Frame
from ..replays.chances import Standing
from ..simulation import SimulationError
from ..tasks.noise import LEVELS
from ..tasks.options import CUES
from .session import HIGH, LOW, STEP, Act, Session, list_moved, nominable, numbers_of, steps_of, stroke_of

T = TypeVar("T")
FORM = 1  # of a link
LONGEST = 30_000  # link [characters]
NEAR = 2**10  # steps of the grid
HEAD, TABLE, TAIL = 15, 2, 4  # bytes: of ``_head_of``, of the length of the first table, of the sum
CHECK, BED, MOST_ACTS, MOST_TABLE = 2**16, 2**22, 2**12, 10_000
"""Bases of a check, of a place's steps from the middle, of the acts; largest first table [characters]."""
STROKE, SETTING = ("speed", "aim", "side", "top", "elevation"), ("noise", "practice", "cue")
"""Fields of a stroke that was asked for."""


class Digits:
    """A large number that is written, from values, or read, which gives the values."""

    def __init__(self, number: int | None = None):
        self.reads: bool = number is not None
        self.number: int = number or 0
        self.base: int = 1

    def within(self, low: int, high: int, value: int = 0) -> int:
        base = high - low + 1
        if self.reads:
            self.number, digit = divmod(self.number, base)
            return low + digit
        assert low <= value <= high
        self.number, self.base = self.number + (value - low) * self.base, self.base * base
        return value

    def one_of(self, values: Sequence[T], value: T | None = None) -> T:
        known = 0 if value is None or self.reads else values.index(value)
        return values[self.within(0, len(values) - 1, known)]


def write_link(session: Session) -> str:
    """The game from its last new table on, in letters of base64url."""
    acts, digits = session.acts[: session.at], Digits()
    acts = acts[max(k for k, act in enumerate(acts) if not act.asked) :]
    integer("acts", len(acts), 1, MOST_ACTS)
    key, counter = acts[0].state["stream"]
    first = session.save() | {"state": acts[0].state | {"stream": [0, counter]}}
    digits.within(0, MOST_ACTS - 1, len(acts) - 1)
    for before, act in pairwise(acts):
        _code_act(digits, before.standing.frame, first, act.asked)
        if act.what == "stroke":
            _code_rest(digits, before, act.standing)
    pack = zlib.compressobj(9, wbits=-15, zdict=_usual())
    table = pack.compress(json.dumps(first).encode()) + pack.flush()
    number = digits.number.to_bytes((digits.base.bit_length() + 7) // 8, "little")
    whole = _head_of(session, key) + len(table).to_bytes(TABLE, "big") + table + number
    return urlsafe_b64encode(whole + zlib.crc32(whole).to_bytes(TAIL, "big")).decode().rstrip("=")


def open_link(session: Session, link: object, shared: Sequence[Act] | None = None) -> None:
    """Play a result of ``write_link`` again; ValueError, which names the stroke, if it comes out otherwise here. ``shared``: in
    a game by link, what was played of it here; then nobody may have changed errors or cue on the way, or practised."""
    (first, digits), agreed = _read_link(session, link), shared is not None
    with session.as_a_whole():
        session.load(first)
        if agreed and session.practice:
            raise refuse("practice", True, "must be False in a game by link")
        if agreed and (session.state["strokes"] or any(session.frame.scores)):
            raise refuse("scores", list(session.frame.scores), "must be 0 at the beginning of a game by link")
        for _ in range(digits.within(0, MOST_ACTS - 1)):
            number = len(session.strokes) + 1
            try:
                asked = _code_act(digits, session.frame, first, {})
                if agreed and _setting(asked, first, session.frame) != _setting({}, first, session.frame):
                    raise refuse("noise", asked["noise"], "must stay as at the beginning, as must the cue")
                _do(session, digits, asked)
            except (ValueError, SimulationError) as error:
                raise ValueError(f"link, stroke {number}: {error}") from None
        if digits.number:
            raise refuse_what("link", "more after its last act", "must end with it")
        session.noise, session.practice, session.cue = list(first["noise"]), first["practice"], first["cue"]
        if shared and shared[0].state["stream"][0] == first["state"]["stream"][0]:  # the same game
            both = shared, session.acts[: len(shared)]
            here, there = ([acts[0].state, *(act.asked for act in acts)] for acts in both)
            if here != there:
                allowed = "must begin with what was played of it here"
                raise refuse_what("link", "an older or different game", allowed)


def _code_act(digits: Digits, frame: Frame, first: dict[str, Any], asked: dict[str, Any]) -> dict[str, Any]:
    """An act as ``Act.asked`` has it, written, or read where nothing is asked; without the places of rest."""
    if frame.phase == "choice":
        decision = digits.one_of([*frame.choices, "concede"], asked.get("choice", "concede"))
        return {"declare": decision} if decision == "concede" else {"choice": decision}
    kind = digits.one_of(("stroke", "concede", "claim"), asked.get("declare", "stroke"))
    if kind != "stroke":
        return {"declare": kind}
    values = numbers_of(CueStroke.of({name: asked[name] for name in STROKE})) if asked else LOW
    numbers = [digits.within(*one) for one in zip(LOW, HIGH[:4], values, strict=False)]
    tilts = digits.within(0, 1, int(values[4] > 0))
    stroke = stroke_of([*numbers, digits.within(0, HIGH[4], values[4]) if tilts else 0])
    place = steps_of(asked.get("place") or [0.0, 0.0]).tolist() if frame.in_hand else []
    place = [digits.within(-BED, BED, step) * STEP for step in place] or None
    nominated = digits.one_of(nominable(frame), asked.get("nominate"))
    setting = _setting(asked, first, frame)
    if digits.within(0, 1, int(setting != _setting({}, first, frame))):
        settings = list(LEVELS), (False, True), CUES
        setting = [digits.one_of(*one) for one in zip(settings, setting, strict=True)]
    told = dict(zip(SETTING, setting, strict=True))
    return {**stroke.to_dict(), **told, "place": place, "nominate": nominated}


def _setting(asked: dict[str, Any], first: dict[str, Any], frame: Frame) -> tuple[Any, ...]:
    """Errors, practice and cue of a stroke; by default those of the end of the game."""
    usual = {"noise": first["noise"][frame.striker], "practice": first["practice"], "cue": first["cue"]}
    return tuple((usual | asked)[name] for name in SETTING)


def _do(session: Session, digits: Digits, asked: dict[str, Any]) -> None:
    """Do what was asked for; after a stroke, the balls come to rest where the link says it."""
    if "choice" in asked:
        session.choose(asked["choice"])
    elif "declare" in asked:
        getattr(session, asked["declare"])()
    else:
        noise, session.practice, session.cue = (asked[name] for name in SETTING)
        session.noise[session.frame.striker] = noise
        if (place := asked["place"]) is not None and session.place(*place) != place:
            raise refuse("place", place, "must be free for the cue ball in hand")
        stroke = CueStroke.of({name: asked[name] for name in STROKE})
        played, tables = session.play(stroke, nominated=asked["nominate"]), session.tables
        rest = Standing(session.frame, tables.positions[0], tables.on_table[0])
        if not _code_rest(digits, session.acts[-2], rest) or not session.is_sound():
            allowed = "must be as in the link: another processor differs, or the link was changed"
            raise refuse_what("what it leaves", "other places or scores here", allowed)
        session.acts[-1] = replace(played, state=session.state)


def _code_rest(digits: Digits, before: Act, rest: Standing) -> bool:
    """Where the balls that moved came to rest, written, or read and taken; whether the check of places and scores is theirs."""
    for ball in list_moved(before.state["positions"], rest):
        for axis, here in enumerate(steps_of(rest.positions[ball]).tolist()):
            shift = (digits.within(0, NEAR - 1, here % NEAR) - here + NEAR // 2) % NEAR - NEAR // 2
            rest.positions[ball, axis] = (here + shift) * STEP
    frame = rest.frame
    there = [i for i, on in enumerate(rest.on_table) if on and (i != CUE or not frame.in_hand)]
    places = [(i, *steps_of(rest.positions[i]).tolist()) for i in there]
    said = frame.scores, frame.striker, frame.phase, int(frame.ball_on), frame.free_ball, frame.miss_called
    check = zlib.crc32(repr((places, said)).encode()) % CHECK
    return digits.within(0, CHECK - 1, check) == check


@cache
def _usual() -> bytes:
    """A first table that others are written after the model of."""
    usual = Session().save()
    return json.dumps(usual | {"state": usual["state"] | {"stream": [0, 0]}}).encode()


def _head_of(session: Session, key: int) -> bytes:
    """The form, the version, a sum of the constants that are played with, and the key of the random stream."""
    rules = session.options_with("none").rules
    table, constants = rules.table, rules.physics.pack().tolist()
    lines = [part.tolist() for part in (table.noses, table.jaws, table.falls)]
    told = repr((constants, lines, rules.fidelity, LEVELS))
    version = bytes(int(part) for part in re.findall(r"\d+", __version__)[:3])
    return bytes([FORM]) + version + zlib.crc32(told.encode()).to_bytes(4, "big")[1:] + key.to_bytes(8, "big")


def _read_link(session: Session, link: object) -> tuple[dict[str, Any], Digits]:
    """The first table, as saved, and the number of a link that is whole, of this version and of the constants here."""
    if not isinstance(link, str) or len(link) > LONGEST:
        what = f"{len(link)} characters" if isinstance(link, str) else f"a {type(link).__name__}"
        raise refuse_what("link", what, f"must be a text of at most {LONGEST} characters")
    form = link.isascii() and re.fullmatch(r"[\w-]*", link) and len(link) % 4 != 1
    raw = urlsafe_b64decode(link + "=" * (-len(link) % 4)) if form else b""
    whole, rest = raw[:-TAIL], raw[HEAD + TABLE : -TAIL]
    same = urlsafe_b64encode(raw).decode().rstrip("=") == link
    if len(whole) < HEAD + TABLE or not same or zlib.crc32(whole) != int.from_bytes(raw[-TAIL:], "big"):
        allowed = "must be whole: this one is damaged, copy it again"
        raise refuse_what("link", f"{len(link)} characters", allowed)
    key = int.from_bytes(whole[7:HEAD], "big")
    own, length = _head_of(session, key), int.from_bytes(whole[HEAD : HEAD + TABLE], "big")
    if whole[:4] != own[:4]:
        allowed = f"must be {__version__}, as here: both players need the same version of snooker_env"
        raise refuse("version", ".".join(map(str, whole[1:4])), allowed)
    if whole[:HEAD] != own:
        raise refuse_what("physics", "other constants", "must be as here: do both use --flight?")
    unpack = zlib.decompressobj(wbits=-15, zdict=_usual())
    try:
        first = strict_json(unpack.decompress(rest[:length], MOST_TABLE))
        first["state"]["stream"][0] = key
        if not unpack.eof or unpack.unused_data:
            raise ValueError
    except (zlib.error, ValueError, LookupError, TypeError):
        raise refuse_what("link", "no table at its beginning", "must begin with one") from None
    return first, Digits(int.from_bytes(rest[length:], "little"))
