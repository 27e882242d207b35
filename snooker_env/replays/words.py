"""What do the referee and the score bar say of each stroke? In plain words, during it and after it."""

from collections.abc import Iterable, Sequence

from ..game.balls import N_REDS, NAMES, BallOn, mask_of_present, points_available
from ..game.frame_columns import BALL_ON
from ..game.ruling import Foul
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


def ball_name(ball: int) -> str:
    """ "red" for each of the reds, "cue ball", else the colour."""
    return "cue ball" if ball == 0 else "red" if ball <= N_REDS else NAMES[ball]


def on_words(ball_on: BallOn) -> str:
    """The ball on in words, e.g. "red", "any colour"; "" if nothing is on."""
    return "" if ball_on == BallOn.NOTHING else ball_on.name.lower().replace("_", " ")


def foul_words(fouls: Foul) -> list[str]:
    """The names of these fouls."""
    return [words for foul, words in FOUL_WORDS.items() if foul & fouls]


def pots_of(shot: Shot) -> list[int]:
    """The balls that were potted, in order of time."""
    return shot.events["i"][shot.events["kind"] == EventKind.POT].tolist()


def sentence(played: Played, players: tuple[str, ...]) -> str:
    """The referee's words after this stroke; ``players``: the names of both in a frame."""
    if played.fouls:
        words = f"Foul, {played.penalty}: {', '.join(foul_words(played.fouls))}"
    elif played.points:
        balls = " and ".join(ball_name(ball) for ball in pots_of(played.shot))
        words = f"{balls[:1].upper()}{balls[1:]} potted, {played.points}"
        if played.break_before:
            words += f", break of {played.break_before + played.points}"
    else:
        words = "Nothing potted"
    if played.winner is not None and len(players) > played.winner:
        winner = played.winner
        words += f". Frame to {players[winner]}, {played.scores[winner]}-{played.scores[1 - winner]}"
    elif played.over and played.next_on == BallOn.NOTHING and not played.fouls:
        words += ". Table cleared"
    return words + "."


def bars(strokes: Iterable[Played], players: Sequence[str]) -> list[tuple[ScoreBar, ScoreBar]]:
    """The bars during and after each stroke of one episode, in order; ``players``: their names."""
    made, names = [], tuple(players)
    potted: list[int] | None = []  # in this break; None: it began before the first recorded stroke
    run = 0
    for played in strokes:
        gains = {played.player: played.points, 1 - played.player: played.penalty}
        scores = tuple(score - gains.get(k, 0) for k, score in enumerate(played.scores))
        if played.break_before != run or not run:
            potted = [] if not played.break_before else None
        here = _start(played)
        before = {
            "players": names,
            "scores": scores if names else (),
            "striker": played.player if names else None,
            "break_points": played.break_before,
            "potted": tuple(potted or ()),
            "reds_left": int(here[1 : N_REDS + 1].sum()),
            "points_on": _left(here, played.ball_on, played.free_ball),
            "ball_on": "free ball" if played.free_ball else on_words(played.ball_on),
        }
        if played.points and potted is not None:
            potted = potted + pots_of(played.shot)
        run = played.break_before + played.points
        after = before | {
            "scores": played.scores if names else (),
            "break_points": run,
            "potted": tuple(potted or ()),
            "reds_left": int(played.on_table[1 : N_REDS + 1].sum()),
            "points_on": _left(played.on_table, played.next_on, played.next_free_ball),
            "ball_on": "free ball" if played.next_free_ball else on_words(played.next_on),
            "words": sentence(played, names),
        }
        made.append((ScoreBar(**before), ScoreBar(**after)))
        run = run if played.points else 0
    return made


def standing_bar(tables: Tables, k: int, players: Sequence[str], last: ScoreBar | None = None) -> ScoreBar:
    """The bar for table k as it stands; ``last``: the bar after the stroke that led there, if known."""
    standing, on_table = tables.standing(k), tables.on_table[k]
    ball_on = BallOn(tables.game[k, BALL_ON])
    goes_on = last is not None and bool(standing["break_points"])
    return ScoreBar(
        players=tuple(players),
        scores=standing["scores"] if players else (),
        striker=standing["next_player"] if players else None,
        break_points=standing["break_points"],
        potted=last.potted if last is not None and goes_on else (),
        reds_left=int(on_table[1 : N_REDS + 1].sum()),
        points_on=_left(on_table, ball_on, standing["next_free_ball"]),
        ball_on="free ball" if standing["next_free_ball"] else on_words(ball_on),
        words=last.words if last is not None else "",
    )


def _start(played):
    """Which balls were on the table when the stroke was played: (22,) bool."""
    here = played.shot.on_table.copy()
    here[pots_of(played.shot)] = True
    return here


def _left(on_table, ball_on, free_ball):
    return points_available(mask_of_present(on_table) & ~1, ball_on, free_ball) if ball_on >= 0 else 0
