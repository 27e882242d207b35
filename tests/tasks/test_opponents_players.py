"""May any player be the opponent, seen from its own side and asked once for all tables?"""

import copy
import json
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

import snooker_env as sn
from snooker_env.game.balls import BLACK, CUE, GREEN, SPOTS, BallOn
from snooker_env.game.frame_columns import (
    BREAKER,
    COLUMNS,
    PLAY_AGAIN,
    REPLACE,
    SCORE_0,
    SCORE_1,
    STRIKER,
    WINNER,
)
from snooker_env.game.sides import swapped
from snooker_env.geometry import BALL_RADIUS, BAULK_Y
from snooker_env.players import Strokes
from snooker_env.tasks import OpponentPool
from snooker_env.tasks.declarations import CONCEDES
from snooker_env.tasks.stroke import ShotBuffers
from tests.tables import PLACES, frame_env, frame_state

MISS = [-0.9, 0, 0, 1.0, 0, 0, 0]


class Soft:
    """Plays one soft stroke upwards, and keeps what it was asked."""

    def __init__(self, **said):
        self.said, self.calls, self.rules = said, [], None

    def at(self, rules):
        self.rules = rules
        return self

    def play(self, positions, seeds):
        self.calls.append((positions, np.array(seeds)))
        n = len(positions)
        return Strokes(
            np.tile([0.5, 0.0, 0.0, np.pi / 2, 0.0], (n, 1)),
            **{k: np.full((n, *np.shape(v)), v) for k, v in self.said.items()},
        )


class Drawing(Soft):
    """Random strokes, of the seeds that it is given."""

    def play(self, positions, seeds):
        drawn = np.array([np.random.default_rng(seed).random(2) for seed in seeds.tolist()])
        strokes = np.zeros((len(seeds), 5))
        strokes[:, 0], strokes[:, 3] = 0.5 + 3 * drawn[:, 0], 6 * drawn[:, 1]
        return Strokes(strokes)


class Sees:
    """Acts on the observations of a visit, or of a frame."""

    def __init__(self, **options):
        self.options, self.seen = options, []

    def act(self, observations, masks, seeds):
        self.seen.append(observations)
        return (
            np.argmax(masks, axis=1) if masks is not None else np.tile([-0.9, 0.0, 0.0, 1.0], (len(seeds), 1))
        )


def asked(env):
    """The opponent's turn on the first table, up to the strike: (its buffers, the tables with a stroke)."""
    one, opponent, buffers = np.zeros(1, np.int64), env.tables.seats[1].player, ShotBuffers(1)
    which = opponent.prepare(env.tables, one, opponent.ask(env.tables, one, [None]), buffers)
    return buffers, which.tolist()


def test_a_player_sees_the_frame_as_the_striker():
    player = Soft()
    env = frame_state(frame_env(opponent=player, noise="club", fidelity="fast"), PLACES, {"scores": (31, 62)})
    player.calls.clear()
    env.step(MISS)
    at, seeds = player.calls[0]
    assert at.of_frames and at.game[0, STRIKER] == 0 and at.scores.tolist() == [[62, 31]]
    assert player.rules is env.options and 0 <= seeds[0] < 2**32


def test_an_object_that_acts_sees_observations():
    for options, size in (({}, 121), ({"task": "frame"}, 140), ({"action": "discrete"}, 121)):
        one = Sees(**options)
        env = frame_state(frame_env(opponent=one), PLACES, {"scores": (31, 62)})
        one.seen.clear()
        assert env.step(MISS)[4]["opponent_strokes"] > 0 and one.seen[0].shape == (1, size)


def test_to_change_sides_twice_changes_nothing():
    rng = np.random.default_rng(0)
    game = rng.integers(0, 2, (50, COLUMNS))
    game[:, WINNER] = rng.integers(-1, 2, 50)
    other = swapped(game)
    assert np.array_equal(swapped(other), game) and np.array_equal(other[:, SCORE_0], game[:, SCORE_1])
    assert (other[:, BREAKER] == 1 - game[:, BREAKER]).all()
    assert ((other[:, WINNER] < 0) == (game[:, WINNER] < 0)).all()


