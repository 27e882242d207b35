"""Is what a player says with a stroke one of its codes, and does an error of a player name who it is?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.players import Strokes

VALUES = np.array([[2.0, 0.0, 0.0, 1.5, 0.0]])


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"nominate": [99]}, r"nominate\[0\] = 99: must be one of"),
        ({"nominate": [16.7]}, r"nominate\[0\] = 16.7: must be one of"),
        ({"decision": [9]}, r"decision\[0\] = 9: must be one of"),
        ({"declare": [-4]}, r"declare\[0\] = -4: must be one of"),
        ({"place": [(5.0, 5.0)]}, r"place\[0\] = \[5.0, 5.0\]: must be on the table"),
        ({"place": [(0.1, np.nan)]}, r"place\[0\] = \[0.1, nan\]: must be on the table"),
    ],
)
def test_what_is_said_is_one_of_its_codes(wrong, says):
    with pytest.raises(ValueError, match=says):
        Strokes(VALUES, **wrong)


class WrongOptions:
    """Sees in a way that there is none."""

    options = {"nix": 1}  # noqa: RUF012 - read, never changed

    def act(self, observations, masks, seeds):
        return []


@pytest.mark.parametrize(
    ("opponent", "says"),
    [
        ("search_3", "^opponent = 'search_3': must end in a number of simulated shots from 8"),
        ("search_20000000", "^opponent = 'search_20000000': must end in a number"),
        (
            f"{__name__}:WrongOptions",
            "^opponent = '.*WrongOptions': key of the options of player WrongOptions",
        ),
        ("nobody", "^opponent = 'nobody': must be one of 'none', 'random'"),
    ],
)
def test_an_opponents_error_names_the_opponent(opponent, says):
    with pytest.raises(ValueError, match=says):
        sn.SnookerEnv(task="frame", opponent=opponent)


def test_a_budget_that_is_none_names_the_player():
    with pytest.raises(
        ValueError, match=r"^player = 'planner_0': must end in a number of simulated shots from 8"
    ):
        sn.player("planner_0")


def test_errors_of_a_seat_name_it():
    with pytest.raises(ValueError, match=r"^seats\[1\]\.noise = 'xx': must be"):
        sn.MatchVectorEnv(2, seats=({"noise": "club"}, {"noise": "xx"}))


def test_a_seed_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match=r"^seed = 1\.5: must be an int, None, or 2 of them"):
        sn.SnookerVectorEnv(2).reset(seed=1.5)
