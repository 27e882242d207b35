"""Does the coach find the errors of players whose errors are known, and what costs them most?"""

import json
from dataclasses import replace
from functools import partial
from math import atan2

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice import (
    CueStroke,
    Recorded,
    coach,
    read_strokes,
)
from snooker_env.advice import errors as estimating
from snooker_env.advice.__main__ import main
from snooker_env.advice.coach import count_costs, value_strokes
from snooker_env.advice.errors import Estimate
from snooker_env.advice.practice import practice_of
from snooker_env.advice.recorded import agree_options, strokes_of
from snooker_env.planning import Planner, pots
from snooker_env.tasks import LEVELS, Noise
from tests.refusals import refuse_each, refused

AT = sn.Position(cue=(0.1, 0.2), reds=[(-0.3, 1.0)], black=(0.0, 1.4605), on="red")
ALONE = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
CUE, MEANT = {"speed": 2.0, "aim": 0.8}, CueStroke(speed=2.0, aim=0.8)
WHERE = {"cue": "free", "physics": "paper", "table": "match"}
TOLD = [word for name, value in WHERE.items() for word in (f"--{name}", value)]
coached = partial(coach, options=WHERE)


def write_strokes(path, strokes):
    kept = {"format": "snooker-strokes", "version": 1, "strokes": [one.to_dict() for one in strokes]}
    path.write_text(json.dumps(kept))


def errors_of(strokes):
    return coached(strokes).errors


def pot_of(position):
    """Ball, pocket and stroke of the widest pot."""
    direct = pots(position)
    ball, pocket = int(direct.ball[0, 0]), int(direct.pocket[0, 0])
    target = sn.geometry.POCKET_AIMS[pocket, :2]
    aim = float(Planner({}).pot_aim(position, [0], [ball], [target], 2.0)[0])
    return ball, pocket, CueStroke(speed=2.0, aim=aim)


def on_disc(tips):
    """Tips (n, 2) where a cue without a miscue meets the ball, as the simulator has them."""
    return tips / np.maximum(1.0, np.hypot(*tips.T) / sn.Physics().max_offset)[:, None]


def played_by(noise, n, seed):
    """n strokes at the pot of ``ALONE``: strokes played with errors, and whether the ball went in."""
    ball, pocket, meant = pot_of(ALONE)
    its, more = LEVELS[noise], np.sqrt(5.0)
    z = its.draw_errors(np.random.default_rng(seed), n)
    strokes = np.repeat(meant.numbers()[None], n, 0)
    stops = Planner({"noise": noise}).play_strokes(ALONE, np.zeros(n, int), strokes, errors=z)
    made = (stops.potted[:, ball] == pocket) & (stops.penalty == 0)
    tips = on_disc(its.offset_mm * 1e-3 / sn.Physics().R * more * z[:, 1:3])
    cues = [
        {
            "speed": max(0.0, 2.0 * (1.0 + its.speed_rel * a)),
            "side": side,
            "top": top,
            "aim": meant.aim + np.radians(its.aim_deg) * more * d,
        }
        for (a, _, _, d), (side, top) in zip(z[:, :4].tolist(), tips.tolist(), strict=True)
    ]
    return ball, pocket, meant, cues, made


@pytest.mark.parametrize("noise", [pytest.param("club", marks=pytest.mark.slow), "professional"])
def test_errors_of_strokes_meant_and_played(noise):
    _, _, meant, cues, _ = played_by(noise, 3000, 1)
    found = errors_of([Recorded(position=ALONE, intended=meant, played=cue) for cue in cues])
    assert (found.at, found.growth) == (2.0, None)  # all strokes are of one speed
    assert found.direction.value == pytest.approx(LEVELS[noise].direction_deg(speed=2.0), rel=0.04)
    assert found.speed.value == pytest.approx(LEVELS[noise].speed_rel, rel=0.04)


def test_without_lapses_the_interval_is_that_of_chi_square(monkeypatch):
    """20 errors whose squares sum to 20: quantiles 0.025, 0.5, 0.975 of chi^2 with 20 degrees, from tables."""
    monkeypatch.setitem(LEVELS, estimating.BASE, replace(LEVELS[estimating.BASE], lapse=0.0))
    weights = estimating.normalise(estimating.weigh_errors(np.ones(20), np.ones((1, 20)))[0])
    one = estimating.estimate(weights, 1.0, 20)
    expected = [np.sqrt(20 / q) for q in (19.337, 34.170, 9.591)]
    assert [one.value, one.low, one.high] == pytest.approx(expected, rel=2e-3)


