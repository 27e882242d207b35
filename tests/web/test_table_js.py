"""Does the browser show what was simulated? ``table.js`` in a real headless Chromium."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import layout
from snooker_env.physics import cloth
from snooker_env.render.scene import scene_data
from snooker_env.replays.encode import pack
from snooker_env.replays.web import table_js
from tests.web.chromium import chromium, module_page  # noqa: F401
from tests.web.replay_data import MATCH, doubles, hit

GAMES = {  # table, physics, balls
    "snooker": ("match", MATCH, 22),
    "paper, few balls": ("match", sn.Physics(), 5),
    "nap": ("match", sn.Physics.preset("match", nap=0.02), 22),
    "pool": ("pool9", sn.Physics.preset("match", R=sn.Table.preset("pool9").ball_radius), 10),
    "carom": ("carom", sn.Physics.preset("match", R=sn.Table.preset("carom").ball_radius), 3),
    "open cloth": (None, sn.Physics.preset("match", spin_decel=0.0, roll_drag=0.03), 4),
}


def start_of(game, rng):
    """Places (n, 2) and flags for a shot of a game: snooker's break-off less some, else strewn balls."""
    table, physics, n = GAMES[game]
    if n == 22:
        r, here = layout("break_off" if rng.random() < 0.5 else "random:9", rng)
        return r, here
    half = np.array([(high - low) / 2 for low, high in scene_data(table)["extent"]]) - 3 * physics.R
    while True:
        r = rng.uniform(-half, half, (n, 2))
        gaps = np.hypot(*(r[:, None] - r[None]).T) + 9 * np.eye(n)
        if gaps.min() > 2.1 * physics.R:
            return r, rng.random(n) > np.append(-1.0, np.full(n - 1, 0.1))


def shots(count, rng):
    """(game, shot, start, on_table) of ``count`` shots of all games, with draw, side and raised cues."""
    made = []
    for k in range(count):
        game = list(GAMES)[k % len(GAMES)]
        table, physics, _ = GAMES[game]
        r, here = start_of(game, rng)
        other = rng.choice(np.flatnonzero(here)[1:])
        aim = np.arctan2(*(r[other] - r[0])[::-1]) + rng.normal(0, 0.01)
        side, top = rng.uniform(-0.33, 0.33, 2)
        speed, elevation = rng.uniform(0.5, 9.0), rng.choice([0.0, 0.1, 0.9])
        shot = hit(r, here, speed, aim, side, top, elevation, table, physics)
        made.append((game, shot, r, here))
    return made


AT = """({replay, times, names}) => {
  const doubles = text => new Float64Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
  const text = numbers => { let s = ""; for (const b of new Uint8Array(numbers.buffer)) s += String.fromCharCode(b); return btoa(s); };
  const {strokes} = table.decode(replay);
  return strokes.map((stroke, k) => {
    const out = [];
    for (const t of doubles(times[k])) { const at = stroke.at(t); for (const name of names) out.push(...at[name]); }
    return text(Float64Array.from(out));
  });
}"""


def in_browser(page, made, times, names):
    """[(times, names, balls)] of shots of one game as the browser evaluates them."""
    replay = sn.replay([shot for _, shot, _, _ in made]).to_dict()
    found = page.evaluate(AT, {"replay": replay, "times": [pack(t, "f8") for t in times], "names": names})
    return [doubles(text).reshape(len(t), len(names), -1) for text, t in zip(found, times, strict=True)]


@pytest.fixture(scope="module")
def page(chromium):  # noqa: F811
    return module_page(chromium)


def test_the_file_is_small_and_loads_nothing():
    source = table_js()
    assert len(source.encode()) < 60 * 1024
    assert "import " not in source and "http" not in source.replace("http-equiv", "").replace(
        "http://www.w3.org/2000/svg", ""
    )  # a name, not an address
    assert "</script" not in source


