"""Does ``cue="real"`` raise the cue where it must, everywhere alike, and is what is aimed then aimed for that?"""

from typing import Any

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import pots
from snooker_env.game.balls import mask_of
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.physics.cue import squirt
from snooker_env.physics.cue_room import NO_RAILS, STEEPEST, least_elevation
from snooker_env.planning import (
    RULE_OF_THUMB,
    Planner,
    Positions,
    VisitJudge,
    action_masks,
    at_pots,
    prospects_of,
)
from snooker_env.planning import pots as direct_pots
from snooker_env.tasks import choice_of
from snooker_env.tasks.discrete_actions import SIDES, SPEEDS, TOPS
from snooker_env.tasks.noise import TWICE, Spread
from tests.kernels import from_python
from tests.tables import table_state

FROZEN = 0.889 - R - 1e-6
"""x of a ball that touches the cushion, nearly."""
WIDE: dict[str, Any] = {"cue": "real", "aim": "absolute", "layout": "random:1"}


def posed(places, on=1, **options):
    """An environment with these balls {id: (x, y)} alone."""
    env = sn.SnookerEnv(**WIDE | options)
    env.keep_history = True
    table_state(env, places, on)
    return env


def cue_of(env, action):
    env.step(np.array(action, np.float32))
    played = env.history[-1]
    return played.cue, played.room


def test_a_frozen_ball_is_played_from_above_and_screw_with_a_higher_tip():
    """The action says: 3.6 m/s, away from the cushion, a level cue."""
    places = {0: (FROZEN, 0.9), 1: (-0.5, 0.2)}
    plain, done = cue_of(posed(places), [0.0, 0.0, 0.0, 1.0])
    assert np.degrees(plain["elevation"]) == pytest.approx(33.3, abs=2.0) and done == ("raised",)
    assert (plain["side"], plain["top"]) == (0.0, 0.0)
    screw, done = cue_of(posed(places), [0.0, 0.0, -0.8, 1.0])
    assert screw["elevation"] == pytest.approx(STEEPEST, abs=1e-6) and done == ("raised", "moved")
    assert -0.4 < screw["top"] < 0.0
    free, done = cue_of(posed(places, cue="free"), [0.0, 0.0, -0.8, 1.0])
    assert (free["elevation"], free["top"], done) == (0.0, pytest.approx(-0.4), ())
    open_, done = cue_of(posed({0: (-0.8, 0.9), 1: (0.5, 0.2)}), [0.0, 0.0, -0.8, 1.0])
    assert np.degrees(open_["elevation"]) < 2.5 and "moved" not in done
    over, done = cue_of(posed({0: (0.0, 0.0), 1: (-0.06, 0.0)}), [0.0, 0.0, 0.0, 0.0])
    assert np.degrees(over["elevation"]) > 30.0 and done == ("raised",)


def test_the_errors_leave_the_cue_above_the_rail():
    """Errors of the elevation downwards have no effect where the rail is in the way."""
    found = []
    for seed in range(40):
        env = sn.SnookerEnv(**WIDE, noise={"elevation_deg": 3.0, "offset_mm": 0.0})
        env.keep_history = True
        table_state(env, {0: (FROZEN, 0.9), 1: (-0.5, 0.2)}, 1, stream=[seed, 0])
        found.append(np.degrees(cue_of(env, [0.0, 0.0, 0.0, 1.0])[0]["elevation"]))
    least = min(found)
    assert np.mean(np.array(found) == least) > 0.3 and max(found) > least + 2.0


def at_the_cushion(n, away, seed):
    """States of n tables: a pot of a red in the open from a cue ball near the right cushion."""
    rng, out = np.random.default_rng(seed), []
    while len(out) < n:
        cue, red = (0.889 - R - away, rng.uniform(0.2, 1.2)), rng.uniform((-0.5, -1.2), (0.5, 1.2))
        positions, on_table = np.zeros((22, 2)), np.zeros(22, bool)
        positions[0], positions[1], on_table[:2] = cue, red, True
        found = pots.pots(positions, on_table, mask_of([1]), most=1)
        if len(found) and found[0, 4] > np.cos(np.radians(40.0)) and np.hypot(*(red - cue)) > 0.5:
            out.append((cue, tuple(red)))
    return out


