"""Is the game in memory the game by the rules, and that of MatchEnv?"""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from snooker_env.advice import CueStroke
from snooker_env.game.balls import CUE
from snooker_env.game.frame_columns import STROKES
from snooker_env.planning import Position
from snooker_env.play.session import STATE, STEP, Session, numbers_of, stroke_of
from snooker_env.tasks.box_actions import MAX_ELEVATION, MAX_SPEED, MIN_SPEED
from tests.playing import COVERED, EASY

ALONG_X = CueStroke(speed=0.6, aim=0.0)


def standing(position, *, scores=(0, 0), striker=0, free_ball=False):
    session = Session(seed=1)
    session.set_up(Position(**position), scores=scores, striker=striker, free_ball=free_ball)
    return session


def test_strokes_are_those_of_the_match_environment():
    """The same strokes, with noise, in both: the same balls, frame and random numbers; then the balls lie on the grid."""
    pytest.importorskip("pettingzoo")
    from snooker_env.envs.match import MatchEnv

    kind = {"task": "frame", "placement": True, "says": ["decision"], "elevation": True, "max_strokes": None}
    env = MatchEnv(**kind, aim="absolute", miss="clear_path", noise="club", cue="real")
    env.reset(seed=3)
    session = Session(seed=3)
    session.noise[:] = ["club", "club"]
    session.load(session.save() | {"state": {k: v for k, v in env.get_state().items() if k in STATE}})
    rng = np.random.default_rng(0)
    for _ in range(12):
        numbers = rng.uniform((0.5, -3, -0.3, -0.3, 0), (6, 3, 0.3, 0.3, 0.3)).tolist()
        wish = CueStroke(**dict(zip(("speed", "aim", "side", "top", "elevation"), numbers, strict=True)))
        stroke = stroke_of(numbers_of(wish))
        assert np.abs(stroke.numbers() - wish.numbers()).max() < 1.5e-3
        if session.frame.in_hand and session.frame.phase == "stroke":
            session.place(0.1, -1.2)
        x, y = session.tables.positions[0, CUE]
        speed = 2 * (stroke.speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1
        action = [speed, 2 * stroke.side, 2 * stroke.top, stroke.aim / pi]
        place = x / 0.292, 2 * (-1.0475 - y) / np.sqrt(0.292**2 - min(x**2, 0.0852)) - 1
        action += [2 * stroke.elevation / MAX_ELEVATION - 1, *place, 0.0]
        if session.frame.phase == "choice":
            session.choose("play")
            if session.frame.in_hand:
                session.place(0.1, -1.2)
                action[5:7] = 0.1 / 0.292, 2 * 0.1525 / np.sqrt(0.292**2 - 0.01) - 1
        session.play(wish)
        env.step(np.clip(action, -1, 1))
        assert replace(session.frame, saved=None) == replace(env.frame, saved=None)
        assert np.allclose(session.tables.positions[0], env.positions, rtol=0, atol=STEP)
        # rounding of a place would grow
        session._set({k: v for k, v in env.get_state().items() if k in STATE})
    assert session.tables.game[0, STROKES] == 12


def test_the_choices_after_a_foul():
    """Play: the other plays on. Play again: the offender. Replace: the offender from where the balls were."""
    for what, striker, back in (("play", 1, False), ("play_again", 0, False), ("replace", 0, True)):
        session = standing(COVERED)
        before = session.tables.positions[0].copy()
        session.play(CueStroke(speed=1.0, aim=0.5 * pi))
        with pytest.raises(ValueError, match="choose first"):
            session.play(ALONG_X)
        session.choose(what)
        assert (session.frame.phase, session.frame.striker) == ("stroke", striker)
        assert np.array_equal(session.tables.positions[0, CUE], before[CUE]) is back
    with pytest.raises(ValueError, match="must be left out"):
        session.choose("play")


def test_a_cue_ball_in_hand_goes_to_the_nearest_free_place_of_the_d():
    session = Session(seed=1)
    assert session.place(5.0, 5.0) == pytest.approx((0.292, -1.0475), abs=0.06)
    assert session.place(0.1, -1.2) == pytest.approx((0.1, -1.2), abs=STEP / 2)
    assert session.at == 1  # a place is no act of its own
    session.play(CueStroke(speed=1.0, aim=-0.5 * pi))
    assert np.allclose(session.acts[-1].played.shot.at(0.0)[0][CUE], (0.1, -1.2), atol=1e-12)
    assert session.go_to(session.at - 1) and session.tables.positions[0, CUE] == pytest.approx(
        [0.1, -1.2], abs=STEP / 2
    )
    with pytest.raises(ValueError, match="not in hand"):
        standing(EASY).place(0.0, -1.2)


def test_undo_and_redo_give_every_state_back_and_a_new_act_ends_redo():
    session = standing(EASY)
    session.noise[:] = ["club", "club"]
    states = [session.state]
    for k in range(3):
        if session.frame.phase == "choice":
            session.choose("play")
        session.play(CueStroke(speed=1.0 + k, aim=0.7))
        states.append(session.state)
    steps = session.at
    seen = []
    while session.go_to(session.at - 1):
        seen.append(session.state)
    assert states[0] in seen and states[1] in seen and not session.go_to(session.at - 1)
    for _ in range(steps - 1):
        assert session.go_to(session.at + 1)
    assert session.state == states[-1] and not session.go_to(session.at + 1)
    session.go_to(session.at - 1)
    again = session.play(CueStroke(speed=3.0, aim=0.7)) if session.frame.phase == "stroke" else None
    assert again is None or session.state == states[-1]  # the same stroke meets the same errors
    assert again is None or not session.go_to(session.at + 1)


def test_noise_is_that_of_the_seat():
    """Only the second seat errs: its aim is not what was asked for, the first one's is."""
    session = standing(EASY)
    session.noise[:] = ["none", "olympiad"]
    first = session.play(CueStroke(speed=1.0, aim=3.0)).played
    if session.frame.phase == "choice":
        session.choose("play")
    assert session.frame.striker == 1
    second = session.play(CueStroke(speed=1.0, aim=3.0)).played
    assert first.cue["aim"] == pytest.approx(3.0, abs=1e-6) and abs(second.cue["aim"] - 3.0) > 1e-5


def test_practice_gives_the_table_back():
    session = standing(COVERED)
    session.practice = True
    session.play(CueStroke(speed=1.0, aim=0.5 * pi))
    assert (session.frame.phase, session.frame.striker, session.frame.scores) == ("stroke", 0, (0, 7))


def test_a_stroke_that_is_played_again_has_the_same_luck():
    session = standing(EASY)
    session.noise[:] = ["none", "club"]
    session.play(CueStroke(speed=1.0, aim=3.0))
    if session.frame.phase == "choice":
        session.choose("play")
    lucky = session.play(CueStroke(speed=1.0, aim=3.0)).luck
    session.go_to(session.at - 1)
    assert session.play(CueStroke(speed=1.0, aim=3.0)).luck == lucky
    assert [act.luck for act in session.acts if act.played] == [0.0, lucky] and lucky != 0.0
