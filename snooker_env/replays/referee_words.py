"""What do the referee and the score bar say of each stroke? In plain words, during it and after it."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..game.balls import N_REDS, NAMES, BallOn, mask_of_present, points_available
from ..game.fouls import Foul
from ..game.frame_columns import BALL_ON
from ..physics.engine import EventKind
from ..render.scene import ScoreBar
from ..simulation import Shot
from ..tasks.played import Played
from ..tasks.tables import Tables

FOUL_WORDS = {
    Foul.NO_CONTACT: "no ball struck",
    Foul.WRONG_FIRST: "wrong ball struck first",
    Foul.WRONG_POT: "wrong ball potted",
    Foul.CUE_POTTED: "in-off",
    Foul.CUE_OFF: "cue ball off the table",
    Foul.BALL_OFF: "ball off the table",
    Foul.JUMP: "jump shot",
    Foul.PUSH: "push stroke",
    Foul.DOUBLE_HIT: "double hit",
    Foul.OUTSIDE_D: "played from outside the D",
    Foul.FEET: "both feet off the floor",
    Foul.OUT_OF_TURN: "played out of turn",
    Foul.BEHIND_FREE_BALL: "snooker behind the free ball",
    Foul.NO_NOMINATION: "no ball nominated",
    Foul.SEVEN: "foul of seven",
    Foul.NO_CUSHION: "no ball reached a cushion",
    Foul.LATE: "not played in time",
}
ERRORS = {
    "none": "none",
    "professional": "a professional's",
    "amateur": "an amateur's",
    "club": "a club player's",
    "beginner": "a beginner's",
    "robot": "a robot's",
    "olympiad": "the Olympiad's robots'",
}
"""Whose execution errors the levels are."""


def ball_name(ball: int) -> str:
    """ "red" for each of the reds, "cue ball", else the colour."""
    return "cue ball" if ball == 0 else "red" if ball <= N_REDS else NAMES[ball]


def on_words(ball_on: BallOn) -> str:
    """The ball on in words, e.g. "red", "any colour"; "" if nothing is on."""
    return "" if ball_on == BallOn.NOTHING else ball_on.name.lower().replace("_", " ")


def foul_words(fouls: Foul) -> list[str]:
    return [words for foul, words in FOUL_WORDS.items() if foul & fouls]


def errors_words(noise: object) -> str:
    """With whose execution errors something was found: those of a level, or others."""
    return "without errors" if noise == "none" else f"with {ERRORS.get(str(noise), 'the given')} errors"


def pots_of(shot: Shot) -> list[int]:
    return shot.events["i"][shot.events["kind"] == EventKind.POT].tolist()


def sentence(played: Played, players: tuple[str, ...]) -> str:
    """The referee's words after this stroke; ``players``: the names of both in a frame."""
    if played.fouls:
        words = f"Foul, {played.penalty}: {', '.join(foul_words(played.fouls))}"
    elif played.points:
        balls = " and ".join(ball_name(ball) for ball in pots_of(played.shot))
        words = f"{balls[:1].upper()}{balls[1:]} potted, {played.points}"
        if played.break_before:
            words += f", break {played.break_before + played.points}"
    else:
        words = "No ball potted"
    if (winner := played.winner) is not None and len(players) > winner:
        who = "you" if players[winner] == "You" else players[winner]
        words += f". Frame to {who}, {played.scores[winner]}-{played.scores[1 - winner]}"
    elif played.over and played.next_on == BallOn.NOTHING and not played.fouls:
        words += ". Table cleared"
    return words + "."


def bars(
    strokes: Iterable[Played], players: Sequence[str], chances: Sequence[float] | None = None
) -> list[tuple[ScoreBar, ScoreBar]]:
    """The bars during and after each of n strokes of one episode; ``chances``: ``Replay.win_chance``, n + 1."""
    made, names = [], tuple(players)
    for one in strokes:
        gains = {one.player: one.points, 1 - one.player: one.penalty}
        scores = tuple(score - gains.get(k, 0) for k, score in enumerate(one.scores))
        here = one.shot.on_table.copy()
        here[pots_of(one.shot)] = True
        on = here, one.ball_on, one.free_ball
        before = _bar(on, names, scores, one.player, one.break_before)
        on, run = (one.on_table, one.next_on, one.next_free_ball), one.break_before + one.points
        made.append((before, _bar(on, names, one.scores, one.player, run, sentence(one, names))))
    if chances is None:
        return made
    kept = zip(made, chances[:-1], chances[1:], strict=True)
    return [(replace(a, win_chance=now), replace(b, win_chance=then)) for (a, b), now, then in kept]


def standing_bar(tables: Tables, k: int, players: Sequence[str], last: ScoreBar | None = None) -> ScoreBar:
    """The bar for table k as it stands; ``last``: the bar after the stroke that led there, if known."""
    now, last = tables.standing(k), last or ScoreBar()
    on = tables.on_table[k], BallOn(tables.game[k, BALL_ON]), now["next_free_ball"]
    of_player = players, now["scores"], now["next_player"], now["break_points"]
    return _bar(on, *of_player, last.words)


def _bar(on, players, scores, striker, break_points, words=""):
    """A bar; without players none of their scores. ``on``: the balls on the table, the ball on, and whether it is free."""
    on_table, ball_on, free_ball = on
    who = (tuple(players), scores, striker) if players else ((), (), None)
    left = points_available(mask_of_present(on_table) & ~1, ball_on, free_ball) if ball_on >= 0 else 0
    return ScoreBar(*who, break_points, left, "free ball" if free_ball else on_words(ball_on), words)
