"""Does a replay hold what was played? Its data decoded here by the format's own words."""

import base64
import json
import re
from itertools import pairwise

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.game.fouls import Foul
from snooker_env.play.session import Session
from snooker_env.render.scene import LEAD
from snooker_env.render.table_picture import View
from snooker_env.replays.referee_words import FOUL_WORDS, bars, foul_words
from tests.refusals import refuse_each, refused
from tests.tables import begun


def numbers(text, kind, columns):
    return np.frombuffer(base64.b64decode(text), f"<{kind}").reshape(-1, columns)


def places_at(stroke, t):
    """Where the balls are at a time, by docs/play/replay.md alone."""
    places = numbers(stroke["start"], "f8", 2).copy()
    rows, which = numbers(stroke["paths"]["f8"], "f8", 7), numbers(stroke["paths"]["u1"], "u1", 2)
    assert len(rows) == len(which) == stroke["paths"]["count"]
    for (t0, x, y, vx, vy, ax, ay), (ball, _) in zip(rows, which, strict=True):
        if t0 <= t:
            dt = t - t0
            places[ball] = x + (vx + 0.5 * ax * dt) * dt, y + (vy + 0.5 * ay * dt) * dt
    return places


def keeping(seed=1, **options):
    """A table that has begun and keeps its history."""
    env = sn.SnookerEnv(**options)
    env.keep_history = True
    env.reset(seed=seed)
    return env


def visit(seed, strokes=40, **options):
    """The strokes of visits one after the other, the softest plain pots."""
    env, kept = keeping(seed, action="discrete", **options), []
    while len(kept) + len(env.history) < strokes:
        if env.step(67)[2]:
            kept += env.history
            env.reset()
    return kept + env.history


@pytest.fixture(scope="module")
def strokes():
    return visit(3, 30)


def test_a_decoded_stroke_is_where_the_shot_is(strokes):
    rng = np.random.default_rng(0)
    data = sn.replay(strokes).to_dict()
    for played, stroke in zip(strokes, data["strokes"], strict=True):
        shot = played.shot
        assert stroke["duration"] == shot.duration
        for t in rng.uniform(0, shot.duration, 20):
            there = stroke["on_table"]
            np.testing.assert_allclose(places_at(stroke, t)[there], shot.at(t)[0][there], rtol=0, atol=1e-12)
        assert stroke["pots"] == np.flatnonzero(shot.potted >= 0).tolist() or len(stroke["pots"]) > 1


def test_the_next_stroke_starts_where_the_last_one_left_the_table(strokes):
    data = sn.replay(strokes).to_dict()["strokes"]
    for played, this, following in zip(strokes, data, data[1:], strict=False):
        if played.over:
            continue
        end = places_at(this, this["duration"] or np.inf)
        there = set(this["on_table"]) - set(this["pots"])
        if this["after"] is not None:
            end, there = numbers(this["after"]["places"], "f8", 2), set(this["after"]["on_table"])
        assert there == set(following["on_table"])
        rows = sorted(there)
        np.testing.assert_allclose(end[rows], numbers(following["start"], "f8", 2)[rows], rtol=0, atol=1e-9)
    assert any(stroke["after"] is not None for stroke in data)  # a colour was respotted


@pytest.fixture(scope="module")
def fouls():
    """Strokes without aim: most are fouls."""
    env, kept = keeping(), []
    env.action_space.seed(0)
    for seed in range(12):
        env.reset(seed=seed)
        env.step(env.action_space.sample())
        kept += env.history
    return kept


def test_what_the_referee_said_is_recorded(strokes, fouls):
    strokes = strokes + fouls
    data = sn.replay(strokes, players=["Ada"]).to_dict()
    assert data["players"] == ["Ada"] and data["format"] == "snooker-replay"
    for played, stroke in zip(strokes, data["strokes"], strict=True):
        assert stroke["points"] == played.points and stroke["penalty"] == played.penalty
        assert stroke["score"] == list(played.scores)
        if played.fouls:
            assert stroke["words"].startswith(f"Foul, {played.penalty}: ")
            assert stroke["fouls"] == foul_words(played.fouls) != []
        elif played.points:
            assert f"potted, {played.points}" in stroke["words"]
        else:
            assert stroke["words"] == "No ball potted."
    assert {bool(s["fouls"]) for s in data["strokes"]} == {True, False}
    assert set(FOUL_WORDS) == set(Foul)


