"""Is the menu of strokes, and what is foreseen of each, what the specification says? Recomputed by public functions."""

from math import log10, pi

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import POCKET_AIMS
from snooker_env.physics.cue_room import in_room_over
from snooker_env.planning import Planner, Position, Positions, pots, prospects_of
from snooker_env.planning.aims import Dynamics, law_of
from snooker_env.tasks import LEVELS, cue_ball_path
from snooker_env.tasks.noise import TWICE, Noise, Spread
from snooker_env.tasks.observations import BALLS_SIZE, STROKE_ENTRIES
from snooker_env.tasks.pot_chance import chance_at
from tests.positions import tables

SPEEDS, TOPS = [0.8 * (4.6 / 0.8) ** (k / 8) for k in range(9)], (-0.4, 0.0, 0.4)
ALONG, CHOICES = 27, 108  # strokes along a pot, and of a visit
COLUMN = {name: k for k, name in enumerate(STROKE_ENTRIES)}
MENU = {"action": "strokes", "observation": "strokes"}
SIZE = len(STROKE_ENTRIES)


def rows_of(observed, choices=CHOICES):
    """What is seen of each stroke, (n, choices, columns), and the state."""
    observed = np.atleast_2d(observed)
    return observed[:, : choices * SIZE].reshape(len(observed), choices, SIZE), observed[:, choices * SIZE :]


