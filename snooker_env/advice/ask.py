"""What would a player do here, and how would it turn out? ``advise``."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from .._check import integer, refuse
from ..planning.positions import PositionsLike
from ..players import Player
from ..players import player as player_of
from ..players.cue_stroke import cue_strokes
from ..tasks.noise import NoiseLike
from . import judging
from .practice import one_position, practice_of
from .suggestions import Advice

AGENT, OF_FRAMES = "planner_500", "tactician"  # who is asked if nobody is named: in a visit, and in a frame
INSTEAD = "random"  # whose strokes are judged where none of an agent's is fair: many discrete choices
CONSIDERED = 8  # ranked strokes that are examined for each stroke requested, so that enough of them differ


def advise(
    position: PositionsLike,
    *,
    agent: Any = None,
    scores: tuple[int, int] | None = None,
    noise: NoiseLike = "professional",
    n: int = 5,
    samples: int = 200,
    visits: int = 40,
    seed: int = 0,
    options: Any = None,
    distinct: bool = True,
    trust: bool = False,
) -> Advice:
    """Return the strokes that a player would play in a position, best first, and their outcomes.

    docs/play/advice.md says how strokes are judged and ordered. Each is played ``samples`` times, with the same
    execution errors whichever player is asked; those errors are drawn from ``seed`` alone, independent of the random
    stream that a saved state carries, so advice never reveals the errors of the next stroke.

    Parameters
    ----------
    position : Position, dict, Positions or environment
        One position, as ``Positions.of`` takes it, or a ``Position.to_dict()``. With the cue ball in hand
        each stroke has its ``place``. Points of the break so far do not count.
    agent : str, Path or player, optional
        The player, as ``snooker_env.player`` takes it, in a frame one that knows frames ("tactician",
        "stroke_value", your own). One without ``rank`` has one stroke. Default None: "planner_500", in a frame
        "tactician".
    scores : (int, int), optional
        Of the striker and of the other, in [0, 1000]: they make a frame of a position of a visit. Default None:
        it is what it is.
    noise : str, dict or Noise
        Execution errors with which strokes are chosen and judged.
    n : int
        Largest number of strokes, in [1, 100].
    samples : int
        How often each stroke is played, in [1, 100000]. Without noise each is played once.
    visits : int
        How many visits of each stroke are continued, in [0, 100000]; 0: ``points`` is that of the stroke.
    seed : int
        Seed of the noise samples, in [0, 2**63].
    options : dict or Options, optional
        An ``Options``, or a dict with "physics", "table", "fidelity", "cue" and, in a frame, "miss" and "game".
        Default None: those of ``position`` if it is an environment, else the defaults.
    distinct : bool
        Whether only the first of strokes with equal descriptions is kept, apart from the speed of a pot.
    trust : bool
        Whether code in a model's file may run, see ``snooker_env.player``.

    Returns
    -------
    Advice
        A sequence of ``Suggestion``. ValueError if an argument is invalid, or there is no stroke to play.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> advice = sn.advise(position, agent="search", n=1, samples=50, visits=5)
    >>> advice[0].ball, sn.POCKETS[advice[0].pocket], advice[0].chance > 0.9
    (21, 'top left', True)
    """
    integer("n", n, 1, 100)
    integer("samples", samples, 1, 100_000)
    integer("visits", visits, 0, 100_000)
    integer("seed", seed, 0, 2**63)
    at = one_position(position, scores)
    practice = practice_of(noise, options, position, of_frames=at.of_frames)
    agent = (OF_FRAMES if at.of_frames else AGENT) if agent is None else agent
    asked = player_of(agent, trust=trust)
    name = str(agent) if isinstance(agent, str | Path) else getattr(asked, "name", "") or type(asked).__name__
    if at.of_frames and not getattr(asked, "frames", True):
        allowed = f'must know frames, as "{OF_FRAMES}" or "stroke_value" do: this player knows visits alone'
        raise refuse("agent", name, allowed)

    def tried(one: Player) -> list[judging.Tried]:
        bound = one.at(practice.options)
        rank = getattr(bound, "rank", None)
        played = bound.play(at, [seed]) if rank is None else rank(at, [seed])[0].strokes
        strokes = judging.tried(practice, at, cue_strokes(played, at)[: CONSIDERED * n])
        return judging.distinct(strokes) if distinct else strokes

    judge: Any = {"samples": samples, "visits": visits, "seed": seed}
    strokes = tried(asked)
    chosen, of_agent = judging.fair(practice, strokes, n, **judge), {one.stroke for one in strokes}
    if not chosen:
        strokes += tried(player_of(INSTEAD))
        chosen = judging.fair(practice, strokes, n, **judge)
    chosen = chosen or [judging.least_bad(practice, strokes, **judge)]
    return Advice(
        suggestions=tuple(chosen),
        position=at[0],
        scores=tuple(at.scores[0].tolist()) if at.of_frames else None,
        agent=name,
        own=all(one.stroke in of_agent for one in chosen),
        noise=noise if isinstance(noise, str) else asdict(practice.noise),
        **judge,
    )