def potted(places, planner, strokes):
    """Share of the places from which these strokes pot, played by a planner."""
    at = Positions.of([posed({0: lie, 1: red}).get_state() for lie, red in places])
    return np.mean(planner.play_strokes(at, np.arange(len(places)), strokes).points > 0)


@pytest.mark.parametrize(("away", "side", "top"), [(0.0, 1, 1), (0.02, 2, 1)])
def test_pots_with_side_are_aimed_for_the_swerve(away, side, top):
    """At 3.6 m/s: aims of a free cue miss when they are played with the raised one, without side they may do."""
    places = at_the_cushion(40, away, 7)
    at = Positions.of([posed({0: lie, 1: red}).get_state() for lie, red in places])
    free, real = (Planner({"action": "discrete", "cue": cue}, threads=1) for cue in ("free", "real"))
    rows, choices = np.arange(40), np.full(40, choice_of(0, 5, side, top))
    level, aimed = (planner.strokes_of(at, rows, choices)[0] for planner in (free, real))
    assert np.mean(real.play(at, rows, choices).points > 0) > 0.9 and potted(places, real, aimed) > 0.9
    assert potted(places, free, level) > 0.9 and (aimed[:, 4] == 0.0).all()
    assert side == 1 or potted(places, real, level) < 0.2
    found = [pots.pots(at.positions[k], at.on_table[k], mask_of([1]), most=1)[0] for k in range(40)]
    targets = [pots.POCKET_AIMS[int(row[1]), :2] for row in found]
    solved = real.pot_aim(at, rows, np.ones(40, int), targets, level, ghosts=[row[2:4] for row in found])
    assert np.allclose(np.exp(1j * solved), np.exp(1j * aimed[:, 3]), atol=1e-12)


@pytest.mark.parametrize("elevated", [False, True])
def test_target_lines_are_turned_by_the_swerve(elevated):
    """A box action with side, no angle off the target line: the cue ball still strikes the red where it should."""
    places, thick = at_the_cushion(30, 0.02, 7), []
    for cue in ("free", "real"):
        for lie, red in places:
            env = posed({0: lie, 1: red}, cue=cue, aim="target", elevation=elevated)
            line = pots.pots(env.positions, env.on_table, mask_of([1]), most=1)[0]
            env.step(np.array([0.0, 0.6, 0.0, 0.0] + [-1.0] * elevated, np.float32))
            shot = env.history[-1].shot
            hit = shot.events[shot.events["kind"] == sn.EventKind.BALL_BALL]
            place = shot.at(float(hit["time"][0]))[0][0] if len(hit) else np.array(lie)
            thick.append(np.hypot(*(place - line[2:4])))
    free, real = np.array(thick).reshape(2, -1)
    assert real.max() < 1e-3 and np.median(free) < 2e-3  # a level cue's squirt is all there is


def crowded(n, seed):
    """Tables whose cue ball lies at a cushion, or at a ball."""
    env, rng = sn.SnookerVectorEnv(n, layout="opened", action="discrete"), np.random.default_rng(seed)
    env.reset(seed=seed)
    places, here = env.tables.positions.copy(), env.tables.on_table.copy()
    for k in range(n):
        gap, turn = rng.uniform(1e-6, 0.012), rng.uniform(0.0, 2.0 * np.pi)
        other = places[k, 1 + rng.choice(np.flatnonzero(here[k, 1:]))]
        beside = other + (2.0 * R + gap) * np.array([np.cos(turn), np.sin(turn)])
        at_rail = rng.choice([-1.0, 1.0]) * (0.889 - R - gap), rng.uniform(-1.7, 1.7)
        x, y = at_rail if k % 2 else beside
        apart = np.hypot(*(places[k, 1:] - (x, y)).T)
        inside = abs(x) < 0.889 - R and abs(y) < 1.74 and apart.min() >= 2.0 * R
        places[k, 0] = (x, y) if inside else (FROZEN, 0.9)
    return Positions(places, here, env.tables.game.copy())