def test_one_call_serves_all_tables_that_wait():
    player = Soft()
    tables = sn.SnookerVectorEnv(
        16, threads=2, task="frame", opponent=player, layout="random:3", aim="target"
    )
    tables.reset(seed=0)
    player.calls.clear()
    _, _, _, _, info = tables.step(np.tile(MISS[:4], (16, 1)))
    assert len(player.calls) == info["opponent_strokes"].max() and len(player.calls[0][0]) > 8


def test_its_stroke_is_played_as_it_is():
    env = frame_state(frame_env(opponent=Soft()), PLACES, {})
    env.tables.game[0, STRIKER] = 1
    buffers, which = asked(env)
    assert which == [0] and buffers.v[0, CUE] == pytest.approx((0.0, np.hypot(*buffers.v[0, CUE])), abs=1e-12)
    assert np.array_equal(buffers.r[0, CUE], PLACES[CUE])


def test_it_places_the_cue_ball_and_nominates():
    env = frame_env(opponent=Soft(place=(0.1, BAULK_Y - 0.1), nominate=GREEN))
    places = PLACES | {CUE: (0.0, BAULK_Y - 0.2), GREEN: SPOTS[GREEN]}
    env = frame_state(env, places, {"in_hand": True, "ball_on": BallOn.ANY_COLOUR})
    env.tables.game[0, STRIKER] = 1
    buffers, _ = asked(env)
    assert buffers.r[0, CUE] == pytest.approx((0.1, BAULK_Y - 0.1)) and env.tables.nominated[0] == GREEN


def test_it_decides_after_a_foul_and_may_concede():
    hidden = {CUE: (0.3, 0.3), 1: (0.3, 1.2), GREEN: (0.3, 0.6), BLACK: SPOTS[BLACK]}
    foul = [-0.9, 0, 0, -0.5, 0, 0, 0]  # away from all balls: snookered behind the green
    env = frame_state(frame_env(opponent=Soft(decision=PLAY_AGAIN), aim="absolute"), hidden, {})
    _, _, _, _, info = env.step(foul)
    assert info["foul"] and env.frame.striker == 0 and env.frame.phase == "stroke"
    assert info["opponent_strokes"] == 0
    # a free ball is void for an offender who plays again
    assert not env.frame.free_ball and env.ball_on == BallOn.RED
    env = frame_state(
        frame_env(opponent=Soft(decision=REPLACE), aim="absolute", miss="clear_path"), PLACES, {}
    )
    env.step(foul)
    assert env.positions[CUE].tolist() == list(PLACES[CUE]) and env.frame.warned is False
    assert env.frame.failures == 1
    env = frame_state(frame_env(opponent=Soft(declare=CONCEDES), aim="absolute"), PLACES, {})
    _, _, terminated, _, info = env.step(foul)
    assert terminated and info["winner"] == 0 and info["opponent_strokes"] == 0


@pytest.mark.parametrize("anywhere", [False, True])
def test_without_a_place_in_its_action_it_stands_where_ghost_ball_would(anywhere):
    shoot_out = {"anywhere": True, "rules": "shoot_out", "miss": "off"} if anywhere else {}
    env = frame_env(opponent=Sees(), game="shoot_out" if anywhere else "snooker")
    places = {CUE: (0.0, BAULK_Y - 0.1), 1: (0.4, 1.0), 21: SPOTS[21], 20: SPOTS[20], 17: SPOTS[17]}
    env = frame_state(env, places, {"in_hand": True} | shoot_out)
    env.tables.game[0, STRIKER] = 1
    buffers, _ = asked(env)
    assert not np.array_equal(buffers.r[0, CUE], places[CUE])
    if anywhere:
        assert np.hypot(*(buffers.r[0, CUE] - (0.4, 1.0))) == pytest.approx(0.3 + 2 * BALL_RADIUS)


