"""Is advice right, by independent visits in the environment, and does the command print it?"""

import numpy as np
import pytest
from cases import ALL, ENDGAME, IN_HAND, OPEN, SNOOKERED, played, state_of, stroke_of

import snooker_env as sn
from snooker_env.advice import destinations
from snooker_env.planning import clear_paths
from tests.refusals import refuse_each

QUICK = {"samples": 60, "visits": 4}
AGENTS = ("planner_500", "search", "ghost_ball", "random")


def test_chances_are_those_of_the_environment():
    """Each stroke 4000 times with other errors."""
    n = 4000
    advice = sn.advise(ENDGAME, noise="club", n=3, samples=n, visits=0)
    assert advice[0].kind == "pot" and advice[0].ball == 19
    # two means of n samples differ by less than four standard deviations of their difference; the variance of one
    # sample of a share p is p (1 - p); that of a squared distance, which lapses make large, is taken from the samples
    apart = 4.0 * np.sqrt(2 / n)
    for one in advice:
        points, fouls, after = played(ENDGAME, one.stroke, n, noise="club")
        share, foul = float(((points == 5) & ~fouls).mean()), float(fouls.mean())
        low, high = one.chance_interval
        assert low <= one.chance <= high and high - low < 2 * 2.1 * np.sqrt(0.25 / n)
        assert abs(one.chance - share) < apart * np.sqrt(share * (1 - share)) + 1e-3
        assert abs(one.foul - foul) < apart * np.sqrt(foul * (1 - foul)) + 1e-3
        cue = np.array([s["positions"][0] for s in after if s["on_table"][0]])
        assert one.stops == pytest.approx(cue.mean(axis=0), abs=apart * one.spread)
        squares = ((cue - cue.mean(axis=0)) ** 2).sum(axis=1)
        assert apart * squares.std() < 0.6 * squares.mean()
        assert abs(one.spread**2 - squares.mean()) < apart * squares.std()


def test_the_seed_decides_and_the_noise_stream_of_a_state_has_no_say():
    many = {"noise": "club", "n": 3, **QUICK}
    first, again, other = (sn.advise(OPEN, seed=seed, **many).to_dict() for seed in (4, 4, 5))
    assert first == again and first["suggestions"] != other["suggestions"]
    apart = [sn.advise(ENDGAME, agent="ghost_ball", seed=seed, **many)[0].stops for seed in (4, 5)]
    assert apart[0] != apart[1]  # of one and the same stroke
    # The trap: a state that is played again meets its own errors again
    states = [state_of(OPEN) | {"stream": [key, 0]} for key in (1, 2)]
    one, other = (sn.advise(state, noise="club", n=2, **QUICK).to_dict() for state in states)
    assert one == other == sn.advise(OPEN, noise="club", n=2, **QUICK).to_dict()


def test_a_position_may_be_given_in_every_way_and_its_points_do_not_count():
    env = sn.SnookerEnv(noise="club")
    env.reset(seed=1, options={"state": state_of(OPEN)})
    many = sn.planning.Positions.of([OPEN])
    asked = [sn.advise(p, n=1, **QUICK).to_dict() for p in (OPEN, OPEN.to_dict(), state_of(OPEN), env, many)]
    assert all(one["suggestions"] == asked[0]["suggestions"] for one in asked)
    far = sn.Position(**OPEN.to_dict() | {"points": 140})
    assert sn.advise(far, n=1, **QUICK)[0] == sn.advise(OPEN, n=1, **QUICK)[0]


def test_the_choice_is_the_agents_own():
    """The strokes are those of its ranking."""
    advice = sn.advise(OPEN, agent="search", n=4, seed=3, **QUICK)
    (ranked,) = sn.player("search").at({"noise": "professional"}).rank(OPEN, [3])
    rows = set(map(tuple, ranked.strokes.values.tolist()))
    assert all((one.speed, one.side, one.top, one.aim, one.elevation) in rows for one in advice)
    assert [one.points for one in advice] == sorted((one.points for one in advice), reverse=True)
    (first,) = sn.advise(OPEN, agent="search", n=1, seed=3, **QUICK)
    assert tuple(first.stroke.numbers()) == tuple(ranked.strokes.values[ranked.scores.argmax()])
    assert first.stroke == stroke_of("search", OPEN, seed=3)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("agent", AGENTS)
def test_every_built_in_agent_has_a_stroke_at_every_position(name, agent):
    position = ALL[name]
    stroke = stroke_of(agent, position, seed=3)
    assert (stroke.place is not None) == position.in_hand
    points, fouls, _ = played(position, stroke, 1, noise="none")
    (first, *_) = sn.advise(position, agent=agent, n=1, seed=3, **QUICK)
    assert first.kind not in ("foul", "in-off") and first.foul <= 0.5
    if not fouls[0] and played(position, stroke, 200, noise="professional")[1].mean() < 0.4:
        assert first.stroke == stroke and (first.kind == "pot") == bool(points[0] > 0)


