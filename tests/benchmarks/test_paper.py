"""Are the data files and the closed forms of ``python -m benchmarks.paper`` right, and does it run?"""

import json

import pytest

from benchmarks.paper import __main__ as paper
from benchmarks.paper import other_data as data
from benchmarks.paper import paper_shots as shots
from tests.physics.test_impacts import CUTS, THROW

PRINTED = {
    "v0_m_s": [1.539, 1.032, 1.364, 1.731, 0.942],
    "topspin_rad_s": [58.63, 39.31, 51.96, 65.94, 35.89],
    "cut_deg": [33.83, 26.36, 40.52, 46.50, 18.05],
    "measured_v_c": [0.816, 0.520, 0.925, 1.275, 0.365],
    "measured_v_o": [0.836, 0.629, 0.700, 0.787, 0.581],
    "measured_angle_c": [35.96, 33.20, 30.50, 27.97, 29.86],
    "measured_angle_o": [33.83, 26.36, 40.51, 46.50, 18.05],
}
"""Tables 1 and 2 of the paper, typed apart from the file; what they predict is held to ``euler:10000``."""


def test_the_tables_file_holds_what_is_printed():
    rows = shots.tables()
    assert {name: rows[name].tolist() for name in PRINTED} == PRINTED


def test_only_the_known_slips_of_the_tables_are_marked():
    rows = shots.table_rows(shots.predictions())
    assert [(r["quantity"], r["shot"]) for r in rows if r["slip"]] == [("v_c", 4)]
    assert [(r["quantity"], r["shot"]) for r in rows if r["error_slip"]] == [("angle_c", 3)]


def test_throw_of_tp_a14():
    for name, rows in data.a14().items():
        kind, v0 = data.A14_SHOTS[name]
        assert rows["cut"] == list(CUTS)
        assert rows["printed"] == list(THROW[kind, v0])
        assert rows["closed form"] == pytest.approx(rows["printed"], abs=0.0051)
        assert rows["fast"] == pytest.approx(rows["closed form"], abs=1e-10)
        if kind == "stun":
            assert rows["reference"] == pytest.approx(rows["closed form, mu follows"], abs=1e-8)


def test_the_command_runs(tmp_path, capsys):
    paper.main(["--no-pictures", "--json", str(tmp_path / "figures.json")])
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert len(figures["tables"]) == 20
    assert len(figures["spins"]) == len(shots.TOPS) * len(shots.SIDES)
    assert "euler:10000 gives 19 of the 20 printed predictions" in capsys.readouterr().out
