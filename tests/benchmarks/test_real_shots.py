"""Does ``python -m benchmarks.real_shots`` find the strikes of shots that the engine itself made, and refuse bad files?"""

import json

import numpy as np
import pytest

import snooker_env as sn
from benchmarks.real_shots import __main__ as command
from benchmarks.real_shots import verdict
from tests.pictures import saved_figures, unreadable

PHYSICS = sn.Physics.preset("carom", tables=False)
STRIKES = ((2.2, 0.9, 0.25, 0.2, 0.03), (1.6, 2.4, -0.2, 0.1, 0.05))
PLACES = (((-0.4, -1.0), (0.1, -0.3), (0.3, 1.1)), ((0.45, 0.3), (-0.1, 0.85), (-0.5, -1.2)))
LATE = 0.013
"""The moment of the strike on the tracks' clock [s]."""


def made(number, wild):
    """One shot of the file, as a camera would see it at 50 Hz with a noise of 1 mm; ``wild``: a sample of ball 1."""
    speed, aim, side, top, elevation = STRIKES[number]
    v, w = sn.strike(speed, aim, side, top, elevation, physics=PHYSICS)
    z = (0.0, 0.0, 0.0)
    shot = sn.simulate(PLACES[number], [v[:2], z[:2], z[:2]], [w, z, z], "carom", PHYSICS)
    rng = np.random.default_rng(number)
    times = np.arange(0.0, shot.duration, 0.02)
    xy = shot.at(np.maximum(times - LATE, 0.0))[0]
    balls = {}
    for k in range(3):
        moved = np.abs(np.diff(xy[:, k], axis=0)).max(1) > 1e-3
        seen = np.flatnonzero(np.concatenate([[True], moved[:-1], [True]]))
        at = xy[seen, k] + rng.normal(0, 7e-4, (len(seen), 2)) * (seen > 0)[:, None]
        if k == 0 and wild:
            at[wild] += (0.0, 0.3)
        balls[str(k + 1)] = {"t": times[seen].tolist(), "x": at[:, 0].tolist(), "y": at[:, 1].tolist()}
    return {"id": 2 * number + 1, "balls": balls}, shot


@pytest.fixture(scope="module")
def data():
    return {"shots": [made(0, wild=40)[0], made(1, wild=0)[0]]}


@pytest.fixture
def file(tmp_path, data):
    path = tmp_path / "shots.json"
    path.write_text(json.dumps(data))
    return path


@pytest.mark.slow
def test_the_command_finds_the_strikes(file, tmp_path, capsys):
    with saved_figures() as drawn:
        command.main([str(file), "--json", str(tmp_path / "figures.json"), "--out", str(tmp_path)])
    assert [unreadable(figure) for figure in drawn] == [[]]
    figures = json.loads((tmp_path / "figures.json").read_text())
    for shot, (speed, aim, side, top, _) in zip(figures["shots"], STRIKES, strict=True):
        assert shot["cue_rms"] < 0.004
        assert shot["order"]
        found = shot["strike"]
        # a ball that soon rolls tells less of each than of the speed at which it rolls, 5/7 of this
        assert found["speed"] * (1 + found["top"]) == pytest.approx(speed * (1 + top), rel=0.02)
        assert found["speed"] == pytest.approx(speed, rel=0.1)
        assert found["aim"] == pytest.approx(aim, abs=0.02)
        assert found["side"] == pytest.approx(side, abs=0.08)
        assert found["start"] == pytest.approx(LATE, abs=0.012)
    assert [sum(shot["wild"]) for shot in figures["shots"]] == [1, 0]
    assert figures["medians"]["held out"]["order"] == 1.0
    said = capsys.readouterr().out
    assert "held out" in said
    assert "wild samples left out: 1" in said


def test_order_of_contacts():
    measured = [(0.1, "ball 1"), (0.5, "left"), (0.51, "near"), (1.0, "right"), (2.0, "ball 2")]
    swapped = [measured[k] for k in (0, 2, 1, 3, 4)]
    assert verdict.same_order(measured, measured)
    assert verdict.same_order(measured, swapped)  # 0.01 s apart: not known
    assert not verdict.same_order(measured, [measured[k] for k in (1, 0, 2, 3)])
    assert not verdict.same_order(measured, measured[:3])
    assert verdict.same_order(measured, measured[:4])


def spoiled(data, change):
    copy = json.loads(json.dumps(data))
    change(copy["shots"][1])
    return copy


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda s: s.pop("balls"), "shots[1].balls is missing"),
        (lambda s: s["balls"].pop("3"), "shots[1].balls has 2 balls, must have 3"),
        (lambda s: s.pop("id"), "shots[1].id is missing"),
        (lambda s: s["balls"]["2"].pop("x"), "shots[1].balls.2.x is missing"),
        (lambda s: s["balls"]["1"]["y"].append(0.0), "shots[1].balls.1: t, x and y have"),
        (
            lambda s: s["balls"]["1"]["x"].__setitem__(0, None),
            "shots[1].balls.1.x must be a list of finite numbers",
        ),
        (lambda s: s["balls"]["1"]["x"].__setitem__(3, 71.0), "shots[1].balls.1.x reaches 71 m"),
        (lambda s: s["balls"]["1"]["t"].reverse(), "shots[1].balls.1.t must rise"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, data, capsys, change, says):
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(spoiled(data, change)))
    with pytest.raises(SystemExit) as stopped:
        command.main([str(path)])
    assert stopped.value.code == 2
    assert says in capsys.readouterr().err
