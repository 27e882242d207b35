"""How does an environment show itself? One picture for "rgb_array", text for "ansi", a window with the moving shot for "human"."""

import gymnasium
import numpy as np

MODES = ("human", "rgb_array", "ansi")
FPS = 30


class Pictures:
    """The pictures of one environment on a ``Table``; a window belongs to one process and is left behind in a copy."""

    def __init__(self, table, mode):
        self.table, self.mode = table, mode
        self._window = None

    def __getstate__(self):
        return self.__dict__ | {"_window": None}

    def render(self, positions, on_table, shot, text):
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        if self.mode is None:
            gymnasium.logger.warn('render() without render_mode; make the environment with render_mode="rgb_array", "ansi" or "human"')
        if self.mode == "rgb_array":
            from ..render.pygame_view import rgb_array

            return rgb_array(self._scene(positions, on_table, shot, text))
        if self.mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene(positions, on_table, shot, text))
        return None

    def show(self, positions, on_table, shot, text, *, film):
        """Show the table in the window; ``film``: first the shot that led there, at twice its speed."""
        from ..render.pygame_view import Window
        from ..render.scene import shot_scenes

        if self._window is None:
            self._window = Window()
        if film:
            self._window.play(shot_scenes(self.table, shot, fps=FPS, speed=2.0, text=text), FPS)
        self._window.draw(self._scene(positions, on_table, shot, text))

    def close(self):
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _scene(self, positions, on_table, shot, text):
        from ..render.scene import ball_paths, scene

        # the paths of the cue ball and of what it potted
        paths = None if shot is None else ball_paths(shot, (0, *np.flatnonzero(shot.potted[1:] >= 0) + 1))
        return scene(self.table, positions, on_table, paths=paths, text=text)
