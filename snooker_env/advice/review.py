"""What did the strokes of a frame cost? Choice and errors, in the chance to win that ``advise`` counts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import radians, sqrt
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
from .outcomes import Suggestion, Trials, judge_strokes
from .practice import one_position, practice_of
from .recorded import CUE_PARTS, call_pot, direction_of, read_balls
from .stroke_words import POCKET_WORDS, ball_name, percent

ROUGH, FEW = "tactician_100", 50
"""Who is asked in the first look at all strokes, and how often each is played."""
SAMPLES = 500  # how often each is played then, unless another number is asked for
MISSED = radians(1.0)  # a stroke whose line is so near to that of a pot was meant to pot
LITTLE = 0.015  # share of the chance to win that is not worth a word: so much sampling makes of 5 % of choices (benchmarks.page)


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
    """A stroke beside the agent's best, in the chance to win of its player; ``rough``: by few samples."""

    number: int
    player: int
    meant: Suggestion
    best: Suggestion
    after: float  # what the stroke left as it was played
    choice: float  # the cost of the choice: the best's mean less its own
    execution: float  # the cost of its errors: the luck with the other sign; if that is not known, its mean less what it left
    pot: str  # the pot that it was likely meant for although it misses without errors, in words; "" for none
    rough: bool

    @property
    def name(self) -> str:
        return f"missed pot, {self.pot}" if self.pot else name_stroke(self.meant)

    @property
    def cost(self) -> float:
        """By what strokes are ordered: the losses alone."""
        return max(0.0, self.choice) + max(0.0, self.execution)

    def to_dict(self) -> dict[str, Any]:
        shares = {"meant": self.meant.figure, "best": self.best.figure}
        return vars(self) | shares | {"name": self.name, "words": str(self)}

    def __str__(self) -> str:
        costs, better, best, meant = [], "", name_stroke(self.best), name_stroke(self.meant)
        if self.choice >= LITTLE:
            costs.append(f"{percent(self.choice)} lost by the choice")
            alone = self.best.kind == "pot" and not best.startswith("red")
            article = "the" if alone else "an" if best[0] in "aei" else "a"
            how = [one for one in _parts(self.best) if one not in _parts(self.meant) and "%" not in one][:2]
            idea = f"{article} {best}" if best != meant else ", ".join(["the same", *how])
            better = f"; the best was {idea}, {percent(self.best.figure)}"
        if abs(self.execution) >= LITTLE:
            way = "lost" if self.execution > 0.0 else "gained"
            costs.append(f"{percent(abs(self.execution))} {way} by the execution")
        return f"stroke {self.number}, {self.name}: {', '.join(costs) or 'nothing lost'}{better}"


class Side(NamedTuple):
    """A player's sums, in their own chance to win: all their strokes gained luck - choice - execution + other."""

    name: str
    strokes: int  # that were reviewed
    choice: float
    execution: float  # of the strokes whose luck is not known
    luck: float | None  # of all strokes; None if not known
    other: float  # how much more the best strokes were worth than the position, and strokes that were not reviewed


