"""Does ``agents.features.indirect_pots`` find all banks, plants and cannons, and do the aims it solves pot?"""

from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest

import snooker_env as sn
from agents.features import indirect_pots as ind
from agents.features.indirect_pots import (
    AIM_X,
    AIM_Y,
    BALL,
    BANK,
    CANNON,
    GHOST_X,
    GHOST_Y,
    KIND,
    PLANT,
    POCKET,
)
from agents.players.aim_search import Aimer, widest_run
from snooker_env.benchmark import play_visits
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, GREEN, N_BALLS, PINK, YELLOW, BallOn, mask_of
from snooker_env.game.pots import pots
from snooker_env.geometry import BALL_RADIUS, HALF_WIDTH, POCKET_AIMS
from snooker_env.physics.engine import EventKind
from snooker_env.physics.parameters import Physics
from snooker_env.physics.table import Table
from snooker_env.planning import Planner, Positions
from snooker_env.tasks import SIDES, SPEEDS, TOPS, choice_of
from snooker_env.tasks.box_actions import line

R = BALL_RADIUS
MATCH, PAPER = Table.preset("match"), Physics.of("paper")
TOP_RIGHT, MIDDLE_RIGHT = 3, 2


def table(places):
    """positions (22, 2), on_table (22,) of the balls {id: (x, y)}."""
    positions, on_table = np.zeros((N_BALLS, 2)), np.zeros(N_BALLS, bool)
    for ball, place in places.items():
        positions[ball], on_table[ball] = place, True
    return positions, on_table


def found(places, ball_on=BallOn.RED, most=200):
    """All indirect shots."""
    return ind.indirect(*table(places), int(ball_on), MATCH, PAPER, most)


def with_entries(shots, **wanted):
    """The shots with these entries in the columns named."""
    for name, value in wanted.items():
        shots = shots[shots[:, getattr(ind, name)] == value]
    return shots


def one(shots, **wanted):
    (shot,) = with_entries(shots, **wanted)
    return shot


@pytest.fixture(scope="module")
def aimer():
    return Aimer(sn.Options(), 2.3)


def batch(*several, ball_on=BallOn.RED):
    """Positions that are being played, of balls {id: (x, y)} each."""
    positions, on_table = zip(*map(table, several), strict=True)
    return Positions(
        np.stack(positions), np.stack(on_table), np.array([[int(ball_on), 0, 0, 0, 0]] * len(several))
    )


def tried(aimer, places, shot, ball_on=BallOn.RED):
    """``Aimer.widest`` of this shot alone."""
    return aimer.widest(batch(places, ball_on=ball_on), shot[None])


def simulated(places, stroke, turn=0.0):
    """The ``Shot`` of a stroke, turned by an angle, by the simulation alone."""
    positions, on_table = table(places)
    speed, aim = float(stroke[0]), float(stroke[3]) + turn
    v, w = sn.strike(speed, aim)
    velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
    velocities[CUE], spins[CUE] = v[:2], w
    return sn.simulate(positions, velocities, spins, on_table=on_table)


def met(shot, kind, *balls):
    """How many events of a kind these balls have."""
    events = shot.events[shot.events["kind"] == kind]
    for name, ball in zip("ij", balls, strict=False):
        events = events[events[name] == ball]
    return len(events)


def potted_when_turned(places, stroke, half, ball):
    """Whether the ball still goes in where the stroke is turned within its half width, and not beyond."""
    turns = (-2.0, -0.8, 0.8, 2.0)
    return [simulated(places, stroke, turn * half).potted[ball] == TOP_RIGHT for turn in turns]


BANKED = {CUE: (0.2, -0.9), 1: (-0.2, -0.2)}
PLANTED = {CUE: (-0.1, 0.3), 1: (0.2, 0.8), 2: (0.5, 1.25)}
OFF = {CUE: (-0.04, -1.24), 1: (0.08, -0.56), BLUE: (0.48, -0.09)}


