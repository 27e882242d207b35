"""Is the chance to win in a replay that of each position of the frame, from the first player's side?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.game import frame_columns as columns
from snooker_env.game.frame import frame_of
from snooker_env.planning import Position, Positions
from snooker_env.play.session import Session
from snooker_env.replays.chances import standings_of
from tests.playing import EASY, STRAIGHT, Asked
from tests.refusals import refused
from tests.replays.test_replays import keeping, visit

GAME = {"task": "frame", "opponent": "ghost_ball", "miss": "clear_path", "noise": "club", **sn.players.FRAMES}


class Judge:
    """Says a chance of the striker's lead, and remembers the positions."""

    def chance_to_win(self, positions):
        self.seen = positions
        lead = positions.scores[:, 0] - positions.scores[:, 1]
        won = positions.game[:, columns.WINNER] == 0
        return np.where(
            positions.game[:, columns.PHASE] == columns.FINISHED, won, 1 / (1 + np.exp(-lead / 9))
        )


@pytest.fixture(scope="module")
def frame():
    """A frame to its end, and the positions in which the agent was asked, by the strokes before them."""
    env, player = keeping(1, **GAME), sn.player("ghost_ball").at(GAME)
    asked, ended = {}, False
    while not ended:
        at = Positions.of(env)
        asked[len(env.history)] = at
        _, _, ended, _, _ = env.step(player.play(at, [7]).actions(env.options, at)[0].astype(np.float32))
    return env, asked


def test_each_position_is_judged_as_it_stood(frame):
    env, asked = frame
    judge = Judge()
    replay = sn.replay(env, judge=judge)
    assert len(judge.seen) == len(env.history) + 1 == len(replay.win_chance)
    choices = 0
    for k, at in asked.items():
        if k == 0 and env.history[0].player == 0:
            continue  # the break-off: its cue ball is placed by then
        rules = [
            frame_of(row, "clear_path", saved, j)
            for row, saved, j in ((judge.seen.game[k], judge.seen.saved, k), (at.game[0], at.saved, 0))
        ]
        assert rules[0] == rules[1], k
        here = at.on_table[0]
        assert np.array_equal(judge.seen.on_table[k], here)
        assert np.array_equal(judge.seen.positions[k][here], at.positions[0][here])
        choices += rules[0].saved is not None and rules[0].saved.layout is not None
    assert choices > 0  # of fouls, the balls before them are known, too


def test_the_chance_is_the_first_players_and_certain_at_the_end_alone(frame):
    env, _ = frame
    chances = sn.replay(env, judge=Judge()).win_chance
    for played, chance in zip(env.history[:-1], chances[1:-1], strict=True):
        first, other = played.scores
        assert chance == pytest.approx(
            np.clip(1 / (1 + np.exp((other - first) / 9)), 1e-4, 1 - 1e-4), abs=1e-4
        )
        assert 0.0 < chance < 1.0
    assert chances[0] == 0.5 and chances[-1] == float(env.history[-1].winner == 0)


@pytest.mark.parametrize(("says", "kept"), [(1.0, (1.0, 0.0)), (1.0 - 1e-9, (0.9999, 0.0001))])
def test_rounding_makes_no_chance_certain(frame, says, kept):
    env, _ = frame

    class Sure:
        def chance_to_win(self, positions):
            return np.full(len(positions), says)

    chances = sn.replay(env, judge=Sure()).win_chance
    strikers = [env.history[0].player, *(played.next_player for played in env.history[:-1])]
    assert list(chances[:-1]) == [kept[striker] for striker in strikers]


def test_the_first_stroke_is_undone_whatever_it_was(frame):
    """The frame before each stroke, as if the replay began there, is the one after the stroke before it."""
    history = frame[0].history
    seen = set()
    for k in range(1, len(history)):
        before, after = standings_of(history[k:])[0], standings_of(history)[k]
        if after.frame.phase != "stroke" or after.frame.in_hand:
            continue
        seen.add((history[k].points > 0, history[k].penalty > 0))
        for name in (
            "scores",
            "striker",
            "breaker",
            "break_points",
            "on_table",
            "ball_on",
            "free_ball",
            "rack",
        ):
            assert getattr(before.frame, name) == getattr(after.frame, name), (k, name)
        assert np.array_equal(before.on_table, after.on_table)
        here = before.on_table
        np.testing.assert_allclose(before.positions[here], after.positions[here], rtol=0, atol=1e-12)
    assert {(True, False), (False, True), (False, False)} <= seen


def test_what_nobody_wins_is_refused(frame):
    env, _ = frame
    strokes, shot = visit(3, 2), env.history[0].shot
    refused(lambda: sn.replay(strokes, judge=Judge()), "strokes[0]", "visit", "must be of a frame")
    refused(lambda: sn.replay([shot], judge=Judge()), "strokes[0]", "bare shot", "must be of a frame")
    refused(lambda: sn.replay(env, judge=3), "judge", "int", "must have chance_to_win")


def test_the_luck_of_a_game_is_kept_for_each_stroke():
    """Where nobody errs none is known."""
    game = Asked()
    game("players", players=["person", "person"], noise=["none", "none"])
    game("position", position=EASY, scores=[20, 30])
    game("stroke", speed=2.0, aim=STRAIGHT)
    assert game.get("replay")["luck"] is None
    game("players", players=["person", "person"], noise=["club", "beginner"])
    for speed in (2.0, 1.5, 0.9, 2.5, 1.0):
        striker = round(10 * speed) % 2
        game("position", position=EASY, scores=[20, 30], striker=striker)
        game("stroke", speed=speed, aim=STRAIGHT)
    game("concede")
    data = game.get("replay")
    assert len(data["luck"]) == len(data["strokes"]) == 6 and all(abs(one) <= 1 for one in data["luck"])
    assert {stroke["player"] for stroke in data["strokes"]} == {0, 1} and max(map(abs, data["luck"])) >= 0.01
    game.service.close()


def test_luck_is_the_strikers_on_either_seat():
    """A pot is lucky, a miss is not, and in the mean the same stroke is neither."""
    told = np.zeros((2, 40, 2))
    for seat, seed in np.ndindex(2, 40):
        session, side = Session(seed=seed), 1 - 2 * seat
        session.noise[:] = ["beginner", "club"][::side]
        session.set_up(Position(**EASY), scores=(20, 30)[::side], striker=seat, free_ball=False)
        act = session.play(CueStroke(speed=1.5, aim=STRAIGHT))
        told[seat, seed] = act.luck, act.played.points > 0
    assert told[1] == pytest.approx(told[0], abs=1e-9)
    luck, potted = told[0].T
    assert luck[potted > 0].mean() > 0.02 and luck[potted == 0].mean() < -0.02
    assert abs(luck.mean()) < 3.0 * luck.std() / 40**0.5


def test_luck_stands_beside_chances_alone(frame):
    env, _ = frame
    n = len(env.history)
    luck = [0.1] * n
    told = sn.Replay(env.history, judge=Judge(), luck=luck)
    assert told.to_dict()["luck"] == luck == list(told.luck)
    assert sn.replay(env, judge=Judge()).luck is None
    refused(lambda: sn.Replay(env.history, luck=luck), "luck", "[0.1", "must be None: without a judge")
    refused(
        lambda: sn.Replay(env.history, judge=Judge(), luck=luck[1:]), "luck", "[0.1", f"must be {n} numbers"
    )
    refused(
        lambda: sn.Replay(env.history, judge=Judge(), luck=[*luck[1:], 1.5]),
        f"luck[{n - 1}]",
        "1.5",
        "[-1, 1]",
    )
