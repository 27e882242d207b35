"""Do score bars and the referee's words follow the frame? Whole frames of chance, against the ``Frame`` after
each stroke."""

from itertools import pairwise

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BallOn
from snooker_env.replays.words import bars, standing_bar


@pytest.fixture(
    scope="module",
    params=[
        ("ghost_ball", "colours", "none"),
        ("random", "colours", "club"),
        ("ghost_ball", "line_up", "club"),
    ],
)
def frame(request):
    """A whole frame's strokes, and the frame after each of the agent's steps."""
    opponent, layout, noise = request.param
    env = sn.SnookerEnv(
        task="frame",
        opponent=opponent,
        layout=layout,
        noise=noise,
        action="discrete",
        miss="clear_path",
        max_strokes=120,
    )
    env.keep_history = True
    env.reset(seed=7)
    rng, seen, ended = np.random.default_rng(7), [], False
    while not ended:
        action = int(rng.choice(np.flatnonzero(env.action_masks())))
        _, _, terminated, truncated, _ = env.step(action)
        seen.append((len(env.history), env.frame))
        ended = terminated or truncated
    return env, seen


def test_scores_follow_the_frame(frame):
    env, seen = frame
    made = bars(env.history, ("A", "B"))
    assert len(made) == len(env.history) > 3
    for count, state in seen:
        if count:
            assert made[count - 1][1].scores == state.scores
    for (_, after), (before, _) in pairwise(made):
        assert before.scores == after.scores
    assert {during.striker for during, _ in made} <= {0, 1}


def test_a_break_is_the_sum_of_its_strokes(frame):
    env, _ = frame
    run, last = 0, None
    for played, (before, after) in zip(env.history, bars(env.history, ("A", "B")), strict=True):
        run = run if played.player == last else 0
        assert before.break_points == run and after.break_points == run + played.points
        assert len(after.potted) - len(before.potted) == (
            len(np.flatnonzero(played.shot.potted >= 0)) if played.points else 0
        )
        if played.points and run:
            assert f"break of {run + played.points}" in after.words
        run, last = run + played.points, played.player if played.points else None


def test_the_end_is_shown(frame):
    env, seen = frame
    last, state = bars(env.history, ("Ada", "Bo"))[-1][1], seen[-1][1]
    if state.winner is not None:
        assert f"Frame to {('Ada', 'Bo')[state.winner]}" in last.words
        assert f"{state.scores[state.winner]}-{state.scores[1 - state.winner]}" in last.words


def test_the_bar_of_a_table_as_it_stands():
    env = sn.SnookerEnv(action="discrete")
    env.keep_history = True
    env.reset(seed=1)
    start = standing_bar(env.tables, 0, ("Ada",))
    assert (start.scores, start.break_points, start.ball_on, start.reds_left, start.points_on) == (
        (0,),
        0,
        "red",
        15,
        147,
    )
    env.step(67)
    kept = bars(env.history, ("Ada",))[-1][1]
    now = standing_bar(env.tables, 0, ("Ada",), kept)
    assert (
        now == kept
        and now.scores == (1,)
        and now.potted == kept.potted != ()
        and env.ball_on == BallOn.ANY_COLOUR
    )
    assert standing_bar(env.tables, 0, ()).players == ()