def test_in_hand_a_stroke_has_a_place_in_the_d_that_counts():
    one = sn.advise(IN_HAND, n=1, samples=100, visits=0)[0]
    x, y = one.place
    assert y <= -1.0475 + 1e-9 and np.hypot(x, y + 1.0475) <= 0.292 + 1e-9 and one.kind == "pot"
    assert "brown spot" in one.words
    points, _, _ = played(IN_HAND, one.stroke, 400, noise="professional")
    assert abs((points > 0).mean() - one.chance) < 4 * np.sqrt(0.25 / 100)
    assert sn.Position(**{**IN_HAND.to_dict(), "cue": one.place}).in_hand  # no ball is in the way


def test_where_nothing_can_be_potted_a_ball_on_is_hit():
    escape, contact = (SNOOKERED, "escape", "planner_500"), (ALL["hidden"], "contact", "ghost_ball")
    for position, kind, agent in (escape, contact):
        one = sn.advise(position, agent=agent, n=1, samples=60, visits=0)[0]
        assert one.kind == kind and one.pocket == -1 and one.ball == one.first and 1 <= one.ball <= 15
        assert bool(clear_paths(position)[0]) == (kind == "contact")
        points, fouls, _ = played(position, one.stroke, 400, noise="professional")
        assert abs((~fouls).mean() - one.chance) < 4 * np.sqrt(0.25 / 60)
        assert points.mean() == pytest.approx(one.points, abs=0.3)
        assert one.words.startswith("escape off the " if kind == "escape" else "contact with the red, ")
        assert " fair " in one.words


WRONG = """
sn.advise(OPEN, n=0) | n | 0 | must be an integer in [1, 100]
sn.advise(OPEN, samples=0) | samples | 0 | must be an integer
sn.advise(OPEN, visits=-1) | visits | -1 | must be an integer
sn.advise(OPEN, seed=1.5) | seed | 1.5 | must be an integer
sn.advise(OPEN, agent="nobody_at_all") | player | nobody_at_all | ghost_ball
sn.advise(OPEN, agent=3) | player | a int | must be a player
sn.advise(OPEN, agent="no_module:Player") | player | no_module:Player | must be MODULE:CLASS
sn.advise(OPEN, noise="wild") | noise | wild | must be one of
sn.advise(OPEN, options={"layout": "opened"}) | key of options | layout | 'physics', 'table', 'fidelity'
sn.advise(OPEN, options={"miss": "off"}) | key of options | miss | 'physics'
sn.advise(OPEN, options=3) | options | a int | must be None, an Options, or a dict
sn.advise(OPEN, scores=(1,)) | scores | (1,) | must be two integers
sn.advise(OPEN, scores=(0, -1)) | scores[1] | -1 | must be an integer in [0, 1000]
sn.advise(sn.planning.Positions.of([OPEN, OPEN])) | position | 2 positions | must be one position
sn.advise(sn.Position(cue=(0.0, 0.0), over=True)) | position.over | True | must be False
sn.advise({"cue": (0.0, 0.0), "cues": 3}) | key of position | cues | 'cue'
destinations(OPEN, {**SOFT, "speed": 9.0}) | speed | 9.0 | [0.2, 7]
destinations(OPEN, {"speed": 2.0}) | stroke | without 'aim' | must be a CueStroke
destinations(OPEN, {**SOFT, "spin": 1}) | field of the stroke | spin | 'speed'
destinations(OPEN, {**SOFT, "side": 0.4, "top": 0.4}) | side, top | (0.4, 0.4) | within the disc
destinations(OPEN, {**SOFT, "elevation": 1.3}) | elevation | 1.3 | must be
destinations(OPEN, {**SOFT, "place": (0.0, -1.1)}) | place | (0.0, -1.1) | must be None: the cue ball is not in hand
destinations(IN_HAND, {**SOFT, "place": (0.0, 0.0)}) | place | (0, 0) | lines of the D
destinations(OPEN, SOFT, samples=0) | samples | 0 | must be an integer
"""


def test_wrong_arguments_are_refused():
    soft = {"speed": 2.0, "aim": 0.0}
    refuse_each(
        WRONG, {"sn": sn, "destinations": destinations, "OPEN": OPEN, "IN_HAND": IN_HAND, "SOFT": soft}
    )


def test_an_environment_before_its_reset_is_refused():
    for env in (sn.SnookerEnv(), sn.SnookerVectorEnv(1), sn.SnookerEnv(task="frame")):
        with pytest.raises(ValueError, match=r"call reset\(\) first"):
            sn.advise(env, **QUICK)
        env.reset(seed=1)
        assert len(sn.advise(env, **QUICK)) >= 1
