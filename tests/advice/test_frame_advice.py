"""Does advice of a frame say why: the chance to win, what the other finds, where the cue ball goes?"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from cases import ENDGAME, HIDDEN, OPEN, SNOOKERED, Given, played, stroke_of

import snooker_env as sn
from snooker_env.advice import CueStroke, stroke_words
from snooker_env.advice.ask import _choose_least_bad, _lay_first, _sort_by_win
from snooker_env.advice.intentions import intend
from snooker_env.advice.outcomes import Trials, judge_strokes
from snooker_env.advice.practice import one_position, practice_of
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Position, Positions, clear_paths
from snooker_env.tasks import LEVELS

QUICK = {"samples": 60, "visits": 4, "scores": (20, 24)}
LAST = Position(cue=(0.0, 0.4), black=(0.0, 1.0))


def errors_of_another(n):
    return LEVELS["professional"].draw_errors(np.random.default_rng(8), n)


def test_the_tactician_is_asked_in_frames_and_the_planner_in_visits():
    assert sn.advise(OPEN, samples=10, visits=0).agent == "planner_500"
    advice = sn.advise(OPEN, **QUICK)
    assert (
        advice.agent == "tactician_1000"
        and advice.scores == (20, 24)
        and advice.order.startswith("By chance to win")
    )
    env = sn.SnookerEnv(task="frame", opponent="ghost_ball", miss="clear_path")
    env.reset(seed=1, options={"breaker": 0})
    broken = sn.advise(env, samples=10, visits=0)
    assert broken.agent == "tactician_1000" and broken.scores == (0, 0) and broken[0].place is not None
    at = one_position(OPEN, (20, 24))
    first = sn.player("tactician_1000").at({"task": "frame", "noise": "professional"}).play(at, [3])
    asked = sn.advise(OPEN, n=1, seed=3, **QUICK)[0]
    assert (
        tuple(asked.stroke.numbers())
        == tuple(first.values[0])
        == tuple(stroke_of("tactician_1000", at, seed=3).numbers())
    )


def test_the_chance_to_win_is_that_of_other_samples_too():
    judge = sn.player("tactician").at({"task": "frame", "noise": "professional"}).judge
    at, n = one_position(HIDDEN, (20, 24)), 2000
    for one in sn.advise(HIDDEN, n=3, **QUICK | {"samples": 400}):
        numbers = np.repeat(one.stroke.numbers()[None], n, 0)
        gains = judge.gains(at, np.zeros(n, np.int64), numbers, errors_of_another(n))
        mean, spread = gains[:, 0].mean(), gains[:, 0].std()
        assert abs(one.win - mean) < 4.0 * spread * np.sqrt(1 / 400 + 1 / n)
        low, high = one.win_interval
        assert low < one.win < high and high - low == pytest.approx(2 * 1.96 * spread / np.sqrt(400), rel=0.3)
        assert f"win chance {100 * one.win:.0f} %" in one.words and 0.0 < one.win < 1.0


def net_points(one):
    return one.points - (1.0 - one.chance if one.kind == "pot" else 1.0) * one.leaves


def test_of_strokes_that_win_as_often_as_the_best_the_one_with_more_points_is_first():
    some = sn.advise(ENDGAME, n=1, noise="amateur", **QUICK)[0]
    made = {
        name: replace(some, kind=kind, win=win, points=points, chance=chance, leaves=leaves)
        for name, kind, win, points, chance, leaves in (
            ("best", "safety", 0.500, 0.0, 1.0, 3.0),  # -3 points
            ("pot", "pot", 0.497, 5.0, 0.5, 4.0),  # 3 points
            ("tight", "safety", 0.496, 0.0, 1.0, 1.0),  # -1 point
            ("worse", "pot", 0.494, 9.0, 0.9, 0.0),  # more than 0.005 below the best
            ("worst", "pot", 0.480, 12.0, 0.9, 0.0),
        )
    }
    given = [made[name] for name in ("worst", "tight", "worse", "best", "pot")]
    assert _sort_by_win(given) == [made[name] for name in ("pot", "tight", "best", "worse", "worst")]


def test_strokes_are_ordered_by_it_and_the_best_is_compared():
    safe, pot = sn.advise(HIDDEN, n=4, **QUICK), sn.advise(ENDGAME, n=3, noise="amateur", **QUICK)
    for advice in (safe, pot):
        for k, one in enumerate(advice):
            for later in advice[k + 1 :]:  # of those that win alike the one with more points
                assert one.win > later.win or (
                    later.win - one.win < 0.005 and net_points(one) >= net_points(later)
                )
        assert all(one.against is None and " against " not in one.words for one in advice[1:])
    assert safe[0].kind == "safety" and "safety off the red, " in safe[0].words
    assert safe[0].words.endswith(f" against {100 * safe[0].against:.0f} % for the best pot")
    assert pot[0].kind == "pot" and pot[0].words.endswith(f"{100 * pot[0].against:.0f} % for the best safety")
    lone = sn.advise(LAST, agent=Given(CueStroke(speed=0.9, aim=np.pi / 2)), **QUICK)
    assert len(lone) == 1 and lone[0].against is None and " against " not in lone[0].words
    two = Given(
        *(CueStroke(speed=speed, aim=np.pi / 2) for speed in (0.9, 1.6, 3.0))
    )  # the second is another way of the first
    best, other = sn.advise(LAST, agent=two, **QUICK)
    assert best.against == other.win and best.words.endswith(f"{100 * other.win:.0f} % for the next best")


def test_what_the_other_finds_is_said_and_is_so():
    """Without errors the opponent pots whatever goes: the black after a soft stroke, which is then the frame's."""
    (one,) = sn.advise(LAST, agent=Given(CueStroke(speed=0.7, aim=np.pi / 2)), noise="none", scores=(10, 8))
    assert (one.kind, one.replies, one.leaves, one.snookers) == ("safety", 1.0, 7.0, 0.0)
    assert "the opponent pots next in 100 %, leaves the opponent 7 points; win chance" in one.words
    never = sn.advise(LAST, agent=Given(CueStroke(speed=0.7, aim=np.pi / 2)), **QUICK | {"visits": 0})[0]
    assert never.replies is None and never.leaves is None and "pots next" not in never.words
    made = sn.advise(Position(cue=(0.3, 1.1), black=(0.0, 1.4605)), noise="none", n=1, scores=(8, 12))[0]
    assert (made.kind, made.win, made.replies, made.leaves) == ("pot", 1.0, None, None) and made.chance == 1.0


