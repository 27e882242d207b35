"""Is what is advised fair, in the order of what is shown, and called what it is?"""

from functools import cache
from math import asin, atan2, hypot

import numpy as np
import pytest
from cases import Given

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.play.session import Session

TABLES = 30
QUICK = {"samples": 60, "visits": 2}


@cache
def after_break_offs():
    """What the opponent finds after thin contacts with the end red, soft and hard, without a foul."""
    rng, found, seed = np.random.default_rng(5), [], 0
    while len(found) < TABLES:
        session, side, seed = Session(seed=seed), float(rng.choice([-1.0, 1.0])), seed + 1
        session.noise[:] = ["professional", "professional"]
        x, y = session.place(side * rng.uniform(0.05, 0.28), -1.0475)
        ex, ey = max(session.tables.positions[0, 1:16].tolist(), key=lambda red: side * red[0])
        thin = rng.uniform(0.3, 0.95) * side * asin(2 * 0.02625 / hypot(ex - x, ey - y))
        session.play(CueStroke(speed=rng.uniform(1.8, 4.5), aim=atan2(ey - y, ex - x) - thin))
        if session.frame.phase == "stroke" and session.frame.striker == 1:
            found.append(session.as_visit()[0])
    return found


@cache
def opened():
    tables = sn.SnookerVectorEnv(TABLES, layout="opened")
    tables.reset(seed=3)
    return list(sn.planning.Positions.of(tables))


def foul(one):
    """Whether a stroke is a foul when played as intended, or in most samples."""
    return one.kind in ("foul", "in-off") or one.foul > 0.5


@pytest.mark.parametrize("positions", [after_break_offs, opened])
@pytest.mark.parametrize(
    ("agent", "each"),
    [
        ("random", 2),
        ("ghost_ball", 2),
        ("planner_500", 10),
        pytest.param("search", 10, marks=pytest.mark.slow),
    ],
)
def test_advice_is_fair_ordered_by_what_it_shows_and_called_what_it_is(positions, agent, each):
    for seed, position in enumerate(positions()[::each]):
        advice = sn.advise(position, agent=agent, seed=seed, **QUICK)
        assert not any(map(foul, advice)), str(advice)
        pots, others = ([one for one in advice if (one.kind == "pot") is pot] for pot in (True, False))
        assert list(advice) in (pots + others, others + pots)
        assert [one.points for one in pots] == sorted((one.points for one in pots), reverse=True)
        assert [one.chance for one in others] == sorted((one.chance for one in others), reverse=True)
        for one in pots:
            assert one.pocket >= 0 and one.words.endswith(" expected")
            assert f"pot {100 * one.chance:.0f} %" in one.words
        for one in others:
            assert one.words.startswith({"contact": "contact with the ", "escape": "escape "}[one.kind])
            fair = f"fair {100 * one.chance:.0f} %; no pot intended, its worth as a safety is not judged"
            assert fair in one.words and "points" not in one.words


BLUE_FIRST, POT, AWAY = (CueStroke(speed=1.5, aim=aim) for aim in (0.0, np.pi / 2, -2.0))
COVERED = sn.Position(cue=(-0.84, 1.0), reds=[(-0.84, 1.4)], blue=(-0.4, 1.0), black=(0.0, 1.4605))


def test_fouls_are_left_out_and_others_judged_where_all_are_fouls():
    thin = CueStroke(speed=1.0, aim=np.pi / 2 + 0.12)
    advice = sn.advise(COVERED, agent=Given(BLUE_FIRST, thin, AWAY), **QUICK)
    assert advice.own and [one.stroke for one in advice] == [thin] and not foul(advice[0])
    advice = sn.advise(COVERED, agent=Given(BLUE_FIRST, AWAY), **QUICK)
    assert not advice.own and advice.agent == "given" and not any(map(foul, advice))
    assert advice.order.startswith("given has no fair stroke here; these strokes are not its own. ")
    assert str(advice).startswith(advice.order)
    assert advice.to_dict()["own"] is False


def test_where_no_fair_stroke_is_found_the_least_bad_is_said_to_be_that():
    """The cue ball among colours: whatever it strikes first is not on."""
    around = [(0.06 * np.cos(turn), 0.06 * np.sin(turn)) for turn in np.linspace(0.3, 0.3 + 2 * np.pi, 7)[:6]]
    names = ("yellow", "green", "brown", "blue", "pink", "black")
    caged = sn.Position(cue=(0.0, 0.0), reds=[(0.5, 1.2)], **dict(zip(names, around, strict=True)))
    for agent in ("planner_500", "random", Given(AWAY)):
        advice = sn.advise(caged, agent=agent, **QUICK)
        assert len(advice) == 1 and foul(advice[0])
        assert advice[0].words.startswith(f"no fair stroke found: {advice[0].kind}")
        assert f"fair {100 * advice[0].chance:.0f} %" in advice[0].words


def test_a_pot_that_hardly_ever_goes_is_never_suggested():
    """A red that is potted 2 times of 100; another stroke is fair nearly always, and wins more often."""
    far = sn.Position(cue=(0.3, -1.3), reds=[(0.1, -0.4)], black=(0.0, 1.4605), on="red")
    pot = CueStroke(speed=3.924964665354218, aim=1.7396937343372483, top=0.17307945551583545)
    safe = CueStroke(speed=0.9, aim=atan2(0.9, -0.2) + 0.01)
    for scores, kind in ((None, "contact"), ((0, 0), "safety")):
        how = {"noise": {"aim_deg": 1.5}, "scores": scores, **QUICK}
        instead = sn.advise(far, agent=Given(pot), **how)
        assert not instead.own and all(one.kind != "pot" or one.chance >= 0.05 for one in instead)
        assert [one.kind for one in sn.advise(far, agent=Given(pot, safe), **how)] == [kind]
