"""Is a miss with the cue ball in hand judged from every place where it could have been put?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BLUE, BROWN, CUE, GREEN, N_BALLS, PINK, SPOTS, YELLOW, mask_of
from snooker_env.game.paths import paths
from snooker_env.geometry import BAULK_Y, D_RADIUS
from tests.tables import frame_env, frame_state

TABLE = sn.Table.preset("match")
CUSHIONS = {"noses": TABLE.noses, "jaws": TABLE.jaws}
RED = (0.0, 0.5)
BEHIND_THE_BROWN = [-0.6, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0]
"""A stroke straight up the table from the back of the D, into the brown."""
WALL = {
    GREEN: (-0.105, 0.9),
    YELLOW: (-0.0525, 0.9),
    BLUE: (0.0, 0.9),
    PINK: (0.0525, 0.9),
    BLACK: (0.105, 0.9),
}
"""Five colours side by side: a red right behind them is seen from nowhere in the D."""


def table(places, cue=None):
    positions, on_table = np.full((N_BALLS, 2), 5.0), np.zeros(N_BALLS, bool)
    for ball, place in places.items() if cue is None else [(CUE, cue), *places.items()]:
        positions[ball], on_table[ball] = place, True
    return positions, on_table


def asks_again(observation, rng):
    """An opponent who has the balls replaced whenever he may."""
    return [-0.9, 0.0, 0.0, 0.9, 0.0, 0.0, 1.0]


def after_failures(miss, strokes):
    """A red on, the cue ball in hand, so many failures behind the brown: environment and last result."""
    env = frame_env(aim="absolute", miss=miss, opponent=asks_again)
    places = {1: RED, BROWN: SPOTS[BROWN], BLACK: SPOTS[BLACK], CUE: (0.18, BAULK_Y)}
    frame_state(env, places, {"in_hand": True})
    for _ in range(strokes):
        result = env.step(BEHIND_THE_BROWN)
    return env, result


@pytest.mark.parametrize("miss", ["clear_path", "attempt"])
def test_who_hides_in_hand_is_sent_back_warned_and_loses_the_frame(miss):
    env, (*_, info) = after_failures(miss, 1)
    assert (info["opponent_score"], info["failures"], info["warned"], env.in_hand) == (4.0, 1, False, True)
    env, (*_, info) = after_failures(miss, 2)
    assert (info["opponent_score"], info["failures"], info["warned"]) == (8.0, 2, True)
    _, (_, _, terminated, _, info) = after_failures(miss, 3)
    assert terminated and (info["opponent_score"], info["winner"]) == (12.0, 1)


@pytest.mark.parametrize(("wall", "called"), [(WALL, False), ({}, True)])
def test_who_can_see_no_ball_on_from_all_of_the_d_is_not_called(wall, called):
    places = {1: (0.0, 0.96), BROWN: SPOTS[BROWN], CUE: (0.18, BAULK_Y), BLACK: SPOTS[BLACK], **wall}
    state = frame_state(frame_env(miss="clear_path"), places, {"in_hand": True}).get_state()
    match = sn.match_env(aim="absolute", miss="clear_path")
    match.reset(seed=1, options={"state": state})
    match.step(BEHIND_THE_BROWN)
    assert (match.frame.phase, match.frame.scores, match.frame.miss_called) == ("choice", (0, 4), called)


def test_paths_in_hand_are_those_of_the_best_place():
    """Without the cue ball on the table it is in hand, as in the test for a snooker."""
    hidden = {1: RED, BROWN: SPOTS[BROWN]}
    assert paths(*table(hidden, (0.0, BAULK_Y - 0.29)), mask_of([1]), **CUSHIONS) == (False, False)
    assert paths(*table(hidden), mask_of([1]), **CUSHIONS) == (True, True)
    walled = table({1: (0.0, 0.96), **WALL})
    assert paths(*walled, mask_of([1]), **CUSHIONS) == (False, False)
    assert paths(*walled, mask_of([1]), anywhere=True, **CUSHIONS) == (True, True)  # from above


@pytest.mark.parametrize("seed", range(12))
def test_no_place_of_the_d_sees_more(seed):
    """Where some place of the D has a clear path, so has the cue ball in hand; touching a ball is none."""
    rng, met = np.random.default_rng(seed), set()
    for _ in range(12):
        at = rng.uniform((-0.5, 0.5), (0.5, 1.3))
        beside = at + rng.uniform((-0.12, -0.3), (0.12, -0.06), (4, 2))
        places = {1: at, **dict(zip((GREEN, YELLOW, BLUE, PINK), beside, strict=True))}
        x = rng.uniform(-D_RADIUS, D_RADIUS, 60)
        d = np.column_stack([x, BAULK_Y - rng.uniform(0, 1, 60) * np.sqrt(D_RADIUS**2 - x**2)])
        found = np.array([paths(*table(places, place), mask_of([1]), **CUSHIONS) for place in d]).any(axis=0)
        in_hand = np.array(paths(*table(places), mask_of([1]), **CUSHIONS))
        assert (in_hand >= found).all()
        met |= {tuple(in_hand.tolist())}
    assert len(met) > 1