def test_with_a_free_ball_any_colour_is_on_for_a_player_of_visits():
    """Snookered by a foul on the only red: a player blind to the free ball strikes at the hidden red."""
    places = {CUE: (0.3, 0.3), 1: (0.3, 1.2), GREEN: (0.3, 0.6), BLACK: SPOTS[BLACK]}
    one = Sees(action="discrete")
    env = frame_state(frame_env(opponent=one), places, {"striker": 0, "phase": "choice", "free_ball": True})
    env.tables.game[0, STRIKER] = 1  # the opponent has the free ball
    buffers, _ = asked(env)
    assert one.seen[-1][0, 110 + 1] == 1.0 and env.frame.free_ball and env.ball_on == BallOn.RED
    assert buffers.v[0, CUE, 1] > 0


@pytest.mark.parametrize(
    "name", ["best_pot", "search_30", "planner_30", "tests.tasks.test_opponents_players:Soft"]
)
def test_a_name_may_play(name):
    env = gymnasium.make(
        "Snooker-v0",
        task="frame",
        opponent=name,
        layout="pots:easy",
        noise="none",
        max_strokes=4,
        aim="target",
    )
    env = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    for seed in range(3):
        env.reset(seed=seed)
        if not env.unwrapped.over:
            _, _, _, _, info = env.step(MISS[:4])
    assert env.unwrapped.tables.seats[1].player.name == name and info["strokes"] >= 2


@pytest.mark.parametrize("n", [1, 5])
def test_a_player_plays_alike_again_whatever_other_tables_do(n):
    options = {"task": "frame", "layout": "random:2", "noise": "club", "aim": "target", "opponent": Drawing()}
    env = sn.SnookerEnv(**options)
    many = sn.SnookerVectorEnv(n, threads=2, **options)
    env.reset(seed=3)
    many.reset(seed=list(range(3, 3 + n)))
    for _ in range(5):
        state = env.get_state()
        one, all_of_them = env.step(MISS[:4]), many.step(np.tile(MISS[:4], (n, 1)))
        assert np.array_equal(one[0], all_of_them[0][0]) and one[1] == all_of_them[1][0]
        if env.over:
            break
        again = sn.SnookerEnv(**options)
        again.reset(seed=99)
        again.set_state(json.loads(json.dumps(state)))
        assert data_equivalence(again.step(MISS[:4])[:4], one[:4], exact=True)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (None, r"opponent Wrong: play\(...\) = a NoneType: must be 1 Strokes, one for each position"),
        (
            Strokes(np.tile([1.0, 0, 0, 0, 0], (3, 1))),
            r"opponent Wrong: play\(...\) = 3 Strokes: must be 1 Strokes",
        ),
    ],
)
def test_what_a_player_answers_is_checked_and_it_is_named(answer, says):
    class Wrong(Soft):
        def play(self, positions, seeds):
            return answer

    env = frame_env(opponent=Wrong())
    with pytest.raises(ValueError, match=f"^{says}"):
        [env.reset(seed=seed) for seed in range(10)]


@pytest.mark.parametrize(
    ("error", "kind"),
    [(ValueError("mine"), ValueError), (TypeError("mine"), TypeError), (KeyError("mine"), RuntimeError)],
)
def test_an_error_of_a_player_names_it(error, kind):
    class Failing(Soft):
        def play(self, positions, seeds):
            raise error

    env = frame_env(opponent=Failing())
    with pytest.raises(kind) as info:
        [env.reset(seed=seed) for seed in range(10)]
    assert str(info.value) == f"opponent Failing raised {type(error).__name__}: {error}"
    assert info.value.__cause__ is error


def test_the_end_of_a_program_is_no_error_of_a_player():
    class Stopped(Soft):
        def play(self, positions, seeds):
            raise KeyboardInterrupt

    env = frame_env(opponent=Stopped())
    with pytest.raises(KeyboardInterrupt):
        [env.reset(seed=seed) for seed in range(10)]


