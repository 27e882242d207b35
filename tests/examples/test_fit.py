"""Does the fit of one's own data find the constants, and refuse bad files in one line?"""

import importlib.util
import re

import numpy as np
import pytest

import snooker_env as sn
from tests.processes import ROOT

SPEC = importlib.util.spec_from_file_location("fit_your_data", ROOT / "examples" / "fit_your_data.py")
fitting = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(fitting)
DATA = ROOT / "benchmarks" / "data"
DOMENECH = {"R": 0.0305, "e_b": 0.968}
ROWS = 60


def inputs(kind):
    """What is set in made-up measurements: the speed first, then others within their ranges."""
    rng = np.random.default_rng(5)
    others = {
        "throw": {"cut_deg": (5, 75), "topspin_rad_s": (-30, 60)},
        "cushion": {"incident_deg": (-60, 60), "side_rad_s": (-40, 40)},
        "cloth": {"topspin_rad_s": (-50, 80)},
    }
    ranges = {"incident_m_s" if kind == "cushion" else "speed_m_s": (0.4, 3.5)} | others[kind]
    return {name: rng.uniform(*limits, ROWS) for name, limits in ranges.items()}


TRUE = {
    "throw": {"mu_bb": 0.07, "e_b": 0.93},
    "cushion": {"e_c": 0.93, "e_c_knee": 1.8, "e_c_power": 0.25, "mu_c": 0.2},
    "cloth": {"mu_r": 0.011, "mu_s": 0.19},
}


def measured(kind, constants, noise=0.5, seed=1):
    """What would be measured of such shots, with half of the errors that the fit supposes."""
    columns, what = inputs(kind), fitting.KINDS[kind]
    model = what.predict(columns, sn.Physics.preset("match", **constants))
    rng = np.random.default_rng(seed)
    errors = {name: noise * column.error * rng.normal(size=ROWS) for name, column in what.measured.items()}
    return columns | {name: model[name] + error for name, error in errors.items()}


@pytest.mark.parametrize("kind", TRUE)
def test_made_up_data_come_back(kind):
    fitted = fitting.fit(kind, measured(kind, TRUE[kind]))
    assert list(fitted.values) == list(TRUE[kind])
    for name, true in TRUE[kind].items():
        low, high = fitted.intervals[name]
        assert low < true < high and high - low < 0.5 * true, (name, fitted.values[name], low, high)
    exact = fitting.fit(kind, measured(kind, TRUE[kind], noise=0.0))
    found = {name: getattr(exact.physics, name) for name in TRUE[kind]}
    assert found == exact.values == pytest.approx(TRUE[kind], rel=1e-3)


def test_domenech_s_throw_gives_a_tenth():
    """A constant friction of 0.10 agrees with these 52 shots, 0.05 does not, as in ``benchmarks.paper``."""
    columns = fitting.read(DATA / "throw_domenech2023.csv", "throw", {"speed_m_s": 0.8})
    fitted = fitting.fit("throw", columns, fixed=DOMENECH)
    low, high = fitted.intervals["mu_bb"]
    assert low < 0.10 < high and low > 0.09 and high < 0.11
    assert np.sqrt(np.mean(fitted.residuals["throw_deg"] ** 2)) < 0.75


def test_the_cushion_of_match_is_within_what_the_rebounds_give():
    """Alone they give a steeper fall than with how far hard throws run, to which "match" was fitted too. Free, e_c is at the
    end of its range, and has no interval."""
    columns = fitting.read(DATA / "cushion_rebound.csv", "cushion")
    fitted, match = fitting.fit("cushion", columns, fixed={"e_c": 0.98}), sn.Physics.preset("match")
    assert fitted.values == pytest.approx({"e_c_knee": 2.174, "e_c_power": 0.3084}, rel=0.002)
    for name, (low, high) in fitted.intervals.items():
        assert low < getattr(match, name) < high
    fitted = fitting.fit("cushion", columns)
    assert fitted.values["e_c"] == pytest.approx(1.0, abs=1e-4) and fitted.intervals["e_c"] is None
    assert fitted.intervals["e_c_power"] is not None


def test_the_command_prints_a_line_that_runs(capsys):
    options = ["--column", "speed_m_s=0.8", "--fix", "R=0.0305", "e_b=0.968"]
    fitting.main(["throw", str(DATA / "throw_domenech2023.csv"), *options])
    line = re.search(r"^physics = .*$", capsys.readouterr().out, re.M)[0]
    scope = {"sn": sn}
    exec(line, scope)
    assert scope["physics"] == sn.Physics.preset("match", R=0.0305, e_b=0.968, mu_bb=scope["physics"].mu_bb)
    assert scope["physics"].mu_bb == pytest.approx(0.102, abs=0.002)


GOOD = "cut_deg,speed_m_s,throw_deg\n"
BAD = {
    "no line": ("", r"= no line: must have a line of names"),
    "an unknown column": ("cut,throw_deg\n10,1\n", r"line 1, column = 'cut': must be one of 'cut_deg', 'sp"),
    "a column twice": ("cut_deg,cut_deg\n", r"columns = \['cut_deg', 'cut_deg'\]: must be different"),
    "a word": (GOOD + "10,1,fast\n", r"line 2, throw_deg = 'fast': must be a number"),
    "not finite": (GOOD + "10,1,nan\n", r"line 2, throw_deg = nan: must be a finite number in \[-45, 45\]"),
    "out of range": (GOOD + "# mine\n\n95,1,1\n", r"line 4, cut_deg = 95\.0: must be .* in \[0, 89\.9\]"),
    "too few values": (GOOD + "10,1\n", r"line 2 = 2 values: must be 3: cut_deg, speed_m_s, throw_deg"),
    "no speed": ("cut_deg,throw_deg\n10,1\n", r"must hold speed_m_s, or --column speed_m_s=VALUE"),
    "nothing measured": ("cut_deg,speed_m_s\n10,1\n", r"must hold one of throw_deg, object_speed_m_s"),
    "the other sign": (GOOD + "10,1,-1\n20,1,-2\n", r"median of throw_deg = -1\.5: must be positive"),
    "too few rows": (GOOD + "10,1,1\n", r"rows = 1: must be more than the 1 constants to fit: mu_bb"),
}


def refused_in_one_line(arguments, says):
    with pytest.raises(SystemExit) as refused:
        fitting.main(["throw", *arguments])
    assert re.search(says, str(refused.value)) and "\n" not in str(refused.value)


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_refused_in_one_line(name, tmp_path):
    text, says = BAD[name]
    file = tmp_path / "mine.csv"
    file.write_text(text)
    refused_in_one_line([str(file)], says)


WRONG = """
no_such.csv | file = 'no_such.csv': must be a CSV file in UTF-8
{data} --fix mu=1 | --fix = 'mu': must be one of
{data} --fix R | --fix = 'R': must be NAME=VALUE
{data} --fix mu_bb=0.1 --column speed_m_s=1 | constants = all fixed: must leave something
{data} --column cut=1 | --column = 'cut': must be one of
{data} --column cut_deg=1 | --column = 'cut_deg': must not be a column of the file
{data} --bootstrap -1 | --bootstrap = -1: must be an integer in [0, 100000]
"""


def test_a_bad_option_is_refused_in_one_line():
    for line in WRONG.strip().splitlines():
        words, _, says = line.partition(" | ")
        refused_in_one_line(words.format(data=DATA / "throw_domenech2023.csv").split(), re.escape(says))
