"""What did the strokes of a frame cost, by the choice of them and by their errors? In the chance to win, as ``advise`` sees it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import refuse, refuse_what
from .._lib.text_tables import text_table
from ..game.frame import Frame
from ..physics.parameters import Physics
from ..planning import Positions
from ..planning.stroke_columns import LEAST, MOST
from ..planning.worth import lead_of
from ..players import Player, Strokes
from ..players import player as player_of
from ..players.cue_stroke import CueStroke, cue_strokes
from ..replays.chances import Standing, positions_of, win_chances
from ..replays.encode import noise_data, table_from
from ..tasks.noise import LEVELS, Noise, NoiseLike
from .ask import choose_strokes, name_player
from .intentions import intend
from .outcomes import Trials, judge_strokes
from .practice import one_position, practice_of
from .recorded import CUE_PARTS, direction_of, read_balls
from .stroke_words import percent
from .suggestions import Suggestion

ROUGH, FEW = (
    "tactician_100",
    50,
)  # who is asked in the first look at all strokes, and how often each is played
LITTLE = 0.005  # share of the chance to win that is not worth a word
SAMPLES = 500  # unless another number is asked for
JUDGE = "tactician"


class Turn(NamedTuple):
    """A stroke of a frame as it was played, the frame before and after it, and the options but for the noise."""

    number: int
    player: int
    standings: list[Standing]
    seen: Positions  # both, as the player sees them
    meant: CueStroke  # where nobody knows it, as it was played
    noise: Noise
    options: dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Reviewed:
    """A stroke beside the agent's best one, in the chance to win of who played it; ``rough``: by few samples."""

    number: int
    player: int
    meant: Suggestion
    best: Suggestion
    after: float  # what the stroke left as it was played
    choice: float  # what it cost to mean it: the best's mean less its own
    execution: float  # what its errors cost: its mean, less what it left
    rough: bool

    @property
    def cost(self) -> float:
        """By what strokes are ordered: the losses alone."""
        return max(0.0, self.choice) + max(0.0, self.execution)

    def to_dict(self) -> dict[str, Any]:
        """As JSON types, with words."""
        both = {"meant": self.meant.to_dict(), "best": self.best.to_dict(), "words": str(self)}
        return vars(self) | both | {"names": [name_stroke(self.meant), name_stroke(self.best)]}

    def __str__(self) -> str:
        costs = []
        if self.choice >= LITTLE:
            costs.append(f"{percent(self.choice)} thrown away by the choice")
        if abs(self.execution) >= LITTLE:
            what = "lost" if self.execution > 0.0 else "gained"
            costs.append(f"{percent(abs(self.execution))} {what} by the execution")
        said = f"stroke {self.number}, {name_stroke(self.meant)}: {', '.join(costs) or 'nothing lost'}"
        best = name_stroke(self.best)
        article = (
            "the"
            if self.best.kind == "pot" and not best.startswith("red")
            else "a" + "n" * (best[0] in "aei")
        )
        better = f"; the best was {article} {best}, {percent(self.best.figure)}"
        return said + better * (self.choice >= LITTLE)


class Side(NamedTuple):
    """The sums of a player: costs of its ``strokes`` reviewed, and the luck of all its strokes, None if nobody knows it."""

    name: str
    strokes: int
    choice: float
    execution: float
    luck: float | None


@dataclass(frozen=True, kw_only=True)
class Review:
    """What is known of a frame: strokes in their order, so far as they were looked at, and both players' sums."""

    strokes: tuple[Reviewed, ...]
    sides: tuple[Side, ...]
    win_chance: list[float]  # of the first player, before the first stroke and after each
    result: float  # 1 if the first player won, else its last chance
    agent: str
    noise: str | dict[str, float]
    samples: int
    seed: int

    @property
    def adjusted(self) -> float | None:
        """The result less the luck of the first player, plus that of the other: on average right, so it may leave [0, 1]."""
        one, other = (side.luck for side in self.sides)
        return None if one is None or other is None else self.result - one + other

    @property
    def costliest(self) -> list[Reviewed]:
        """The strokes, those that cost most first."""
        return sorted(self.strokes, key=lambda one: -one.cost)

    def to_dict(self) -> dict[str, Any]:
        """As JSON types."""
        own = {"adjusted": self.adjusted, "costliest": [one.number for one in self.costliest]}
        own |= {"sides": [one._asdict() for one in self.sides]}
        return vars(self) | own | {"strokes": [one.to_dict() for one in self.strokes]}

    def __str__(self) -> str:
        head = ["stroke", "player", "meant", "best", "wins", "wins", "choice", "execution", "left"]
        rows = []
        for one in self.strokes:
            shares = (one.meant.figure, one.best.figure, one.choice, one.execution, one.after)
            names = self.sides[one.player].name, name_stroke(one.meant), name_stroke(one.best)
            rows.append([str(one.number), *names, *map(percent, shares)])
        lines = [*text_table(head, rows, 4), "", *map(str, self.costliest[:3]), ""]
        for one in self.sides:
            sums = f"choice cost {percent(one.choice)}, execution {percent(one.execution)} in {one.strokes} strokes"
            luck = "not known" if one.luck is None else f"{100.0 * one.luck:+.0f} %"
            lines.append(f"{one.name}: luck {luck}" + f"; {sums}" * (one.strokes > 0))
        if self.adjusted is not None:
            lines.append(
                f"{self.sides[0].name}: result {percent(self.result)}, without luck {percent(self.adjusted)}"
            )
        return "\n".join(lines)


