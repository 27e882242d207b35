"""Which safeties would a coach play? Twenty positions by hand in which no pot is likely, and what a coach would accept of
the stroke that is advised there, as shares of simulated outcomes.

``python tests/advice/coach.py [AGENT]`` prints what is advised, by the tactician if nobody is named, and what of that is as
a coach wants it."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

import snooker_env as sn
from snooker_env.advice.practice import arrive, find_arrivals, keys, one_position, practice_of, start_from
from snooker_env.geometry import BAULK_Y
from snooker_env.planning import clear_paths, prospects_of
from snooker_env.tasks import LEVELS

OPTIONS = {"cue": "real", "miss": "clear_path"}
NOISE = "professional"
SEEDS, SAMPLES, PURPOSE = range(5), 200, 77  # the samples are none that advice or its search has met
LIKELY = 0.75
"""Chance of a pot, by its width, from which he would take it on."""
FAR = 1.2  # from here on [m] the nearest ball on is far away

RACK = tuple(
    (0.0525 * (i - row / 2), 0.9452 + 0.04547 * row) for row in range(5) for i in range(row + 1)
)  # reds 1 to 15; 11 and 15 are the ends of the last row
_ASIDE = (0, 1, -1, -1, 0, 1, 1, -1, 0, 1, 0, -1, 1, 1, -1)
PACK = tuple(
    (1.2 * x + 0.003 * aside, 0.9452 + 1.2 * (y - 0.9452) + 0.002 * ((7 * k) % 3 - 1))
    for k, ((x, y), aside) in enumerate(zip(RACK, _ASIDE, strict=True))
)
"""The same with gaps of a centimetre, as after a few thin contacts."""
SIDE, END = 0.8627, 1.7582  # frozen to a cushion
SPOTS = {
    "yellow": (0.292, -1.0475),
    "green": (-0.292, -1.0475),
    "brown": (0.0, -1.0475),
    "blue": (0.0, 0.0),
    "pink": (0.0, 0.89),
    "black": (0.0, 1.4605),
}
REDS = tuple(range(1, 16))


class Case(NamedTuple):
    """A position of a frame, and what a coach wants: ``first``, the balls to be struck first, () if that does not matter;
    ``most`` and ``least``, bounds of shares (``Measured``)."""

    coach: str
    position: sn.Position
    scores: tuple[int, int] = (0, 0)
    first: Sequence[int] = REDS
    most: Mapping[str, float] = MappingProxyType({})
    least: Mapping[str, float] = MappingProxyType({})


def at(cue, reds=(), *, without=(), on=None, **moved):
    """A position with colours on their spots, apart from those moved or left out."""
    colours = {name: place for name, place in (SPOTS | moved).items() if name not in without}
    return sn.Position(cue=cue, reds=reds, on=on, **colours)


SAFE = {"pot": 0.2, "foul": 0.05, "likely": 0.15}
CASES = {
    "break_off": Case(
        "thin on the end red, round off three cushions, back to baulk",
        sn.Position(in_hand=True, reds=RACK, **SPOTS),
        first=(7, 10, 11, 15),
        most=SAFE,
        least={"baulk": 0.8},
    ),
    "thin_from_the_green_side": Case(
        "thin off the end red on his side and back to baulk: the pack stays shut",
        at((-0.45, -1.70), PACK),
        first=(7, 11),
        most=SAFE,
        least={"baulk": 0.7},
    ),
    "thin_from_the_yellow_side": Case(
        "the same from the other side",
        at((0.55, -1.45), PACK),
        first=(10, 15),
        most=SAFE,
        least={"baulk": 0.7},
    ),
    "frozen_to_the_baulk_cushion": Case(
        "from under the cushion nothing fancy: a red thin, and the cue ball back to baulk",
        at((0.0, -END), (*PACK[:10], (-SIDE, 1.0), (SIDE, 0.4), (0.3, END))),
        scores=(12, 8),
        most=SAFE | {"foul": 0.1, "likely": 0.2},
        least={"baulk": 0.5},
    ),
    "from_the_top_cushion": Case(
        "clip a red at the edge of the pack and run the length of the table to baulk",
        at((-0.5, 1.70), PACK[3:]),
        scores=(8, 1),
        most=SAFE,
        least={"baulk": 0.6},
    ),
    "behind_the_pack": Case(
        "into the pack, or past it down the table: he must not see a red that goes",
        at((0.04, 1.70), PACK[:10]),
        scores=(0, 16),
        most=SAFE,
    ),
    "touching_the_pack": Case(
        "touching ball: play away from it, down to baulk",
        at((PACK[14][0] + 0.05251, PACK[14][1]), PACK),
        first=(),
        most=SAFE | {"foul": 0.03},
        least={"baulk": 0.7},
    ),
    "from_the_corner_of_baulk": Case(
        "a thin contact with the pack and back: not a thick one that opens it",
        at((0.80, -1.70), (*PACK[3:10], (-0.75, 0.25))),
        scores=(15, 20),
        most=SAFE,
        least={"baulk": 0.6},
    ),
    "roll_up_to_the_brown": Case(
        "no colour goes: roll up tight behind the brown, he is snookered on all reds",
        at((0.02, -1.74), PACK[5:], yellow=(0.45, END), green=(-0.45, END), on="any_colour"),
        scores=(1, 0),
        first=(18,),
        most=SAFE | {"likely": 0.05},
        least={"hidden": 0.8},
    ),
    "roll_up_to_the_green": Case(
        "the same behind the green",
        at(
            (-0.32, -1.72),
            (*PACK[5:8], (-0.6, -0.5)),
            yellow=(SIDE, -0.6),
            brown=(SIDE, -0.35),
            on="any_colour",
        ),
        scores=(22, 30),
        first=(17,),
        most=SAFE | {"foul": 0.1, "likely": 0.1},
        least={"hidden": 0.6},
    ),
    "snookered_behind_the_brown": Case(
        "off a side cushion, at the pace that leaves nothing if it hits",
        at((0.0, -1.30), PACK[:6]),
        scores=(20, 20),
        most={"pot": 0.2, "foul": 0.25, "likely": 0.25},
    ),
    "snookered_behind_the_black": Case(
        "off the cushions down to the reds in baulk",
        at((0.0, 1.525), ((-0.1, -1.35), (0.15, -1.5), (0.3, -1.65))),
        scores=(35, 28),
        most={"pot": 0.2, "foul": 0.25, "likely": 0.3},
    ),
    "last_red_on_the_top_cushion": Case(
        "leave the red where it is, the cue ball goes back to baulk",
        at((0.4, -1.2), ((-0.2, END),)),
        scores=(40, 44),
        most=SAFE | {"foul": 0.1},
        least={"baulk": 0.6},
    ),
    "last_red_on_a_side_cushion": Case(
        "the red stays at its cushion, the cue ball far away or behind a colour",
        at((-0.7, 0.3), ((SIDE, 0.3),)),
        scores=(44, 40),
        most=SAFE,
        least={"safe": 0.6},
    ),
    "two_reds_and_a_lead": Case(
        "35 in front with 43 left: no risk, back to baulk",
        at((0.0, -1.4), ((-SIDE, 0.6), (0.3, END))),
        scores=(55, 20),
        most=SAFE | {"likely": 0.1},
        least={"baulk": 0.5},
    ),
    "reds_at_both_sides": Case(
        "no red goes: a soft contact that leaves it that way",
        at((0.0, -0.5), ((-SIDE, -0.4), (-SIDE, -0.3), (SIDE, 0.5), (SIDE, 0.6), (0.2, END))),
        scores=(30, 33),
        most=SAFE,
    ),
    "yellow_on_a_side_cushion": Case(
        "the yellow stays at the cushion, the cue ball far from it or behind a colour",
        at((0.3, -0.3), yellow=(-SIDE, 0.5)),
        scores=(48, 46),
        first=(16,),
        most=SAFE,
        least={"safe": 0.6},
    ),
    "needs_a_snooker": Case(
        "22 behind with 18 on the table: a pot does not help, lay a snooker",
        at((0.4, -0.4), without=("yellow", "green", "brown"), blue=(-SIDE, -0.5)),
        scores=(40, 62),
        first=(19,),
        most={"pot": 0.2, "foul": 0.05},
        least={"hidden": 0.2},
    ),
    "pink_on_a_side_cushion": Case(
        "pink at one end, cue ball at the other, or behind the black",
        at((0.5, 0.45), without=("yellow", "green", "brown", "blue"), pink=(-SIDE, 0.4)),
        scores=(50, 52),
        first=(20,),
        most=SAFE,
        least={"safe": 0.6},
    ),
    "black_on_the_baulk_cushion": Case(
        "the black stays in baulk, the cue ball goes up the table: distance",
        at((0.0, 0.5), without=("yellow", "green", "brown", "blue", "pink"), black=(0.1, -END)),
        scores=(60, 60),
        first=(21,),
        most=SAFE,
        least={"safe": 0.7},
    ),
}


UNLIKE = {
    "break_off": "four of five play a plant out of the rack that goes in 40 %: exact places make it what it is on no table",
    "thin_from_the_green_side": "three of five play a plant out of the pack",
    "thin_from_the_yellow_side": "foul 0.29 (wanted 0.05): so thin that the red is missed",
    "frozen_to_the_baulk_cushion": "foul 0.30, baulk 0.22: thin contacts with a raised cue, many of them missed",
    "from_the_top_cushion": "pot 1.00: it takes a pot of three in four on, where a coach would play safe",
    "roll_up_to_the_brown": "pot 0.60: three of five take the brown on, at 71 %; the others roll up behind it",
    "roll_up_to_the_green": "pot 1.00, hidden 0.01: it takes the green on, at 73 %",
    "snookered_behind_the_black": "foul 0.46 (wanted 0.25)",
    "last_red_on_the_top_cushion": "foul 0.28 (wanted 0.1): so thin that the red is missed",
    "two_reds_and_a_lead": "foul 0.11 (wanted 0.05), baulk 0.23 (wanted 0.5)",
}
"""Where the tactician's advice is not as a coach wants it: what was measured."""