def test_the_cue_as_struck_sets_the_cue_ball_off(strokes):
    """Velocity and spin of the cue ball at time 0 are those of the recorded strike."""
    noisy = visit(5, 10, noise="club")
    for played in strokes[:5] + noisy:
        v, w = sn.strike(**played.cue)
        _, velocities, spins = played.shot.at(0.0)
        np.testing.assert_allclose(velocities[0], v[:2], rtol=0, atol=1e-12)
        np.testing.assert_allclose(spins[0], w, rtol=0, atol=1e-9)


def test_the_page_holds_everything_and_asks_for_nothing(strokes):
    assert len(strokes) == 30 and len(sn.replay(strokes).html().encode()) < 200_000
    page = sn.replay(strokes[:2], title="</script><b>&", players=["</script>"]).html()
    assert not re.search(r"\{\{(title|module|data)\}\}", page)
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", page) and "@import" not in page
    assert page.count("</script>") == page.count("<script") and "&lt;/script&gt;&lt;b&gt;&amp;" in page
    data = re.search(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL)
    assert data is not None
    assert json.loads(data[1])["players"] == ["</script>"]


def test_errors_of_both_seats_and_what_was_played_on():
    """Each stroke has the errors of its player; of shots with several physics no one is all's."""
    env = keeping(task="frame", opponent="ghost_ball", action="discrete", noise={"aim_deg": 0.1}, cue="real")
    for _ in range(4):
        env.step(int(np.flatnonzero(env.action_masks())[0]))
    data = sn.replay(env).to_dict()
    assert (data["version"], data["physics"], data["table"]) == (2, "paper", "match")
    assert all((one["cue_kind"], one["noise"]) == ("real", {"aim_deg": 0.1}) for one in data["strokes"])
    match = Session()
    match.noise, match.cue = ["club", "none"], "free"
    for aim in (np.pi / 2, 1.5):
        match.play(CueStroke(speed=2.0, aim=aim))
        if match.frame.phase == "choice":
            match.choose("play")
    both = sn.replay([act.played for act in match.acts if act.played is not None]).to_dict()["strokes"]
    assert [one["noise"] for one in both] == [("club", "none")[one["player"]] for one in both]
    assert {one["player"] for one in both} == {0, 1} and {one["cue_kind"] for one in both} == {"free"}
    shots = [
        sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0, 0, 0)], "match", name) for name in ("paper", "match")
    ]
    assert (
        sn.replay(shots).to_dict()["physics"] is None and sn.replay(shots[1]).to_dict()["physics"] == "match"
    )


def test_history_is_kept_on_request_and_starts_anew():
    env = begun(sn.SnookerEnv(action="discrete"))
    env.step(67)
    assert env.history == [] and env.last_shot is not None and not len(env.last_shot.segments)
    refused(lambda: sn.replay(env), "source", "keeps no history", "keep_history = True")
    shot, env.keep_history = env.last_shot, True
    assert env.last_shot is shot and env.history == []
    env.reset(seed=1)
    refused(lambda: sn.replay(env), "source", "without a stroke", "at least one")
    env.step(67)
    assert len(env.history) == 1 and len(env.last_shot.segments) and env.history[0].shot is env.last_shot
    env.reset()
    assert env.history == [] and env.last_shot is None
    with pytest.raises(ValueError, match="keep_history"):
        env.keep_history = 1
    env.keep_history = False
    assert sn.SnookerEnv(render_mode="ansi").keep_history


def test_keeping_history_changes_no_result():
    options = {"task": "frame", "opponent": "ghost_ball", "noise": "club", "action": "discrete"}
    env, other = keeping(**options), sn.SnookerEnv(**options)
    other.reset(seed=1)
    for choice in range(5):
        assert np.array_equal(env.step(choice)[0], other.step(choice)[0])


WRONG = """
sn.replay(3) | source | int | must be a Shot
sn.replay([]) | strokes | [] | at least one
sn.replay([1]) | strokes[0] | int | must be a Shot
sn.Replay(None) | strokes | None | must be strokes
sn.replay([one, other]) | strokes[1] | another table | must be on the table of
sn.replay([one, slower]) | strokes[1] | other physics | spin_decel
sn.replay(one, players=["a", "b"]) | players | 'a', 'b' | one for a visit
sn.replay(one, players=3) | players | 3 | must be None, or names
sn.replay(one, players=[None]) | players | None | must be a str
sn.replay(one, title=?) | title | ? | must be a str | None; 3; chr(0xD800)
sn.replay(one, 3) | path | 3 | must be a str or a Path
sn.replay(one, folder / "break.exe") | suffix | .exe | .html
sn.replay(one).save(folder / "a.html", fps=3) | path | a.html | must end in .mp4 or .gif
next(sn.replay(one).frames(size=None)) | size | None | must be
next(sn.replay(one).frames(fps=None)) | fps | None | must be
sn.replay(one).save(folder / "a.mp4", size=(321, 180)) | size | (321, 180) | both even
sn.replay(one).save(folder / "a.gif", fps=0) | fps | 0 | must be
sn.replay(one).save(folder / "a.gif", speed=-1) | speed | -1 | must be
"""


