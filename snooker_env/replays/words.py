"""What does the referee say after a stroke? One sentence in plain words, and the names of the fouls."""

from ..game.balls import N_REDS, NAMES, BallOn
from ..game.ruling import Foul
from ..physics.engine import EventKind
from ..simulation import Shot
from ..tasks.played import Played

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
