"""Do the shots at which the fuzz of a million once failed come to rest?"""

import pytest

import snooker_env as sn
from benchmarks import fuzz


@pytest.mark.parametrize(
    ("number", "index", "why"),
    [
        (4770, 114, "it lay in a mouth narrower than a ball, behind the ends of both jaws"),
        (4030, 64, "a ball held by edge and jaw met another at once, without end"),
        (4030, 134, "the same"),
    ],
)
def test_it_comes_to_rest(number, index, why):
    drawn = fuzz.batch(6, number)
    places, velocities = (part[index] for part in drawn.states())
    world = drawn.spins[index], drawn.table, drawn.physics, "standard"
    shot = sn.simulate(places, velocities, *world, max_events=40_000)
    assert shot.duration > 0.0, why
