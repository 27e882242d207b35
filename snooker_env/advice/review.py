"""What did the strokes of a frame cost, by the choice of them and by their errors? In the chance to win, as ``advise`` sees it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from .._lib.check import integer, refuse, refuse_what
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
SAMPLES = 500  # how often each is played then, unless another number is asked for
LITTLE = 0.015  # share of the chance to win that is not worth a word: so much is sampling error


class Turn(NamedTuple):
    """A stroke of a frame as it was played, and the options but for the noise."""

    number: int
    player: int
    standings: list[Standing]  # the frame before and after it
    seen: Positions  # both, as the player sees them
    meant: CueStroke  # where nobody knows it, as it was played
    noise: Noise
    options: dict[str, Any]


class FrameRecord(NamedTuple):
    """The strokes of a frame, the names of the players, and the luck of each stroke if it is known."""

    turns: list[Turn]
    players: Sequence[str]
    luck: Sequence[float] | None


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
        shares = {"meant": self.meant.figure, "best": self.best.figure}
        return vars(self) | shares | {"name": name_stroke(self.meant), "words": str(self)}

    def __str__(self) -> str:
        costs, better, best, meant = [], "", name_stroke(self.best), name_stroke(self.meant)
        if self.choice >= LITTLE:
            costs.append(f"{percent(self.choice)} thrown away by the choice")
            article = (
                "the" if self.best.kind == "pot" and best[:3] != "red" else "a" + "n" * (best[0] in "aei")
            )
            how = [one for one in _parts(self.best) if one not in _parts(self.meant) and "%" not in one][:2]
            idea = f"{article} {best}" if best != meant else ", ".join(["the same", *how])
            better = f"; the best was {idea}, {percent(self.best.figure)}"
        if abs(self.execution) >= LITTLE:
            way = "lost" if self.execution > 0.0 else "gained"
            costs.append(f"{percent(abs(self.execution))} {way} by the execution")
        return f"stroke {self.number}, {meant}: {', '.join(costs) or 'nothing lost'}{better}"


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

    strokes: list[Reviewed]
    sides: tuple[Side, Side]
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
        lists = {
            "strokes": [one.to_dict() for one in self.strokes],
            "sides": [x._asdict() for x in self.sides],
        }
        return (
            vars(self) | lists | {"adjusted": self.adjusted, "costliest": [x.number for x in self.costliest]}
        )

    def __str__(self) -> str:
        head, rows = ["stroke", "player", "meant", "wins", "best", "choice", "execution", "left"], []
        for one in self.strokes:
            shares = one.meant.figure, one.best.figure, one.choice, one.execution, one.after
            said = [percent(round(share, 2) + 0.0) for share in shares]  # no "-0 %"
            rows.append([str(one.number), self.sides[one.player].name, name_stroke(one.meant), *said])
        lines = [*text_table(head, rows, 3), "", *map(str, self.costliest[:3]), ""]
        for one in self.sides:
            costs = (
                f"; choice cost {percent(one.choice)}, execution {percent(one.execution)}"
                if one.strokes
                else ""
            )
            lines.append(
                f"{one.name}: luck {'not known' if one.luck is None else f'{100 * one.luck:+.0f} %'}{costs}"
            )
        known = (
            "" if self.adjusted is None else f", without luck {percent(min(1.0, max(0.0, self.adjusted)))}"
        )
        return "\n".join([*lines, f"{self.sides[0].name}: result {percent(self.result)}{known}"])


def name_stroke(one: Suggestion) -> str:
    """What a stroke does, in few words."""
    words = _parts(one)
    return f"{words[0]} to the {words[1]}" if one.kind == "pot" else words[0]


def _parts(one: Suggestion) -> list[str]:
    """The words of a stroke, part by part."""
    return one.words.removeprefix("no fair stroke found: ").split("; ")[0].split(", ")


def go_through(
    frame: FrameRecord,
    players: Sequence[int] = (0, 1),
    *,
    winner: int | None = None,
    agent: Any = None,
    noise: NoiseLike | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
) -> Iterator[tuple[int, int, Review]]:
    """Review a frame; yield how many steps are done, of how many, and what is known.

    A rough look at all strokes of the ``players``, with errors of its own, gives their order. Then the costliest first are
    judged as ``advise`` does with ``n=1`` and ``visits=0``."""
    trials = Trials(integer("samples", samples, 1, 100_000), 0, integer("seed", seed, 0, 2**62))
    turns, mine = frame.turns, [one for one in frame.turns if one.player in players]
    if not mine:
        raise refuse("player", players[0], "must have played a stroke of the frame")
    errors = common_noise([one.noise for one in mine]) if noise is None else Noise.of(noise)
    name, asked = name_player(agent, mine[0].seen[:1])
    judge: Any = player_of("tactician").at(practice_of(errors, mine[0].options, of_frames=True).options)
    chances = win_chances(judge, [turns[0].standings[0], *(one.standings[1] for one in turns)])
    found: dict[int, Reviewed] = {}

    def sum_up(player: int) -> Side:
        own = [one for one in found.values() if one.player == player]
        lucks = {k: luck for k, luck in enumerate(frame.luck or (), 1) if turns[k - 1].player == player}
        # under the errors that were made, the execution tells the luck by more samples
        lucks |= {one.number: -one.execution for one in own if turns[one.number - 1].noise == errors}
        choice, execution = (sum(getattr(one, part) for one in own) for part in ("choice", "execution"))
        luck = None if frame.luck is None else sum(lucks.values())
        return Side(frame.players[player], len(own), choice, execution, luck)

    def sum_all() -> Review:
        strokes, result = (
            [found[number] for number in sorted(found)],
            chances[-1] if winner is None else 1.0 - winner,
        )
        how: dict[str, Any] = {"agent": name, "noise": noise_data(errors), "samples": samples, "seed": seed}
        return Review(strokes=strokes, sides=(sum_up(0), sum_up(1)), win_chance=chances, result=result, **how)

    yield 0, 2 * len(mine), sum_all()
    for done, one in enumerate(mine, 1):
        found[one.number] = _judge(one, player_of(ROUGH), errors, Trials(FEW, 0, seed + 1), True)
        yield done, 2 * len(mine), sum_all()
    for done, rough in enumerate(sum_all().costliest, 1 + len(mine)):
        found[rough.number] = _judge(turns[rough.number - 1], asked, errors, trials, False)
        yield done, 2 * len(mine), sum_all()


def _judge(turn: Turn, agent: Player, noise: Noise, trials: Trials, rough: bool) -> Reviewed:
    """A stroke beside the agent's best, both under the same errors."""
    practice, at = practice_of(noise, turn.options, of_frames=True), one_position(turn.seen[:1])
    ((best,), _) = choose_strokes(practice, agent, at, 1, trials, rivals=0)
    (meant,) = judge_strokes(practice, intend(practice, at, [turn.meant]), trials)
    after = float(practice.judge.value_of(lead_of(at), turn.seen[1:].known_to(practice.options.rules))[0, 0])
    costs = {"choice": best.figure - meant.figure, "execution": meant.figure - after}
    return Reviewed(
        number=turn.number, player=turn.player, meant=meant, best=best, after=after, rough=rough, **costs
    )


