"""May any player be the opponent, seen from its own side and asked once for all tables?"""

import copy
from typing import ClassVar

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import frame_columns as columns
from snooker_env.game.balls import BLACK, CUE, GREEN, SPOTS, BallOn
from snooker_env.game.frame_columns import PLAY_AGAIN, REPLACE, STRIKER
from snooker_env.geometry import BALL_RADIUS, BAULK_Y
from snooker_env.players import OpponentPool, SeenPlayer, Strokes
from snooker_env.players.opponents import opponent_of
from snooker_env.tasks.declarations import CONCEDES
from snooker_env.tasks.stroke import ShotBuffers
from snooker_env.tasks.tables import Crew
from tests.tables import PLACES, begun, frame_env, frame_state, plain

MISS = [-0.9, 0, 0, 1.0, 0, 0, 0]
HIDDEN = {CUE: (0.3, 0.3), 1: (0.3, 1.2), GREEN: (0.3, 0.6), BLACK: SPOTS[BLACK]}


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
        said = {k: np.full((n, *np.shape(v)), v) for k, v in self.said.items()}
        return Strokes(np.tile([0.5, 0.0, 0.0, np.pi / 2, 0.0], (n, 1)), **said)


class Sees:
    """Acts on the observations of a visit, or of a frame."""

    options: ClassVar = {}

    def __init__(self, **options):
        self.options, self.seen = options or self.options, []

    def act(self, observations, masks, seeds):
        self.seen.append(observations)
        return np.tile(MISS[:4], (len(seeds), 1)) if masks is None else np.argmax(masks, axis=1)


def asked(env):
    """The opponent's turn on the first table, up to the strike: (its buffers, the tables with a stroke)."""
    one, opponent, buffers = np.zeros(1, np.int64), env.tables.seats[1].player, ShotBuffers(1)
    strokes = opponent.strokes(env.tables, one, Crew(buffers))
    return buffers, env.tables.carry_out(one, strokes, buffers, 1).tolist()


def test_a_player_sees_the_frame_as_the_striker():
    player = Soft()
    env = frame_state(frame_env(opponent=player, noise="club", fidelity="fast"), PLACES, {"scores": (31, 62)})
    player.calls.clear()
    env.step(MISS)
    at, seeds = player.calls[0]
    assert at.of_frames and at.game[0, STRIKER] == 0 and at.scores.tolist() == [[62, 31]]
    assert player.rules is env.options and 0 <= seeds[0] < 2**32


def test_one_call_serves_all_tables_that_wait():
    player = Soft()
    options = {"task": "frame", "opponent": player, "layout": "random:3", "aim": "target"}
    tables = begun(sn.SnookerVectorEnv(16, threads=2, **options), 0)
    player.calls.clear()
    _, _, _, _, info = tables.step(np.tile(MISS[:4], (16, 1)))
    assert len(player.calls) == info["opponent_strokes"].max() and len(player.calls[0][0]) > 8


@pytest.mark.parametrize("name", ["ghost_ball", "random"])
@pytest.mark.parametrize(
    "options",
    [
        {"aim": "target", "noise": "club", "miss": "clear_path", "layout": "random:3"},
        {"action": "discrete", "cue": "real", "noise": "professional", "layout": "colours"},
        {"conditions": "drawn", "says": ["nominate", "decision"], "game": "shoot_out", "layout": "random:2"},
    ],
    ids=["box", "discrete", "drawn"],
)
def test_a_name_is_one_player(name, options, monkeypatch):
    """What the opponent with a name does is what the player with that name answers, on any number of threads."""
    monkeypatch.setattr("snooker_env.tasks.threads.CHUNK", 4)
    asked, player = [], sn.player(name)

    class Same(Soft):
        def at(self, rules):
            self.player = player.at(rules)
            return self

        def play(self, positions, seeds):
            asked.append(len(positions))
            return self.player.play(positions, seeds)

    runs = []
    for opponent in (name, Same()):
        tables = begun(sn.SnookerVectorEnv(20, threads=3, task="frame", opponent=opponent, **options), 3)
        rng, shape = np.random.default_rng(0), tables.action_space.shape
        for _ in range(5):
            masks = tables.action_masks() if "action" in options else None
            tables.step(rng.uniform(-1.0, 1.0, shape) if masks is None else masks.argmax(axis=1))
        runs.append([plain(state) | {"rng": None} for state in tables.get_state()])
    assert runs[0] == runs[1] and sum(asked) > 60


def test_it_places_the_cue_ball_and_nominates():
    env = frame_env(opponent=Soft(place=(0.1, BAULK_Y - 0.1), nominate=GREEN))
    places = PLACES | {CUE: (0.0, BAULK_Y - 0.2), GREEN: SPOTS[GREEN]}
    env = frame_state(env, places, {"in_hand": True, "ball_on": BallOn.ANY_COLOUR})
    env.tables.game[0, STRIKER] = 1
    buffers, _ = asked(env)
    assert buffers.r[0, CUE] == pytest.approx((0.1, BAULK_Y - 0.1)) and env.tables.nominated[0] == GREEN


