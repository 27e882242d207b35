"""Are the paths, contacts and strikes that diagrams draw those of the shot?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.render import shot_paths
from tests.refusals import refused

R = 0.02625


def played(balls, speed=2.0, aim=1.5708, table="match", physics=None, **tip):
    v, w = sn.strike(speed, aim, physics=physics, **tip)
    still = [(0.0, 0.0)] * (len(balls) - 1)
    return sn.simulate(balls, [v[:2], *still], [w, *[(0.0, 0.0, 0.0)] * len(still)], table, physics)


@pytest.fixture(scope="module")
def shots():
    """Screw into a cushion; a masse; a path bent by the nap; a pot with a jaw on its way."""
    return {
        "screw": played([(0.0, 0.5), (0.03, 1.0), (-0.4, 1.3)], top=-0.4, side=0.2),
        "masse": played([(0.0, -1.0), (0.4, 0.6)], aim=1.3, side=0.3, top=-0.1, elevation=0.8),
        "nap": played([(0.0, -1.0), (0.3, 0.2)], 3.0, 1.3, physics=sn.Physics.preset("match", nap=0.02)),
        "cushions": played([(0.1, -0.9), (0.5, 1.2)], speed=4.0, aim=1.9, side=0.3),
    }


def test_every_vertex_of_a_path_is_where_the_shot_has_the_ball(shots):
    for shot in shots.values():
        for ball, own in shot_paths.paths(shot).items():
            for piece in own:
                assert np.array_equal(piece.points, shot.at(piece.times)[0][:, ball])
            starts, ends = [p.times[0] for p in own[1:]], [p.times[-1] for p in own[:-1]]
            assert all(a >= b for a, b in zip(starts, ends, strict=True))
            assert own[-1].times[-1] <= shot.duration
            assert np.allclose(own[-1].points[-1], shot.positions[ball], atol=1e-9)


def test_between_the_vertices_the_lines_lie_on_the_path(shots):
    for shot in shots.values():
        for ball, own in shot_paths.paths(shot).items():
            for piece in own:
                for a, b in zip(piece.times[:-1], piece.times[1:], strict=True):
                    p, q = (shot.at(t)[0][ball] for t in (a, b))
                    if np.hypot(*(q - p)) < 1e-6:
                        continue
                    unit = (q - p) / np.hypot(*(q - p))
                    for r in shot.at(np.linspace(a, b, 9))[0][1:-1, ball] - p:
                        assert abs(unit[0] * r[1] - unit[1] * r[0]) <= shot_paths.STRAY


def test_a_piece_slides_where_the_contact_point_slips(shots):
    """Slip v + R (-w_y, w_x): of the middle of each piece, from the shot itself."""
    kinds = set()
    for shot in shots.values():
        for ball, own in shot_paths.paths(shot).items():
            for piece in own:
                t = (piece.times[0] + piece.times[-1]) / 2
                _, v, w = (part[ball] for part in shot.at(t))
                slip = np.hypot(v[0] - R * w[1], v[1] + R * w[0])
                assert (slip > 1e-9) == (piece.kind == "slide"), (ball, piece.kind, slip)
                kinds.add(piece.kind)
    assert kinds == {"slide", "roll"}


def test_contacts_are_those_of_the_log_at_their_places(shots):
    for shot in shots.values():
        found = [c for ball in range(len(shot.positions)) for c in shot_paths.contacts(shot, ball)]
        log = shot.events[shot.events["kind"] <= sn.EventKind.POT]
        assert len(found) == len(log) + (log["kind"] == sn.EventKind.BALL_BALL).sum()
        for c in found:
            if c.kind == sn.EventKind.BALL_BALL:
                other = shot.at(c.time)[0][c.other]
                assert np.hypot(*(c.place - c.centre)) == pytest.approx(R, abs=1e-6)
                assert np.hypot(*(c.place - other)) == pytest.approx(R, abs=1e-6)
            elif c.kind == sn.EventKind.CUSHION:
                axis, side, level = shot.table.noses[c.other, :3]
                assert c.place[int(axis)] == side * level
                assert np.hypot(*(c.place - c.centre)) == pytest.approx(R, abs=1e-6)
            assert c.speed == pytest.approx(np.hypot(*shot.at(c.time - 1e-7)[1][c.ball]), abs=1e-5)
            assert c.after == np.hypot(*shot.at(c.time)[1][c.ball])


def test_the_cut_is_that_of_the_geometry():
    """A ball that rolls along y past a ball aside by d is cut by asin(d / 2R)."""
    for aside in (0.0, 0.01, 0.03, 0.05):
        spins = [(-1.0 / R, 0.0, 0.0), (0.0, 0.0, 0.0)]
        shot = sn.simulate([(0.0, 0.0), (aside, 0.5)], [(0.0, 1.0), (0.0, 0.0)], spins)
        met = next(shot_paths.contacts(shot, 0))
        assert met.cut == pytest.approx(np.arcsin(aside / (2 * R)), abs=1e-9)


@pytest.mark.parametrize("elevation", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("tip", [(0.3, -0.2), (-0.25, 0.35), (-0.1, -0.45), (0.02, 0.1)])
def test_the_tip_is_that_of_the_strike(tip, elevation):
    v, w = sn.strike(2.5, 0.7, *tip, elevation)
    rolls = np.allclose([v[0] - R * w[1], v[1] + R * w[0]], 0.0, atol=1e-12)
    assert rolls == ((elevation, tip) in {(0.3, (-0.25, 0.35)), (1.0, (0.02, 0.1))})
    if rolls:  # nothing tells how
        return
    found = shot_paths.tip_of(v[:2], w, sn.Physics.of(None))
    given = found.side, found.top, found.speed, found.elevation
    assert np.allclose(given, [*tip, 2.5, elevation], atol=1e-12)


def test_without_side_the_cue_is_taken_as_level():
    v, w = sn.strike(2.5, 0.7, 0.0, -0.2, 0.4)
    found = shot_paths.tip_of(v[:2], w, sn.Physics.of(None))
    assert found.elevation == 0.0 and found.side == 0.0 and found.speed == pytest.approx(np.hypot(*v[:2]))


@pytest.mark.parametrize("side", [0.0, 0.1, -0.2])
def test_a_ball_that_rolls_off_the_tip_is_taken_as_struck_by_a_level_cue(side):
    """The steep cue makes it roll, as a level one at 0.4 R above the middle does."""
    v, w = sn.strike(2.5, 0.7, side, 0.1, 1.4)
    found = shot_paths.tip_of(v[:2], w, sn.Physics.of(None))
    assert (
        found.elevation == 0.0
        and found.top == pytest.approx(0.4)
        and found.speed == pytest.approx(np.hypot(*v[:2]))
    )
    assert np.sign(found.side) == np.sign(side)


def test_arrowheads_stand_evenly_on_their_line():
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.6)])
    found = shot_paths.arrow_places(points, 0.4)
    assert np.allclose([p for p, _ in found], [(0.2, 0), (0.6, 0), (1, 0), (1, 0.4)])
    assert np.allclose([u for _, u in found][:2], [(1, 0), (1, 0)]) and np.allclose(found[3][1], (0, 1))
    assert len(shot_paths.arrow_places(points, 2.0)) == 1 and len(shot_paths.arrow_places(points, 4.0)) == 0


def test_a_shot_without_its_path_is_refused():
    env = sn.SnookerEnv()
    env.reset(seed=1)
    env.step([0.0, 0.0, 0.0, 0.5])
    refused(lambda: shot_paths.paths(env.last_shot), "shot.segments", "none", "keep_history = True")
    # it crashed the interpreter
    refused(lambda: env.last_shot.at(0.0), "shot.segments", "none", "keep_history = True")
