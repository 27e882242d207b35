"""Who sits at a frame's table? A seat: how actions are read, with which errors executed, who decides."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from .box_actions import Actions
from .discrete_actions import Choices
from .noise import Noise
from .opponents import Opponent

if TYPE_CHECKING:
    from .options import Rules


@dataclass(frozen=True)
class Seat:
    """One side of frames; ``player`` None: whoever calls ``Frames`` decides."""

    actions: Actions | Choices
    noise: Noise
    player: Opponent | None = None

    @classmethod
    def of(cls, rules: "Rules", player: Opponent | None = None) -> "Seat":
        """The seat with the actions and errors of ``rules``."""
        return cls(rules.actions, rules.noise, player)

    def packed(self, rules: "Rules") -> tuple[Any, Any, Any]:
        """``Rules.packed`` with this seat's actions and errors."""
        return replace(rules, actions=self.actions, noise=self.noise).packed()