@dataclass(frozen=True, kw_only=True)
class Review:
    """What is known of a frame: its reviewed strokes in order, and both players' sums."""

    strokes: list[Reviewed]
    sides: tuple[Side, Side]
    win_chance: list[float]  # of the first player, before each stroke, and at the end, before a concession
    between: float  # gained for the first player by decisions and set-ups between the strokes
    result: float  # 1 if the first player won, else its last chance
    agent: str
    noise: str | dict[str, float]
    samples: int
    seed: int

    @property
    def adjusted(self) -> float | None:
        """The result less the first player's luck, plus the other's: right on average, so it may leave [0, 1]."""
        one, other = (side.luck for side in self.sides)
        return None if one is None or other is None else self.result - one + other

    @property
    def concession(self) -> float:
        """What the first player gained by a concession, negative if they conceded."""
        return self.result - self.win_chance[-1]

    @property
    def account(self) -> list[tuple[str, int]]:
        """The first player's chance at the start, all that changed it, and the result [%]: the changes add up."""
        start, end = (round(100 * share) for share in (self.win_chance[0], self.result))
        names, rows, loser = [side.name for side in self.sides], {}, int(self.concession > 0.0)
        for k, (one, sign) in enumerate(zip(self.sides, (100, -100), strict=True)):
            parts = {"choice": -one.choice if one.strokes else None, "luck": one.luck}
            parts |= {"execution": -one.execution or None, "other": one.other}
            rows |= {(k, name): round(sign * share) for name, share in parts.items() if share is not None}
        ends = ((None, "between the strokes"), self.between), ((loser, "concession"), self.concession)
        rows |= {who: round(100 * gained) for who, gained in ends if round(100 * gained)}
        rows[0, "other"] += end - start - sum(rows.values())  # rounding must not spoil the sum
        said = [(what if k is None else f"{names[k]}: {what}", share) for (k, what), share in rows.items()]
        return [("start", start), *said, ("end", end)]

    @property
    def costliest(self) -> list[Reviewed]:
        return sorted(self.strokes, key=lambda one: -one.cost)

    def to_dict(self) -> dict[str, Any]:
        told = {"adjusted": self.adjusted, "concession": self.concession, "account": self.account}
        strokes, sides = [one.to_dict() for one in self.strokes], [one._asdict() for one in self.sides]
        told |= {"strokes": strokes, "sides": sides}
        return vars(self) | told | {"costliest": [one.number for one in self.costliest]}

    def __str__(self) -> str:
        head, rows = ["stroke", "player", "meant", "wins", "best", "choice", "execution", "left"], []
        for one in self.strokes:
            shares = one.meant.figure, one.best.figure, one.choice, one.execution, one.after
            said = [percent(round(share, 2) + 0.0) for share in shares]  # no "-0 %"
            rows.append([str(one.number), self.sides[one.player].name, one.name, *said])
        lines = [*text_table(head, rows, 3), "", *map(str, self.costliest[:3]), ""]
        head = ["", *(side.name for side in self.sides)]
        (start, *changes, end), rows = self.account, []
        for name, share in changes:
            rows.append([name, f"{share:+} %", f"{-share:+} %"])
        ends = ([name, f"{share} %", f"{100 - share} %"] for name, share in (start, end))
        lines += text_table(head, [next(ends), *rows, next(ends)], 1)
        said = f"{self.sides[0].name}: result {percent(self.result)}"
        if self.adjusted is not None:
            said += f", without luck {percent(min(1.0, max(0.0, self.adjusted)))}"
        return "\n".join([*lines, said])


def name_stroke(one: Suggestion) -> str:
    """What a stroke does, in few words."""
    words = _parts(one)
    if one.kind == "foul":
        return ", ".join(words[:2])
    return f"{words[0]} to the {words[1]}" if one.kind == "pot" else words[0]


def _parts(one: Suggestion) -> list[str]:
    return one.words.removeprefix("no fair stroke found: ").split("; ")[0].split(", ")