def wanted_of(at, options, pot, index):
    """The numbers of stroke ``index`` of one position, at a pot as of ``pots``: a dict."""
    line, along = divmod(index, ALONG)
    speed, top = SPEEDS[along // 3], TOPS[along % 3]
    ball, pocket, ghost = pot.ball[:, line], pot.pocket[:, line], pot.ghost[:, line]
    to, stroke = POCKET_AIMS[pocket, :2], np.array([[speed, 0.0, top, 0.0, 0.0]])
    stroke[0, 3] = Planner({"cue": options.cue}).pot_aim(at, [0], ball, to, stroke, ghosts=ghost)[0]
    rules = options.rules
    room = at.positions[0], at.on_table[0], np.array(rules.rails), rules.physics.R, rules.physics.max_offset
    played, _, _, _ = in_room_over(tuple(stroke[0].tolist()), *room, rules.physics.end_mass_ratio)
    noise = LEVELS[options.noise]
    core = np.radians(noise.direction_deg(rules.physics, speed=speed)) * (1.0 + played[4] / TWICE)
    spread = Spread(core, noise.lapse, noise.lapse_factor)
    length = np.hypot(*(ghost[0] - at.positions[0, 0])) + np.hypot(*(to[0] - at.positions[0, ball[0]]))
    chance = chance_at(pot.tolerance[0, line], length, spread)
    out, no_balls, row = np.empty((1, 1, cue_ball_path.SEEN)), np.empty(0, int), np.zeros(1, int)
    left = (np.empty((1, 22, 2)), np.empty((1, 22), bool), np.empty(1, int))
    none, at_pot = (np.zeros((1, 5)), Noise().pack(0.02625)), np.array([[ball[0], pocket[0]]])
    balls, law = (at.positions, at.on_table), law_of(Dynamics.of(rules), at)
    cue_ball_path.predict(balls, row, stroke, at_pot, *none, law, out, no_balls)
    cue_ball_path.leave_pots((*balls, at.ball_on.copy()), row, at_pot, out[:, 0], left)
    seen = out[0, 0]
    wanted = {"there": 1.0, "pot": 1.0, "chance": chance, "log_chance": max(-1.0, log10(chance) / 2.0)}
    wanted |= {"points": max(1, ball[0] - 14) / 7.0, "speed": speed / 4.6, "top": top / 0.4}
    wanted |= {
        "cut": pot.cut[0, line] / (pi / 2.0),
        "tolerance": pot.tolerance[0, line] / (pot.tolerance[0, line] + 0.01),
    }
    wanted |= {
        "x": seen[0] / 0.889,
        "y": seen[1] / 1.7845,
        "noses": min(1.0, seen[2] / 5.0),
        "balls": min(1.0, seen[3] / 5.0),
    }
    wanted |= {"run": min(1.0, seen[4] / 8.0), "lost": seen[5], "missed": seen[8] / 2.0}
    wanted |= {
        "near": min(1.0, seen[7] / 0.3),
        "reach": seen[9] / 3.0,
        "foul": float(seen[5] > 0.0 or seen[8] > 0.0),
    }
    worth, many = 0.0, 0
    arrives = not wanted["foul"] and seen[9] >= 1.0 and abs(seen[11]) <= 0.02
    if arrives and left[2][0] != cue_ball_path.NONE:
        after = Positions(left[0], left[1], np.array([[left[2][0], 0, 0, 0, 0]]))
        usual = noise.spread(rules.physics)
        (worth,), _ = prospects_of(after, usual, rails=rules.rails)
        many = int((pots(after, most=32).ball[0] >= 0).sum())
    wanted |= {"prospects": worth / 35.0, "promise": chance * (max(1, ball[0] - 14) + worth) / 42.0 * arrives}
    return wanted, many <= 4


@pytest.mark.parametrize(
    "options",
    [
        {"noise": "professional", "cue": "real"},
        {"noise": "club", "layout": "random:4"},
        {"noise": "club", "layout": "colours"},
    ],
    ids=["opened", "few reds", "colours"],
)
def test_what_is_foreseen_of_each_stroke_at_a_pot(options):
    """The aim is solved a little less exactly, so that a few ways past other balls end elsewhere."""
    env, rng = tables(24, **MENU, **options), np.random.default_rng(4)
    at, same, judged = Positions.of(env), [], 0
    seen, state = rows_of(env.reset(seed=2)[0])
    at = Positions.of(env)
    assert np.array_equal(state, at.observations()[:, BALLS_SIZE:])
    names = "chance", "points", "prospects", "promise"
    chance, points, prospects, promise = (seen[..., COLUMN[name]] for name in names)
    told = promise > 0.0
    assert told.any()
    assert promise[told] == pytest.approx((chance * (7.0 * points + 35.0 * prospects) / 42.0)[told], rel=1e-5)
    for k in range(24):
        pot = pots(at[[k]])
        many = int((pot.ball[0] >= 0).sum())
        if many == 0:
            continue
        assert seen[k, :, 0].tolist() == [float(c < ALONG * many) for c in range(CHOICES)]
        for index in rng.choice(ALONG * many, 8, replace=False).tolist():
            wanted, few = wanted_of(at[[k]], env.options, pot, index)
            judged += few
            names = [name for name in wanted if few or name not in ("prospects", "promise")]
            got = seen[k, index]
            off = {name: abs(got[COLUMN[name]] - wanted[name]) for name in names}
            assert max(off[name] for name in ("chance", "points", "speed", "top", "cut", "tolerance")) < 2e-3
            same.append(max(off.values()) < 0.03)
    assert np.mean(same) > 0.9 and judged > 5, np.mean(same)


def test_it_is_the_stroke_that_is_played():
    """Speed, tip and the aim of ``pot_aim``; what is not on the menu is the same stroke along the last line that is."""
    env, planner = tables(30, **MENU, cue="real"), Planner({**MENU, "cue": "real"})
    at = Positions.of(env)
    choices = np.random.default_rng(1).integers(0, CHOICES, 30)
    values, _ = planner.strokes_of(at, np.arange(30), choices)
    masks, played = env.action_masks(), 0
    for k, choice in enumerate(choices.tolist()):
        pot = pots(at[[k]])
        many = int((pot.ball[0] >= 0).sum())
        if not many:
            continue
        assert masks[k].tolist() == [c < ALONG * many for c in range(CHOICES)]
        line, along = min(choice // ALONG, many - 1), choice % ALONG
        stroke = np.array([[SPEEDS[along // 3], 0.0, TOPS[along % 3], 0.0, 0.0]])
        to = POCKET_AIMS[pot.pocket[:, line], :2]
        ball, ghost = pot.ball[:, line], pot.ghost[:, line]
        (aim,) = Planner({"cue": "real"}).pot_aim(at, [k], ball, to, stroke, ghosts=ghost)
        assert values[k, [0, 1, 2, 4]] == pytest.approx(stroke[0, [0, 1, 2, 4]], abs=1e-12)
        assert abs(np.exp(1j * values[k, 3]) - np.exp(1j * aim)) < 1e-9
        played += choice // ALONG >= many
    assert played > 0


def test_what_is_not_there_shows_and_plays_the_nearest_that_is():
    env = sn.SnookerEnv(**MENU, noise="none")
    alone = Position(cue=(0.0, 0.0), black=(0.3, 1.0), on="black")
    observed, _ = env.reset(options={"position": alone})
    (rows,), _ = rows_of(observed)
    there = env.action_masks()
    many = int(there.sum()) // ALONG
    assert 1 <= many < 4 and there.tolist() == [c < ALONG * many for c in range(CHOICES)]
    assert (rows[:, 0] == there).all()
    last = rows[ALONG * (many - 1) : ALONG * many, 1:]
    for line in range(many, 4):
        assert np.array_equal(rows[ALONG * line : ALONG * (line + 1), 1:], last)
    ends = []
    for choice in (ALONG * (many - 1) + 7, 3 * ALONG + 7):
        env.reset(options={"position": alone})
        env.step(choice)
        ends.append(env.positions)
    assert np.array_equal(*ends)


@pytest.mark.parametrize("speeds", [2, 9, 20])
def test_all_that_is_seen_lies_in_the_space(speeds):
    """On 600 held-out tables, of which an aim that was sought in vain once showed places off the table."""
    options = {"layout": "held_out", "noise": "professional", "cue": "real", "speeds": speeds}
    env = sn.SnookerVectorEnv(600, **MENU, **options)
    observed, _ = env.reset(seed=1_000_000)
    assert env.action_masks().shape == (600, 12 * speeds) and observed.shape == (600, 12 * speeds * SIZE + 11)
    assert all(env.single_observation_space.contains(one) for one in observed)
    rows, _ = rows_of(observed, 12 * speeds)
    fastest = rows[:, 3 * (speeds - 1) : 3 * speeds, COLUMN["speed"]]
    assert fastest == pytest.approx(1.0) and rows[:, :3, COLUMN["speed"]] == pytest.approx(0.8 / 4.6)


def test_threads_and_vectors_change_no_bit():
    seen = []
    for threads in (1, 3):
        options = MENU | {"noise": "club", "cue": "real", "autoreset_mode": "SameStep"}
        env = sn.SnookerVectorEnv(40, **options, threads=threads)
        observed, rng, each = env.reset(seed=3)[0], np.random.default_rng(0), []
        for _ in range(4):
            each.append(observed)
            observed, rewards, *_ = env.step(rng.integers(0, CHOICES, 40))
            each.append(rewards)
        seen.append(each)
    assert all(np.array_equal(a, b) for a, b in zip(*seen, strict=True))


def test_what_is_observed_and_how_one_acts_are_chosen_apart():
    assert sn.SnookerEnv(action="strokes").observation_space.shape == (61,)
    seen = sn.SnookerEnv(observation="strokes", conditions="drawn", observe_conditions=True)
    observed, info = seen.reset(seed=1)
    assert observed.shape == (CHOICES * SIZE + 11 + 8,) and seen.observation_space.contains(observed)
    assert observed[-8] == pytest.approx(2.0 * (info["mu_s"] - 0.15) / 0.1 - 1.0, abs=1.0)
    with pytest.raises(ValueError, match="says"):
        sn.SnookerEnv(task="frame", action="strokes", says=["concede"])
    with pytest.raises(ValueError, match="elevation"):
        sn.SnookerEnv(action="strokes", elevation=True)


def test_one_seat_alone_may_have_a_menu():
    env = sn.match_env(seats=({"action": "strokes"}, {}), noise="none")
    env.reset(seed=1)
    one, other = env.possible_agents
    assert (env.action_space(one).n, env.action_space(other).shape) == (CHOICES + 50, (7,))


def test_a_frame_has_safeties_the_break_off_and_decisions():
    env = sn.match_env(**MENU, noise="none")
    env.reset(seed=1)
    first = env.agent_selection
    (rows,), state = rows_of(env.observe(first), CHOICES + 50)
    assert state.shape == (1, 30) and rows[108:156, 0].any() and not rows[156:, 0].any()
    assert rows[108, COLUMN["speed"]] == pytest.approx(3.4 / 4.6)
    assert rows[108, COLUMN["top"]] == pytest.approx(0.1 / 0.4)
    other = next(name for name in env.possible_agents if name != first)
    assert not rows_of(env.observe(other), CHOICES + 50)[0][..., 0].any()
    assert env.action_mask(first)[:156].tolist() == rows[:156, 0].tolist()
    env.step(108)
    assert env.last_shot is not None or env.agent_selection == other


@pytest.mark.parametrize("miss", ["off", "clear_path"])
@pytest.mark.parametrize("choice", [7, 156, 157])
def test_the_decisions_after_a_foul(choice, miss):
    env = sn.match_env(**MENU, miss=miss, noise="none", seats=({"action": "box", "aim": "absolute"}, {}))
    position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.3)], yellow=(-0.4, 0.2), black=(0.0, 1.3))
    env.reset(seed=1, options={"position": position})
    env.step(np.array([-1.0, 0.0, 0.0, -0.5]))  # a soft stroke at nothing
    offender, striker = env.possible_agents
    assert env.frame.phase == "choice" and env.agent_selection == striker
    back = miss != "off"
    (rows,), _ = rows_of(env.observe(striker), CHOICES + 50)
    assert env.action_mask(striker)[156:].tolist() == rows[156:, 0].tolist() == [1, back]
    assert rows[156:, COLUMN["speed"]].tolist() == [-1.0, 1.0]
    assert rows[156:, COLUMN["pot"]].tolist() == [-1.0, -1.0]
    before, lies = env.get_state()["strokes"], env.positions[0]
    env.step(choice)
    if choice == 7 or (choice == 157 and not back):
        assert env.get_state()["strokes"] == before + 1
    else:
        assert env.agent_selection == offender and env.get_state()["strokes"] == before
        assert np.array_equal(env.positions[0], (0.0, 0.0) if choice == 157 else lies)
