"""How does a replay become a film? Pictures go to the encoder one by one, so only one is in memory."""

import subprocess
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .._lib.check import number, refuse
from .._lib.files import write_atomic
from .._lib.install import missing
from .._lib.types import Bytes
from ..physics.table import Table
from ..render.scene import UNTURNED, Film, Scene, ScoreBar, scene
from ..render.table_picture import SIZE, Size
from ..simulation import Shot
from ..tasks.played import Played
from .referee_words import bars

if TYPE_CHECKING:
    from .document import Replay

PAUSE = 0.8  # how long the table is shown after each stroke [s of the film]
MP4 = ["-c:v", "libx264", "-preset", "ultrafast", "-crf", "26", "-threads", "1"]
MP4 += ["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-colorspace", "bt709"]
MP4 += ["-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]
"""What ffmpeg is told of a film: its colours are turned into those of BT.709 in its limited range, and declared so."""
USUAL: dict[str, tuple[tuple[int, int], float]] = {".mp4": (SIZE, 30.0), ".gif": ((640, 360), 12.0)}
"""Default size [pixels] and pictures per second of a film: a GIF that fits into a page."""


def film_stroke(
    table: Table, stroke: Shot | Played, during: ScoreBar | None, after: ScoreBar | None, text: str = ""
) -> tuple[Film, Scene]:
    """A stroke as a film, and the table after it; ``during`` and ``after`` are the bars of ``bars``."""
    shot, cue = (stroke.shot, stroke.cue) if isinstance(stroke, Played) else (stroke, None)
    film = Film(table, shot, strike=cue, bar=during, text=text)
    last, where, on_table = film.at(shot.duration), stroke.positions, stroke.on_table
    placed = not np.array_equal(where[0], shot.positions[0])
    over = {"paths": last.paths, "ghosts": last.ghosts, "turn": UNTURNED if placed else last.turn}
    still = scene(table, where, on_table, bar=after, text=text, **over)
    return film, replace(still, ball_radius=last.ball_radius)


def frames(replay: "Replay", fps: float, speed: float, size: Size) -> Iterator[Bytes]:
    """The pictures of ``Replay.frames``: of each stroke, and of the table after it with the referee's words."""
    from ..render.pygame_view import rgb_array

    fps, speed = (number(name, x, 0.0, 1000.0, open_low=True) for name, x in (("fps", fps), ("speed", speed)))
    judged = [stroke for stroke in replay.strokes if isinstance(stroke, Played)]
    its = iter(bars(judged, replay.players, replay.win_chance))
    for stroke in replay.strokes:
        during, after = next(its) if isinstance(stroke, Played) else (None, None)
        film, still = film_stroke(replay.table, stroke, during, after, "" if during else replay.title)
        for picture in film.scenes(fps, speed):
            yield rgb_array(picture, size=size)
        yield from [rgb_array(still, size=size)] * round(PAUSE * fps)


def write_film(
    replay: "Replay", target: Path, fps: float | None = None, speed: float = 1.0, size: Size | None = None
) -> None:
    """Write ``Replay.frames`` to an .mp4 or .gif file."""
    usual_size, usual_fps = USUAL[target.suffix.lower()]
    size, fps = usual_size if size is None else size, usual_fps if fps is None else fps
    sides = size if isinstance(size, tuple | list) else ()
    if len(sides) != 2 or not all(isinstance(side, int) and side > 0 and side % 2 == 0 for side in sides):
        raise refuse("size", size, "must be (width, height), both even, as video encoders require")
    pictures = frames(replay, fps, speed, size)
    write_atomic(target, lambda path: _encode(pictures, path, fps, size))


def _encode(pictures: Iterator[Bytes], path: Path, fps: float, size: tuple[int, int]) -> None:
    first = next(pictures)  # ValueError for a wrong rate, before anything is written
    pictures = chain([first], pictures)
    if path.suffix.lower() != ".gif":
        _pipe(pictures, size, fps, MP4, path)
        return
    colours = path.with_name(f"{path.stem}.colours.png")
    try:
        _pipe([first], size, fps, ["-vf", "palettegen"], colours)
        chosen = ["-i", str(colours), "-lavfi", "paletteuse=dither=none:diff_mode=rectangle", "-loop", "0"]
        _pipe(pictures, size, fps, chosen, path)
    finally:
        colours.unlink(missing_ok=True)


def encoder_file() -> str:
    """Where ffmpeg is; an ImportError names what brings it."""
    try:
        import pygame  # noqa: F401
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise missing("films need pygame-ce and ffmpeg", "render") from error
    return get_ffmpeg_exe()


def _pipe(pictures, size, fps, wanted, path):
    """Send pictures through ffmpeg into a file."""
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-"]
    command = [encoder_file(), "-y", "-loglevel", "error", *raw, *wanted, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None and encoder.stderr is not None
        try:
            with suppress(BrokenPipeError):
                for picture in pictures:
                    encoder.stdin.write(np.ascontiguousarray(picture).data)
                encoder.stdin.close()
            complaint = encoder.stderr.read().decode(errors="replace").strip()
        except BaseException:
            encoder.kill()
            raise
    if encoder.returncode:
        raise OSError(f"the film could not be written: {complaint or f'code {encoder.returncode}'}")