def test_wrong_arguments_are_refused_and_no_file_is_left(strokes, tmp_path):
    still = [(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)]
    names = {"sn": sn, "folder": tmp_path, "one": strokes[0]}
    names |= {"other": sn.simulate(*still, table="tight")}
    names |= {"slower": sn.simulate(*still, physics={"spin_decel": 5.0})}
    refuse_each(WRONG, names)
    assert list(tmp_path.iterdir()) == []


# Score bars and the referee's words follow the ``Frame`` after each stroke


FRAMES = (("ghost_ball", "colours", "none"), ("random", "colours", "club"), ("ghost_ball", "line_up", "club"))


@pytest.fixture(scope="module", params=FRAMES)
def frame(request):
    """A whole frame's strokes, and the frame after each of the agent's steps."""
    options = dict(zip(("opponent", "layout", "noise"), request.param, strict=True))
    rules = {"task": "frame", "action": "discrete", "miss": "clear_path", "max_strokes": 120}
    env = keeping(7, **rules, **options)
    rng, seen, ended = np.random.default_rng(7), [], False
    while not ended:
        action = int(rng.choice(np.flatnonzero(env.action_masks())))
        _, _, terminated, truncated, _ = env.step(action)
        seen.append((len(env.history), env.frame))
        ended = terminated or truncated
    return env, seen


def test_scores_follow_the_frame(frame):
    env, seen = frame
    made = bars(env.history, ("A", "B"))
    assert len(made) == len(env.history) > 3
    for count, state in seen:
        if count:
            assert made[count - 1][1].scores == state.scores
    for (_, after), (before, _) in pairwise(made):
        assert before.scores == after.scores
    assert {during.striker for during, _ in made} <= {0, 1}


def test_a_break_is_the_sum_of_its_strokes(frame):
    env, _ = frame
    run, last = 0, None
    for played, (before, after) in zip(env.history, bars(env.history, ("A", "B")), strict=True):
        run = run if played.player == last else 0
        assert before.break_points == run and after.break_points == run + played.points
        if played.points and run:
            assert f"break {run + played.points}" in after.words
        run, last = run + played.points, played.player if played.points else None


# Films: their pictures, length and colours, and what cannot be written


SMALL = {"size": (320, 180), "fps": 10.0}


@pytest.fixture(scope="module")
def replay():
    pytest.importorskip("pygame")
    pytest.importorskip("imageio_ffmpeg")
    env = keeping(action="discrete")
    env.step(67)
    env.step(67)
    return sn.replay(env)


def test_the_pictures_show_the_motion_and_then_the_table(replay):
    pictures = list(replay.frames(**SMALL))
    moving = [len(np.arange(0.0, shot.duration, 0.1)) + 1 + round(LEAD / 0.1) for shot in replay.shots]
    assert len(pictures) == sum(moving) + 2 * 8  # 0.8 s after each stroke
    assert all(picture.shape == (180, 320, 3) and picture.dtype == np.uint8 for picture in pictures)
    assert np.array_equal(pictures[moving[0]], pictures[moving[0] + 7])
    assert not np.array_equal(pictures[9], pictures[10])
    fast = list(replay.frames(**SMALL, speed=4.0))
    moving = [len(np.arange(0.0, shot.duration, 0.4)) + 1 + round(LEAD / 0.4) for shot in replay.shots]
    assert len(fast) == sum(moving) + 2 * 8


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_every_ball_keeps_its_colour(replay, tmp_path, suffix):
    """In a GIF too, which has 256 colours: small balls must not lose theirs to the cloth."""
    imageio = pytest.importorskip("imageio.v3")
    size = (1280, 720)
    file = replay.save(tmp_path / f"film{suffix}", size=size, fps=5.0)
    film, first = imageio.imread(file, index=0), next(replay.frames(size=size, fps=5.0))
    view = View.of(sn.Table.preset("match"), size=size)
    for place in replay.shots[0].at(0.0)[0]:
        x, y = np.rint(view(place)).astype(int)
        around = slice(y - 1, y + 2), slice(x - 1, x + 2), slice(3)
        seen, drawn = (picture[around].astype(int).mean(axis=(0, 1)) for picture in (film, first))
        # a video halves the resolution of colours
        assert np.abs(seen - drawn).max() < 60, (place, seen, drawn)
    assert [p.name for p in tmp_path.iterdir()] == [file.name]
