"""May any player of the project be the opponent, seen from his own side, by his own actions? Views, places, free balls, seeds, errors."""

import copy
import json
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

import snooker_env as sn
from snooker_env.benchmark import AtFrames
from snooker_env.game.balls import BLACK, CUE, GREEN, SPOTS, BallOn
from snooker_env.game.frame_columns import ANYWHERE, BREAKER, COLUMNS, IN_HAND, SCORE_0, SCORE_1, STRIKER, WINNER
from snooker_env.game.sides import swapped
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, HALF_LENGTH, HALF_WIDTH
from snooker_env.tasks import OpponentPool
from snooker_env.tasks.stroke import ShotBuffers
from tests.tables import PLACES, frame_env, frame_state

MISS = [-0.9, 0, 0, 1.0, 0, 0, 0]


class Watcher:
    """Plays softly along the potting line, and keeps what he was shown."""

    def __init__(self, **options):
        self.options, self.calls = {"aim": "target", **options}, []

    def act(self, tables, observations, going):
        self.calls.append((tables, observations.copy(), going.copy()))
        size = tables.options.rules.actions.size
        return np.tile(np.array([-0.7] + [0.0] * (size - 1), np.float32), (len(going), 1))


class OfFrames(Watcher):
    """Sees frames as such."""

    frames = True


class Drawing(Watcher):
    """Random strokes, from a seed that he is given before each decision."""

    def begin(self, seed):
        self.rng = np.random.default_rng(seed)

    def act(self, tables, observations, going):
        return self.rng.uniform(-1, 1, (len(going), 4))


def test_a_player_of_visits_sees_the_stroke_to_come_as_one_of_a_visit():
    player = Watcher()
    env = frame_state(frame_env(opponent=player, noise="club", fidelity="fast", action="box"), PLACES, {"scores": (31, 62)})
    player.calls.clear()
    env.step(MISS)
    tables, seen, going = player.calls[0]
    assert seen.shape == (1, 121) and going.all() and tables.options.task == "visit"
    for name in ("noise", "physics", "table", "fidelity"):
        assert getattr(tables.options, name) == getattr(env.options, name)
    assert tables.options.aim == "target" and not tables.options.placement


def test_a_player_of_frames_sees_them_from_his_own_side():
    player = OfFrames(decision=True)
    env = frame_state(frame_env(opponent=player), PLACES, {"scores": (31, 62)})
    seen = []
    twin = frame_state(
        frame_env(opponent=lambda observation, rng: seen.append(observation) or np.array(MISS)), PLACES, {"scores": (31, 62)}
    )
    player.calls.clear()
    seen.clear()
    for one in (env, twin):
        one.step(MISS)
    tables, rows, _ = player.calls[0]
    assert np.array_equal(rows[0], seen[0])  # as a callable is shown it
    assert tables.options.task == "frame" and tables.options.rules.actions.decision


def test_to_change_sides_twice_changes_nothing():
    rng = np.random.default_rng(0)
    game = rng.integers(0, 2, (50, COLUMNS))
    game[:, WINNER] = rng.integers(-1, 2, 50)
    other = swapped(game)
    assert np.array_equal(swapped(other), game) and np.array_equal(other[:, SCORE_0], game[:, SCORE_1])
    assert (other[:, BREAKER] == 1 - game[:, BREAKER]).all() and ((other[:, WINNER] < 0) == (game[:, WINNER] < 0)).all()


def test_his_actions_are_read_by_his_own_options():
    """The environment's actions have seven numbers; his have four, and a choice of the discrete ones is none of either."""
    for options in ({"aim": "target"}, {"action": "discrete"}, {"aim": "absolute", "elevation": True, "placement": True}):
        player = Watcher(**options)
        if "action" in options:
            player.act = lambda tables, observations, going: tables.action_masks().argmax(axis=1)
        env = frame_env(opponent=player, layout="random:2")
        strokes = 0
        for seed in range(6):
            env.reset(seed=seed)
            strokes += 0 if env.over else env.step(MISS)[4]["opponent_strokes"]
        assert strokes > 0


def test_one_call_serves_all_tables_that_wait():
    player = Watcher()
    tables = sn.SnookerVectorEnv(16, threads=2, task="frame", opponent=player, layout="random:3")
    tables.reset(seed=0)
    player.calls.clear()
    _, _, _, _, info = tables.step(np.tile(MISS[:4], (16, 1)))
    assert len(player.calls) == info["opponent_strokes"].max() and player.calls[0][2].sum() > 8


