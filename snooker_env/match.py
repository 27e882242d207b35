"""How do I get a match of two players? ``match_env``: the PettingZoo environment, with PettingZoo loaded only when it is asked for."""

from typing import TYPE_CHECKING, Any

from ._types import RenderMode

if TYPE_CHECKING:
    from .envs.match import MatchEnv as _MatchEnv
    from .tasks.options import Options
else:  # neither PettingZoo nor the environments are loaded before they are asked for
    _MatchEnv = Options = Any


def match_env(options: Options | None = None, *, render_mode: RenderMode | None = None, **given: Any) -> "_MatchEnv":
    """A frame of snooker between "player_0" and "player_1": a PettingZoo AEC environment (``snooker_env.envs.match.MatchEnv``).

    The arguments are those of ``Snooker-v0`` with ``task="frame"``, as keywords or as ``Options``, but for an opponent. As keywords,
    placement in the D and the decision after a foul are part of the action unless switched off (of ``action="discrete"`` they never
    are). After ``max_strokes`` strokes of both together (1000, None for never) the referee stops the frame, both players are truncated.

    Raises ImportError without PettingZoo, ValueError on a bad argument.
    """
    try:
        from .envs.match import MatchEnv
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "pettingzoo":
            raise
        raise ImportError('match_env needs PettingZoo; install it, in a clone of snooker_env, with: pip install -e ".[multi]"') from error
    return MatchEnv(options, render_mode=render_mode, **given)
