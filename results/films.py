"""The films on the pages of the tasks: one episode of each, as .mp4.

A film shows the first of a few seeds whose episode has what the film illustrates. The same code makes the same film.
"""

import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env.planning import Positions
from snooker_env.players import FRAMES, VISITS
from snooker_env.replays import replay

SIZE, FPS, SPEED = (720, 406), 20.0, 2.0
ENCODER = "-c:v libx264 -preset slow -crf 30 -pix_fmt yuv420p -movflags +faststart -threads 1"
MOST_STROKES = 8
"""Strokes of an episode that a film shows, so that the files stay small."""
SEED, TRIES = 1_000_000, 40
"""The first seed, that of judged tables, and how many are tried."""


@dataclass(frozen=True)
class Film:
    """One film.

    Attributes
    ----------
    agent : str
        Who plays: a name of ``snooker_env.player``.
    options : mapping
        Of ``SnookerEnv``.
    at_least : int
        The least points of the episode, or in a frame the agent's least score when the film ends.
    title : str
        Shown in the first picture.
    quiet : float
        The least share of strokes that score nothing, most of them safeties.
    """

    agent: str
    options: Mapping[str, Any] = field(default_factory=dict)
    at_least: int = 0
    title: str = ""
    quiet: float = 0.0


def _visit(agent, layout, at_least, noise="professional", **options):
    return Film(
        agent,
        {"layout": layout, "noise": noise, "cue": "real", **options},
        at_least,
        f"{agent}, layout {layout}, {noise}'s execution errors",
    )


FRAME = {
    "task": "frame",
    "opponent": "tactician",
    "noise": "professional",
    "cue": "real",
    "miss": "clear_path",
}
FILMS = {
    "break": _visit("stroke_value", "held_out", 20),
    "break_club": _visit("planner", "held_out", 8, noise="club"),
    "escape": _visit("planner", "snookered", 0, reward="legal", one_stroke=True),
    "frame": Film("tactician", FRAME, title="a frame: tactician against tactician", quiet=0.5),
    "break_off": _visit("planner_500", "break_off", 0),
    "random": _visit("planner_500", "random:6", 15),
    "pot_easy": _visit("ghost_ball", "pots:easy", 1),
}
"""The films by name."""


def episode(film: Film, seed: int) -> Any:
    """A ``SnookerEnv`` with the history of the first strokes of an episode."""
    env = sn.SnookerEnv(**film.options, **(FRAMES if film.options.get("task") == "frame" else VISITS))
    player = sn.player(film.agent).at(env)
    env.keep_history = True
    env.reset(seed=seed)
    for stroke in range(MOST_STROKES):
        strokes = player.play(env, [stroke])
        _, _, terminated, truncated, info = env.step(strokes.actions(env.options, Positions.of(env))[0])
        if terminated or truncated or len(env.history) >= MOST_STROKES:
            break
    points = film.at_least if film.options.get("reward") == "legal" else info.get("score", env.points)
    quiet = float(np.mean([played.points == 0 for played in env.history]))
    return env if points >= film.at_least and quiet >= film.quiet and not info["foul"] else None


def found(film: Film) -> tuple[Any, int]:
    """The episode of the first seed that has what the film shows, and that seed. SystemExit without one."""
    for seed in range(SEED, SEED + TRIES):
        env = episode(film, seed)
        if env is not None:
            return env, seed
    raise SystemExit(f"{film.title}: nothing to show in {TRIES} episodes")


def write(
    made: Any, path: Path, *, size: tuple[int, int] = SIZE, fps: float = FPS, speed: float = SPEED
) -> None:
    """Encode a ``Replay`` as an .mp4 that browsers play while it loads: smaller than that of ``Replay.save``, and slower to
    make."""
    from imageio_ffmpeg import get_ffmpeg_exe

    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-"]
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error", *given, *ENCODER.split(), str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None
        for picture in made.frames(fps=fps, speed=speed, size=size):
            encoder.stdin.write(np.ascontiguousarray(picture).data)
    if encoder.returncode:
        raise SystemExit(f"ffmpeg ended with {encoder.returncode}")


def make(folder: Path, names: list[str]) -> None:
    """Write the films with these names, of ``FILMS``."""
    for name in names:
        film, path = FILMS[name], folder / f"{name}.mp4"
        env, seed = found(film)
        players = [film.agent, film.options["opponent"]] if "opponent" in film.options else [film.agent]
        write(replay(env, title=film.title, players=players), path)
        size = path.stat().st_size / 1000
        print(f"{path}: {film.agent}, seed {seed}, {len(env.history)} strokes, {size:.0f} kB", flush=True)