def test_masks_of_crowded_tables_are_those_of_every_stroke_asked_for_its_room():
    least, turned = from_python(least_elevation), from_python(squirt)
    rails = np.array(sn.Options(cue="real").rules.rails)
    at, cleared = crowded(60, 3), 0
    free, real, direct = action_masks(at), action_masks(at, rails=rails), direct_pots(at)
    for k in np.flatnonzero(direct.ball[:, 0] >= 0).tolist():
        wanted = free[k].reshape(4, len(SPEEDS), len(SIDES), len(TOPS)).copy()
        for line in np.flatnonzero(direct.ball[k] >= 0).tolist():
            dx, dy = direct.ghost[k, line] - at.positions[k, 0]
            for s, side in enumerate(SIDES):
                aim = np.arctan2(dy, dx) - turned(side, sn.Physics().end_mass_ratio)
                for t, top in enumerate(TOPS):
                    stroke = side, top, aim, 0.0
                    if least(stroke, at.positions[k], at.on_table[k], rails, R) > STEEPEST:
                        wanted[line, :, s, t] = False
        wanted = wanted.ravel() if wanted.any() else free[k]
        assert np.array_equal(real[k], wanted), k
        cleared += (free[k] & ~wanted).any()
    assert cleared > 5


def test_planning_and_players_of_choices_have_the_masks_of_the_task():
    states = [posed({0: (FROZEN, 0.9), 1: (0.0, 1.2)}), posed({0: (0.3, 0.0), 1: (0.0, 1.2)})]
    at = Positions.of([env.get_state() for env in states])
    lies = ({0: lie, 1: (0.0, 1.2)} for lie in at.positions[:, 0])
    wanted = np.stack([posed(lie, action="discrete").action_masks() for lie in lies])
    rails = sn.Options(cue="real").rules.rails
    free, real = action_masks(at), action_masks(at, rails=rails)
    assert np.array_equal(real, wanted) and (free[0] != real[0]).any() and np.array_equal(free[1], real[1])
    wrong: Any
    for wrong in ("real", None, rails[1:], np.array([rails]), rails.astype(np.float32), np.full(6, np.nan)):
        with pytest.raises(ValueError, match=r"^rails = .*must be Planner\.rules\.rails"):
            action_masks(at, rails=wrong)
        with pytest.raises(ValueError, match=r"^rails = "):
            prospects_of(at, Spread(1e-3), rails=wrong)
    player: Any = sn.player("random").at({"cue": "real"})
    scores = player.scores(at, np.array([1, 2]))
    assert np.array_equal(np.isfinite(scores), real)
    choices = np.array([choice_of(0, 5, 2, 3)])
    planners = (Planner({"action": "discrete", "cue": cue}) for cue in ("free", "real"))
    level, aimed = (planner.strokes_of(at, [0], choices)[0] for planner in planners)
    assert abs(level - aimed).max() > 1e-4


def test_chances_of_pots_fall_where_the_cue_must_be_raised():
    cushion, spread = at_the_cushion(1, 0.0, 7)[0], Spread(1e-3)
    at = Positions.of(posed({0: cushion[0], 1: cushion[1]}).get_state())
    rails = sn.Options(cue="real").rules.rails
    level, raised = (prospects_of(at, spread, RULE_OF_THUMB, rails=r) for r in (NO_RAILS, rails))
    wider = prospects_of(at, Spread(1e-3 * (1.0 + np.radians(33.3) / TWICE)), RULE_OF_THUMB)
    assert raised[1][0, 0] == pytest.approx(wider[1][0, 0], rel=0.05)
    assert raised[1][0, 0] < 0.7 * level[1][0, 0]
    assert raised[0][0] < level[0][0]
    judges = (VisitJudge({"cue": cue, "noise": {"aim_deg": 0.05}}) for cue in ("free", "real"))
    proposed = [at_pots(judge, at, 30, np.array([3])).chances[0] for judge in judges]
    assert (proposed[1] < proposed[0]).all() and np.ptp(proposed[1]) > 10.0 * np.ptp(proposed[0])