@pytest.mark.slow
def test_places_are_those_of_the_simulation_at_1000_times_of_100_shots(page):
    rng = np.random.default_rng(16)
    made = shots(102, rng)
    kinds = np.concatenate([shot.events["kind"] for _, shot, _, _ in made])
    states = np.concatenate([shot.segments[:, cloth.SEGMENT_STATE] for _, shot, _, _ in made])
    for kind in (sn.EventKind.POT, sn.EventKind.DROP, sn.EventKind.JAW):
        assert (kinds == kind).sum() >= 3, f"no {kind.name} among these shots"
    assert (states == cloth.BEND).sum() > 50
    worst, equal, total = 0.0, 0, 0
    for game in GAMES:
        ours = [one for one in made if one[0] == game]
        times = []
        for _, shot, _, _ in ours:
            impacts = rng.choice(np.append(shot.events["time"], (0.0, shot.duration)), 100)
            times.append(np.append(rng.uniform(0, 1.05 * shot.duration, 900), impacts))
        shown = in_browser(page, ours, times, ["x", "y"])
        for (_, shot, _, _), t, found in zip(ours, times, shown, strict=True):
            expected = shot.at(t)[0].transpose(0, 2, 1)
            worst = max(worst, np.abs(found - expected).max())
            equal += (found == expected).sum()
            total += found.size
    assert worst < 1e-9
    assert equal == total, f"{total - equal} of {total} numbers differ, by at most {worst:g} m"


def test_velocities_spins_and_who_is_there(page):
    rng = np.random.default_rng(17)
    made = shots(18, rng)
    for game in GAMES:
        ours = [one for one in made if one[0] == game]
        drawn = [(rng.uniform(0, 1.05 * shot.duration, 50), shot) for _, shot, _, _ in ours]
        times = [np.append(some, shot.events["time"][:20]) for some, shot in drawn]  # impacts, too
        shown = in_browser(page, ours, times, ["vx", "vy", "wx", "wy", "wz", "on"])
        for (_, shot, _, here), t, found in zip(ours, times, shown, strict=True):
            _, v, w = shot.at(t)
            assert np.array_equal(found[:, :2], v.transpose(0, 2, 1))
            assert np.allclose(found[:, 2:5], w.transpose(0, 2, 1), rtol=1e-6, atol=5e-5)  # 32 bits
            gone = np.where(here, np.inf, -1.0)
            pots = shot.events[shot.events["kind"] == sn.EventKind.POT]
            gone[pots["i"]] = pots["time"]
            assert np.array_equal(found[:, 5], gone > t[:, None])


@pytest.mark.slow
def test_a_ball_turns_as_it_spins(page):
    """Against tiny steps of the simulation's own spins; and the same whichever way a time is come to."""
    r = np.array([(0.1, -1.0), (0.0, 0.3)])
    shot = hit(r, None, 2.5, np.arctan2(1.3, -0.1), 0.3, -0.3, 0.05, "match", MATCH)
    replay = sn.replay(shot).to_dict()
    times = [0.3, 0.9, 2.5, shot.duration]
    found = page.evaluate(
        """([replay, times]) => {
        const turns = order => {
          const [stroke] = table.decode(replay).strokes;
          return order.map(t => [stroke.turn(0, t), stroke.turn(1, t)]);
        };
        return [turns([0, ...times]), turns([0, ...times].reverse()).reverse()];
        }""",
        [replay, times],
    )
    assert found[0] == found[1]
    fine = np.arange(0.0, shot.duration, 2e-4)
    w = shot.at(fine + 1e-4)[2]
    for ball in (0, 1):
        q, k = np.array(found[0][0][ball]), 0
        for t, expected in zip(times, found[0][1:], strict=True):
            while k < len(fine) and fine[k] < t:
                turn = w[k, ball] * min(2e-4, t - fine[k])
                q = _after(q, turn)
                k += 1
            apart = 2 * np.arccos(min(1.0, abs(q @ expected[ball])))
            assert apart < 0.05, (ball, t, apart)
            assert abs(np.linalg.norm(expected[ball]) - 1) < 1e-9
    assert abs(np.dot(found[0][0][0], found[0][-1][0])) < 0.999  # it has turned at all