def test_one_error_tells_as_much_as_the_law_says():
    """The posterior of the scale s after one error e is the law of e / |z|, for the prior is flat in log s."""
    e, scales = 0.1, np.array([0.03, 0.05, 0.1, 0.3, 1.0, 3.0])
    weights = estimating.normalise(estimating.weigh_errors(np.array([e]), np.ones((1, 1)))[0])
    z = np.abs(LEVELS["professional"].draw_errors(np.random.default_rng(0), 400_000)[:, 3])
    z = z[(e / estimating.MOST < z) & (z < e / estimating.LEAST)]
    for s in scales.tolist():
        assert weights[s > estimating.SCALES].sum() == pytest.approx((e / z < s).mean(), abs=0.012), s


def test_what_no_lapse_explains_tells_no_size():
    """A line solved for a wrong tip, or a stroke recorded wrongly: one in 100 is no reason to call all the others worse."""
    e = LEVELS["professional"].draw_errors(np.random.default_rng(3), 100)[:, 3]
    usual, astray = (
        estimating.estimate(
            estimating.normalise(estimating.weigh_errors(e, np.ones((1, len(e))))[0]), 1.0, len(e)
        )
        for e in (e, np.append(e, 200.0))
    )
    assert astray.value == pytest.approx(usual.value, rel=0.02)


@pytest.mark.parametrize("noise", ["club", pytest.param("amateur", marks=pytest.mark.slow)])
def test_pots_and_misses_alone_tell_the_direction(noise):
    ball, pocket, meant, cues, made = played_by(noise, 1500, 2)
    known = [
        Recorded(position=ALONE, intended=meant, ball=ball, pocket=pocket, potted=bool(one)) for one in made
    ]
    found = errors_of(known[:200])
    truth = LEVELS[noise].direction_deg(speed=2.0)
    assert found.direction.low < truth < found.direction.high and found.speed is None
    assert 0.15 < found.direction.high / found.direction.low - 1.0 < 1.0
    practice = practice_of("professional")
    p = estimating.simulate_pots(known[:40], practice, 0).chances.mean(axis=0)
    here = np.abs(estimating.SCALES * LEVELS["professional"].direction_deg(speed=2.0) - truth).argmin()
    assert p[here] == pytest.approx(made.mean(), abs=0.04)
    line = errors_of([Recorded(position=ALONE, ball=ball, pocket=pocket, played=cue) for cue in cues[:400]])
    assert line.direction.value == pytest.approx(truth, rel=0.1)