class Measured(NamedTuple):
    """What the first strokes of advice, one for each seed, lead to: their words, the balls first struck without
    errors, and shares. Of the strokes: ``pot``, those that are pots. Of the samples: ``foul``; and, where the other
    comes: ``likely``, he has a likely pot; ``baulk``, the cue ball lies in baulk; ``hidden``, he has no straight path to
    a ball on; ``safe``, that or the nearest ball on is far away."""

    words: list[str]
    first: list[int]
    shares: dict[str, float]


def measured(case, seeds=SEEDS, samples=SAMPLES, visits=0, agent=None):
    """Ask for advice with each seed, and play its first stroke under fresh errors."""
    start = one_position(case.position, case.scores)
    practice = practice_of(NOISE, OPTIONS, of_frames=True)
    words, first, pots, rows = (
        [],
        [],
        [],
        {name: [] for name in ("foul", "likely", "baulk", "hidden", "safe")},
    )
    for seed in seeds:
        one, *_ = sn.advise(
            case.position,
            scores=case.scores,
            noise=NOISE,
            seed=seed,
            options=OPTIONS,
            visits=visits,
            agent=agent,
        )
        words.append(one.words)
        first.append(one.first)
        pots.append(one.kind == "pot")
        strokes = np.repeat(one.stroke.numbers()[None], samples, 0)
        begin = start_from(start, one.stroke)
        stops = practice.play(begin, np.zeros(samples, np.int64), strokes, keys(seed, PURPOSE, samples))
        theirs = arrive(stops.afterstates[find_arrivals(stops.afterstates)])
        cue, hidden = theirs.positions[:, 0], ~clear_paths(theirs)
        gaps = np.hypot(*(theirs.positions - cue[:, None]).transpose(2, 0, 1))
        far = np.where(theirs.balls_on, gaps, np.inf).min(axis=1) >= FAR
        chances = prospects_of(theirs, LEVELS[NOISE].spread(), rails=practice.options.rules.rails)[1]
        rows["foul"].append(stops.penalty > 0)
        rows["likely"].append(chances.max(axis=1) >= LIKELY)
        rows["baulk"].append(cue[:, 1] < BAULK_Y)
        rows["hidden"].append(hidden)
        rows["safe"].append(hidden | far)
    shares = {name: float(np.concatenate(each).mean()) for name, each in rows.items()}
    return Measured(words, first, {"pot": float(np.mean(pots)), **shares})


def unlike(case, found):
    """What of the outcome is not as a coach wants it, in words: [] if all is."""
    out = [
        f"{name} {found.shares[name]:.2f} > {most}"
        for name, most in case.most.items()
        if found.shares[name] > most
    ]
    out += [
        f"{name} {found.shares[name]:.2f} < {least}"
        for name, least in case.least.items()
        if found.shares[name] < least
    ]
    wrong = sum(ball not in case.first for ball in found.first) if case.first else 0
    return out + ([f"first struck {found.first}"] if 2 * wrong > len(found.first) else [])


if __name__ == "__main__":
    import sys

    for name, case in CASES.items():
        here = one_position(case.position, case.scores)
        on = prospects_of(here, LEVELS[NOISE].spread())[1].max()
        found = measured(case, visits=20, agent=sys.argv[1] if sys.argv[1:] else None)
        told = ", ".join(f"{key} {share:.2f}" for key, share in found.shares.items())
        print(f"{name}: likeliest pot {on:.2f}; {told}\n   {unlike(case, found) or 'as a coach wants it'}")
        for words in found.words:
            print(f"   {words}")
