"""Is the first stroke of a player's ranking the one that it plays, and does the ranking hold its own scores, best first?"""

import numpy as np
import pytest
from positions import tables

from agents.players.by_name import player_of
from snooker_env.planning import pots
from snooker_env.tasks import STROKES

GOING = np.array([True, False, True, True])


def ranked(player, **options):
    """What a fresh player of that kind plays on four tables, and how it ranks strokes there."""
    env = tables(4, seed=2, noise="professional", **player().options, **options)
    seen = env.tables.observe(np.arange(4))
    return env, player().act(env, seen, GOING)[GOING], player().rank(env, seen, GOING)


@pytest.mark.parametrize("name", ["ghost_ball", "lookahead_foresight", "search", "lookahead", "best_pot"])
@pytest.mark.parametrize("layout", ["held_out", "break_off"])
def test_the_first_of_a_ranking_is_played(name, layout):
    env, played, ranking = ranked(lambda: player_of(name, budget=150), layout=layout)
    assert len(ranking) == 3
    for own, (actions, scores) in zip(played, ranking, strict=True):
        assert np.array_equal(own, actions[0]) and len(actions) == len(scores) >= 1
        assert (np.diff(scores) <= 0).all()
    if layout == "held_out":
        assert max(len(scores) for _, scores in ranking) > 1
        if "foresight" in name or name == "ghost_ball":
            masks = env.action_masks()[GOING]
            assert all(mask[actions].all() for mask, (actions, _) in zip(masks, ranking, strict=True))


def test_the_ghost_ball_player_ranks_all_pots_by_their_width():
    env, _, ranking = ranked(lambda: player_of("ghost_ball"))
    found = pots(env)
    for k, (actions, scores) in zip(np.flatnonzero(GOING), ranking, strict=True):
        many = int((found.ball[k] >= 0).sum())
        assert (actions // STROKES).tolist() == list(range(many)) and np.array_equal(scores, found.tolerance[k, :many])


@pytest.mark.parametrize("name", ["ppo_mask", "ppo_foresight"])
def test_a_masked_policy_ranks_its_choices_by_probability(name):
    env, played, ranking = ranked(lambda: player_of(name))
    masks = env.action_masks()[GOING]
    for own, mask, (actions, scores) in zip(played, masks, ranking, strict=True):
        assert own == actions[0] and mask[actions].all() and scores.sum() == pytest.approx(1.0, abs=1e-4)
        assert (np.diff(scores) <= 0).all() and scores[0] > 1.5 / len(scores)


def test_a_policy_of_numbers_gives_its_one_stroke():
    _, played, ranking = ranked(lambda: player_of("ppo_target"))
    for own, (actions, scores) in zip(played, ranking, strict=True):
        assert np.array_equal(actions, own[None]) and scores is None
