"""Which game is played? Snooker, six-red snooker or the Shoot Out: what each changes in the rules of a frame,
as data.

``docs/environment/rules.md`` says where each rule comes from, what is left out and why. Kernels know a rule
set by its ``code``.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from .._check import choice
from .balls import COLOURS_MASK, N_REDS

RulesName: TypeAlias = Literal["snooker", "six_red", "shoot_out"]
"""Names of the rule sets."""

SNOOKER, SIX_RED, SHOOT_OUT = range(3)
"""Codes of the rule sets, for the kernels."""


@dataclass(frozen=True, kw_only=True)
class RuleSet:
    """What one kind of game changes in the rules of snooker.

    Attributes
    ----------
    name : {"snooker", "six_red", "shoot_out"}
        Its name.
    code : int
        Its number, for kernels.
    reds : int
        Reds in the rack at the start: the first ``reds`` places of the triangle.
    most_misses : int
        Foul-and-a-miss calls in succession after which the position is not replaced again, and the
        non-offender may place the cue ball anywhere instead; 0 for no limit.
    behind_nominated : bool
        A snooker behind a nominated ball is a foul at any time: behind a colour nominated after a red, too,
        and with pink and black.
    anywhere : bool
        After every foul the opponent plays from in hand, from anywhere on the table: no choice, no free ball
        and no miss.
    cushion : bool
        A stroke that pots no ball must drive a ball, the cue ball included, to a cushion.
    clock : int
        Simulated time after which the frame ends [ms]; 0 for none.
    shot_clock : tuple of int
        Longest time to play a stroke in the first and in the second half of that time [ms]; zeros for none.

    Examples
    --------
    >>> from snooker_env.game.rule_sets import rule_set
    >>> rule_set("six_red").reds, rule_set("shoot_out").shot_clock
    (6, (15000, 10000))
    """

    name: RulesName
    code: int
    reds: int = N_REDS
    most_misses: int = 0
    behind_nominated: bool = False
    anywhere: bool = False
    cushion: bool = False
    clock: int = 0
    shot_clock: tuple[int, int] = (0, 0)

    @property
    def on_table(self) -> int:
        """Mask of the object balls at the start."""
        return COLOURS_MASK | ((2 << self.reds) - 2)


LATE_PENALTY = 5
"""Least penalty in points for a stroke that was not begun within the shot clock."""

RULE_SETS = (
    RuleSet(name="snooker", code=SNOOKER),
    RuleSet(name="six_red", code=SIX_RED, reds=6, most_misses=5, behind_nominated=True),
    RuleSet(
        name="shoot_out",
        code=SHOOT_OUT,
        anywhere=True,
        cushion=True,
        clock=600_000,
        shot_clock=(15_000, 10_000),
    ),
)
"""All rule sets, by code."""
RULES = get_args(RulesName)
"""Their names, by code."""

MOST_MISSES = RULE_SETS[SIX_RED].most_misses
CLOCK_LIMIT = RULE_SETS[SHOOT_OUT].clock
SHOT_CLOCK = RULE_SETS[SHOOT_OUT].shot_clock
"""The same numbers for the kernels."""


def rule_set(name: RulesName) -> RuleSet:
    """The ``RuleSet`` of a name.

    Parameters
    ----------
    name : {"snooker", "six_red", "shoot_out"}
        Its name.

    Returns
    -------
    RuleSet
        The rule set.

    Raises
    ------
    ValueError
        For an unknown name.

    Examples
    --------
    >>> from snooker_env.game.rule_sets import rule_set
    >>> rule_set("snooker").reds
    15
    """
    return RULE_SETS[RULES.index(choice("rules", name, RULES))]