def common_noise(errors: list[Noise]) -> Noise:
    """The largest errors, and at least a professional's, for whom the tactician has learned; who makes none errs by hand, as
    an amateur."""
    return max(
        *errors, LEVELS["amateur" if any(one.silent for one in errors) else "professional"], key=size_of
    )


def size_of(noise: Noise) -> float:
    """The root mean square error of the direction [deg], lapses included."""
    return noise.direction_deg() * sqrt(1.0 + noise.lapse * (noise.lapse_factor**2 - 1.0))


def read_frame(kept: Mapping[str, Any]) -> FrameRecord:
    """The frame of a replay's data; ValueError unless all strokes are of a frame."""
    if kept["physics"] is None:
        raise refuse("physics", None, "must be the same for all strokes")
    where, out = {"physics": kept["physics"], "table": table_from(kept["table"])}, []
    for k, one in enumerate(kept["strokes"]):
        if one.get("frames") is None:
            raise refuse_what(f"strokes[{k}]", "none of a frame", "must be one: nobody wins a visit")
        before, after = (Frame.from_dict(frame) for frame in one["frames"])
        start, rest, _ = read_balls(one)
        standings = [Standing(before, *start), Standing(after, *rest)]
        seen = positions_of(standings, np.full(2, before.striker), np.array([k, k + 1]))
        cue = one["meant"] or one["cue"] | {"aim": direction_of(one["cue"], Physics.of(where["physics"]))}
        numbers = np.clip([[cue[name] for name in CUE_PARTS]], LEAST, MOST)
        (meant,) = cue_strokes(Strokes(numbers, np.full((1, 2), np.nan)), seen[:1])
        options = {**where, "cue": one["cue_kind"], "miss": before.miss, "game": before.rules}
        out.append(Turn(k + 1, before.striker, standings, seen, meant, Noise.of(one["noise"]), options))
    return FrameRecord(out, kept["players"], kept["luck"])
