"""Does a stroke mean what it says?"""

from math import atan2, cos, pi, sin

import numpy as np
import pytest
from cases import OPEN, Given
from scipy.stats import binomtest

import snooker_env as sn
from snooker_env.advice import CueStroke, stroke_words
from snooker_env.advice.outcomes import expect_points, wilson
from snooker_env.physics.events import EventKind
from snooker_env.tasks import box_actions
from tests.shots import shot


def test_a_stroke_is_its_action_and_a_suggestion_is_a_stroke():
    stroke = CueStroke(speed=3.1, aim=2.5, side=-0.2, top=0.3, elevation=0.2, place=(0.1, -1.2))
    actions = box_actions.Actions("absolute", True, True, ("decision",))
    options = sn.Options(task="frame", aim="absolute", elevation=True, placement=True, says=["decision"])
    at = sn.Positions.of(OPEN)
    (a,) = stroke.strokes().actions(options, at)
    places, on_table, _ = OPEN.arrays()
    speed, side, top, cue, elevation = shot(actions, a, places, on_table, 2)
    v, _ = sn.strike(speed, cue, side, top, 0.0)
    numbers = speed, side, top, elevation, atan2(v[1], v[0])
    assert numbers == pytest.approx((3.1, -0.2, 0.3, 0.2, 2.5), abs=1e-6)
    x, back = a[5], 0.5 * (a[6] + 1.0)
    assert (0.292 * x, -1.0475 - 0.292 * np.sqrt(1 - x * x) * back) == pytest.approx((0.1, -1.2), abs=1e-6)
    assert abs(a[7]) < 1 / 3  # play
    corner = CueStroke(speed=1.0, aim=7.0, place=(0.292, -1.0475)).strokes()
    (a,) = corner.actions(sn.Options(aim="absolute", placement=True), at)
    assert a[3:].tolist() == pytest.approx([(7.0 - 2 * pi) / pi, 1.0, -1.0])
    assert CueStroke(**stroke.to_dict()) == stroke == CueStroke.of(stroke.to_dict())
    assert CueStroke.of(stroke) is stroke
    (one,) = sn.advise(OPEN, n=1, samples=10, visits=0)
    assert CueStroke.of(one) is one
    assert one.stroke == CueStroke.of({"speed": one.speed, "aim": one.aim, "side": one.side, "top": one.top})


def test_spin_in_words():
    say = lambda top, side=0.0, distance=0.3, speed=2.5: stroke_words.spin_words(  # noqa: E731
        CueStroke(speed=speed, aim=0.0, top=top, side=side), distance, sn.Physics()
    )
    tops = {0.4: "top", 0.2: "follow", 0.0: "plain", -0.2: "screw", -0.45: "deep screw"}
    assert {top: say(top) for top in tops} == tops
    assert say(0.0, distance=0.1) == "stun"
    assert say(0.0, distance=2.0) == "plain" and say(-0.2, distance=2.5) == "drag"
    assert say(-0.2, distance=0.6) == "stun"
    assert say(-0.4, 0.3) == "deep screw with right side" and say(0.2, -0.3) == "follow with left side"
    assert say(-0.2, distance=None) == "screw" and say(0.0, distance=None) == "plain"


def test_the_cushion_of_an_escape_is_the_one_that_the_ball_meets():
    rng, seen = np.random.default_rng(1), set()
    for _ in range(40):
        x, y, aim = rng.uniform(-0.7, 0.7), rng.uniform(-1.5, 1.5), rng.uniform(-pi, pi)
        c, s, spin = cos(aim), sin(aim), 4.0 / 0.02625
        shot = sn.simulate([(x, y)], [(4.0 * c, 4.0 * s)], [(-spin * s, spin * c, 0.0)])
        hits = shot.events[shot.events["kind"] == EventKind.CUSHION]
        jaws = shot.events[np.isin(shot.events["kind"], (EventKind.JAW, EventKind.POT))]
        if not len(hits) or (len(jaws) and jaws["time"][0] < hits["time"][0]):
            continue
        (px, py), *_ = shot.at(hits["time"][0])[0]
        side = abs(abs(px) - 0.889) < abs(abs(py) - 1.7845)
        name = ("right" if px > 0 else "left") if side else ("top" if py > 0 else "baulk")
        assert stroke_words.cushion_words(x, y, aim) == f"{name} cushion"
        seen.add(name)
    assert len(seen) == 4


