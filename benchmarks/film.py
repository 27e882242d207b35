"""How fast is a film made? The pictures of a moving break-off as arrays, on one core: making the scene, and
drawing it.

    python -m benchmarks.film [--size 1920 1080] [--fps 60] [--repeats 3] [--json FILE] [--out FOLDER]

The film is that of an exported one: the score bar, the cue ball's growing path, its spots, and ghosts where
it met other balls. Times are those of every frame; the first of a process also draws the table and the balls,
so it is given alone. Encoding is not in them: the last line is that of a whole .mp4, by the processor time of
this process and of its encoder together, so that it says what one core writes.
"""

import os
import tempfile
import time
from pathlib import Path

import numpy as np

import snooker_env as sn
from commands import provenance
from snooker_env.game.balls import BROWN, CUE, N_BALLS, SPOTS
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import Film, ScoreBar

from ._common.command import Command, at_least, run, save_json


def break_off():
    """A hard break-off from the yellow's side, with side: most balls move."""
    target, start = SPOTS[15] + (0.03, -0.01), np.array([0.2, SPOTS[BROWN, 1]])
    v, w = sn.strike(6.0, np.arctan2(*(target - start)[::-1]), side=0.35)
    positions, velocities, spins = SPOTS.copy(), np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
    positions[CUE], velocities[CUE], spins[CUE] = start, v[:2], w
    return sn.simulate(positions, velocities, spins, physics="match")


def made(shot, size, fps):
    """Times [s] of each frame: (frames, 2), the scene and its drawing."""
    bar = ScoreBar(
        ("a player", "another"), (0, 0), striker=0, break_points=0, reds_left=15, points_on=147, ball_on="red"
    )
    scenes = Film("match", shot, bar=bar).scenes(fps)
    times = []
    while True:
        begin = time.perf_counter()
        scene = next(scenes, None)
        if scene is None:
            return np.array(times)
        between = time.perf_counter()
        rgb_array(scene, size=size)
        times.append((between - begin, time.perf_counter() - between))


def exported(shot, size):
    """Pictures a second of processor time of a whole .mp4, at 30 a second of the shot."""
    replay = sn.replay(shot)
    frames = len(list(replay.frames(size=size)))
    with tempfile.TemporaryDirectory() as folder:
        replay.save(Path(folder) / "first.mp4", size=size)  # compiled now, not while it is timed
        before = os.times()[:4]
        replay.save(Path(folder) / "film.mp4", size=size)
        return frames / (sum(os.times()[:4]) - sum(before))


def main():
    """Command line."""
    parser = Command("film", __doc__)
    parser.add_argument(
        "--size",
        type=at_least(100),
        nargs=2,
        default=(1920, 1080),
        metavar=("WIDTH", "HEIGHT"),
        help="[1920 1080]",
    )
    parser.add_argument(
        "--fps", type=at_least(1), default=60, metavar="N", help="pictures of a second of the shot [60]"
    )
    parser.add_argument(
        "--repeats",
        type=at_least(1),
        default=3,
        metavar="N",
        help="times the film is made; the quickest counts [3]",
    )
    options = parser.options()
    shot, size = break_off(), tuple(options.size)
    films = [made(shot, size, options.fps) for _ in range(options.repeats)]
    best = min(films, key=lambda times: times.sum())
    first = 1e3 * float(films[0][0].sum())
    scene, drawing = 1e3 * np.median(best, axis=0)
    figures = {
        "machine": provenance.machine(),
        "size": size,
        "frames": len(best),
        "scene_ms": float(scene),
        "drawing_ms": float(drawing),
        "worst_ms": 1e3 * float(best.sum(axis=1).max()),
        "frames_per_second": float(len(best) / best.sum()),
        "first_ms": first,
        "frames_per_second_of_each_film": [float(len(times) / times.sum()) for times in films],
    }
    figures["exported_per_core_second"] = exported(shot, size)
    print(provenance.line())
    print(
        f"\nA break-off of {shot.duration:.1f} s, {len(best)} frames of {size[0]} x {size[1]}, {len(shot.events)} events"
    )
    print(f"  making the scene   {scene:6.2f} ms (median)")
    print(f"  drawing, as array  {drawing:6.2f} ms (median)")
    print(f"  worst frame        {figures['worst_ms']:6.2f} ms")
    print(f"  first frame        {first:6.2f} ms (the table and the balls are drawn)")
    print(f"  frames a second    {figures['frames_per_second']:6.0f}")
    print(
        f"  written as an .mp4 {figures['exported_per_core_second']:6.0f} a second of one core, the encoder included"
    )
    save_json(options.json, figures)


if __name__ == "__main__":
    run(main)