def test_a_bank_is_the_mirror_image_and_goes_in(aimer):
    shot = one(found(BANKED), KIND=BANK, POCKET=TOP_RIGHT, BALL=1)
    red, at, pocket = np.array(BANKED[1]), shot[[AIM_X, AIM_Y]], POCKET_AIMS[TOP_RIGHT, :2]
    # as near as a ball's centre comes to the cushion
    assert at[0] == pytest.approx(-(HALF_WIDTH - R), abs=1e-12)
    before, after = at - red, pocket - at
    assert before[1] / before[0] == pytest.approx(-after[1] / after[0], rel=1e-12)
    ghost = shot[[GHOST_X, GHOST_Y]]
    assert ghost == pytest.approx(red - 2 * R * before / np.hypot(*before), abs=1e-12)
    stroke, half, _, _ = tried(aimer, BANKED, shot)
    played = simulated(BANKED, stroke)
    assert played.potted[1] == TOP_RIGHT and played.potted[CUE] < 0
    assert met(played, EventKind.CUSHION, 1) == 1 and met(played, EventKind.BALL_BALL, CUE, 1) == 1
    # the width is the true one, and the aim its middle
    assert potted_when_turned(BANKED, stroke, half, 1) == [False, True, True, False]


def contact(start, angle, ball):
    """Where the centre of a ball that comes from ``start`` is when it meets another one."""
    u, to = np.array((cos(angle), sin(angle))), ball - start
    along = to @ u
    return start + u * (along - np.sqrt(4 * R * R - (to @ to - along * along)))


def half_window_over_slope(passes, pocket):
    """The tolerance of straight lines: ``passes(turn)`` is the last leg's start and direction for a turn."""

    def aside(turn):
        start, d = passes(turn)
        to = POCKET_AIMS[pocket, :2] - start
        return d[0] * to[1] - d[1] * to[0]

    assert pocket not in (2, 5)
    angle = np.degrees(np.arccos(passes(0.0)[1] @ POCKET_AIMS[pocket, 2:4]))
    # game.pots, of a corner
    window = np.interp(angle, (0.0, 10.0, 20.0, 30.0, 40.0, 50.0), (0.058, 0.055, 0.047, 0.033, 0.016, 0.0))
    assert aside(0.0) == pytest.approx(0.0, abs=1e-9)
    return 0.5 * window / abs((aside(1e-6) - aside(-1e-6)) / 2e-6)


def aimed(shot, places):
    """(cue ball, first ball, angle of the cue ball's way) of a shot."""
    cue, first = np.array(places[CUE]), np.array(places[int(shot[BALL])])
    return cue, first, atan2(*(shot[[GHOST_X, GHOST_Y]] - cue)[::-1])


def test_the_tolerance_of_a_bank_is_what_the_straight_lines_allow():
    """Independently: turn the cue ball's direction until the straight lines miss the pocket's window."""
    shot = one(found(BANKED), KIND=BANK, POCKET=TOP_RIGHT, BALL=1)
    cue, red, angle = aimed(shot, BANKED)

    def last_leg(turn):
        d = (red - contact(cue, angle + turn, red)) / (2 * R)
        off = -(HALF_WIDTH - R)
        return red + d * (off - red[0]) / d[0], np.array((-d[0], d[1]))

    assert shot[ind.TOLERANCE] == pytest.approx(half_window_over_slope(last_leg, TOP_RIGHT), rel=1e-6)


def test_the_tolerance_of_a_plant_is_what_the_straight_lines_allow():
    shot = one(found(PLANTED), KIND=PLANT, BALL=1, OTHER=2, POCKET=TOP_RIGHT)
    cue, first, angle = aimed(shot, PLANTED)
    second = np.array(PLANTED[2])

    def last_leg(turn):
        d = first - contact(cue, angle + turn, first)
        return second, (second - contact(first, atan2(*d[::-1]), second)) / (2 * R)

    assert shot[ind.TOLERANCE] == pytest.approx(half_window_over_slope(last_leg, TOP_RIGHT), rel=1e-6)


