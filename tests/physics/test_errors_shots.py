"""Are wrong physics, tables, impacts, shots and strikes refused, and what is just allowed played? A ValueError names field,
value and what is allowed."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import simulation
from snooker_env.geometry import BALL_RADIUS, HALF_WIDTH
from tests import refusals
from tests.refusals import FIDELITY, WRONG_FIDELITIES, Z, batch, cushion, impact, refuse_each, refused, shot


def put(x, y):
    return [(0.0, 0.0), (x, y)]


def three(**second):
    """Three tables, of which the second has other arrays."""
    here = refusals.HERE
    return batch(**{name: [here[name], value, here[name]] for name, value in second.items()})


def moved(t):
    return lambda: sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z]).at(t)


def own(**parts):
    return lambda: sn.Table(**{"name": "mine", "noses": np.zeros((0, 5)), **NONE} | parts)


NONE = {"jaws": np.zeros((0, 6)), "falls": np.zeros((0, 3))}
WIDTHS = {"positions": 2, "velocities": 2, "spins": 3}
WIDE = sn.Table.rectangular(4.0, 2 * 1.067)
ODD = sn.Table("odd", np.array([(0, -1, 0.3, -9, 9), (0, 1, 1.0, -9, 9)]), **NONE)
BARE = sn.Table("bare", np.zeros((0, 5)), sn.Table.preset().jaws, sn.Table.preset().falls)
NAMES = {**vars(refusals), "WIDTHS": WIDTHS, "put": put, "three": three, "moved": moved, "FIDELITY": FIDELITY}
NAMES |= {"own": own, "ODD": ODD, "WIDE": WIDE, "BARE": BARE}

VECTORS = """
call(field=(1.0, 0.0)) | field | shape (2,) | must have shape (3,)
call(field=1.0) | field | shape () | must have shape (3,)
call(field=(1.0, NAN, 0.0)) | field | nan | must be finite
call(field=(-INF, 0.0, 0.0)) | field | -inf | must be finite
call(field=?) | field | ? | must be real numbers of shape (3,) | None; "abc"; [(1.0, 2.0), 0.0, 0.0]; np.array([1.0, 0.0, 0.0], object)
call(field=np.ma.array([1.0, 0.0, 0.0], mask=[False, True, False])) | field | masked | must be real numbers of shape (3,)
"""
NORMALS = """
call(normal=?) | normal | ? | must be a horizontal unit vector | (2.0, 0.0, 0.0); (0.0, 0.0, 0.0); (0.0, 0.0, 1.0)
call(normal=?) | normal | ? | must be a horizontal unit vector | (0.6, 0.8, 0.001); (1.00001, 0.0, 0.0); (1e200, 0.0, 0.0)
"""
SHOTS = """
shot(positions=[(0.0, 0.0)]) | velocities | shape (2, 2) | must have shape (1, 2)
shot(velocities=[(1.0, 0.0)]) | velocities | shape (1, 2) | must have shape (2, 2)
shot(spins=np.zeros((2, 2))) | spins | shape (2, 2) | must have shape (2, 3)
shot(positions=np.zeros((2, 3))) | positions | shape (2, 3) | must have shape (n, 2)
shot(positions=[]) | positions | shape (0,) | must have shape (n, 2)
shot(**{name: np.zeros((0, n)) for name, n in WIDTHS.items()}) | positions | shape (0, 2) | at least one ball
shot(**{name: np.zeros((4097, n)) for name, n in WIDTHS.items()}) | positions | shape (4097, 2) | at most 4096
shot(positions=put(NAN, 0.0)) | positions[1, 0] | nan | must be finite
shot(positions=put(1e300, 0.3)) | positions[1, 0] | 1e+300 | must be finite, within 1e+06 m of zero
shot(positions=put(1e7, 0.0), table=None) | positions[1, 0] | 10000000.0 | must be finite, within 1e+06 m of zero
shot(velocities=[(1.0, 0.0), (0.0, -INF)]) | velocities[1, 1] | -inf | must be finite
shot(velocities=np.array([["1e4000", 0], [0, 0]], np.longdouble)) | velocities[0, 0] | inf | must be finite
shot(velocities=[(?, 0.0), (0.0, 0.0)]) | velocities[0, 0] | ? | must be finite, within 1,000 m/s of zero | 1e25; -1e200; 1000.1
shot(spins=[(0.0, 0.0, NAN), Z]) | spins[0, 2] | nan | must be finite
shot(spins=[(0.0, 0.0, ?), Z]) | spins[0, 2] | ? | must be finite, within 100,000 rad/s of zero | 1e25; -100001.0
shot(positions=put(0.05, 0.0)) | positions | balls 0 and 1 | overlap by 0.0025 m, at most 1e-06 is allowed
shot(positions=put(0.0525 - 1.1e-6, 0.0)) | positions | balls 0 and 1 | overlap by 1.1e-06 m, at most 1e-06 is allowed
shot(positions=put(1.5, 0.0)) | positions | (1.5, 0.0) | must be on the table, |x| <= 0.86275, |y| <= 1.75825
shot(positions=put(0.0, -2.0)) | positions | (0.0, -2.0) | must be on the table
shot(positions=put(0.87, 0.5)) | positions | (0.87, 0.5) | overlaps the cushion at x = 0.889
shot(positions=put(0.2, 1.77)) | positions | (0.2, 1.77) | overlaps the cushion at y = 1.7845
shot(positions=put(0.2, -1.77)) | positions | (0.2, -1.77) | overlaps the cushion at y = -1.7845
shot(positions=put(0.889, 1.7845)) | positions | (0.889, 1.7845) | is over a pocket
shot(positions=put(0.895, 0.0)) | positions | (0.895, 0.0) | is over a pocket
shot(positions=put(0.885, 0.05)) | positions | (0.885, 0.05) | overlaps jaw
shot(on_table=[True]) | on_table | bool array of shape (1,) | must be bool of shape (2,)
shot(on_table=[[True, True]]) | on_table | bool array of shape (1, 2) | must be bool of shape (2,)
shot(on_table=[1, 0]) | on_table | int64 array of shape (2,) | must be bool of shape (2,)
shot(on_table=[1.0, 0.0]) | on_table | float64 array | must be bool of shape (2,)
shot(on_table="yes") | on_table | array of shape () | must be bool of shape (2,)
shot(on_table=?) | on_table | ? | must be bool of shape (2,) | [[True], True]
shot(max_events=?) | max_events | ? | must be an integer in [1, 2147483648] | 0; -1; 1.5; 100.0; True; "many"; None; NAN; 2**31 + 1
shot(max_events=?) | max_events | ? | must be an integer in | np.timedelta64(3, "ns")
shot(table=?) | table | ? | "match", "tight" | 3; True; ["match"]; {"name": "match"}; b"match"
shot(table=?) | table | ? | must be one of 'match', 'tight' | ""; "Match"; "loose"; "unbounded"
sn.Table.preset(?) | table | ? | must be one of 'match', 'tight' | ""; "Match"; None
sn.Table("x", np.zeros((1, 2)), np.zeros((0, 6)), np.zeros((0, 3))) | table.noses | shape (1, 2) | must have shape (n, 5)
shot(physics={"mu_s": 0.0}) | physics.mu_s | 0.0 | must be > 0 to simulate a shot
shot(physics={"mu_r": 0.0}) | physics.mu_r | 0.0 | must be > 0 to simulate a shot
shot(physics={"mu_r": 1e-8}) | physics.mu_r | 1e-08 | times g = 9.81 in [1e-06, 1e+06] m/s^2
shot(physics={"spin_decel": 5e-324}) | physics.spin_decel | 5e-324 | must be 0 (a spin about the vertical stays) or at least 1e-06 rad/s^2
shot(physics={"g": 1e308}) | physics.mu_s | 0.21 | times g = 1e+308 in [1e-06, 1e+06]
shot(fidelity="euler:" + "9" * 5000) | fidelity | 'euler:9999 | must be "fast", "standard"
moved(-0.5) | t | -0.5 | must not be negative
moved([0.1, -1e-12]) | t | -1e-12 | must not be negative
moved(NAN) | t[0] | nan | must be finite
moved([0.0, INF]) | t[1] | inf | must be finite
moved([[0.1]]) | t | shape (1, 1) | must have shape (n,)
moved(np.ma.array([0.1], mask=[True])) | t | masked | must be real numbers of shape (n,)
moved(?) | t | ? | must be real numbers of shape (n,) | True; "soon"; 1j
"""
TABLES = """
own(name=?) | table.name | ? | must be a str | None; 3
sn.Table.rectangular(2.0, 1.0, pockets=False) | table.pockets | False | must be 6, 4 or 0
own(noses=[(2, 1, 1, -1, 1)]) | table.noses[0] | (2.0, 1.0, 1.0, -1.0, 1.0) | must be axis 0 or 1, side -1 or 1
own(noses=[(0, 1, 1, -1, 1), (0, 0, 1, -1, 1)]) | table.noses[1] | (0.0, 0.0, 1.0, -1.0, 1.0) | side -1 or 1, level, and lo <= hi
own(noses=[(0, 1, NAN, -1, 1)]) | table.noses[0, 2] | nan | must be finite
own(noses=[(0, 1, 1, 1, -1)]) | table.noses[0] | (0.0, 1.0, 1.0, 1.0, -1.0) | lo <= hi
own(jaws=[(0, 0, -0.1, 1, 0, 0)]) | table.jaws[0] | -0.1 | must be x, y, radius >= 0, a unit vector (to 1e-6), and a cosine
own(jaws=[(0, 0, 0.1, 0, 0, 0)]) | table.jaws[0] | (0.0, 0.0, 0.1, 0.0, 0.0, 0.0) | a unit vector
own(jaws=[(0, 0, 0.1, 1, 0, 1.5)]) | table.jaws[0] | 1.5 | and a cosine
own(falls=[(0, 0, 0.1), (0, 0, -0.1)]) | table.falls[1] | -0.1 | must be x, y, and a radius > 0
shot(table="match", physics={"R": 0.02}) | physics.R | 0.02 | which is made for it: write physics={"R": 0.02625}
shot(table="uk8") | physics.R | 0.02625 | on table "uk8", which is made for it
batch(table="carom", physics="match") | physics.R | 0.02625 | must be 0.03075 on table "carom", which is made for it
shot(positions=put(1.05, 0.3), table=WIDE) | positions[1] | (1.05, 0.3) | overlaps the cushion at x = 1.067
shot(positions=put(-0.4, 1.0), table=ODD) | positions[1] | (-0.4, 1.0) | must be on the table, -0.27375 <= x <= 0.97375 away
shot(positions=put(0.895, 0.0), table=BARE) | positions[1] | (0.895, 0.0) | is over a pocket
sn.Table.preset().check([0.0, 1.0], 0.02625) | positions | array of shape (2,) | must have shape (n, 2) or (b, n, 2)
sn.Table.preset().check([(0.0, 0.0)], 0.02625, on_table=[True] * 4) | on_table | bool array of shape (4,) | must be bool of shape (1,)
SnookerEnv(table=?) | table | Table | Snooker-v0: this one is made for balls of radius 0.03075 m | sn.Table.preset("carom")
SnookerEnv(table=sn.Table.rectangular(3.569, 1.7)) | table | 'rectangular' | must have its noses at x = -0.889 in Snooker-v0
"""
PHYSICS = """
sn.Physics(R=?) | physics.R | ? | must be a finite number in [0.001, 1] | 0; -1; 1.1; 1e-300
sn.Physics(M=?) | physics.M | ? | must be a finite number in (0, inf) | 0; -0.1
sn.Physics(g=?) | physics.g | ? | must be a finite number in (0, inf) | 0; -9.81
sn.Physics(mu_s=?) | physics.mu_s | ? | must be a finite number in [0, 1] | -0.1; 1.1
sn.Physics(mu_r=?) | physics.mu_r | ? | must be a finite number in [0, 1] | -0.01; 1.01
sn.Physics(spin_decel=?) | physics.spin_decel | ? | must be a finite number in [0, inf) | -1
sn.Physics(roll_drag=?) | physics.roll_drag | ? | must be a finite number in [0, 1] | -1e-9; 1.01
sn.Physics(e_b=?) | physics.e_b | ? | must be a finite number in [0, 1] | -0.1; 1.01
sn.Physics(e_c=?) | physics.e_c | ? | must be a finite number in [0, 1] | -0.1; 1.01
sn.Physics(e_j=?) | physics.e_j | ? | must be a finite number in [0, 1] | -0.1; 1.01; "0.5"; True
sn.Physics(e_t=1.0) | physics.e_t | 1.0 | must be a finite number in
sn.Physics(flight=1) | physics.flight | 1 | must be True or False
sn.Physics(tables=1) | physics.tables | 1 | must be True or False
sn.Physics(e_c_knee=-1) | physics.e_c_knee | -1 | must be a finite number in [0, inf)
sn.Physics(e_c_power=?) | physics.e_c_power | ? | must be a finite number in [0, 0.8] | -0.1; 0.81
sn.Physics(mu_c=?) | physics.mu_c | ? | must be a finite number in [0, 1] | -0.1; 2
sn.Physics(sin_theta=?) | physics.sin_theta | ? | must be a finite number in [0, 0.95] | -0.1; 0.96
sn.Physics(end_mass_ratio=-1) | physics.end_mass_ratio | -1 | must be a finite number in [0, inf)
sn.Physics(max_offset=?) | physics.max_offset | ? | must be a finite number in (0, 0.999] | 0; 1.0
sn.Physics(R=?) | physics.R | ? | all balls of a shot are equal (docs/physics/limits.md) | [0.025, 0.026]; np.array([0.025, 0.025])
sn.Physics.preset("match", M=(0.1, 0.2)) | physics.M | (0.1, 0.2) | must be one number: all balls of a shot are equal
sn.Physics(mu_bb=?) | physics.mu_bb | ? | must be a finite number in [0, 1] | -0.1; 1.1; NAN; None
sn.Physics(mu_bb=?) | physics.mu_bb | ? | "marlow", or (a, b, c) with a, b, c >= 0 and a + b <= 1 | "Marlow"; (0.1, 0.2); (0.5, 0.6, 1.0)
sn.Physics(mu_bb=(0.1, ?, 1.0)) | physics.mu_bb | ? | must be a finite number in [0, inf) | -0.1; NAN
sn.Physics(nap=0.001, roll_drag=0.01) | physics.roll_drag | 0.01 | must be 0 with physics.nap = 0.001
sn.Physics(nap=?) | physics.nap | ? | must be | 0.0127 * 9.81; -0.2; NAN; INF
sn.Physics(e_c_power=0.25) | physics.e_c_knee | 0.0 | must be at least 0.001 m/s where e_c_power > 0
sn.Physics.preset("match", e_c_knee=?) | physics.e_c_knee | 0.0 | must be at least 0.001 m/s where e_c_power > 0 | 0; 9e-4 * 0
strike(physics={"mu_r": ?}) | physics.mu_r | ? | must be a finite number in [0, 1] | -0.01; NAN
SnookerEnv(physics={"mu_r": ?}) | physics.mu_r | ? | must be a finite number in [0, 1] | -0.01; NAN
sn.Physics.preset(?) | physics | ? | must be one of 'paper', 'match' | ""; "Paper"; "real"
strike(physics=?) | physics | ? | must be one of 'paper', 'match' | ""; "Paper"
shot(physics="real") | physics | 'real' | must be one of 'paper', 'match'
batch(physics="real") | physics | 'real' | must be one of 'paper', 'match'
SnookerEnv(physics="real") | physics | 'real' | must be one of 'paper', 'match'
sn.Physics.of({"preset": "real"}) | physics | 'real' | must be one of 'paper', 'match'
sn.Physics.of(?) | physics | ? | must be None, a preset's name, a dict of overrides, or a Physics | 3; ["paper"]; True; 0.5; b"paper"
sn.Physics.of({?: 1}) | physics field | ? | must be one of 'R', 'M', 'g', 'mu_s' | "mu"; "name"; "cls"; 1
SnookerEnv(physics={"mu": 0.1}) | physics field | 'mu' | must be one of 'R'
"""
BATCHES = """
batch(positions=[(0.0, 0.0), (0.3, 0.0)]) | positions | shape (2, 2) | must have shape (b, n, 2)
batch(velocities=np.zeros((2, 2, 2))) | velocities | shape (2, 2, 2) | must have shape (3, 2, 2)
three(positions=put(0.02, 0.0)) | positions[1] | balls 0 and 1 | overlap by 0.0325 m
three(positions=put(0.905, 0.5)) | positions[1][1] | (0.905, 0.5) | must be on the table
three(positions=put(0.3, NAN)) | positions[1, 1, 1] | nan | must be finite
three(velocities=[(1e25, 0.0), (0.0, 0.0)]) | velocities[1, 0, 0] | 1e+25 | must be finite, within 1,000 m/s of zero
three(spins=[(0.0, -100001.0, 0.0), Z]) | spins[1, 0, 1] | -100001.0 | must be finite, within 100,000 rad/s of zero
batch(on_table=[True, True]) | on_table | bool array of shape (2,) | must be bool of shape (3, 2)
batch(**{name: np.zeros((2, 0, n)) for name, n in WIDTHS.items()}) | positions | shape (2, 0, 2) | at least one ball
batch(threads=?) | threads | ? | must be an integer in [1, 1024] | 0; -2; 1.0; "2"; True; 1025
batch(events=?) | events | ? | must be True or False | "x"; 1; None; [True]
batch(max_events=0) | max_events | 0 | must be an integer in [1, 2147483648]
"""
STRIKES = """
strike(speed=?) | speed | ? | must be a finite number in [0, 1000] | -1.0; -1e-300; 1000.1; 1e25; NAN; INF
strike(speed=?) | speed | ? | must be a finite number | np.complex128(1 + 2j); np.array(1j); np.timedelta64(3, "ns"); np.True_
strike(speed=10**400) | speed | 1000 | must be a finite number
strike(elevation=?) | elevation | ? | must be a finite number in [0, 1.5] | -0.01; 1.51; NAN; INF
strike(aim=?) | aim | ? | must be in radians, within a turn of 0; from degrees: np.radians(degrees) | 90.0; -180.0; 6.3
strike(side=0.6) | (side, top) | (0.6, 0.0) | 0.6 R is a miscue, must be within 0.5 R of the ball's centre
strike(side=-0.4, top=0.4) | (side, top) | (-0.4, 0.4) | miscue, must be within 0.5 R
strike(side=0.4, physics={"max_offset": 0.3}) | (side, top) | (0.4, 0.0) | within 0.3 R
"""
NO_NUMBER = """
strike(field=?) | field | ? | must be a finite number | NAN; INF; "1"; None; True; [1.0, 2.0]; 1j; b"1"; np.array([2.0]); np.ma.masked; {}
"""
NO_CONSTANT = """
sn.Physics(field=?) | physics.field | ? | must be a finite number in | NAN; INF; "0.1"; None; True; [0.1]
"""


def test_what_is_no_vector_of_an_impact():
    for call, fields in (("impact", ("v1", "w1", "v2", "w2", "normal")), ("cushion", ("v", "w", "normal"))):
        for field in fields:
            refuse_each(VECTORS.replace("call", call).replace("field", field), NAMES)
        refuse_each(NORMALS.replace("call", call), NAMES)
    allowed = "must be real numbers of shape (3,)"
    refuse_each(f'impact(v1=?) | v1 | ? | {allowed} | ["1", "0", "0"]; [True, False, False]', NAMES)


@pytest.mark.parametrize(("call", "fields"), [(impact, ("v1", "w1", "v2", "w2")), (cushion, ("v", "w"))])
def test_impacts_too_fast_to_compute(call, fields):
    for field in fields:
        most, unit = (1e9, "1e+09 rad/s") if field.startswith("w") else (1e6, "1e+06 m/s")
        for k in range(3):
            for wrong in (np.nextafter(most, np.inf), -1.1 * most, 1e25, -1e200):
                said = f"{field}[{k}]", repr(float(wrong)), f"must be finite, within {unit} of zero"
                refused(call(**{field: np.eye(3)[k] * wrong}), *said)


@pytest.mark.parametrize("call", [impact, cushion, shot, batch])
def test_wrong_fidelities(call):
    for wrong in WRONG_FIDELITIES:
        refused(call(fidelity=wrong), "fidelity", repr(wrong), FIDELITY)


@pytest.mark.parametrize(
    "table",
    [SHOTS, BATCHES, STRIKES, TABLES, PHYSICS],
    ids=["shots", "batches", "strikes", "tables", "physics"],
)
def test_wrong_values(table):
    refuse_each(table, NAMES)


def test_what_is_no_number():
    for field in ("speed", "aim", "side", "top", "elevation"):
        refuse_each(NO_NUMBER.replace("field", field), NAMES)
    values = vars(sn.Physics()).items()
    constants = [name for name, value in values if type(value) is float and name != "mu_bb"]
    assert len(constants) > 12
    for field in constants:
        refuse_each(NO_CONSTANT.replace("field", field), NAMES)


def test_physics_cannot_be_changed_and_its_range_ends_are_allowed():
    with pytest.raises(AttributeError):
        sn.Physics().e_b = 0.5
    with pytest.raises(TypeError, match="mu_ball"):
        sn.Physics(mu_ball=0.1)
    sn.Physics(e_c_power=0.8, e_c_knee=1e-3)
    ends = {"R": 1, "mu_s": 0, "mu_r": 1, "spin_decel": 0, "e_b": 1, "e_c": 0, "mu_c": 1, "sin_theta": 0.95}
    sn.Physics(**ends, end_mass_ratio=0, max_offset=0.999, mu_bb=(0, 1, 0))


def test_balls_off_the_table_may_lie_anywhere():
    """What is not on the table is not looked at: no overlap, no place is wrong for it, and it stays where it is."""
    places, v = [(0.0, 0.0), (0.0, 0.0), (5.0, 5.0)], [(0.0, 1.0), (9.0, 0.0), (0.0, 0.0)]
    shot = sn.simulate(places, v, np.zeros((3, 3)), on_table=[True, False, False])
    assert shot.positions[1:].tolist() == [[0.0, 0.0], [5.0, 5.0]]
    assert shot.on_table.tolist() == [True, False, False]


def test_what_is_just_allowed_is_played():
    touching = [(0.0, 0.0), (0.0525 - 0.9e-6, 0.0)]
    assert sn.simulate(touching, np.zeros((2, 2)), np.zeros((2, 3))).duration == 0.0
    wall = HALF_WIDTH - BALL_RADIUS
    assert sn.simulate([(wall + 0.9e-6, 0.5)], np.zeros((1, 2)), np.zeros((1, 3))).duration == 0.0
    sn.strike(0.0, -2 * np.pi, side=0.3, top=-0.4, elevation=1.5)
    assert sn.collide_cushion((1, 0, 0), Z, (1 + 5e-7, 0, 0))[0][0] < 0
    assert sn.simulate(touching[:1], [(1.0, 0.0)], [Z], table=None, max_events=2**31).positions[0, 0] > 1.0


def test_too_few_events_are_an_error_of_the_simulation_with_advice():
    end = r"max_events \(after 1 events; the last was ROLL of 0 and -1 at 0\.138690 s"
    with pytest.raises(sn.SimulationError, match=r"shot 0 did not come to rest.*" + end):
        sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], max_events=1)
    with pytest.raises(sn.SimulationError, match=r"shot 1 did not come to rest.*max_events"):
        sn.simulate_batch([[(0.0, 0.0)]] * 2, [[(0.0, 0.0)], [(1.0, 0.0)]], np.zeros((2, 1, 3)), max_events=1)


def test_a_shot_inside_a_shot_has_its_own_log(monkeypatch):
    """As a signal handler or a trace function may start one: between the kernel and the copy of its log."""
    first = ([(0.0, 0.0)], [(1.0, 0.2)], [(0.0, 0.0, 0.0)])
    other = ([(0.0, 0.5)], [(0.3, 2.0)], [(5.0, 0.0, 0.0)])
    want, run = sn.simulate(*first), simulation._run

    def interrupted(*arguments, **more):
        out = run(*arguments, **more)
        monkeypatch.setattr(simulation, "_run", run)
        sn.simulate(*other)
        return out

    monkeypatch.setattr(simulation, "_run", interrupted)
    got = sn.simulate(*first)
    assert np.array_equal(got.events, want.events) and np.array_equal(got.segments, want.segments)
    assert len(want.events) > 1
