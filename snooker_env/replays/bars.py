"""What does the score bar show? During each stroke, and after the referee's decision."""

from collections.abc import Iterable, Sequence

from ..game.balls import N_REDS, BallOn, mask_of_present, points_available
from ..game.frame_columns import BALL_ON
from ..render.scene import ScoreBar
from ..tasks.played import Played
from ..tasks.tables import Tables
from .words import on_words, pots_of, sentence


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