def test_the_tolerance_of_a_cannon_is_what_the_straight_lines_allow():
    """Nearly: the geometry takes differences over a 24th of the other ball's width for the slope."""
    blue = np.array(OFF[BLUE])
    corners = [shot for shot in with_entries(found(OFF), KIND=CANNON) if shot[POCKET] not in (2, 5)]
    assert corners
    for shot in corners:
        cue, first, angle = aimed(shot, OFF)

        def last_leg(turn, cue=cue, first=first, angle=angle):
            d = (first - contact(cue, angle + turn, first)) / (2 * R)
            at = contact(first, atan2(*d[::-1]), blue)
            centres = (blue - at) / (2 * R)
            # rolling: 5/7 after and 2/7 before
            after = d - 5 / 7 * 0.5 * (1 + PAPER.e_b) * (d @ centres) * centres
            return at, after / np.hypot(*after)

        assert shot[ind.TOLERANCE] == pytest.approx(
            half_window_over_slope(last_leg, int(shot[POCKET])), rel=0.25
        )


def test_a_plant_drives_the_second_red_in(aimer):
    shot = one(found(PLANTED), KIND=PLANT, BALL=1, OTHER=2, POCKET=TOP_RIGHT)
    first, second, pocket = np.array(PLANTED[1]), np.array(PLANTED[2]), POCKET_AIMS[TOP_RIGHT, :2]
    d = (pocket - second) / np.hypot(*(pocket - second))
    meets = second - 2 * R * d
    assert shot[[AIM_X, AIM_Y]] == pytest.approx(meets, abs=1e-12)
    ghost = first - 2 * R * (meets - first) / np.hypot(*(meets - first))
    assert shot[[GHOST_X, GHOST_Y]] == pytest.approx(ghost, abs=1e-12)
    stroke, half, _, _ = tried(aimer, PLANTED, shot)
    played = simulated(PLANTED, stroke)
    assert played.potted[2] == TOP_RIGHT and played.potted[CUE] < 0
    assert met(played, EventKind.BALL_BALL, CUE, 1) >= 1 and met(played, EventKind.BALL_BALL, CUE, 2) == 0
    assert potted_when_turned(PLANTED, stroke, half, 2) == [False, True, True, False]


def test_a_set_plant_is_aimed_along_the_line_of_the_two_reds(aimer):
    """Two reds that touch and point at the pocket, but for a degree: no ghost ball, yet it goes in."""
    pocket, second = POCKET_AIMS[TOP_RIGHT, :2], np.array((0.5, 1.3))
    angle = atan2(*(pocket - second)[::-1]) + 0.01
    first = second - 2 * R * np.array((cos(angle), sin(angle)))
    places = {CUE: (0.3, 0.3), 1: tuple(first), 2: tuple(second)}
    shot = one(found(places), KIND=PLANT, BALL=1, OTHER=2, POCKET=TOP_RIGHT)
    ghost = first - 2 * R * np.array((cos(angle), sin(angle)))
    assert shot[[GHOST_X, GHOST_Y]] == pytest.approx(ghost, abs=1e-9)
    stroke, half, _, _ = tried(aimer, places, shot)
    assert simulated(places, stroke).potted[2] == TOP_RIGHT and half > 5e-3
    first = second - 2 * R * np.array((cos(angle + 0.2), sin(angle + 0.2)))
    shots = found(places | {1: tuple(first)})
    assert len(with_entries(shots, KIND=PLANT, POCKET=TOP_RIGHT)) == 0


def test_a_cannon_goes_off_the_other_ball(aimer):
    cannons = with_entries(found(OFF), KIND=CANNON)
    for shot in cannons:
        at = shot[[AIM_X, AIM_Y]]
        assert shot[BALL] == 1 and shot[ind.OTHER] == BLUE
        assert hypot(*(at - OFF[BLUE])) == pytest.approx(2 * R, abs=1e-9)
        before, centres = (at - OFF[1]) / np.hypot(*(at - OFF[1])), (OFF[BLUE] - at) / (2 * R)
        sliding = before - 0.5 * (1 + PAPER.e_b) * (before @ centres) * centres
        # what is left when the cloth has made both spins the ball's own
        rolling = 5 / 7 * sliding + 2 / 7 * before
        pocket = POCKET_AIMS[int(shot[POCKET]), :2] - at
        assert rolling @ pocket / np.hypot(*rolling) == pytest.approx(np.hypot(*pocket), rel=1e-9)
    hits = [(shot, tried(aimer, OFF, shot)) for shot in cannons]
    hits = [(shot, hit[0]) for shot, hit in hits if hit is not None]
    assert hits
    for shot, stroke in hits:
        played = simulated(OFF, stroke)
        assert played.potted[1] == shot[POCKET] and met(played, EventKind.BALL_BALL, 1, BLUE) >= 1
        assert played.potted[BLUE] < 0