def test_without_a_place_in_his_action_he_stands_where_ghost_ball_would():
    player = Watcher(aim="absolute")
    env = frame_env(opponent=player, layout="break_off")
    breaks = []
    for seed in range(8):
        player.calls.clear()
        env.reset(seed=seed)
        if player.calls:
            breaks.append(player.calls[0][1][0, :2])
    assert breaks and all(abs(abs(x * 0.889) - 0.18) < 1e-6 and y * 1.7845 == pytest.approx(BAULK_Y) for x, y in breaks)


def test_with_a_free_ball_any_colour_is_on_for_him():
    """Snookered by a foul on the only red: a player blind to the free ball strikes at the hidden red."""
    places = {CUE: (0.3, 0.3), 1: (0.3, 1.2), GREEN: (0.3, 0.6), BLACK: SPOTS[BLACK]}
    player = Watcher()
    fields = {"striker": 0, "phase": "choice", "free_ball": True}
    env = frame_state(frame_env(opponent=player), places, fields)
    tables = env.tables
    tables.game[0, STRIKER] = 1  # the opponent has the free ball
    actions = env.options.rules.opponent.ask(tables, np.zeros(1, np.int64), [None])
    seat, seen, _ = player.calls[-1]
    assert seat.tables.game[0, 0] == BallOn.ANY_COLOUR and seen[0, 110 + 1] == 1.0
    buffers = ShotBuffers(1)
    env.options.rules.opponent.prepare(tables, np.zeros(1, np.int64), actions, buffers)
    assert env.frame.free_ball and env.ball_on == BallOn.RED  # the frame itself is as it was
    assert buffers.v[0, CUE, 1] > 0 and abs(buffers.v[0, CUE, 0]) < buffers.v[0, CUE, 1]  # at the green, which hides the red


def test_a_free_ball_is_void_for_an_offender_whom_he_sends_back():
    """A player of visits decides on the frame as it is: what he sees of the free ball is written back only where he plays."""

    class Sends(Watcher):
        def act(self, tables, observations, going):
            return np.tile(np.array([-0.9, 0, 0, 0, -1.0], np.float32), (len(going), 1))

    hidden = {CUE: (0.3, 0.3), 1: (0.3, 1.2), GREEN: (0.3, 0.6), BLACK: SPOTS[BLACK]}
    env = frame_state(frame_env(opponent=Sends(decision=True), aim="absolute"), hidden, {"free_ball": False})
    _, _, _, _, info = env.step([-0.9, 0, 0, -0.5, 0, 0, 0])  # away from all balls: snookered behind the green
    assert info["foul"] and env.frame.striker == 0 and env.frame.phase == "stroke"
    assert not env.frame.free_ball and env.ball_on == BallOn.RED and not info["free_ball"]


@pytest.mark.parametrize("name", ["lookahead", "agents.players.built_in:GhostBall", "ppo_mask", "agents/pretrained/ppo_target.zip"])
def test_a_name_that_the_project_knows_may_play(name):
    if name.startswith(("ppo", "agents/pre")):
        pytest.importorskip("stable_baselines3")
    env = gymnasium.make("Snooker-v0", task="frame", opponent=name, layout="pots:easy", noise="none", max_strokes=4)
    spec = gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())
    env = gymnasium.make(spec)
    for seed in range(3):
        env.reset(seed=seed)
        if not env.unwrapped.over:
            _, _, _, _, info = env.step(MISS[:4])
    assert env.unwrapped.options.rules.opponent.name == name and info["strokes"] >= 2


