"""Are ``aim="pot"`` and ``observation="pots"`` what the specification says? Recomputed in plain Python."""

from math import acos, atan2, hypot, log10, pi, radians

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, CUE
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Planner, Position, Positions, pots, prospects_of
from snooker_env.tasks import LEVELS
from snooker_env.tasks.discrete_actions import SIDES, SPEEDS, TOPS, choice_of
from snooker_env.tasks.noise import Spread
from snooker_env.tasks.observations import POT_ENTRIES
from tests.positions import chances_by_width, tables

VALUES = [0, *[1] * 15, 2, 3, 4, 5, 6, 7]


def stroke_of(a, at, direct, cue):
    """Speed, side, top, aim and elevation of an action on one position, and which pot it picks."""
    speed, side, top = 0.8 * (4.6 / 0.8) ** ((a[0] + 1.0) / 2.0), 0.2 * a[1], 0.4 * a[2]
    elevation = radians(30.0) * (a[4] + 1.0) / 2.0 if len(a) > 4 else 0.0
    many = int((direct.ball >= 0).sum())
    pick = next(k for k in range(many) if abs(a[3]) < (k + 1) / many or k == many - 1)
    to, ghost = POCKET_AIMS[direct.pocket[:, pick], :2], direct.ghost[:, pick]
    played = [[speed, side, top, 0.0, elevation]]
    (aim,) = Planner({"cue": cue}).pot_aim(at, [0], direct.ball[:, pick], to, played, ghosts=ghost)
    return [speed, side, top, aim, elevation], pick


@pytest.mark.parametrize("elevation", [False, True])
@pytest.mark.parametrize("cue", ["free", "real"])
@pytest.mark.parametrize("layout", ["opened", "random:6"])
def test_an_action_picks_a_pot_and_its_aim_is_solved(layout, cue, elevation):
    env, picked = tables(60, layout=layout, cue=cue, elevation=elevation), set()
    at, rng = Positions.of(env), np.random.default_rng(3)
    actions = rng.uniform(-1.0, 1.0, (60, 4 + elevation))
    values, _ = Planner(env).strokes_of(at, np.arange(60), actions)
    for k in range(60):
        direct = pots(at[[k]])
        if direct.ball[0, 0] < 0:
            continue
        wanted, pick = stroke_of(actions[k], at[[k]], direct, cue)
        picked.add(pick)
        assert values[k, [0, 1, 2, 4]] == pytest.approx(np.array(wanted)[[0, 1, 2, 4]], abs=1e-12)
        assert abs(np.exp(1j * values[k, 3]) - np.exp(1j * wanted[3])) < 1e-9
    assert picked == {0, 1, 2, 3}


def test_equal_parts_of_the_number_pick_the_pots_on_either_side_of_0():
    env = sn.SnookerEnv()
    reds = [(0.5, 1.2), (-0.5, 0.6), (0.2, 1.0)]
    at = Positions.of(Position(cue=(0.1, 0.2), reds=reds, black=(0.0, -1.4)))
    many = int((pots(at, most=32).ball >= 0).sum())
    assert many >= 4
    ends = np.array([0.0, 0.249, 0.251, 0.499, 0.501, 0.749, 0.751, 1.0])
    actions = np.zeros((16, 4))
    actions[:, 3] = np.concatenate([ends, -ends])
    aims = Planner(env).strokes_of(at, np.zeros(16, int), actions)[0][:, 3].reshape(2, 4, 2)
    assert (aims[0] == aims[1]).all() and (aims[..., 0] == aims[..., 1]).all()
    assert len(set(aims[0, :, 0].tolist())) == 4
    ghosts = pots(at).ghost[0] - at.positions[0, CUE]
    assert aims[0, :, 0] == pytest.approx(np.arctan2(ghosts[:, 1], ghosts[:, 0]), abs=0.03)


@pytest.mark.parametrize(
    "options", [{"layout": "snookered"}, {"layout": "escape", "cue": "real"}, {"layout": "break_off"}]
)
def test_without_a_pot_an_action_picks_a_line_of_the_choices(options):
    """Break-offs, contacts and escapes, solved for the same stroke."""
    box, discrete = (tables(40, **options, action=kind) for kind in ("box", "discrete"))
    at, rows, speed, top = Positions.of(box), np.arange(40), 3, 4
    assert (at.positions == Positions.of(discrete).positions).all()
    lines, chosen = discrete.action_masks().reshape(40, 4, -1).any(axis=2).sum(axis=1), Planner(discrete)
    without = pots(at).ball[:, 0] < 0
    assert without.sum() > 15
    a0 = 2.0 * np.log(SPEEDS[speed] / 0.8) / np.log(4.6 / 0.8) - 1.0
    seen = set()
    for line in range(4):
        own = rows[without & (line < lines)]
        actions = np.tile([a0, 0.0, TOPS[top] / 0.4, 0.0], (40, 1))
        actions[:, 3] = (line + 0.5) / lines
        picks = np.full(len(own), choice_of(line, speed, SIDES.index(0.0), top))
        meant = Planner(box).strokes_of(at, own, actions[own])[0]
        wanted = chosen.strokes_of(at, own, picks)[0]
        assert np.allclose(meant, wanted, rtol=0, atol=1e-9)
        seen |= {line} if len(own) else set()
    assert seen >= {0, 1}


