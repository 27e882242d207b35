"""Does the fit of the law of errors find the law that made the figures, and say what they do not decide?"""

import numpy as np
import pytest

from agents.evaluation.law_fit import (
    FITTED,
    LONG_POTS,
    RANGES,
    law_of,
    long_pots,
    profile,
    spread_laws,
    tables_of,
)
from snooker_env.tasks import LEVELS, Noise


def test_laws_fill_their_ranges():
    logs, laws = spread_laws(40, 3)
    for k, (name, (low, high)) in enumerate(RANGES.items()):
        values = np.array([law[name] for law in laws])
        assert np.log(values) == pytest.approx(logs[:, k])
        edges = np.geomspace(low, high, 41)  # one law in each fortieth
        assert (np.histogram(values, edges)[0] == 1).all()


def test_a_law_has_the_direction_that_it_names():
    noise = law_of(core=0.04, growth=2.0, lapse=0.1, lapse_factor=5.0, speed_rel=0.02)
    assert noise.direction_deg() == pytest.approx(0.04)
    assert (noise.growth, noise.lapse, noise.lapse_factor, noise.speed_rel) == (2.0, 0.1, 5.0, 0.02)
    assert noise.offset_mm / noise.aim_deg == pytest.approx(
        LEVELS["professional"].offset_mm / LEVELS["professional"].aim_deg
    )


def test_the_law_that_made_the_figures_is_found_and_what_they_do_not_tell_stays_open():
    """Figures that depend on core, lapses and growth, and not at all on the errors of speed."""
    logs = spread_laws(80, 1)[0]
    truth = {"core": 0.04, "lapse": 0.09, "lapse_factor": 4.5, "speed_rel": 0.015, "growth": 1.1}
    ways = np.random.default_rng(2).normal(size=(len(FITTED) + 1, len(RANGES)))
    ways[:, list(RANGES).index("speed_rel")] = 0.0
    names, middle = (*FITTED, "long"), logs.mean(axis=0)

    def figures_at(points):
        return dict(zip(names, (10.0 + 5.0 * (points - middle) @ ways.T).T, strict=True))

    figures = figures_at(logs)
    said = {name: (float(value), 0.4) for name, value in figures_at(np.log(list(truth.values()))).items()}
    best, least, rows = profile(logs, figures, said, 7)
    assert least < 2.0
    for name, value in truth.items():
        if name == "speed_rel":
            assert max(rows[name][1]) < 1.0 + rows[name][1][0]
        else:
            assert best[name] == pytest.approx(value, rel=0.25)
            nearest = np.abs(np.log(np.array(rows[name][0]) / value)).argmin()
            assert rows[name][1][nearest] < 0.3 * max(rows[name][1])
    assert "core" in tables_of(best, least, rows)[0].text() and LONG_POTS[0] == 57.5


def test_long_pots_fall_with_the_errors():
    made = [
        long_pots(noise, 5)
        for noise in (Noise(aim_deg=1e-4), *(LEVELS[name] for name in ("professional", "club")))
    ]
    assert made[0] == 100.0 and made[0] > made[1] + 30.0 > made[2] + 50.0, made