def name_stroke(one: Suggestion) -> str:
    """What a stroke does, in few words."""
    words = one.words.removeprefix("no fair stroke found: ").split("; ")[0].split(", ")
    return f"{words[0]} to the {words[1]}" if one.kind == "pot" else words[0]


def go_through(
    kept: Mapping[str, Any],
    players: tuple[int, ...] = (0, 1),
    *,
    winner: int | None = None,
    agent: Any = None,
    noise: NoiseLike | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
) -> Iterator[tuple[int, int, Review]]:
    """Review a replay's data; yield how many steps are done, of how many, and what is known.

    A first, rough look at the strokes of the ``players``, with errors of its own, gives their order: the costliest are then
    judged first, as ``advise`` does with ``n=1`` and ``visits=0``."""
    turns = read_turns(kept)
    mine = [one for one in turns if one.player in players]
    if not mine:
        raise refuse("player", players[0], "must have played a stroke of the frame")
    errors = common_noise([one.noise for one in mine]) if noise is None else Noise.of(noise)
    name, asked = name_player(agent, mine[0].seen[:1])
    judge: Any = player_of(JUDGE).at(practice_of(errors, mine[0].options, of_frames=True).options)
    chances = win_chances(judge, [turns[0].standings[0], *(one.standings[1] for one in turns)])
    found: dict[int, Reviewed] = {}

    def sum_up(player: int) -> Side:
        own = [one for one in found.values() if one.player == player]
        # of errors as they were played the execution tells the luck by more samples
        lucks = {k: luck for k, luck in enumerate(kept["luck"] or (), 1) if turns[k - 1].player == player}
        lucks |= {
            one.number: -one.execution for one in own if lucks and turns[one.number - 1].noise == errors
        }
        choice, execution = (sum(getattr(one, part) for one in own) for part in ("choice", "execution"))
        luck = sum(lucks.values()) if kept["luck"] else None
        return Side(
            name=kept["players"][player], strokes=len(own), choice=choice, execution=execution, luck=luck
        )

    def sum_all() -> Review:
        strokes = tuple(found[number] for number in sorted(found))
        result = chances[-1] if winner is None else 1.0 - winner
        how: dict[str, Any] = {"agent": name, "noise": noise_data(errors), "samples": samples, "seed": seed}
        sides = sum_up(0), sum_up(1)
        return Review(strokes=strokes, sides=sides, win_chance=chances, result=result, **how)

    yield 0, 2 * len(mine), sum_all()
    for done, one in enumerate(mine, 1):
        found[one.number] = _judge(one, player_of(ROUGH), errors, Trials(FEW, 0, seed + 1), True)
        yield done, 2 * len(mine), sum_all()
    for done, rough in enumerate(sum_all().costliest, 1 + len(mine)):
        one = turns[rough.number - 1]
        found[one.number] = _judge(one, asked, errors, Trials(samples, 0, seed), False)
        yield done, 2 * len(mine), sum_all()


def _judge(turn: Turn, agent: Player, noise: Noise, trials: Trials, rough: bool) -> Reviewed:
    """A stroke beside the agent's best, both under the same errors."""
    practice, at = practice_of(noise, turn.options, of_frames=True), one_position(turn.seen[:1])
    ((best,), _) = choose_strokes(practice, agent, at, 1, trials, rivals=0)
    (meant,) = judge_strokes(practice, intend(practice, at, [turn.meant]), trials)
    after = float(practice.judge.value_of(lead_of(at), turn.seen[1:].known_to(practice.options.rules))[0, 0])
    costs = {"choice": best.figure - meant.figure, "execution": meant.figure - after}
    own: dict[str, Any] = {"number": turn.number, "player": turn.player, "rough": rough}
    return Reviewed(meant=meant, best=best, after=after, **costs, **own)


def common_noise(errors: list[Noise]) -> Noise:
    """The largest errors, and at least a professional's, for whom the tactician has learned; who makes none errs by hand, as
    an amateur."""
    least = LEVELS["amateur" if any(one.silent for one in errors) else "professional"]
    return max(
        *errors,
        least,
        key=lambda one: one.direction_deg() * sqrt(1.0 + one.lapse * (one.lapse_factor**2 - 1.0)),
    )


def read_turns(kept: Mapping[str, Any]) -> list[Turn]:
    """The strokes of a replay's data; ValueError unless all are of a frame."""
    if kept["physics"] is None:
        raise refuse("physics", None, "must be the same for all strokes")
    where, out = {"physics": kept["physics"], "table": table_from(kept["table"])}, []
    for k, one in enumerate(kept["strokes"], 1):
        if one.get("frames") is None:
            raise refuse_what(f"strokes[{k - 1}]", "none of a frame", "must be one: nobody wins a visit")
        start, rest, _ = read_balls(one)
        frames = [Frame.from_dict(frame) for frame in one["frames"]]
        standings = [Standing(*both) for both in ((frames[0], *start), (frames[1], *rest))]
        player = frames[0].striker
        seen = positions_of(standings, np.full(2, player), np.array([k - 1, k]))
        cue = one["meant"] or one["cue"] | {"aim": direction_of(one["cue"], Physics.of(where["physics"]))}
        numbers = np.clip([cue[name] for name in CUE_PARTS], LEAST, MOST)
        (meant,) = cue_strokes(Strokes(numbers[None], np.full((1, 2), np.nan)), seen[:1])
        options = {**where, "cue": one["cue_kind"], "miss": frames[0].miss, "game": frames[0].rules}
        out.append(Turn(k, player, standings, seen, meant, Noise.of(one["noise"]), options))
    return out