def test_a_replay_and_a_file_give_the_same_strokes(tmp_path):
    env = sn.SnookerEnv(task="frame", opponent="ghost_ball", noise="club", action="discrete")
    env.keep_history = True
    env.reset(seed=3)
    for _ in range(6):
        choices = np.flatnonzero(env.action_masks())
        env.step(int(choices[len(choices) // 3]))
    mine = strokes_of(sn.replay(env).to_dict(), 0)
    assert len(mine) == sum(one.player == 0 for one in env.history) > 3
    first = next(one for one in env.history if one.player == 0)
    assert mine[0].played == pytest.approx(first.cue) and mine[0].points == first.points
    assert np.allclose(mine[0].after.cue, first.positions[0])
    for suffix in (".json", ".html"):
        sn.replay(env, tmp_path / f"replay{suffix}")
        assert read_strokes(tmp_path / f"replay{suffix}", player=0) == mine
    refused(
        lambda: strokes_of(sn.replay(env).to_dict(), None),
        "player",
        "None",
        "must be 0 or 1: the replay is of two players",
    )


def test_a_replay_says_where_it_was_played(tmp_path):
    """A coach that assumed another cue than the replay's would err by a third."""
    real = {"noise": "club", "cue": "real", "physics": {"mu_r": 0.012}}
    env = sn.SnookerEnv(task="frame", opponent="ghost_ball", **real)
    env.keep_history = True
    env.reset(seed=3)
    for _ in range(3):
        env.step([-0.2, 0.0, 0.0, 0.51])
    kept = sn.replay(env, tmp_path / "new.json").to_dict()
    assert (kept["physics"], kept["table"]) == ({"preset": "paper", "mu_r": 0.012}, "match")
    assert {(one["cue_kind"], one["noise"]) for one in kept["strokes"]} == {("real", "club")}
    mine = read_strokes(tmp_path / "new.json", player=0)
    where = {"cue": "real", "physics": sn.Physics(mu_r=0.012), "table": sn.Table.preset("match")}
    assert all({name: getattr(one, name) for name in where} == where for one in mine)
    write_strokes(tmp_path / "mine.json", mine)
    assert read_strokes(tmp_path / "mine.json") == mine
    bench = agree_options(mine, None)
    assert practice_of("none", bench).options.cue == "real" and bench["physics"].mu_r == 0.012
    assert agree_options(mine, {"fidelity": "fast"}) == bench | {"fidelity": "fast"}
    for name, value, shown in (
        ("cue", "free", "'real'"),
        ("physics", "paper", "0.012"),
        ("table", "tight", "match"),
    ):
        says = f"must be {value!r}, as options say"
        refused(partial(agree_options, mine, {name: value}), f"strokes[0].{name}", shown, says)
    mixed = [mine[0], replace(mine[1], cue="free")]
    refused(partial(agree_options, mixed, None), "strokes[1].cue", "free", "first stroke")
    ours = [replace(one, **dict.fromkeys(WHERE)) for one in mine]
    for name in WHERE:
        told = {key: value for key, value in WHERE.items() if key != name}
        refused(partial(coach, ours, options=told), name, "None", f"must be given (options={{{name!r}: ...}}")


def strokes_that_grow(g, n, rng, whole=0.1):
    """Strokes meant with side, and played with errors of direction of 0.1 degrees at 1.5 m/s that grow with the speed."""
    base, R = LEVELS["professional"], sn.Physics().R
    times = whole / (base.direction_deg(speed=0.0) * np.hypot(1.0, 1.5 * g))
    speeds, sides = np.exp(rng.uniform(np.log(0.9), np.log(6.0), n)), rng.uniform(-0.2, 0.2, n)
    errors = base.draw_errors(rng, n) * times * np.hypot(1.0, g * speeds)[:, None]
    tips = on_disc(np.column_stack([sides, np.zeros(n)]) + base.offset_mm * 1e-3 / R * errors[:, 1:3])
    made = []
    for speed, side, tip, e in zip(
        speeds.tolist(), sides.tolist(), tips.tolist(), errors[:, 3].tolist(), strict=True
    ):
        cue = 1.0 - np.arctan2(*sn.strike(1.0, 0.0, side)[0][1::-1]) + np.radians(base.aim_deg) * e
        meant = CueStroke(speed=speed, aim=1.0, side=side)
        struck = {"speed": speed, "aim": float(cue), "side": tip[0], "top": tip[1]}
        made.append(Recorded(position=ALONE, intended=meant, played=struck))
    return made


@pytest.mark.parametrize("g", [0.0, 0.5, 1.0, 2.0])
def test_growth_with_the_speed_is_estimated(g):
    """Of 20 players 18 intervals hold the error of direction, and 18 its growth."""
    rng = np.random.default_rng(54 + int(2 * g))
    found = [errors_of(strokes_that_grow(g, 100, rng)) for _ in range(20)]
    assert all(1.5 <= one.at < 1.8 for one in found)
    truth = [0.1 * np.hypot(1.0, g * one.at) / np.hypot(1.0, g * 1.5) for one in found]
    held = [one.direction.low < true < one.direction.high for one, true in zip(found, truth, strict=True)]
    assert sum(held) >= 18 and sum(one.growth.low <= g <= one.growth.high for one in found) >= 18
    assert (
        all(one.growth.high < 1.0 for one in found)
        if g == 0.0
        else all(one.growth.high > g / 2 for one in found)
    )
    ratio = np.array([one.direction.value / true for one, true in zip(found, truth, strict=True)])
    assert abs(ratio.mean() - 1.0) < 0.07


def test_an_error_grows_as_strokes_under_that_noise_do():
    """By the law of ``Noise`` itself, which is stated as a professional's at the speed that the error is of."""
    speeds = np.array([0.5, 2.0, 6.0])
    for g, each in zip(estimating.GROWTHS, estimating.grow_with_speed(speeds, 2.0), strict=True):
        noise = Noise(aim_deg=1.0, growth=float(g))
        law = np.array([noise.direction_deg(speed=v) for v in speeds.tolist()])
        assert each / each[1] == pytest.approx(law / law[1], rel=1e-9)
        assert each[1] == pytest.approx(np.hypot(1.0, LEVELS["professional"].growth * 2.0), rel=1e-12)


def test_strokes_as_fast_as_a_lapse_makes_them_are_read():
    env = sn.SnookerEnv(noise={"speed_rel": 2.0}, aim="absolute")
    env.keep_history, fastest = True, 0.0
    for seed in range(20):
        env.reset(seed=seed)
        env.step([1.0, 0.0, 0.0, 0.5])
        fastest = max(fastest, strokes_of(sn.replay(env).to_dict(), None)[0].played["speed"])
    assert fastest > 20.0  # it was refused


def test_the_speed_of_the_softest_and_hardest_pots_may_be_a_lapse():
    ball, pocket, meant = pot_of(ALONE)
    speeds = [0.1, *np.linspace(1.0, 3.0, 38).tolist(), 15.0]
    strokes = [
        Recorded(position=ALONE, ball=ball, pocket=pocket, played={"speed": v, "aim": meant.aim})
        for v in speeds
    ]
    *_, paces = estimating.measure_errors(strokes, practice_of("professional", WHERE))
    assert paces.min() >= 1.0 and paces.max() <= 3.0
    assert paces[5:-5].tolist() == speeds[5:-5]
    *_, paces = estimating.measure_errors(strokes[:3], practice_of("professional", WHERE))
    assert paces.tolist() == speeds[:3]


def test_a_cue_that_errors_raised_once_more_was_meant_lower():
    """Errors of a real cue grow with the elevation that was meant, not with the one at which they left room."""
    at = sn.Position(cue=(0.0, -1.70), black=(0.0, 1.0))
    real = practice_of("professional", WHERE | {"cue": "real"})
    meant = CueStroke(speed=2.0, aim=np.pi / 2)
    needed, _ = estimating.fit_to_room(Recorded(position=at), meant.numbers(), real)
    assert np.radians(2.0) < needed < np.radians(15.0)
    cue = {"speed": 2.0, "aim": np.pi / 2 + 0.003, "elevation": needed + np.radians(0.8)}
    unit = np.radians(LEVELS["professional"].direction_deg(speed=0.0)) * (1.0 + needed / np.radians(15.0))
    played = Recorded(position=at, intended=meant, played=cue)
    assert estimating.measure_errors([played], real)[0][0] == pytest.approx(0.003 / unit)


def missed_and_made():
    """A pot missed so that the black hangs over the pocket, and the same pot made: both ends of a frame's black."""
    ball, pocket, _ = pot_of(ALONE)
    left = sn.Position(cue=(0.0, 1.0), black=(-0.80, 1.65))
    same = {"position": ALONE, "ball": ball, "pocket": pocket}
    return Recorded(**same, potted=False, after=left), Recorded(
        **same, potted=True, points=7, after=sn.Position(over=True)
    )


def test_costs_have_the_signs_of_what_happened():
    bench = practice_of("professional", of_frames=True)
    missed, made = missed_and_made()
    parts = count_costs([missed, made], bench, 0)[0]
    assert (
        parts[0, 0] > 1.0 > 0.0 >= parts[1, 0]
    )  # a pot missed costs, one that the target makes too gains nothing
    # both of a stroke sum to what it was worth to the target, less what it brought
    assert parts[0].sum() - parts[1].sum() == pytest.approx(7.0 - values_of(bench, missed), abs=1e-9)
    assert parts[1, 2] == parts[0, 1] == 0.0
    assert values_of(bench, missed) < -5.0  # the other is left a black that hangs over a pocket
    hanging = Recorded(position=AT, after=sn.Position(cue=(-0.5, 1.3), reds=[(-0.80, 1.66)]))
    hidden = Recorded(
        position=AT,
        after=sn.Position(cue=(0.0, -1.6), reds=[(0.0, 1.74)], brown=(0.0, -1.5), yellow=(0.7, -1.7)),
    )
    easy, safe = count_costs([hanging, hidden], bench, 0)[0][:, 2]
    assert easy > safe


def values_of(bench, one):
    return float(value_strokes(bench, [one])[0])


def test_the_drill_is_that_of_the_largest_cost():
    missed, made = missed_and_made()
    found = coached([missed] * 9 + [made])
    assert found.visits == 10 and (found.called, found.made) == (10, 1)
    assert found.expected.low <= found.made <= found.expected.high
    assert found.most == "potting" and found.drills[0].layout.startswith("pots:")
    assert found.costs["potting"].low > 0.0 and found.sure > 0.5
    assert found.drills[0].layout in {"pots:easy", "pots:medium", "pots:hard"}
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["most"] == "potting"
    better = {"potting": Estimate(value=-2.0, low=-3.0, high=1.0, strokes=5)}
    said = str(replace(found, costs=better, most=None, drills=())).splitlines()
    assert said[-2:] == [
        "potting gains 2.00 [-1.00, 3.00] points a visit, from 5 strokes",
        "nothing to practise: no part costs more than at the target level",
    ]
    same = coached([missed] * 9 + [made])
    assert same == found


def test_the_command(tmp_path, capsys):
    missed, made = missed_and_made()
    write_strokes(tmp_path / "mine.json", [missed, made])
    assert main(["coach", str(tmp_path / "mine.json"), *TOLD]) == 0
    assert "pots: 1 of 2 made" in capsys.readouterr().out
    assert main(["coach", str(tmp_path / "mine.json"), *TOLD, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["called"] == 2
    for text, words in (
        ("{", "or 'snooker-replay' (Expecting"),
        ('{"format": "other"}', "must have the format 'snooker-strokes' or 'snooker-replay'"),
        ('{"format": "snooker-strokes", "version": 2, "strokes": []}', "must be 1"),
        ('{"format": "snooker-strokes", "version": 1, "strokes": []}', "must hold at least one stroke"),
        ('{"format": "snooker-strokes", "version": 1, "strokes": [{"colour": 1}]}', "strokes[0]"),
        ('{"format": "snooker-replay", "version": 2, "strokes": [{}]}', "a damaged file"),
    ):
        (tmp_path / "bad.json").write_text(text)
        assert main(["coach", str(tmp_path / "bad.json")]) == 2
        said = capsys.readouterr()
        assert said.out == "" and words in said.err and said.err.count("\n") == 1, text
    assert main(["coach", str(tmp_path / "none.json")]) == 2
    assert main(["coach", str(tmp_path / "mine.json"), *TOLD[2:]]) == 2
    assert "cue = None: must be given (options={'cue': ...}, --cue)" in capsys.readouterr().err


WRONG = """
ball=21 | pocket | None | must
ball=3, pocket=0 | ball | 3 | must
potted=True | potted | True | must
points=17 | points | 17 | must
played={"speed": 1.0} | played | without speed and aim | must
scores=(1,) | scores | (1,) | must
guessed=True | guessed | True | must
guessed=True, ball=21, pocket=4, played=CUE, intended=MEANT | guessed | True | must
speed=9.0 | speed | 9.0 | must
"""


def test_bad_records_are_refused():
    calls = "\n".join(
        "Recorded(position=ALONE, " + line.replace(" | ", ") | ", 1) for line in WRONG.split("\n") if line
    )
    refuse_each(calls, globals())


def test_called_is_the_nearest_line():
    from snooker_env.advice.recorded import call_pot

    ball, pocket, meant = pot_of(ALONE)
    assert call_pot(ALONE, meant.aim + 0.005) == (ball, pocket)
    x, y = ALONE.cue
    assert call_pot(ALONE, atan2(-1.0 - y, -x)) is None


def test_an_unknown_target_is_named():
    with pytest.raises(ValueError, match=r"^target = 'wizard'"):
        coached([Recorded(position=ALONE, ball=21, pocket=4, potted=True)], target="wizard")
