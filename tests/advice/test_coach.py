"""Are the safeties that are advised those a coach would name? Twenty positions by hand (``coach``)."""

import numpy as np
import pytest
from cases import Given
from coach import CASES, LIKELY, NOISE, OPTIONS, SAFE, UNLIKE, Case, at, measured, unlike

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.advice.practice import one_position
from snooker_env.planning import prospects_of
from snooker_env.tasks import LEVELS

SEEN = {"seeds": (0,), "samples": 300}


@pytest.mark.slow
def test_there_are_twenty_and_no_pot_is_likely_in_any():
    assert len(CASES) == 20 and set(UNLIKE) <= set(CASES)
    for name, case in CASES.items():
        here = one_position(case.position, case.scores)
        chances = prospects_of(here, LEVELS[NOISE].spread())[1]
        assert chances.max() < LIKELY, name
        assert case.coach and case.most and set(case.first) <= set(range(1, 22))
        hidden = not sn.planning.clear_paths(case.position)[0]
        assert hidden == name.startswith("snookered"), name
        assert sn.advise(
            case.position, scores=case.scores, options=OPTIONS, agent="stroke_value", n=1, samples=1, visits=0
        )


def test_a_rolled_up_ball_is_as_a_coach_wants_it_and_an_opened_pack_is_not():
    """The measures by strokes whose outcome is plain: they tell good from bad."""
    near = Case(
        "roll up",
        at((0.0, -1.3), [(0.02, 1.2)], on="any_colour"),
        first=(18,),
        most=SAFE,
        least={"hidden": 0.9},
    )
    soft, hard = (Given(CueStroke(speed=speed, aim=np.pi / 2)) for speed in (0.36, 3.0))
    good, bad = (measured(near, agent=agent, **SEEN) for agent in (soft, hard))
    assert unlike(near, good) == [] and good.first == [18] and good.shares["baulk"] == 1.0
    assert good.shares["hidden"] > 0.95 and good.shares["safe"] >= good.shares["hidden"]
    assert any(said.startswith("hidden ") for said in unlike(near, bad))
    assert unlike(near._replace(first=(19,)), good) == ["first struck [18]"]
    opened = CASES["break_off"]
    smash = measured(opened, agent=Given(CueStroke(speed=6.5, aim=1.6183, place=(0.18, -1.0475))), **SEEN)
    assert smash.first == [6] and "first struck [6]" in unlike(opened, smash)
    alone = Case("nothing to hide behind", sn.Position(cue=(0.0, 0.4), black=(0.0, 1.0)), most=SAFE)
    left = measured(alone, agent=Given(CueStroke(speed=0.7, aim=np.pi / 2)), **SEEN)
    assert left.shares["likely"] > 0.5 and 0.5 < LIKELY < 1.0
    assert any(said.startswith("likely ") for said in unlike(alone, left))


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_advised_safety_is_as_a_coach_wants_it(name):
    """Where it is not, the case stands in ``UNLIKE`` with the reason, and is taken off that list when it is."""
    said = unlike(CASES[name], measured(CASES[name]))
    assert bool(said) == (name in UNLIKE), said
