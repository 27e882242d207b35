"""How does a replay become a film? Picture after picture of its strokes, straight into the encoder: never more than one is held."""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._check import number, refuse
from .._files import write_whole
from ..render.scene import Film, Scene, scene
from ..tasks.played import Played
from .bars import bars
from .words import pots_of

if TYPE_CHECKING:
    from .document import Replay

PAUSE = 0.8
"""How long the table is shown after each stroke [s of the film]."""
SIZE = (1920, 1080)
GIF_COLOURS = 128


def scenes(replay: "Replay", fps: float, speed: float) -> Iterator[Scene]:
    """What the film shows, one ``Scene`` a picture."""
    judged = [stroke for stroke in replay.strokes if isinstance(stroke, Played)]
    told = iter(bars(judged, replay.players))
    for stroke in replay.strokes:
        shot = stroke if not isinstance(stroke, Played) else stroke.shot
        during, after = next(told) if isinstance(stroke, Played) else (None, None)
        text = "" if during else replay.title
        film = Film(replay.table, shot, trail=(0, *pots_of(shot)), spots=(0,), faded=(0,), bar=during, text=text)
        yield from film.scenes(fps, speed)
        last = film.at(shot.duration)
        rest = {"ball_radius": shot.physics.R, "paths": last.paths, "turns": last.turns, "ghosts": last.ghosts, "bar": after, "text": text}
        where, there = (shot.positions, shot.on_table) if not isinstance(stroke, Played) else (stroke.positions, stroke.on_table)
        still = scene(replay.table, where, there, **rest)
        for _ in range(round(PAUSE * fps)):
            yield still


def frames(replay: "Replay", fps: float, speed: float, size: tuple[int, int]) -> Iterator[NDArray[np.uint8]]:
    """See ``Replay.frames``."""
    from ..render.pygame_view import rgb_array

    for picture in scenes(replay, _rate("fps", fps), _rate("speed", speed)):
        yield rgb_array(picture, size=size)


def write_film(replay: "Replay", target: Path, *, fps: float = 30.0, speed: float = 1.0, size: tuple[int, int] = SIZE) -> None:
    """Write ``frames`` to an .mp4 or .gif file."""
    if len(size) != 2 or any(side % 2 for side in size):
        raise refuse("size", size, "must be (width, height), both even, as video encoders want them")
    pictures = replay.frames(fps=fps, speed=speed, size=size)
    write_whole(target, lambda path: _encode(pictures, path, fps, size))


def _rate(field: str, value: Any) -> float:
    return number(field, value, 0.0, 1000.0, open_low=True)


def _encode(pictures: Iterator[NDArray[np.uint8]], path: Path, fps: float, size: tuple[int, int]) -> None:
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise ImportError('films need ffmpeg; install it, in a clone of snooker_env, with: pip install -e ".[render]"') from error
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-"]
    wanted = ["-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    if path.suffix == ".gif":
        palette = (
            f"[0:v]split[a][b];[a]palettegen=max_colors={GIF_COLOURS}:stats_mode=diff[p];[b][p]paletteuse=dither=none:diff_mode=rectangle"
        )
        wanted = ["-filter_complex", palette, "-loop", "0"]
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error", *given, *wanted, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None and encoder.stderr is not None
        try:
            for picture in pictures:
                encoder.stdin.write(picture.data)
            encoder.stdin.close()
            complaint = encoder.stderr.read().decode(errors="replace")
        except BrokenPipeError:
            complaint = encoder.stderr.read().decode(errors="replace")
        except BaseException:
            encoder.kill()
            raise
    if encoder.returncode:
        raise OSError(f"the film could not be written: {complaint.strip() or f'ffmpeg ended with {encoder.returncode}'}")