def test_the_middle_of_the_box_is_a_sensible_stroke():
    """The widest pot at a middling speed, without spin; a number on either side of it is one, too."""
    env = tables(200, layout="opened", noise="professional", cue="real", seed=5)
    at = Positions.of(env)
    values, _ = Planner(env).strokes_of(at, np.arange(200), np.zeros((200, 4)))
    assert values[:, 0] == pytest.approx((0.8 * 4.6) ** 0.5, abs=1e-12) and not values[:, [1, 2, 4]].any()
    points, going = np.zeros(200), np.ones(200, bool)
    while going.any():
        _, rewards, terminated, truncated, _ = env.step(np.zeros((200, 4)))
        points += np.where(going, rewards, 0.0)
        going &= ~(terminated | truncated)
    assert points.mean() > 4.0  # of random ones 0.9


def chances_of(at, options):
    """The chance of the four widest pots at 2 m/s: (n, 4)."""
    noise = LEVELS[options.noise]
    wide = radians(noise.direction_deg(options.physics, speed=2.0))
    spread = Spread(max(1e-5, wide), noise.lapse, noise.lapse_factor)
    if options.cue == "real":
        return prospects_of(at, spread, rails=options.rules.rails)[1]
    return chances_by_width(at, spread)[:, :4]


@pytest.mark.parametrize(
    "options",
    [
        {"noise": "professional", "cue": "real"},
        {"noise": "club", "layout": "random:5", "aim": "absolute"},
        {"layout": "colours", "action": "discrete"},
        {"noise": "club", "layout": "break_off", "conditions": "drawn", "observe_conditions": True},
    ],
)
def test_the_four_widest_pots_the_cue_ball_and_the_state_are_seen(options):
    env, rng = tables(40, seed=2, **options), np.random.default_rng(1)
    observed, pockets, none = env.reset(seed=2)[0], set(), 0
    for _ in range(4):
        at = Positions.of(env)
        direct, chances = pots(at), chances_of(at, env.options)
        flat = at.observations()
        assert observed.shape == env.observation_space.shape and env.observation_space.contains(observed)
        assert observed.shape[1] == 61 + 8 * env.options.observe_conditions
        for k in range(40):
            wanted, (cx, cy) = np.zeros((4, 12)), at.positions[k, CUE] * at.on_table[k, CUE]
            wanted[:, 1] = -1.0
            for j in range((direct.ball[k] >= 0).sum() * at.on_table[k, CUE]):
                ball, pocket, t = direct.ball[k, j], direct.pocket[k, j], direct.tolerance[k, j]
                (x, y), (gx, gy) = at.positions[k, ball], direct.ghost[k, j]
                (px, py) = POCKET_AIMS[pocket, :2]
                to, on = np.array([gx - cx, gy - cy]), np.array([px - x, py - y])
                turn = atan2(to[0] * on[1] - to[1] * on[0], to @ on)  # to the left
                chance, far = chances[k, j], hypot(*to)
                way = atan2(to[1], to[0])
                wanted[j] = [
                    *(chance, max(-1.0, log10(chance) / 2.0), turn / (pi / 2.0), t / (t + 0.01)),
                    *(VALUES[ball] / 7.0, x / 0.889, y / 1.7845, np.cos(way), np.sin(way), far / 4.0),
                    *(px / 0.889, py / 1.7845),
                ]
                pockets.add(int(pocket))
            none += not wanted[0, 0]
            cue = cx / 0.889, cy / 1.7845
            assert observed[k, :61] == pytest.approx([*wanted.ravel(), *cue, *flat[k, 110:]], abs=2e-6)
        chooses = env.options.action == "discrete"
        a = env.action_masks().argmax(axis=1) if chooses else rng.uniform(-0.2, 0.2, (40, 4))
        observed = env.step(a)[0]
    assert len(POT_ENTRIES) == 12
    assert none > 0 and len(pockets) >= (4 if options.get("layout") != "break_off" else 0)


def test_of_equal_pots_the_lower_ball_comes_first_then_the_lower_pocket():
    env = sn.SnookerEnv(noise="club")
    for reds in (((-0.3, 0.5), (0.3, 0.5)), ((0.3, 0.5), (-0.3, 0.5))):
        position = Position(cue=(0.0, 0.0), reds=reds, black=(0.0, 1.4605))
        observed, _ = env.reset(options={"position": position})
        rows = observed[:48].reshape(4, 12)
        assert rows[0, 3] == rows[1, 3] > 0.0
        assert rows[:2, 5] == pytest.approx([x / 0.889 for x, _ in reds], abs=1e-6)
    alone = Position(cue=(0.0, 0.0), black=(0.0, 1.0), on="black")
    rows = env.reset(options={"position": alone})[0][:48].reshape(4, 12)
    same = rows[:, 3] == rows[0, 3]
    assert same[:2].all() and rows[0, 10] == -rows[1, 10]
    direct = pots(alone)
    assert direct.pocket[0, 0] < direct.pocket[0, 1] and direct.ball[0, :2].tolist() == [BLACK, BLACK]
    assert acos(rows[0, 7]) == pytest.approx(pi - acos(rows[1, 7]), abs=1e-6)