def test_it_decides_after_a_foul_and_may_concede():
    foul = [-0.9, 0, 0, -0.5, 0, 0, 0]  # away from all balls: snookered behind the green
    env = frame_state(frame_env(opponent=Soft(decision=PLAY_AGAIN), aim="absolute"), HIDDEN, {})
    _, _, _, _, info = env.step(foul)
    assert info["foul"] and env.frame.striker == 0 and env.frame.phase == "stroke"
    assert info["opponent_strokes"] == 0
    # a free ball is void for an offender who plays again
    assert not env.frame.free_ball and env.ball_on == BallOn.RED
    replaces = frame_env(opponent=Soft(decision=REPLACE), aim="absolute", miss="clear_path")
    env = frame_state(replaces, PLACES, {})
    env.step(foul)
    assert env.positions[CUE].tolist() == list(PLACES[CUE]) and env.frame.warned is False
    assert env.frame.failures == 1
    env = frame_state(frame_env(opponent=Soft(declare=CONCEDES), aim="absolute"), PLACES, {})
    _, _, terminated, _, info = env.step(foul)
    assert terminated and info["winner"] == 0 and info["opponent_strokes"] == 0


@pytest.mark.parametrize("anywhere", [False, True])
def test_without_a_place_in_its_action_it_stands_where_ghost_ball_would(anywhere):
    shoot_out = {"anywhere": True, "rules": "shoot_out", "miss": "off"} if anywhere else {}
    env = frame_env(opponent=SeenPlayer(Sees()), game="shoot_out" if anywhere else "snooker")
    places = {CUE: (0.0, BAULK_Y - 0.1), 1: (0.4, 1.0), 21: SPOTS[21], 20: SPOTS[20], 17: SPOTS[17]}
    env = frame_state(env, places, {"in_hand": True} | shoot_out)
    env.tables.game[0, STRIKER] = 1
    buffers, _ = asked(env)
    assert not np.array_equal(buffers.r[0, CUE], places[CUE])
    if anywhere:
        assert np.hypot(*(buffers.r[0, CUE] - (0.4, 1.0))) == pytest.approx(0.3 + 2 * BALL_RADIUS)


def test_with_a_free_ball_any_colour_is_on_for_a_player_of_visits():
    """Snookered by a foul on the only red: a player blind to the free ball strikes at the hidden red."""
    one = Sees(action="discrete", observation="flat")
    choice = {"striker": 0, "phase": "choice", "free_ball": True}
    env = frame_state(frame_env(opponent=SeenPlayer(one)), HIDDEN, choice)
    env.tables.game[0, STRIKER] = 1  # the opponent has the free ball
    buffers, _ = asked(env)
    assert one.seen[-1][0, 110 + 1] == 1.0 and env.frame.free_ball and env.ball_on == BallOn.RED
    assert buffers.v[0, CUE, 1] > 0


@pytest.mark.parametrize("name", ["search_30", "tests.tasks.test_opponents_players:Soft"])
def test_a_name_may_play(name):
    options = {"layout": "pots:easy", "noise": "none", "max_strokes": 4, "aim": "target"}
    env = gymnasium.make("Snooker-v0", task="frame", opponent=name, **options)
    env = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    for seed in range(3):
        env.reset(seed=seed)
        if not env.unwrapped.over:
            _, _, _, _, info = env.step(MISS[:4])
    assert env.unwrapped.tables.seats[1].player.name == name and info["strokes"] >= 2


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (None, r"opponent Wrong: play\(...\) = a NoneType: must be 1 Strokes, one for each position"),
        (Strokes([[1.0, 0, 0, 0, 0]] * 3), r"opponent Wrong: play\(...\) = 3 Strokes: must be 1 Strokes"),
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
    error = KeyboardInterrupt()  # the end of a program is no error of a player
    with pytest.raises(KeyboardInterrupt):
        [env.reset(seed=seed) for seed in range(10)]


class SeesNothing(Sees):
    options: ClassVar = {"nix": 1}


OPTIONS_OF = "key of the options of player "
ACTS = (Sees(), lambda observation, rng: MISS)


@pytest.mark.parametrize(
    ("opponent", "says"),
    [
        (f"{__name__}:Nobody", "opponent = "),
        ("", "opponent = "),
        ("serch", "opponent = 'serch': must be one of 'none', 'random', 'ghost_ball', .*MODULE:CLASS"),
        (Soft, r"opponent = <class '.*Soft'>: must be an instance and not the class: Soft\(...\)"),
        (OpponentPool, "opponent = <class '.*OpponentPool'>: must be an instance"),
        ("none,random", "opponent = 'none,random': must be 'none' alone"),
        (7, "opponent = 7: must be one of 'none', 'random', 'ghost_ball', the name of another player"),
        *(
            (one, "opponent = .*: must be one of .*; players.SeenPlayer wraps an object that acts")
            for one in ACTS
        ),
        (f"{__name__}:SeesNothing", f"opponent = '.*SeesNothing': {OPTIONS_OF}SeesNothing"),
    ],
)
def test_what_is_no_player_is_refused(opponent, says):
    with pytest.raises(ValueError, match=f"^{says}"):
        frame_env(opponent=opponent)


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