def test_how_often_he_is_snookered_is_as_in_the_environment():
    """By independent strokes in visits, whose balls stop where those of frames do: the red beside the brown is hidden if
    the cue ball comes near enough to it."""
    beside = Position(cue=(0.0, -1.3), reds=[(0.5, 0.2)], brown=(0.0, -1.0475), on="any_colour")
    for speed, least, most in ((0.36, 0.9, 1.0), (0.44, 0.2, 0.8)):
        roll = Given(CueStroke(speed=speed, aim=np.pi / 2))
        (one,) = sn.advise(beside, agent=roll, samples=400, visits=0, scores=(1, 0))
        _, fouls, states = played(beside, one.stroke, 400, noise="professional")
        balls = [(np.array(s["positions"]), np.array(s["on_table"])) for s in np.array(states)[~fouls]]
        game = np.tile([1, 0, 0, 0, 0], (len(balls), 1))
        left = Positions(*(np.stack(part) for part in zip(*balls, strict=True)), game)
        share = float((~clear_paths(left)).mean())
        assert abs(share - one.snookers) < 4.0 * np.sqrt(0.5 * max(0.01, share * (1 - share)) / 100)
        assert (
            least <= one.snookers <= most
            and f"snookered in {100 * one.snookers:.0f} %"
            in stroke_words.reply_words(one.kind, 0.0, 0.0, one.snookers)
        )


