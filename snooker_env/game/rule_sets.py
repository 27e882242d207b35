"""Which game is played? What six-red snooker and the Shoot Out change in the rules of a frame, as data.

``docs/environment/rules.md`` says where each rule comes from, what is left out and why."""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from .._lib.check import choice
from .balls import COLOURS_MASK, N_REDS

RulesName: TypeAlias = Literal["snooker", "six_red", "shoot_out"]  # names of the rule sets
SNOOKER, SIX_RED, SHOOT_OUT = range(3)  # codes of the rule sets, for the kernels


@dataclass(frozen=True, kw_only=True)
class RuleSet:
    """What one kind of game changes in the rules of snooker."""

    name: RulesName
    code: int  # for kernels
    reds: int = N_REDS  # in the rack: the first places of the triangle
    most_misses: int = 0  # calls in succession, then no replacement but the cue ball anywhere; 0: no limit
    behind_nominated: bool = False  # snookers behind any nominated ball are fouls: after a red, on pink too
    anywhere: bool = False  # after every foul: in hand, anywhere; no choice, free ball or miss
    cushion: bool = False  # a stroke without a pot must drive a ball, the cue ball included, to a cushion
    clock: int = 0  # simulated time after which the frame ends [ms]; 0: none
    shot_clock: tuple[int, int] = (0, 0)  # [ms] for a stroke in each half of that time

    @property
    def on_table(self) -> int:
        """Mask of the object balls at the start."""
        return COLOURS_MASK | ((2 << self.reds) - 2)


LATE_PENALTY = 5  # least penalty in points for a stroke that was not begun within the shot clock
_SHOT_CLOCK = (15_000, 10_000)
RULE_SETS = (
    RuleSet(name="snooker", code=SNOOKER),
    RuleSet(name="six_red", code=SIX_RED, reds=6, most_misses=5, behind_nominated=True),
    RuleSet(
        name="shoot_out", code=SHOOT_OUT, anywhere=True, cushion=True, clock=600_000, shot_clock=_SHOT_CLOCK
    ),
)
"""All rule sets, by code."""
RULES = get_args(RulesName)  # their names, by code
MOST_MISSES, CLOCK_LIMIT = RULE_SETS[SIX_RED].most_misses, RULE_SETS[SHOOT_OUT].clock
SHOT_CLOCK = RULE_SETS[SHOOT_OUT].shot_clock


def rule_set(name: RulesName) -> RuleSet:
    """The ``RuleSet`` of a name; ValueError for an unknown one."""
    return RULE_SETS[RULES.index(choice("rules", name, RULES))]
