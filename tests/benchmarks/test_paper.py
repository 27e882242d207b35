"""Are the data files and the closed forms of ``python -m benchmarks.paper`` right, and does it run?"""

import json

import numpy as np
import pytest

import snooker_env as sn
from benchmarks.paper import __main__ as paper
from benchmarks.paper import other_data as data
from benchmarks.paper import paper_shots as shots
from tests.oracles.paper_tables import PAPER_ROWS
from tests.physics.test_impacts import CUTS, THROW


def test_the_tables_file_holds_what_the_other_tests_hold():
    """Two copies of the paper's numbers, typed apart: they differ where the file keeps the printed slip."""
    rows = shots.tables()
    for q in shots.QUANTITIES:
        assert rows[f"measured_{q}"].tolist() == [getattr(r, f"measured_{q}") for r in PAPER_ROWS]
        different = np.flatnonzero(rows[f"printed_{q}"] != [getattr(r, q) for r in PAPER_ROWS]).tolist()
        assert different == ([3] if q == "v_c" else [])
    assert [rows[k].tolist() for k in ("v0_m_s", "topspin_rad_s", "cut_deg")] == [
        [getattr(r, k) for r in PAPER_ROWS] for k in ("v0", "w_t", "cut")
    ]


def test_only_the_known_slips_of_the_tables_are_marked():
    rows = shots.table_rows(shots.predictions())
    assert [(r["quantity"], r["shot"]) for r in rows if r["slip"]] == [("v_c", 4)]
    assert [(r["quantity"], r["shot"]) for r in rows if r["error_slip"]] == [("angle_c", 3)]


@pytest.mark.parametrize("e", [0.89, 1.0])
@pytest.mark.parametrize("topspin", [0.0, 40.0])
def test_models_without_friction_are_the_package_without_friction(e, topspin):
    v1, w1, v2, w2 = shots.impact(1.2, topspin, 37.0, sn.Physics(e_b=e, mu_bb=0.0))
    v_c, v_o, angle_c, angle_o = shots.make_closed_form(e, 0.0, cloth=True)(1.2, topspin, 37.0)
    for v, w, speed, angle in ((v1, w1, v_c, angle_c), (v2, w2, v_o, angle_o)):
        x, y = shots.rolling(v, w)
        assert np.hypot(x, y) == pytest.approx(speed, rel=1e-12)
        assert abs(np.degrees(np.arctan2(y, x))) == pytest.approx(angle, rel=1e-12)


@pytest.mark.parametrize("cut", [5.0, 50.0])
def test_planar_friction_is_the_package_for_a_stun_shot(cut):
    """Slip that ends (5 deg) and slip that lasts (50 deg); with no roll the planar model is exact."""
    planar = shots.make_closed_form(shots.E_B, shots.MU_BB, cloth=True)
    assert planar(1.2, 0.0, cut) == pytest.approx(
        shots.make_solved_model("reference")(1.2, 0.0, cut), rel=1e-9
    )


def test_throw_of_tp_a14():
    for name, rows in data.a14().items():
        kind, v0 = data.A14_SHOTS[name]
        assert rows["cut"] == list(CUTS)
        assert rows["printed"] == list(THROW[kind, v0])
        assert rows["closed form"] == pytest.approx(rows["printed"], abs=0.0051)
        assert rows["fast"] == pytest.approx(rows["closed form"], abs=1e-10)
        if kind == "stun":
            assert rows["reference"] == pytest.approx(rows["closed form, mu follows"], abs=1e-8)


def test_simulate_follows_the_papers_parabola():
    found = shots.curved_path(0.2)
    assert found["gap"] < 1e-12
    assert found["leaves_deg"] - found["rolls_deg"] > 1


def test_the_command_runs(tmp_path, capsys):
    paper.main(["--no-pictures", "--json", str(tmp_path / "figures.json")])
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert len(figures["tables"]) == 20
    assert len(figures["spins"]) == len(shots.TOPS) * len(shots.SIDES)
    assert "euler:10000 gives 19 of the 20 printed predictions" in capsys.readouterr().out
