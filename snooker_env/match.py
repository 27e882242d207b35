"""How do I get a match of two players? ``match_env``: the PettingZoo environment, with PettingZoo loaded only when it is asked for."""

from typing import TYPE_CHECKING, Any

from ._types import RenderMode

if TYPE_CHECKING:
    from .envs.match import MatchEnv as _MatchEnv
    from .tasks.options import Options
else:  # neither PettingZoo nor the environments are loaded before they are asked for
    _MatchEnv = Options = Any


def match_env(options: Options | None = None, *, render_mode: RenderMode | None = None, **given: Any) -> "_MatchEnv":
    """A frame of snooker between "player_0" and "player_1", as a PettingZoo AEC environment.

    After ``max_strokes`` strokes of both together (1000, None for never) the referee stops the frame and both players are truncated.

    Parameters
    ----------
    options : Options, optional
        How the game is played: ``task="frame"``, no opponent. None: it is made of the keywords.
    render_mode : {"human", "rgb_array", "ansi"}, optional
        How ``render`` shows the table.
    **given
        ``render_size``, and the keywords of ``Options`` in place of ``options``. Placement in the D and the decision after a foul are part
        of the action unless they are switched off; with ``action="discrete"`` they never are.

    Returns
    -------
    snooker_env.envs.match.MatchEnv
        Its docstring is the specification.

    Raises
    ------
    ImportError
        Without PettingZoo.
    ValueError
        On a bad argument.

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
        raise ImportError('match_env needs PettingZoo; install it, in a clone of snooker_env, with: pip install -e ".[multi]"') from error
    return MatchEnv(options, render_mode=render_mode, **given)