def between(a, b, share, aside=0.0):
    """A place on the way from a to b, so far to its left."""
    a, b = np.array(a, float), np.array(b, float)
    d = (b - a) / np.hypot(*(b - a))
    return tuple(a + share * (b - a) + aside * np.array((-d[1], d[0])))


@pytest.mark.parametrize("leg", range(3))
@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("places", "wanted"),
    [
        (BANKED, {"KIND": BANK, "BALL": 1, "POCKET": TOP_RIGHT}),
        (PLANTED, {"KIND": PLANT, "BALL": 1, "OTHER": 2, "POCKET": TOP_RIGHT}),
        (OFF, {"KIND": CANNON, "BALL": 1, "OTHER": BLUE}),
    ],
)
def test_a_ball_on_any_leg_blocks_it(places, wanted, leg, side):
    shot = with_entries(found(places), **wanted)[0]
    where, ghost = shot[[AIM_X, AIM_Y]], shot[[GHOST_X, GHOST_Y]]
    last = places[2] if shot[KIND] == PLANT else where
    a, b = [(places[CUE], ghost), (places[1], where), (last, POCKET_AIMS[int(shot[POCKET]), :2])][leg]
    for aside, many in ((1.98 * R, 0), (2.02 * R, 1)):
        shots = found(places | {PINK: between(a, b, 0.5, side * aside)})
        shots = with_entries(shots, **wanted | {"POCKET": shot[POCKET]})
        assert sum(np.allclose(one[[AIM_X, AIM_Y]], where) for one in shots) == many


def test_only_balls_that_may_go_down_together_are_planted():
    coloured = {CUE: PLANTED[CUE], 1: PLANTED[1], PINK: PLANTED[2]}
    assert PLANT in found(PLANTED)[:, KIND] and PLANT not in found(coloured)[:, KIND]
    assert CANNON in found(coloured)[:, KIND]  # a red off a colour is fair
    colours = {CUE: PLANTED[CUE], PINK: PLANTED[1], BLACK: PLANTED[2]}
    shots = found(colours, BallOn.ANY_COLOUR)
    assert len(shots) and PLANT not in shots[:, KIND]
    assert set(found(colours, BallOn.PINK)[:, BALL]) == {PINK}
    assert set(found(coloured)[:, BALL]) == {1}
    banked = {**BANKED, PINK: (0.5, 0.9)}
    assert set(found(banked)[:, BALL]) == {1} and set(found(banked, BallOn.ANY_COLOUR)[:, BALL]) == {PINK}


def no_direct(n, wanted=lambda shots: True):
    """n tables {id: place} of four reds and the colours, drawn, on which no red can be potted directly."""
    tables = []
    env = SnookerVectorEnv(4000, layout="random:4", aim="absolute")
    env.reset(seed=7000)
    for p, on in zip(env.tables.positions, env.tables.on_table, strict=True):
        if len(tables) < n and not len(pots(p, on, mask_of(range(1, 5)), most=1)):
            places = {int(i): tuple(p[i]) for i in np.flatnonzero(on)}
            if wanted(found(places)):
                tables.append(places)
    assert len(tables) == n
    return tables


def mirrored(places):
    """The table seen in a mirror, left and right exchanged."""
    return {ball: (-x, y) for ball, (x, y) in places.items()}