@pytest.mark.parametrize("n", [1, 5])
def test_a_player_with_begin_plays_alike_again_whatever_other_tables_do(n):
    options = {"task": "frame", "layout": "random:2", "noise": "club", "opponent": Drawing()}
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
        again = sn.SnookerEnv(**options | {"opponent": Drawing()})
        again.reset(seed=99)
        again.set_state(json.loads(json.dumps(state)))
        assert data_equivalence(again.step(MISS[:4])[:4], one[:4], exact=True)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (np.zeros((1, 3)), r"opponent Wrong: actions = array of shape \(1, 3\): must have shape \(1, 4\)"),
        (np.full((1, 4), 2.0), r"opponent Wrong: actions\[0\] = \[2.0.*must be finite and within"),
        (None, r"opponent Wrong: actions = array of shape \(\): must be 1, one for each table"),
        (np.zeros((3, 4)), r"opponent Wrong: actions = array of shape \(3, 4\): must be 1, one for each table"),
    ],
)
def test_what_a_player_answers_is_checked_and_he_is_named(answer, says):
    class Wrong:
        options = {}  # noqa: RUF012

        def act(self, tables, observations, going):
            return answer

    env = frame_env(opponent=Wrong())
    with pytest.raises(ValueError, match=f"^{says}"):
        [env.reset(seed=seed) for seed in range(10)]


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (ValueError("mine"), ValueError),
        (TypeError("mine"), TypeError),
        (ZeroDivisionError("mine"), RuntimeError),
        (KeyError("mine"), RuntimeError),
    ],
)
@pytest.mark.parametrize("method", ["act", "begin"])
def test_an_error_of_a_player_names_him(error, kind, method):
    class Failing(Drawing):
        pass

    def fail(self, *args):
        raise error

    setattr(Failing, method, fail)
    env = frame_env(opponent=Failing())
    with pytest.raises(kind) as info:
        [env.reset(seed=seed) for seed in range(10)]
    assert str(info.value) == f"opponent Failing raised {type(error).__name__}: {error}" and info.value.__cause__ is error


def test_the_end_of_a_program_is_no_error_of_a_player():
    class Stopped(Watcher):
        def act(self, tables, observations, going):
            raise KeyboardInterrupt

    env = frame_env(opponent=Stopped())
    with pytest.raises(KeyboardInterrupt):
        [env.reset(seed=seed) for seed in range(10)]


def after_a_foul(opponent, **options):
    """A frame of the Shoot Out in which the opponent has the cue ball in hand, anywhere: one red, and three colours."""
    env = frame_env(opponent=opponent, game="shoot_out", **options)
    places = {CUE: (0.0, BAULK_Y - 0.1), 1: (0.4, 1.0), 21: SPOTS[21], 20: SPOTS[20], 17: SPOTS[17]}
    frame = {"striker": 0, "in_hand": True, "anywhere": True, "rules": "shoot_out", "miss": "off"}
    env = frame_state(env, places, frame)
    env.tables.game[0, STRIKER] = 1
    return env


@pytest.mark.parametrize("options", [{}, {"placement": True}, {"action": "discrete"}])
def test_a_player_of_visits_has_his_cue_ball_anywhere_placed_for_him(options):
    """He knew the places in the D only, and with ``placement`` his D was read as the whole table."""
    player = Watcher(**options)
    if "action" in options:
        player.act = lambda tables, observations, going: player.calls.append((tables, observations, going)) or np.zeros(1, np.int64)
    env = after_a_foul(player)
    tables, opponent, one = env.tables, env.options.rules.opponent, np.zeros(1, np.int64)
    buffers = ShotBuffers(1)
    opponent.prepare(tables, one, opponent.ask(tables, one, [None]), buffers)
    seen = player.calls[-1][0].tables
    assert not seen.game[0, IN_HAND] and env.frame.in_hand and env.frame.anywhere  # the frame itself is as it was
    assert np.array_equal(buffers.r[0, CUE], seen.positions[0, CUE])
    assert np.hypot(*(buffers.r[0, CUE] - (0.4, 1.0))) == pytest.approx(0.3 + 2 * BALL_RADIUS)


def test_a_player_of_frames_places_it_himself():
    player = OfFrames(placement=True, decision=True)
    env = after_a_foul(player)
    opponent, one, buffers = env.options.rules.opponent, np.zeros(1, np.int64), ShotBuffers(1)
    opponent.prepare(env.tables, one, np.array([[-0.7, 0.0, 0.0, 0.0, 0.5, -0.5, 0.0]]), buffers)
    assert buffers.r[0, CUE] == pytest.approx((0.5 * HALF_WIDTH, -0.5 * HALF_LENGTH))


