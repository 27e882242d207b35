"""Does a position mean what its words say, in arrays, environments and files, or is it refused by name?"""

import dataclasses
import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import SPOTS, BallOn
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Position, Positions
from tests.refusals import refused

FULL = {"cue": (0.1, -1.2), "reds": [(0.3, 0.5), (-0.3, 0.7)], "pink": (0.2, 0.1), "black": (0.0, 1.4605)}


def test_words_and_arrays_say_the_same():
    position = Position(**FULL, on="any colour", points=9)
    assert position.on == "any_colour" and position.reds == ((0.3, 0.5), (-0.3, 0.7))
    assert position.yellow is None
    positions, on_table, game = position.arrays()
    assert np.flatnonzero(on_table).tolist() == [0, 1, 2, 20, 21] and game.tolist() == [0, 0, 9, 0, 0]
    places = [FULL["cue"], *FULL["reds"], FULL["pink"], FULL["black"]]
    assert np.array_equal(positions[[0, 1, 2, 20, 21]], places)
    assert Position.of_arrays(positions, on_table, game) == position
    assert hash(position) == hash(Position(**FULL, on="any_colour", points=9))
    assert Position(**json.loads(json.dumps(position.to_dict()))) == position
    assert set(position.to_dict()) == {"cue", "reds", "pink", "black", "on", "in_hand", "points", "over"}
    assert dataclasses.replace(position, pink=None).pink is None
    with pytest.raises(dataclasses.FrozenInstanceError):
        position.on = "red"


def test_what_is_on_follows_from_the_balls_if_it_is_not_said():
    assert Position(**FULL).on == "red"
    assert Position(**FULL | {"reds": []}).on == "pink"
    assert Position(**FULL, on=BallOn.ANY_COLOUR).on == "any_colour"
    assert Position(black=(0.0, 1.4605), over=True, on="nothing").cue is None
    assert Position(over=True).on == "nothing"


def test_a_cue_ball_in_hand_lies_in_the_d():
    assert Position(reds=[(0.3, 0.3)], in_hand=True).cue == pytest.approx(tuple(SPOTS[0]))
    beside = Position(reds=[tuple(SPOTS[0])], in_hand=True)  # its usual place is taken
    assert np.hypot(*(beside.cue - SPOTS[0])) == pytest.approx(2 * 0.02625, abs=1e-3)
    with pytest.raises(ValueError, match="in_hand = True: must be False with the cue ball at"):
        Position(cue=(0.0, 0.0), reds=[(0.3, 0.3)], in_hand=True)


def test_positions_of_states_and_of_environments_are_the_same():
    env = sn.SnookerVectorEnv(4, noise="club", layout="random:5")
    env.reset(seed=0)
    batch, states = Positions.of(env), Positions.of(env.get_state())
    for name in ("positions", "on_table", "game"):
        assert np.array_equal(getattr(batch, name), getattr(states, name))
    assert Positions.of(batch) is batch and len(Positions.of(env.get_state()[1])) == 1
    assert repr(batch) == "Positions(4 rows)"
    assert batch.balls_on.sum(axis=1).tolist() == [5] * 4 and not batch.over.any() and not batch.in_hand.any()


def test_one_row_is_words_and_any_other_index_a_batch():
    env = sn.SnookerVectorEnv(5, layout="random:3")
    env.reset(seed=0)
    batch = Positions.of(env)
    assert isinstance(batch[2], Position) and batch[-1] == batch[4] and [p.on for p in batch] == ["red"] * 5
    # reds keep their order here
    assert np.array_equal(Positions.of(list(batch)).observations(), batch.observations())
    for rows in (slice(1, 5, 2), [1, 3], np.array([False, True, False, True, False])):
        assert np.array_equal(batch[rows].positions, batch.positions[[1, 3]])
        assert batch[rows].positions.flags.c_contiguous
    view = batch[1:3]
    view.ball_on[:] = 0
    assert batch.ball_on.tolist() == [1, 0, 0, 1, 1]
    with pytest.raises(IndexError):
        batch[5]


def test_positions_of_frames_hold_what_the_striker_may_know():
    env = sn.SnookerVectorEnv(3, task="match", frames=5, miss="clear_path")
    env.reset(seed=0)
    game, saved = env.tables.game, env.tables.layouts_before
    sides = columns.SCORE_0, columns.SCORE_1, columns.FRAMES_0, columns.FRAMES_1
    game[:, [columns.STRIKER, *sides]] = (0, 20, 7, 1, 2)
    game[1, [columns.STRIKER, columns.FREE_BALL, columns.PHASE, columns.MISS_CALLED]] = (
        1,
        1,
        columns.CHOICE,
        1,
    )
    game[2, [columns.PHASE, columns.RESPOTTED_BLACK]] = columns.LOT, 1
    saved.positions[1, 0] = (0.1, 0.2)
    at = Positions.of(env)
    assert at.of_frames and at.game.shape == (3, 33) and at.saved.positions[1, 0].tolist() == [0.1, 0.2]
    assert at.scores.tolist() == [[20, 7], [7, 20], [20, 7]]
    assert [each.tolist() for each in (at.free_ball, at.choice, at.miss_called)] == [[False, True, False]] * 3
    assert [each.tolist() for each in (at.lot, at.respotted_black)] == [[False, False, True]] * 2
    assert at.balls_on.sum(axis=1).tolist() == [15, 21, 15] and not at.anywhere.any()
    assert not at.game[:, columns.STRIKER].any()
    assert game[1, columns.STRIKER] == 1  # the environment's own rows stay as they are
    part = at[[1]]
    assert part.free_ball.all() and part.saved.positions[0, 0].tolist() == [0.1, 0.2]
    assert part.copy().saved.on_table.shape == (1, 22)
    visits = at.as_visits()
    assert visits.game.shape == (3, 5) and visits.ball_on.tolist() == [1, 0, 1]
    assert visits.as_visits() is visits
    assert not (visits.free_ball.any() or visits.choice.any() or visits.scores.any() or visits.of_frames)
    assert at[1].on == "any_colour" and at[0].on == "red"


BALLS = {"cue": (0.1, -1.2), "reds": [(0.3, 0.5), (1 / 3, -0.7)], "black": (0.0, 1.4605)}
POSITION = Position(**BALLS, on="any_colour", points=9, in_hand=True)


def test_a_file_holds_the_position_to_the_last_bit_on_any_table(tmp_path):
    file = tmp_path / "one.json"
    POSITION.save(file)
    assert Position.load(file) == POSITION and Position.load(str(file)) == POSITION
    assert json.loads(file.read_text()) == POSITION.to_dict() and file.stat().st_size < 300
    assert [p.name for p in tmp_path.iterdir()] == ["one.json"]
    far = Position(cue=(0.0, 0.0), black=(3.0, 0.0), table=None)
    far.save(tmp_path / "far.json")
    assert Position.load(tmp_path / "far.json", table=None) == far
    refused(
        lambda: Position.load(tmp_path / "far.json"),
        f"{tmp_path / 'far.json'}: black",
        "3.0",
        "must be on the table",
    )