def test_mirrored_tables_offer_the_mirrored_shots():
    columns = [AIM_X, AIM_Y, GHOST_X, GHOST_Y]
    kinds = set()
    for places in [*no_direct(4, len), BANKED, PLANTED, OFF]:
        here, there = found(places), found(mirrored(places))
        assert len(here) == len(there) > 0
        assert here[:, ind.TOLERANCE] == pytest.approx(there[:, ind.TOLERANCE], rel=1e-6)
        assert (here[:, [KIND, BALL, ind.OTHER]] == there[:, [KIND, BALL, ind.OTHER]]).all()
        assert here[:, columns] * (-1, 1, -1, 1) == pytest.approx(there[:, columns], abs=1e-7)
        kinds |= set(here[:, KIND])
    assert kinds == {BANK, PLANT, CANNON}


def test_mirrored_tables_are_played_with_mirrored_aims(aimer):
    tables = [*no_direct(6, len), BANKED, PLANTED]
    here, there = (aimer.strokes(batch(*side)) for side in (tables, [mirrored(t) for t in tables]))
    assert here[:, :3] == pytest.approx(there[:, :3], abs=1e-6)
    aside = pi - here[:, 3] - there[:, 3]
    assert aside - 2.0 * pi * np.round(aside / (2.0 * pi)) == pytest.approx(np.zeros(len(tables)), abs=6e-4)


def test_where_the_plain_line_pots_it_is_played():
    """Where the widest pot goes in along its solved line, that stroke is it; elsewhere there are others."""
    env = SnookerVectorEnv(60, layout="held_out")
    env.reset(seed=3)
    at, planner = Positions.of(env), Planner({"action": "discrete"})
    choice = choice_of(0, SPEEDS.index(2.3), SIDES.index(0.0), TOPS.index(0.0))
    plain = planner.strokes_of(at, np.arange(60), np.full(60, choice))[0]
    searched = sn.player("geometric").at(env).play(at, np.zeros(60, int)).values
    made = planner.play(at, np.arange(60), strokes=plain).points > 0
    assert 30 < made.sum() < 60 and np.allclose(searched[made], plain[made], atol=1e-6)
    assert (planner.play(at, np.arange(60), strokes=searched).points > 0).sum() > made.sum()


def test_the_nearest_ball_on_is_struck_where_nothing_goes_in(aimer):
    tables = no_direct(8, lambda shots: len(shots) == 0)
    at = batch(*tables)
    for p, on, stroke in zip(at.positions, at.on_table, aimer.strokes(at), strict=True):
        off = float(stroke[3]) - line(p, on, mask_of(range(1, 5)))
        assert abs(sin(off)) < 1e-6 and cos(off) > 0.0


def test_the_widest_run():
    rng = np.random.default_rng(0)
    good = rng.random((300, 17)) < 0.6
    good[0], good[1] = False, True
    starts, lengths = widest_run(good)
    for row, start, length in zip(good, starts, lengths, strict=True):
        runs = [(a, b - a) for a in range(17) for b in range(a + 1, 18) if row[a:b].all()]
        longest = max([n for _, n in runs], default=0)
        assert length == longest
        if longest:
            middles = {a: abs(a + 0.5 * (n - 1) - 8.0) for a, n in runs if n == longest}
            assert middles[start] == min(middles.values())


def test_the_widest_of_several_is_taken(aimer):
    """Each shot alone, then all at once: the widest of them."""
    places = {**PLANTED, **{3: (-0.5, 0.9), GREEN: (-0.3, -1.0), YELLOW: (0.3, -1.0)}}
    shots = found(places, most=3)
    each = [tried(aimer, places, shot) for shot in shots]
    stroke, half, which, _ = aimer.widest(batch(places), shots)
    widths = [hit[1] if hit else 0.0 for hit in each]
    assert half == max(widths) and which == int(np.argmax(widths)) and (stroke == each[which][0]).all()


def test_a_visit_is_longer_than_the_plain_players():
    players = sn.player("ghost_ball"), sn.player("geometric")
    plain, own = (play_visits(one, 30, noise="none", threads=1).made.sum() for one in players)
    assert own > 1.5 * plain