def test_the_agent_s_cue_ball_anywhere_is_placed_for_a_player_of_visits_too():
    agent, tables = Watcher(placement=True), sn.SnookerVectorEnv(2, threads=1, task="frame", game="shoot_out", aim="target", placement=True)
    observations, _ = tables.reset(seed=0)
    player = AtFrames(agent)
    for _ in range(30):
        waiting = tables.tables.game[:, ANYWHERE] != 0
        actions = player.act(tables, observations, np.ones(2, bool))
        if waiting.any():
            break
        observations, *_ = tables.step(np.tile([-1.0, 0, 0, 1.0, 0, 0], (2, 1)))
    seen = agent.calls[-1][0].tables
    assert waiting.any() and actions[waiting, 4:6] * (HALF_WIDTH, HALF_LENGTH) == pytest.approx(seen.positions[waiting, CUE])
    assert not seen.game[waiting, IN_HAND].any()


@pytest.mark.parametrize("name", ["geometric", "ppo_mask", "lookahead", "player", "pool"])
def test_any_opponent_plays_matches_and_stable_baselines_tables(name):
    pytest.importorskip("stable_baselines3")
    from snooker_env.sb3 import SnookerVecEnv

    opponent = {"player": Watcher(), "pool": OpponentPool(["ghost_ball", Watcher(), "geometric"])}.get(name, name)
    options = {
        "task": "match",
        "frames": 3,
        "opponent": opponent,
        "layout": "pots:easy",
        "aim": "target",
        "max_strokes": 20,
        "noise": "none",
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


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"noise": "club"}, "key of the options of opponent Watcher = 'noise': must be one of 'action'"),
        ({"observation": "balls"}, "observation of opponent Watcher = 'balls': must be \"flat\""),
        ({"action": "both"}, "action = 'both': must be one of 'box', 'discrete'"),
        ({"aim": "north"}, "aim = 'north'"),
    ],
)
def test_options_that_are_none_of_a_player_are_refused(options, says):
    with pytest.raises(ValueError) as info:
        frame_env(opponent=Watcher(**options))
    assert str(info.value).startswith(says)


def test_a_name_that_nobody_has_is_refused():
    for name in ("nobody", "agents.players.built_in:Nobody", ""):
        with pytest.raises(ValueError, match=r"opponent = "):
            frame_env(opponent=name)


def test_a_misspelt_name_is_answered_with_the_names():
    with pytest.raises(
        ValueError, match=r"opponent = 'lookahed': must be one of 'none', 'random', 'ghost_ball', 'lookahead', .*MODULE:CLASS"
    ):
        frame_env(opponent="lookahed")


def test_what_an_object_lacks_to_be_a_player_is_named():
    class ActsOnly:
        def act(self, tables, observations, going):
            return np.zeros((len(going), 4))

    listed = ActsOnly()
    listed.options = ["aim"]
    for wrong, says in (
        (ActsOnly(), r"opponent = a ActsOnly with act\(...\) alone: must also have options, a mapping"),
        (listed, r"opponent = a ActsOnly with act\(...\) and options that are no mapping: must also have options, a mapping"),
        (Watcher, r"opponent = <class '.*Watcher'>: must be an instance and not the class: Watcher\(...\)"),
        (ActsOnly, r"opponent = <class '.*ActsOnly'>: must be an instance"),
        (OpponentPool, r"opponent = <class '.*OpponentPool'>: must be an instance"),
        (7, "opponent = 7: must be one of 'none'"),
    ):
        with pytest.raises(ValueError, match=f"^{says}"):
            frame_env(opponent=wrong)


def test_copies_of_an_environment_play_on_alike():
    env = frame_env(opponent=Watcher(), layout="random:2", noise="club")
    env.reset(seed=2)
    copies = copy.deepcopy(env), pickle.loads(pickle.dumps(env))
    first = env.step(MISS)
    assert all(data_equivalence(one.step(MISS)[:4], first[:4], exact=True) for one in copies)


def test_both_sides_share_one_view():
    """The agent's view of the benchmark, and the opponent's: the same numbers for the same table."""
    agent, opponent = Watcher(), Watcher()
    tables = sn.SnookerVectorEnv(4, threads=1, task="frame", aim="target", opponent=opponent, layout="random:2")
    observations, _ = tables.reset(seed=1)
    AtFrames(agent).act(tables, observations, np.ones(4, bool))
    tables.tables.game[:, STRIKER] = 1
    tables.options.rules.opponent.ask(tables.tables, np.arange(4), [None] * 4)
    assert np.array_equal(agent.calls[-1][1], opponent.calls[-1][1])
