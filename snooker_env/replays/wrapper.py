"""How are an environment's episodes written to files? ``RecordReplay`` writes a replay of each."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import gymnasium

from .._lib.check import choice, refuse, refuse_what
from .._lib.types import Action
from .chances import ChanceJudge, check_judge
from .document import SUFFIXES, Replay, check_players, read_path


class RecordReplay(gymnasium.Wrapper[Any, Any, Any, Any], gymnasium.utils.RecordConstructorArgs):
    """Records the strokes of ``Snooker-v0`` and writes episodes as replays.

    The files are ``FOLDER/PREFIX-episode-0.html`` and so on; existing ones are overwritten. An episode is written when it
    ends, or when the next one or ``close()`` cuts it short; an episode without a stroke gives no file. No render mode is
    needed.

    Parameters
    ----------
    env : gymnasium.Env
        ``Snooker-v0`` with one table, wrapped or not; else ValueError.
    folder : str or Path
        Folder of the files, created if it does not exist.
    episode_trigger : callable, optional
        ``episode_trigger(number) -> bool``: whether to write the episode with this number, from 0. Default None: all.
    name_prefix : str
        Beginning of the files' names.
    suffix : {".html", ".json", ".mp4", ".gif"}
        Format of the files, see ``Replay.save``.
    players : iterable of str, optional
        Names of the players, see ``snooker_env.replay``.
    judge : object with ``chance_to_win``, optional
        Estimates each player's chance to win a frame, see ``snooker_env.Replay``; ValueError for visits.

    Attributes
    ----------
    paths : list of Path
        The files written so far.

    Examples
    --------
    >>> import tempfile
    >>> import gymnasium
    >>> import snooker_env as sn
    >>> env = gymnasium.make("Snooker-v0", action="discrete")
    >>> env = sn.RecordReplay(env, tempfile.mkdtemp(), suffix=".json")
    >>> _ = env.reset(seed=1)
    >>> _ = env.step(67)
    >>> env.close()
    >>> [path.name for path in env.paths]
    ['snooker-episode-0.json']
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        folder: str | Path,
        episode_trigger: Callable[[int], bool] | None = None,
        *,
        name_prefix: str = "snooker",
        suffix: str = ".html",
        players: Iterable[str] | None = None,
        judge: ChanceJudge | None = None,
    ):
        arguments = {"episode_trigger": episode_trigger, "name_prefix": name_prefix, "suffix": suffix}
        arguments |= {"players": players, "judge": judge}
        gymnasium.utils.RecordConstructorArgs.__init__(self, folder=str(folder), **arguments)
        super().__init__(env)
        inner = env.unwrapped
        if not hasattr(inner, "keep_history"):
            raise refuse_what("env", f"a {type(inner).__name__}", "must be a Snooker-v0 of one table")
        inner.keep_history = True  # type: ignore[attr-defined]
        self.paths: list[Path] = []
        self._folder, self._prefix = read_path("folder", folder), name_prefix
        if episode_trigger is not None and not callable(episode_trigger):
            raise refuse("episode_trigger", episode_trigger, "must be None, or a callable(number) -> bool")
        self._suffix = choice("suffix", suffix, SUFFIXES)
        if not isinstance(name_prefix, str) or Path(name_prefix + suffix).name != name_prefix + suffix:
            words = "must be the beginning of a file's name, without folders"
            raise refuse("name_prefix", name_prefix, words)
        frame = inner.options.task != "visit"  # type: ignore[attr-defined]
        self._wanted, self._players = episode_trigger, check_players(players, 1 + frame)
        self._judge = check_judge(judge)
        if judge is not None and not frame:
            raise refuse_what("judge", f"a {type(judge).__name__}", "must be None: nobody wins a visit")
        self._number, self._written = -1, True
        self._folder.mkdir(parents=True, exist_ok=True)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """As ``SnookerEnv.reset``; first writes what was played of the last episode, OSError if it cannot."""
        self._write()
        result = super().reset(seed=seed, options=options)
        self._number, self._written = self._number + 1, False
        return result

    def step(self, action: Action) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """As ``SnookerEnv.step``; writes an episode that ends, OSError if it cannot."""
        result = super().step(action)
        if self._written:  # an inner wrapper has begun another episode
            self._number, self._written = self._number + 1, False
        if result[2] or result[3]:
            self._write()
        return result

    def close(self) -> None:
        """Write what was played of the episode, and close the environment."""
        self._write()
        super().close()

    def _write(self) -> None:
        strokes = [] if self._written else self.unwrapped.history  # type: ignore[attr-defined]
        self._written = True
        if strokes and (self._wanted is None or self._wanted(self._number)):
            title = f"episode {self._number}"
            path = self._folder / f"{self._prefix}-episode-{self._number}{self._suffix}"
            replay = Replay(strokes, title=title, players=self._players, judge=self._judge)
            self.paths.append(replay.save(path))
