"""Do the paths of the miss rule end at cushions? Shots that the physics really plays are the judge."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import CUE, N_BALLS, NAMES, mask_of
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from tests.game.geometry_cases import lie
from tests.miss_paths import paths

TABLE = sn.Table.preset("match")


def scene(**places):
    return lie({1 if name == "red" else NAMES.index(name): place for name, place in places.items()})


def first_met(positions, on_table, angles):
    """What a cue ball that rolls fast along each angle meets first: a ball's id, or -1."""
    n = len(angles)
    velocities, spins = np.zeros((n, N_BALLS, 2)), np.zeros((n, N_BALLS, 3))
    c, s = np.cos(angles), np.sin(angles)
    velocities[:, CUE] = 20 * np.column_stack([c, s])
    spins[:, CUE, :2] = 20 / R * np.column_stack([-s, c])
    tables, present = np.repeat(positions[None], n, 0), np.repeat(on_table[None], n, 0)
    out = sn.simulate_batch(tables, velocities, spins, "match", on_table=present, events=True)
    met = np.full(n, -1)
    for k in range(n):
        own = [e for e in out.events[k] if e["i"] == CUE and e["kind"] in (0, 1, 2, 3, 6)]
        if own and own[0]["kind"] == 0:
            met[k] = own[0]["j"]
    return met


def in_mouths_and_at_rails(rng):
    """A place near the rails, or in the mouth of a pocket, that the table leaves to a ball."""
    while True:
        place = rng.uniform([-HALF_WIDTH, -HALF_LENGTH], [HALF_WIDTH, HALF_LENGTH])
        if rng.random() < 0.6:
            side = rng.integers(2)
            rail = (HALF_WIDTH, HALF_LENGTH)[side] - R
            place[side] = np.sign(place[side]) * (rail - rng.exponential(0.003) + 0.004)
        if rng.random() < 0.4:
            place[1] = rng.choice([-HALF_LENGTH, 0, HALF_LENGTH]) + rng.normal(0, 0.05)
        try:
            TABLE.check([place], R)
        except ValueError:
            continue
        return place


@pytest.mark.slow
def test_paths_agree_with_rolled_balls():
    """Near rails and pockets, two balls between; 300 directions, then 6,000, over the target."""
    rng, met = np.random.default_rng(8), {"any": 0, "full": 0, "barred": 0, "partly": 0, "by cushions": 0}
    while met["any"] < 20:
        cue, red = in_mouths_and_at_rails(rng), in_mouths_and_at_rails(rng)
        if rng.random() < 0.7:
            red[0] = cue[0]  # along the same rail
        across = np.array([cue[1] - red[1], red[0] - cue[0]]) / np.hypot(*(red - cue))
        shares = rng.uniform((0.1, -2.5 * R), (0.9, 2.5 * R), (2, 2))
        places = [cue, red, *(cue + along * (red - cue) + aside * across for along, aside in shares)]
        try:
            TABLE.check(np.array(places[1:])[:, None], R)  # each by itself
        except ValueError:
            continue
        apart = [np.hypot(*(a - b)) for k, a in enumerate(places) for b in places[:k]]
        if min(apart) < 2 * R + 1e-3:
            continue
        positions, on_table = scene(cue=places[0], red=places[1], blue=places[2], pink=places[3])
        d = places[1] - places[0]
        towards, half = np.arctan2(d[1], d[0]), np.arcsin(2 * R / np.hypot(*d))
        any_part, full = paths(positions, on_table, mask_of([1]), noses=TABLE.noses, jaws=TABLE.jaws)
        found = (first_met(positions, on_table, towards + half * np.linspace(-0.999, 0.999, 300)) == 1).any()
        if any_part and not found:  # a narrow opening
            found = (first_met(positions, on_table, towards + half * np.linspace(-1, 1, 6000)) == 1).any()
        assert found == any_part
        # The edge of what decides the centre line is left out: a hair to either side must agree.
        straight = first_met(positions, on_table, towards + np.array([-1e-5, 0.0, 1e-5])) == 1
        if straight.all() or not straight.any():
            assert full == straight[1]
        met["any"] += any_part
        met["full"] += full
        met["barred"] += not any_part
        met["partly"] += any_part and not full
        met["by cushions"] += (any_part, full) != paths(positions, on_table, mask_of([1]))
    assert min(met.values()) >= 1
