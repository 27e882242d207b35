"""How is a match of two players made? ``match_env`` loads PettingZoo only when it is called."""

from typing import TYPE_CHECKING, Any

from ._install import missing
from ._types import RenderMode

if TYPE_CHECKING:
    from .envs.match import MatchEnv as _MatchEnv
    from .tasks.options import Options
else:  # PettingZoo and the environments are loaded at their first use
    _MatchEnv = Options = Any


def match_env(
    options: Options | None = None, *, render_mode: RenderMode | None = None, **keywords: Any
) -> "_MatchEnv":
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
        from .envs.match import MatchEnv
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "pettingzoo":
            raise
        raise missing("match_env needs PettingZoo", "multi") from error
    return MatchEnv(options, render_mode=render_mode, **keywords)
