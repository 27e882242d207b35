"""Is a mirrored shot the mirror image to the last bit? On a preset table and on unbounded cloth, in both axes."""

import numpy as np
import pytest

import snooker_env as sn
from benchmarks import fuzz
from benchmarks.stability.symmetry import images
from snooker_env.game.balls import SPOTS

AXES = (0, 1)


def assert_mirrored(drawn, axis):
    here, there = images(drawn, axis)
    assert all(np.array_equal(a, b) for a, b in zip(here, there, strict=True))


STATES = """
-0.7080654630442265 -1.53820476535497 -0.03763651157339082 -0.3143866118787602 -2.7861911148152276
0.664816318256439 -3.1377128437097856
0.6834735910295815 -1.4348324656274336 8.737459975608057e-09 -2.1354345055963315e-09 -2.6318672736203923
-1.2321581963042363 -1.1476878310510337
-0.5997487400388513 -1.429521620900905 -16.494507570290715 11.470756751715614 131.12636982665725
-1581.8914422594514 2548.5804158569586
0.371852724123952 -0.3619382321560509 -0.0 0.0 0.0010172257001981933 0.007091693272813801
-0.003128906233734853
0.5803480087307542 -1.2771108804478382 -1.846272926173316e-05 -1.2203552948827453e-07 -0.7848294314306914
-0.24653267111613486 -0.2838740347846104
0.4009527962716286 -0.9466700341875738 0.0 -0.0 -0.0 -0.0 -0.0
-0.34075243634558616 -1.2408855459533403 0.024898591592191637 -0.014987698543484106 0.0 0.0 0.0
-0.0727156545790344 -1.4400686828184779 4.168690279808415e-10 -1.6461256833155996e-08 -0.0 0.0 -0.0
0.037187733616767304 -1.3227138840708168 -2.431604580593746 2.9493115341738343 0.0 0.0 0.0
0.6103360912064733 -1.4085321146461727 1.9482228110958397 13.38783186737358 -181.11687281273868
138.69952011231538 256.9762819159328
"""
"""Of each ball: place (2), velocity (2), spin (3)."""
SLOW = {
    "mu_s": 0.185101748694865,
    "mu_r": 0.004689008469113155,
    "spin_decel": 35.540494356801965,
    "e_b": 0.6020187660714211,
    "mu_bb": 0.14065769285912888,
    "e_c": 0.55635554289081,
    "e_c_knee": 2.58826387917434,
    "e_c_power": 0.392464920774469,
    "e_j": 0.8240976711911294,
    "mu_c": 0.36194284046561975,
    "sin_theta": 0.2188564184492621,
}


def one_shot(p, v, w, physics, fidelity="standard"):
    """A batch of one shot on the match table."""
    arrays = (np.array([a]) for a in (p, v, w, np.zeros_like(p)))
    return fuzz.Batch("one shot", "", fidelity, physics, sn.Table.preset("match"), *arrays)


def test_shots_that_once_differed():
    """A jaw found with the time of another jaw as its limit, or a fall; a polynomial with -0.0 where its image has 0.0: by 3e-13 m."""
    rack, v, w = SPOTS.copy(), np.zeros((22, 2)), np.zeros((22, 3))
    rack[0], v[0] = (0.1, -1.3), (-0.061457985580204356, 1.655226055840073)
    w[0] = -48.51082848359777, -37.101183069595784, 32.11365387724147
    assert_mirrored(one_shot(rack, v, w, sn.Physics.preset("paper")), 1)
    slow = (
        [(0.6850169620401869, 1.700800798779885)],
        [(1.3913081502840885e-06, -2.2175766845057323e-06)],
        [(0.0, -0.0, -0.0)],
    )
    assert_mirrored(one_shot(*slow, sn.Physics(**SLOW), "fast"), 0)
    balls = np.array(STATES.split(), float).reshape(-1, 7)
    assert_mirrored(one_shot(balls[:, :2], balls[:, 2:4], balls[:, 4:], sn.Physics.preset("match")), 1)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("number", [1, 7, 8, 15, 16])
def test_random_shots_are_mirrored_to_the_last_bit(number, axis):
    drawn = fuzz.batch(5, number)
    assert_mirrored(drawn, axis)