def test_groups_hold_every_option_once():
    groups = [sn.Options.group(name) for name in ("task", "action", "view", "shot", "frame")]
    names = [name for group in groups for name in group]
    assert len(names) == len(set(names)) == 25
    assert set(sn.Options.group("action", "visit")) == {"action", "aim", "elevation", "placement"}
    assert all(getattr(sn.Options(), name) == default for group in groups for name, default in group.items())


# A pool draws an opponent for each table and frame, from its own stream, and keeps it in the state

DOWN = np.array([-0.9, 0.0, 0.0, 1.0])


class Noted(Soft):
    """Notes who played."""

    def __init__(self, name, seen):
        super().__init__()
        self.name, self.seen = name, seen

    def play(self, positions, seeds):
        self.seen.append(self.name)
        return super().play(positions, seeds)


FRAME = {"task": "frame", "layout": "random:2"}


def frames(pool, n=1, **options):
    return sn.SnookerVectorEnv(n, threads=2, opponent=pool, **FRAME, **options)


def test_one_is_drawn_for_each_frame_in_proportion_to_the_weights():
    tables = frames(OpponentPool(["random", "ghost_ball", "random"], weights=[1, 2, 0]), 300)
    tables.reset(seed=0)
    tables.step(np.tile(DOWN, (300, 1)))
    drawn = np.bincount(tables.tables.game[:, columns.OPPONENT], minlength=4)
    assert drawn[3] == 0 and 70 < drawn[1] < 130 and drawn[2] > 150


def test_the_one_drawn_plays_the_whole_frame():
    seen = []
    tables = frames(OpponentPool([Noted("a", seen), Noted("b", seen)]), max_strokes=30)
    by_frame = set()
    for seed in range(12):
        tables.reset(seed=seed)
        seen.clear()
        for _ in range(5):
            tables.step(DOWN[None])
        assert len(set(seen)) == 1
        by_frame |= set(seen)
    assert by_frame == {"a", "b"}


def test_members_may_be_added_while_frames_go_on():
    seen = []
    pool = OpponentPool([Noted("old", seen)])
    tables = frames(pool, 8, max_strokes=6)
    tables.reset(seed=0)
    pool.add(Noted("new", seen))
    pool.set_weight(0, 0.0)
    seen.clear()
    for _ in range(12):
        tables.step(np.tile(DOWN, (8, 1)))
    assert "new" in seen
    seen.clear()
    tables.reset(seed=100)
    tables.step(np.tile(DOWN, (8, 1)))
    assert set(seen) == {"new"} and copy.deepcopy(pool).weights == (0.0, 1.0)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: OpponentPool([]), r"members = \[\]: must hold one"),
        (lambda: OpponentPool(["random"], weights=[0]), r"weights = \[0\]: must hold a number above 0"),
        (lambda: OpponentPool(["random"], weights=[]), ".*weight"),
        (lambda: OpponentPool(["random"], weights=[-1.0]), ".*weight"),
        *[(lambda m=member: OpponentPool([m]), "member = ") for member in (OpponentPool(), "none", None)],
        (lambda: frames(OpponentPool(["nobody"])), ".*opponent = 'nobody'"),
    ],
)
def test_what_is_no_pool_is_refused(call, says):
    with pytest.raises(ValueError, match=f"^{says}"):
        call()


def test_weights_and_an_empty_pool():
    assert OpponentPool().members == ()
    assert OpponentPool(["random", "ghost_ball"], weights=[0, 1]).weights == (0.0, 1.0)
    empty = frames(OpponentPool(), 2)
    with pytest.raises(ValueError, match="must have a member with a weight above 0"):
        [(empty.reset(seed=seed), empty.step(np.tile(DOWN, (2, 1)))) for seed in range(5)]


def test_a_wrong_member_is_named():
    name = r"^members\[1\] of the OpponentPool: opponent = 'foo': must be one of 'none', 'random', 'ghost_ball', "
    with pytest.raises(ValueError, match=name):
        frames(OpponentPool(["random", "foo"]))
    tables = frames(pool := OpponentPool(["random"]), 2)
    pool.add("foo")
    with pytest.raises(ValueError, match=name):
        [(tables.reset(seed=seed), tables.step(np.tile(DOWN, (2, 1)))) for seed in range(5)]


def test_names_with_commas_are_a_pool_whatever_stands_first():
    for names in ("planner@club,ghost_ball", "ghost_ball, planner@club"):
        opponent = opponent_of(names, sn.Options(task="frame"))
        assert sorted(opponent.pool.members) == ["ghost_ball", "planner@club"]
