"""How does an agent interact with the table? The Gymnasium environments, and the match of two players."""

from typing import TYPE_CHECKING, Any

from .._lib.install import missing
from .._lib.types import RenderMode
from ..tasks.options import Options

if TYPE_CHECKING:
    from .match import MatchEnv
else:  # PettingZoo is loaded at its first use
    MatchEnv = Any


def match_env(
    options: Options | None = None, *, render_mode: RenderMode | None = None, **keywords: Any
) -> MatchEnv:
    """Make a frame or match of snooker between "player_0" and "player_1", as a PettingZoo AEC environment.

    Parameters
    ----------
    options : Options, optional
        The options, with ``task="frame"`` or "match" and no opponent. Default None: they are made from the
        keywords, with the task "match" if ``frames`` is among them, else "frame".
    render_mode : {"human", "rgb_array", "ansi"}, optional
        How ``render`` shows the table; default None: not at all.
    **keywords
        ``seats`` (two dicts: what differs in the actions and the noise of each player), ``render_size`` (width
        and height [pixels], each in [100, 8192]), and the keywords of ``Options`` in place of ``options``. Box
        actions hold the place in the D and the decision after a foul, unless ``placement=False`` or other
        ``says``, as ``says=[]``.

    Returns
    -------
    snooker_env.envs.match.MatchEnv
        The environment. ImportError without PettingZoo.

    Examples
    --------
    >>> import snooker_env as sn
    >>> env = sn.match_env(noise="club")
    >>> env.reset(seed=1)
    >>> env.step(env.action_space(env.agent_selection).sample())
    >>> env.agents
    ['player_0', 'player_1']
    """
    try:
        from .match import MatchEnv
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "pettingzoo":
            raise
        raise missing("match_env needs PettingZoo", "multi") from error
    return MatchEnv(options, render_mode=render_mode, **keywords)