def test_what_a_stroke_does_in_words():
    say = stroke_words.what_words
    assert say("pot", 19, 2, 19) == "blue, right middle" and say("pot", 5, 5, 5) == "red, left middle"
    assert say("pot", 5, 0, 8) == "red by a plant, green pocket"
    assert say("pot", 21, 4, 1) == "black off the red, top left"
    assert say("contact", 3, -1, 3, "full") == "contact with the red, full"
    assert say("in-off", 3, -1, 3) == "in-off from the red"
    assert say("escape", 20, -1, 20, "top cushion") == "escape off the top cushion to the pink"
    assert say("escape", 1, -1, 1) == "escape to the red"
    assert say("foul", -1, -1, -1) == "foul, nothing struck"
    assert say("foul", 16, -1, 16) == "foul, yellow first"
    assert stroke_words.figures_words("pot", 0.874, 23.4) == "pot 87 %, 23 points expected"
    safety = "fair 50 %; no pot intended, its worth as a safety is not judged"
    assert [stroke_words.figures_words(kind, 0.5, 1.04) for kind in ("contact", "escape")] == [safety] * 2
    assert stroke_words.figures_words("foul", 0.03, 0.0) == "fair 3 %"
    assert stroke_words.figures_words("pot", 1.0, 1.04) == "pot 100 %, 1 point expected"
    assert stroke_words.figures_words("pot", 1.0, 0.26).endswith("0.3 points expected")
    assert stroke_words.place_words(0.05, -1.1475) == "from 5 cm right of and 10 cm behind the brown spot"
    assert stroke_words.place_words(0, -1.0475) == "from the brown spot"


def test_intervals_hold_the_truth_as_often_as_they_say():
    for made, tries in ((0, 10), (3, 10), (10, 10), (87, 100), (199, 200)):
        interval = binomtest(made, tries).proportion_ci(0.95, "wilson")
        assert wilson(made, tries) == pytest.approx((interval.low, interval.high), abs=1e-6)
    rng, inside, runs = np.random.default_rng(3), 0, 600
    for _ in range(runs):
        goes_on = rng.random(200) < 0.8
        points, rest = np.where(goes_on, 1.0, 0.0), rng.exponential(10.0, 60)
        mean, (low, high) = expect_points(points, goes_on, rest)
        assert mean == pytest.approx(goes_on.mean() * (1.0 + rest.mean()))
        inside += low <= 0.8 * 11.0 <= high
    assert 0.92 < inside / runs < 0.97


def test_a_hit_of_a_ball_that_nearly_touches_is_called_a_push():
    """Half a millimetre straight ahead; not from 2 mm on, at a fine edge, nor away from it."""
    ahead = sn.Position(cue=(0.0, 0.9), reds=[(0.0, 0.9 + 0.0525 + 0.0005)], black=(0.0, 1.4605), on="red")
    for on in (0.0, 0.6):  # from the middle [rad]
        given = Given(CueStroke(speed=1.5, aim=np.pi / 2 + on))
        (one,) = sn.advise(ahead, agent=given, noise="none", visits=0)
        assert ", at a real table a push stroke, a foul: the red is 0.5 mm away, " in one.words
    say = stroke_words.push_words
    assert say(0.0, 0.0525 + 0.0005, np.pi / 2, 1) == (
        "at a real table a push stroke, a foul: the red is 0.5 mm away"
    )
    for gap, aim in ((0.002, np.pi / 2), (0.0005, -np.pi / 2), (0.0005, np.pi / 2 + 1.2), (1e-6, np.pi / 2)):
        assert say(0.0, 0.0525 + gap, aim, 1) == ""  # one that touches is judged by the referee here, too