@pytest.mark.parametrize("name", ["best_pot", "search_30", "player", "pool"])
def test_any_opponent_plays_matches_and_stable_baselines_tables(name):
    pytest.importorskip("stable_baselines3")
    from snooker_env.sb3 import SnookerVecEnv

    opponent = {"player": Soft(), "pool": OpponentPool(["ghost_ball", Soft(), "best_pot"])}.get(name, name)
    options = {
        "task": "match",
        "frames": 3,
        "opponent": opponent,
        "layout": "pots:easy",
        "aim": "target",
        "max_strokes": 20,
    }
    env = sn.SnookerEnv(**options)
    env.reset(seed=1)
    over = strokes = steps = 0
    while not over and steps < 100:
        _, _, terminated, truncated, info = env.step(MISS[:4])
        over, strokes, steps = terminated or truncated, strokes + info["opponent_strokes"], steps + 1
    assert over and strokes > 0 and (truncated or max(info["frames_won"], info["opponent_frames"]) == 2)
    tables = SnookerVecEnv(3, threads=1, info_keys=["opponent_strokes"], **options)
    tables.seed(1)
    tables.reset()
    ended = strokes = 0
    for _ in range(12):
        _, _, dones, infos = tables.step(np.tile(np.array(MISS[:4], np.float32), (3, 1)))
        ended, strokes = ended + dones.sum(), strokes + sum(info["opponent_strokes"] for info in infos)
    tables.close()
    assert ended > 0 and strokes > 0


def test_a_name_that_nobody_has_is_refused_with_the_names():
    for name in ("tests.tasks.test_opponents_players:Nobody", ""):
        with pytest.raises(ValueError, match=r"^opponent = "):
            frame_env(opponent=name)
    with pytest.raises(
        ValueError,
        match=r"^opponent = 'serch': must be one of 'none', 'random', 'ghost_ball', .*MODULE:CLASS",
    ):
        frame_env(opponent="serch")


def test_what_is_no_player_is_refused():
    for wrong, says in (
        (Soft, r"opponent = <class '.*Soft'>: must be an instance and not the class: Soft\(...\)"),
        (OpponentPool, r"opponent = <class '.*OpponentPool'>: must be an instance"),
        (7, "opponent = 7: must be one of 'none', 'random', 'ghost_ball', the name of another player"),
        (Sees(noise="club"), "key of the options of player Sees = 'noise': must be one of 'action'"),
    ):
        with pytest.raises(ValueError, match=f"^{says}"):
            frame_env(opponent=wrong)


def test_options_hold_text_and_objects_come_beside_them():
    with pytest.raises(ValueError, match=r"^opponent = .*: must be one of .*Options hold text"):
        sn.Options(task="frame", opponent=Soft())
    env = sn.SnookerEnv(task="frame", opponent=Soft())
    assert env.options.opponent == "object"
    with pytest.raises(ValueError, match=r"^opponent = 'object': must come with the object"):
        sn.SnookerEnv(env.options)
    again = sn.SnookerVectorEnv(2, env.options, opponent=Soft())
    assert again.options == env.options
    assert sn.SnookerEnv(sn.Options(task="frame"), opponent=Soft()).options.opponent == "object"


def test_copies_of_an_environment_play_on_alike():
    env = frame_env(opponent=Soft(), layout="random:2", noise="club")
    env.reset(seed=2)
    copies = copy.deepcopy(env), pickle.loads(pickle.dumps(env))
    first = env.step(MISS)
    assert all(data_equivalence(one.step(MISS)[:4], first[:4], exact=True) for one in copies)


def test_says_and_the_flags_are_two_spellings():
    options = sn.Options(task="frame", decision=True, says=["lot"])
    assert options.says == ("decision", "lot") and options.decision and not options.nominate
    assert options == sn.Options(task="frame", lot=True, says=("decision",))
    assert options.but(decision=False).says == ("lot",)
    assert options.but(says=("claim",)).says == ("claim",) and options.but(noise="club").says == options.says
    assert (
        sn.SnookerEnv(options).action_space
        == sn.SnookerEnv(task="frame", decision=True, lot=True).action_space
    )


def test_groups_hold_every_option_once():
    groups = [sn.Options.group(name) for name in ("task", "action", "view", "shot", "frame")]
    names = [name for group in groups for name in group]
    assert len(names) == len(set(names)) == 21
    assert set(sn.Options.group("action", "visit")) == {"action", "aim", "elevation", "placement"}
    assert all(getattr(sn.Options(), name) == default for group in groups for name, default in group.items())
