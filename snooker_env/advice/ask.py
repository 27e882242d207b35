"""What would a player do here, and what would come of it? ``advise``: ranked strokes; ``stroke_of``: the one that it would play."""

from dataclasses import asdict
from typing import Any

from .._check import integer
from ..planning.positions import PositionsLike
from ..tasks.noise import NoiseLike
from . import judging
from .players import player_of
from .practice import one_position, practice_of
from .strokes import CueStroke
from .suggestions import Advice

LOOKED_AT = 8
"""Of a player's ranking so many times the strokes wanted are looked at, to find so many that differ."""


def advise(
    position: PositionsLike, *, agent: Any = "lookahead", noise: NoiseLike = "professional", n: int = 5, samples: int = 200,
    visits: int = 40, seed: int = 0, options: Any = None, distinct: bool = True, trust: bool = False,
) -> Advice:  # fmt: skip
    """The strokes that a player would play at a position, best first, and what comes of each under errors of execution.

    The order is the player's own. What comes of a stroke is found in the same way for every player: the stroke is played ``samples``
    times, all strokes under the same errors, and judged as one of a visit. Then ``visits`` of the visits that go on are played to their
    end by a quick player (``snooker_env.advice.visits``), who looks one stroke ahead, but less well than the built-in lookahead: the points
    are what a good player makes of the position, and those of different agents' strokes can be compared.

    A state carries its noise stream: a state that is restored and played again meets the same errors again. Advice never uses it. The
    errors are drawn from ``seed`` alone: the same seed gives the same advice, another one other samples.

    Parameters
    ----------
    position : Position, dict, state, Positions or environment
        One position, as ``Positions.of`` takes it, or ``Position.to_dict()``. With the cue ball in hand places in the D are tried, and
        each stroke has its ``place``. Points of the visit so far do not count.
    agent : str, path or player
        Whom to ask, see ``player_of``.
    noise : str, dict or Noise
        Errors of execution, to choose and to judge strokes by.
    n : int
        How many strokes at most.
    samples : int
        How often each is played. Without noise once is enough.
    visits : int
        How many visits of each are played on, at most one a sample that goes on; 0: the points are those of the stroke itself.
    seed : int
    options : mapping or Options, optional
        "physics", "table" and "fidelity" of the world. None: those of ``position`` if it is an environment, else the defaults.
    distinct : bool
        Whether of strokes that read the same, but for the speed of a pot, only the first is given.
    trust : bool
        See ``player_of``.

    Returns
    -------
    Advice
        A sequence of ``Suggestion``.

    Raises
    ------
    ValueError
        If an argument is none of these, or there is no stroke to play.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> advice = sn.advise(position, agent="ghost_ball", n=1, samples=50, visits=5)
    >>> advice[0].ball, sn.POCKETS[advice[0].pocket], advice[0].chance > 0.9
    (21, 'top left', True)
    """
    integer("n", n, 1, 100)
    integer("samples", samples, 1, 100_000)
    integer("visits", visits, 0, 100_000)
    integer("seed", seed, 0, 2**63)
    at, practice, player = one_position(position), practice_of(noise, options, position), player_of(agent, trust=trust)
    ranked = player.rank(practice, at, n, seed)[: LOOKED_AT * n]
    if distinct:
        ranked = judging.distinct(practice, at, ranked)
    chosen = judging.judged(practice, at, ranked[:n], samples=samples, visits=visits, seed=seed)
    said = noise if isinstance(noise, str) else asdict(practice.noise)
    return Advice(
        suggestions=tuple(chosen), position=at[0], agent=player.name, noise=said, samples=samples, visits=visits, seed=seed
    )  # fmt: skip


def stroke_of(player: Any, position: PositionsLike, *, noise: NoiseLike = "professional", options: Any = None, seed: int = 0) -> CueStroke:
    """The one stroke that a player would play at a position.

    Parameters
    ----------
    player : str, path or player
        As ``player_of`` takes it; what it gives saves time when it is asked again.
    position, noise, options, seed
        As of ``advise``.

    Returns
    -------
    CueStroke
        With a place in the D if the cue ball is in hand.

    Raises
    ------
    ValueError
        As ``advise``.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import stroke_of
    >>> stroke_of("ghost_ball", sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))).speed
    2.3
    """
    integer("seed", seed, 0, 2**63)
    (stroke, _), *_ = player_of(player).rank(practice_of(noise, options, position), one_position(position), 1, seed)
    return stroke