def test_the_decision_after_a_foul_and_the_lot_are_behind_the_stroke():
    at = one_position(OPEN, (20, 24))
    usual = sn.advise(at, n=2, samples=20, visits=0)
    for phase in (columns.CHOICE, columns.LOT):
        at.game[:, columns.PHASE] = phase
        assert [one.stroke for one in sn.advise(at, n=2, samples=20, visits=0)] == [
            one.stroke for one in usual
        ]
    at.game[:, columns.PHASE], at.game[:, [columns.IN_HAND, columns.ANYWHERE]] = columns.STROKE, 1
    assert sn.advise(at, n=1, samples=20, visits=0)[0].place is None


def test_where_the_cue_ball_goes_in_words():
    assert (
        stroke_words.lie_words(0.0, -1.2, -1, 0.0) == "to baulk"
        and stroke_words.lie_words(0.0, 0.0, -1, 0.0) == ""
    )
    assert stroke_words.lie_words(0.3, -1.7, -1, 0.0) == "to the baulk cushion"
    assert stroke_words.lie_words(0.3, 1.7, -1, 0.0) == "to the top cushion"
    assert stroke_words.lie_words(0.0, -1.2, 18, 0.09) == "tight behind the brown"
    assert (
        stroke_words.lie_words(0.0, -1.7, 18, 0.4) == "behind the brown"
        and stroke_words.lie_words(0.0, 0.0, 3, 0.3) == "behind the red"
    )
    roll = Position(cue=(0.0, -1.3), reds=[(0.02, 1.2)], brown=(0.0, -1.0475), on="any_colour")
    (one,) = sn.advise(roll, agent=Given(CueStroke(speed=0.36, aim=np.pi / 2)), noise="none", scores=(1, 0))
    assert (
        one.kind == "safety" and ", tight behind the brown, fair 100 %" in one.words and one.snookers == 1.0
    )
    (out,) = sn.advise(SNOOKERED, n=1, **QUICK)
    assert out.kind == "escape" and out.words.startswith("escape off the ")


def test_a_player_of_visits_does_not_advise_a_frame():
    """It knows no safety and no score: a pot of 4 % would be its first suggestion. Who knows frames is said."""
    network = type("Seen", (), {"act": lambda self, observations, masks, seeds: np.zeros((len(seeds), 4))})
    for agent in ("planner", "search_60", "best_pot", "ghost_ball", "random", network()):
        with pytest.raises(
            ValueError, match=r'^agent = .*: must know frames, as "tactician_1000" or "stroke_value" do'
        ):
            sn.advise(OPEN, agent=agent, **QUICK)
    for agent in ("stroke_value", "tactician_253", Given(CueStroke(speed=0.9, aim=np.pi / 2))):
        assert sn.advise(OPEN, agent=agent, n=1, **QUICK)[0].win is not None


HOPELESS = Position(
    cue=(0.0, 1.74), blue=(0.3, -1.72), pink=(0.0, 1.68), black=(-0.06, 1.7), on="blue"
)  # no stroke of many is fair
NOTHING, PINK_FIRST = (CueStroke(speed=1.0, aim=aim) for aim in (0.0, -np.pi / 2))


def test_where_nothing_is_fair_the_foul_that_wins_most_often_is_advised_and_said():
    """Nothing struck gives 5 away, the pink first 6; others that leave more behind are found among discrete choices."""
    practice, at = practice_of("none", {"cue": "free"}, of_frames=True), one_position(HOPELESS, (41, 22))
    trials = Trials(samples=1, visits=0, seed=0)
    nothing, pink = judge_strokes(practice, intend(practice, at, [NOTHING, PINK_FIRST]), trials)
    assert nothing.win > pink.win + 0.03 and nothing.foul == pink.foul == 1.0
    strokes = intend(practice, at, [PINK_FIRST, NOTHING])
    assert _choose_least_bad(practice, strokes, trials).stroke == NOTHING
    how = {"noise": "none", "visits": 0, "options": {"cue": "free"}}
    (one,) = sn.advise(HOPELESS, agent=Given(NOTHING, PINK_FIRST), scores=(41, 22), **how)
    assert one.foul == 1.0 and one.win >= nothing.win and ", fouls in 100 %; win chance " in one.words
    assert one.words.startswith("no fair stroke found: foul, ")