def go_through(
    frame: FrameRecord,
    players: Sequence[int] = (0, 1),
    *,
    winner: int | None = None,
    end: Standing | None = None,
    agent: Any = None,
    noise: NoiseLike | None = None,
    samples: int = SAMPLES,
    seed: int = 0,
) -> Iterator[tuple[int, int, Review]]:
    """Review a frame; yield how many steps are done, of how many, and what is known. A rough look at all strokes of the
    ``players`` gives their order; then ``advise`` judges, the costliest first, with ``n=1`` and ``visits=0``. ``end``: the
    frame before the loser conceded; None: as the last stroke left it."""
    trials = Trials(integer("samples", samples, 1, 100_000), 0, integer("seed", seed, 0, 2**62))
    turns, mine = frame.turns, [one for one in frame.turns if one.player in players]
    if not mine:
        raise refuse("player", players[0], "must have played a stroke of the frame")
    errors = common_noise([one.noise for one in mine]) if noise is None else Noise.of(noise)
    name, asked = name_player(agent, mine[0].seen[:1])
    judge: Any = player_of("tactician").at(practice_of(errors, mine[0].options, of_frames=True).options)
    last = turns[-1].standings[1] if end is None else end
    stood = [standing for one in turns for standing in one.standings]
    chances = np.array(win_chances(judge, [*stood, last]))
    gains, between = np.diff(chances)[::2], float(np.diff(chances)[1::2].sum())
    found: dict[int, Reviewed] = {}
    told = {one.number: frame.luck[one.number - 1] for one in turns if frame.luck and not one.noise.silent}

    def sum_up(player: int) -> Side:
        own = [one for one in found.values() if one.player == player]
        numbers = [one.number for one in turns if one.player == player]
        choice = sum(one.choice for one in own)
        execution = sum(one.execution for one in own if one.number not in told)
        luck = sum(told.get(number, 0.0) for number in numbers)
        gained = float(sum(gains[number - 1] for number in numbers)) * (-1.0 if player else 1.0)
        other = gained - luck + choice + execution
        return Side(frame.players[player], len(own), choice, execution, luck if frame.luck else None, other)

    def sum_all() -> Review:
        strokes = [found[number] for number in sorted(found)]
        shares = [*chances[:-1:2].tolist(), float(chances[-1])]
        how: dict[str, Any] = {"agent": name, "noise": noise_data(errors), "samples": samples, "seed": seed}
        how |= {"result": shares[-1] if winner is None else 1.0 - winner, "between": between}
        return Review(strokes=strokes, sides=(sum_up(0), sum_up(1)), win_chance=shares, **how)

    yield 0, 2 * len(mine), sum_all()
    for done, one in enumerate(mine, 1):
        found[one.number] = _judge(one, player_of(ROUGH), errors, Trials(FEW, 0, seed + 1), told, True)
        yield done, 2 * len(mine), sum_all()
    for done, rough in enumerate(sum_all().costliest, 1 + len(mine)):
        found[rough.number] = _judge(turns[rough.number - 1], asked, errors, trials, told, False)
        yield done, 2 * len(mine), sum_all()


def _judge(
    turn: Turn, agent: Player, noise: Noise, trials: Trials, luck: Mapping[int, float], rough: bool
) -> Reviewed:
    """A stroke beside the agent's best, both under the same errors; ``luck`` by number, where it is known."""
    practice, at = practice_of(noise, turn.options, of_frames=True), one_position(turn.seen[:1])
    ((best,), _) = choose_strokes(practice, agent, at, 1, trials, rivals=0)
    (meant,) = judge_strokes(practice, intend(practice, at, [turn.meant]), trials)
    after = float(practice.judge.value_of(lead_of(at), turn.seen[1:].known_to(practice.options.rules))[0, 0])
    execution = -luck[turn.number] if turn.number in luck else meant.figure - after
    pot = None if meant.kind == "pot" else call_pot(at[0], turn.meant.aim, MISSED)
    return Reviewed(
        number=turn.number,
        player=turn.player,
        meant=meant,
        best=best,
        after=after,
        choice=best.figure - meant.figure,
        execution=execution,
        pot=f"{ball_name(pot[0])} to the {POCKET_WORDS[pot[1]]}" if pot else "",
        rough=rough,
    )


def common_noise(errors: list[Noise]) -> Noise:
    """The largest errors, at least a professional's (the tactician learned so); who has none counts as an amateur."""
    least = LEVELS["amateur" if any(one.silent for one in errors) else "professional"]
    # by the root mean square error of the direction, lapses included
    return max(
        [*errors, least],
        key=lambda one: one.direction_deg() * sqrt(1.0 + one.lapse * (one.lapse_factor**2 - 1.0)),
    )


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
