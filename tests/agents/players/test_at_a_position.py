"""Can a player be asked what it would play at a position in words? Through tables that a reset has put there, as the page and advice do."""

import numpy as np
import pytest

from agents.players.by_name import player_of
from snooker_env import Planner, Position, Positions, SnookerVectorEnv

HERE = Position(cue=(0.0, -0.2), reds=[(0.5, 0.8), (-0.3, 0.4)], blue=(0.0, 0.0), black=(0.0, 1.4605), on="red", points=8)
THERE = Position(cue=(0.3, 1.1), reds=[(0.6, 1.4)], black=(0.0, 1.4605), on="any_colour", points=1)


@pytest.mark.parametrize("name", ["random", "ghost_ball", "lookahead", "geometric"])
def test_a_player_acts_at_positions_and_the_planner_plays_its_actions(name):
    player = player_of(name)
    tables = SnookerVectorEnv(2, threads=1, noise="none", **player.options)
    observations, _ = tables.reset(seed=1, options={"positions": [HERE, THERE]})
    assert list(Positions.of(tables)) == [HERE, THERE]
    actions = player.act(tables, observations, np.ones(2, bool))
    planned = Planner(tables.options).play([HERE, THERE], rows=[0, 1], actions=actions)
    _, rewards, terminated, _, infos = tables.step(actions)
    assert planned.points.tolist() == rewards.tolist() and (planned.goes_on == ~terminated).all()
    assert infos["break"].tolist() == [8 + rewards[0], 1 + rewards[1]]
    if name != "random":
        assert rewards.all()  # both pots are open