def test_a_risk_of_a_foul_is_said_in_a_frame():
    risks = {}
    for agent in ("tactician_60", Given(*(CueStroke(speed=2.0, aim=1.65 + 0.01 * k) for k in range(12)))):
        for position in (SNOOKERED, HIDDEN):
            for one in sn.advise(position, agent=agent, noise="beginner", n=8, **QUICK):
                said = f", fouls in {100 * one.foul:.0f} %" in one.words
                assert said == (one.foul > 0.2), one.words
                assert one.kind == "pot" or said != (f", fair {100 * one.chance:.0f} %" in one.words)
                risks[said] = risks.get(said, 0) + 1
    assert min(risks[True], risks[False]) >= 3
    say = stroke_words.figures_words
    assert say("pot", 0.54, 12.0, 0.28) == "pot 54 %, fouls in 28 %, 12 points expected"
    assert say("pot", 0.54, 12.0, 0.2) == say("pot", 0.54, 12.0) == "pot 54 %, 12 points expected"
    assert say("escape", 0.72, 0.0, 0.28) == "fouls in 28 %" and say("escape", 0.8, 0.0, 0.2) == "fair 80 %"


COLOURS = {
    "yellow": (0.292, -1.0475),
    "green": (-0.292, -1.0475),
    "brown": (0.0, -1.0475),
    "blue": (0.0, 0.0),
    "pink": (0.0, 0.89),
    "black": (0.0, 1.4605),
}
BEHIND = Position(cue=(0.4, -0.6), **COLOURS, on="yellow")
"""The yellow can be potted nine times of ten; 27 are left."""


def test_a_snooker_that_is_needed_is_laid_and_a_pot_comes_first_only_on_the_way():
    how = {"n": 3, "samples": 300, "visits": 4}
    usual = sn.advise(BEHIND, scores=(35, 62), **how)[0]
    assert usual.kind == "pot" and "snookers" not in usual.words
    lays = sn.advise(BEHIND, scores=(30, 62), **how)
    assert all(one.kind == "safety" and ", needs snookers, " in one.words for one in lays)
    assert lays[0].snookers > 0.5 and lays[0].words.endswith(" for the best pot")
    last = Position(cue=(0.2, 0.9), reds=[(0.5, 1.3)], **COLOURS)
    first = sn.advise(last, scores=(20, 60), **how)[0]
    assert first.kind == "safety"  # the last red is easier to hide than six colours
    colour = Position(
        cue=(0.2, 1.2), **COLOURS, on="any_colour"
    )  # it is spotted again, and if missed its points are lost
    first = sn.advise(colour, scores=(20, 56), **how)[0]
    assert first.kind == "pot" and ", needs snookers, then 29 behind with 27 left, pot " in first.words


def test_a_pot_that_takes_a_ball_to_lay_snookers_on_is_first_where_it_wins_far_more_often():
    made = {
        name: SimpleNamespace(figure=win) for name, win in (("safe", 0.010), ("pot", 0.012), ("far", 0.014))
    }
    safe, pot, far = made["safe"], made["pot"], made["far"]
    assert _lay_first([safe], [pot]) == [safe, pot] and _lay_first([safe], [far, pot]) == [far, pot, safe]
    assert _lay_first([], [pot]) == [pot] and _lay_first([safe], []) == [safe]


def test_a_pot_after_which_snookers_are_needed_says_so():
    """The yellow brings 2 where a black would bring 7: 27 are left."""
    straight = Position(cue=(0.103, -0.814), **COLOURS, on="any_colour")
    pot = Given(CueStroke(speed=1.5, aim=np.arctan2(-0.737, 0.597)))
    for mine, words in ((30, ", then needs snookers: 28 behind with 27 left, pot 100 %"), (31, "")):
        (one,) = sn.advise(straight, agent=pot, noise="none", visits=0, scores=(mine, 60))
        assert (one.kind, one.ball) == ("pot", 16)
        assert words in one.words and ("snookers" in one.words) == bool(words)