def _after(q, turn):
    angle = np.linalg.norm(turn)
    if angle == 0:
        return q
    w, axis = np.cos(angle / 2), np.sin(angle / 2) * turn / angle
    return np.array([w * q[0] - axis @ q[1:], *(w * q[1:] + axis * q[0] + np.cross(axis, q[1:]))])


DRAWN = """({scene, frame, at, size = [900, 500]}) => {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = size;
  const view = new table.TableView(canvas, scene);
  view.draw(frame);
  const screen = at.map(([x, y]) => view.toScreen(x, y)), pen = canvas.getContext("2d");
  const pixels = screen.map(place => Array.from(pen.getImageData(...place.map(Math.round), 1, 1).data.slice(0, 3)));
  return {pixels, screen, back: screen.map(place => view.toTable(...place)), scale: view.scale};
}"""


def drawn(page, scene, frame, at, **more):
    return page.evaluate(DRAWN, {"scene": scene, "frame": frame, "at": at, **more})


def near(rgb, other, most=60):
    return np.abs(np.subtract(rgb, other)).max() <= most


@pytest.mark.parametrize("table", ["match", "pool9", "carom", None])
def test_every_table_is_drawn_as_it_is(page, table):
    scene = scene_data(table)
    (_, high_x), (_, high_y) = scene["extent"]
    places = [[0.3, 0.2], [high_x / 2, high_y + (0.1 if table else 0.03)], [0.1, -0.4]]
    places += [[x, y] for x, y, _ in scene["falls"]]
    frame = {"x": [0.1], "y": [-0.4], "on": [1]}
    cloth_, rail, ball, *pockets = drawn(page, scene, frame, places)["pixels"]
    palette = scene["palette"]
    assert near(cloth_, palette["cloth"])
    assert near(rail, palette["wood"] if scene["cushions"] else palette["cloth"], 70)
    assert near(ball, scene["balls"][0]["rgb"])
    assert all(near(pocket, palette["hole"], 70) for pocket in pockets)
    assert len(pockets) == len(scene["falls"])


def test_everything_that_a_frame_may_hold_is_drawn(page):
    scene = scene_data("match")
    bare = {"x": [0.0, 0.3], "y": [0.0, 0.5], "on": [1, 0]}
    places = [[0.3, 0.5], [0.5, -1.0], [-0.5, 0.5], [0.2, -0.52], [-0.4, -0.6], [0.0, 0.0], [0.0, -0.5]]
    extra = {
        "lines": [{"points": [[0.5, -1.5], [0.5, -0.5]], "colour": [255, 255, 0]}],
        "rings": [{"x": -0.5, "y": 0.5, "ball": 21, "alpha": 0.9}],
        "heat": [dict(x0=0.1, y0=-0.6, cell=0.1, nx=2, ny=1, values=[0, 5], rgb=[255, 0, 255])],
        "labels": True,
        "highlight": [0],
        "cue": {"x": 0.0, "y": 0.0, "aim": np.pi / 2, "pull": 0.05},
    }
    before, after = (drawn(page, scene, {**bare, **more}, places)["pixels"] for more in ({}, extra))
    gone, line, ring, empty, _, _, cue = after
    assert gone == before[0]  # a ball that is not on the table
    assert near(line, [255, 255, 0], 20)
    assert near(ring, [40, 40, 40], 80)
    # the full cell, with the larger x
    assert empty != before[3] and near(before[3], scene["palette"]["cloth"])
    assert not near(cue, scene["palette"]["cloth"], 40)
    empty_cell = [drawn(page, scene, frame, [[0.12, -0.52]])["pixels"] for frame in (bare, bare | extra)]
    assert empty_cell[0] == empty_cell[1]
