"""Does the referee agree with a file of cases? ``python -m tests.rules_cases FILE`` runs any file of that
schema through the real code.

Prints a line a case and last ``N passed, N failed``; the exit status is 1 if any failed. A case is judged by
its kind: "shot", "option", "claim", "concede", "stalemate", "arithmetic", "spotting" or "snooker_geometry".
Every key of ``expect`` is compared with what the code answers; a key, a field or a kind that is not
understood makes the case fail, so that nothing passes unread.
"""

import json
import re
import sys

from snooker_env.game import balls
from snooker_env.game.fouls import AUTO
from snooker_env.game.frame import Frame
from snooker_env.game.referee import Stroke
from tests.game import geometry_cases
from tests.game.geometry_cases import unknown

PLAYERS = ("A", "B")
CHOICES = {"play": "play", "play_again_as_left": "play_again", "replace_and_replay": "replace"}


def ball_on_of(name):
    return balls.BallOn[name.upper()]


def name_of(ball_on):
    return None if ball_on == balls.BallOn.NOTHING else ball_on.name.lower()


def colours_in(mask):
    return [balls.NAMES[i] for i in balls.ids_of(mask) if i >= balls.YELLOW]


def reds_in(mask):
    return sum(1 <= i < balls.YELLOW for i in balls.ids_of(mask))


def table(reds, colours):
    return balls.mask_of([*range(1, 1 + reds), *map(balls.colour, colours)])


def by_player(pair):
    return dict(zip(PLAYERS, pair, strict=True))


# Strokes


def frame_before(before, miss):
    """The frame that ``before`` describes."""
    on_table = table(before.get("reds", 0), before.get("colours", []))
    scores = before.get("scores", {"A": 0, "B": 0})
    as_said = ("in_hand", "free_ball", "respotted_black", "miss", "rules", "misses", "clock")
    fields = {"in_hand": False, "miss": miss} | {name: before[name] for name in as_said if name in before}
    return Frame(
        scores=tuple(scores[p] for p in PLAYERS),
        striker=PLAYERS.index(before.get("striker", "A")),
        on_table=on_table,
        ball_on=ball_on_of(before["ball_on"]),
        **fields,
    )


def stroke_of(shot, free_ball):
    """The stroke; reds have no names in a file: those that go, or are struck, are the first ones."""
    reds = iter(range(1, 16))

    def ids(names):
        return [balls.CUE if n == "cue" else next(reds) if n == "red" else balls.colour(n) for n in names]

    potted, off = ids(shot["potted"]), ids(shot["forced_off"])
    reds = iter(range(1, 16))
    first = ids(shot["first_contact"])
    reds = iter(range(1, 16))
    touching = balls.mask_of(ids(shot["touching"]))
    chosen = shot.get("free_ball_nominated") if free_ball else shot.get("nominated")
    return Stroke(
        first=balls.mask_of(first),
        potted=balls.mask_of(potted) | (balls.CUE_BIT if shot["cue_potted"] else 0),
        off=balls.mask_of(off),
        touching=touching,
        moved=touching if shot["touching_ball_moved"] else 0,
        # A free ball that nobody nominated is declined; a colour after a red is the one evidently played at.
        nominated=balls.colour(chosen) if chosen else 0 if free_ball else AUTO,
        jump=shot["jump_shot"],
        push=shot["push_stroke"],
        double_hit=shot["double_hit"],
        outside_d=shot["played_from_outside_D"],
        snookered=shot["after"]["next_player_snookered"],
        behind_free_ball=shot["after"]["effective_snookering_ball_is_free_ball"],
        no_cushion=shot.get("no_cushion", False),
    )


SHOT_FIELDS = (
    "nominated free_ball_nominated first_contact touching touching_ball_moved potted cue_potted forced_off "
    "jump_shot push_stroke double_hit played_from_outside_D clear_path_to_ball_on clear_full_ball_path after "
    "attempt no_cushion time_to_play duration"
)
BEFORE_FIELDS = (
    "reds colours ball_on free_ball scores striker in_hand respotted_black rules miss misses clock"
)


def run_shot(case):
    before, shot = case["before"], case["shot"]
    problem = unknown(shot, SHOT_FIELDS) or unknown(before, BEFORE_FIELDS)
    if problem:
        return problem
    frame = frame_before(before, "clear_path" if "foul_and_a_miss" in case["expect"] else "off")
    paths = bool(shot["clear_path_to_ball_on"]), bool(shot["clear_full_ball_path"])
    more = {name: shot[name] for name in ("attempt", "time_to_play", "duration") if name in shot}
    stroke = stroke_of(shot, frame.free_ball)
    after, verdict = frame.play(stroke, clear_path=paths[0], full_ball_path=paths[1], **more)
    answers = {
        "foul": bool(verdict.fouls),
        "penalty_to_opponent": verdict.penalty,
        "points_to_striker": verdict.points,
        "colours_left": colours_in(after.on_table),
        "respotted": colours_in(verdict.respotted),
        "cue_ball_in_hand": verdict.in_hand,
        "free_ball_to_next": verdict.free_ball,
        "respotted_black_procedure": after.phase == "lot",
        "foul_and_a_miss": after.miss_called,
        "choices": list(after.choices),
        "anywhere": after.anywhere,
    }
    return compare(case["expect"], frame_answers(after) | answers)


def compare(expect, answers):
    """The first difference as a sentence, or None. The order of names in a list does not matter."""
    for key, wanted in expect.items():
        if key not in answers:
            return f"not understood: expect.{key}"
        got = answers[key]
        if (sorted(got) != sorted(wanted)) if isinstance(wanted, list) else (got != wanted):
            return f"{key}: expected {wanted!r}, got {got!r}"
    return None


# Decisions between strokes


def refused(act):
    """Whether the code refuses an act."""
    try:
        act()
    except ValueError:
        return True
    return False


def frame_answers(frame):
    """What a frame says of itself, under every name that a case may use."""
    over, reds = frame.phase == "over", reds_in(frame.on_table)
    return {
        "next_striker": None if over or frame.phase == "lot" else PLAYERS[frame.striker],
        "next_ball_on": name_of(frame.ball_on),
        "scores": by_player(frame.scores),
        **dict.fromkeys(("reds", "reds_left"), reds),
        "cue_ball_in_hand": frame.in_hand,
        **dict.fromkeys(("free_ball", "free_ball_to_next"), frame.free_ball),
        "frame_over": over,
        "winner": PLAYERS[frame.winner] if over else None,
    }


def fouled(before):
    """A frame before and after a foul by hitting nothing, in the state of ``before``."""
    ball_on = ball_on_of(before.get("ball_on_before_foul", before.get("ball_on", "red")))
    low = max(ball_on, balls.BallOn.YELLOW)
    on_table = balls.mask_of(range(14 + low, balls.N_BALLS)) | (
        balls.mask_of(range(1, 16)) if ball_on <= balls.BallOn.RED else 0
    )
    offender = PLAYERS.index(before["foul_by"])
    scores = tuple(before.get("scores", {"A": 0, "B": 0})[p] for p in PLAYERS)
    miss = bool(before.get("miss"))
    standing = {"on_table": on_table, "ball_on": ball_on, "in_hand": False}
    start = Frame(scores=scores, striker=offender, miss="clear_path" if miss else "off", **standing)
    # On any colour, the nomination that costs the case's penalty.
    nominated = 14 + max(2, before.get("penalty", 4)) if ball_on == balls.BallOn.ANY_COLOUR else AUTO
    stroke = Stroke(nominated=nominated, snookered=bool(before.get("free_ball")))
    return start, start.play(stroke, clear_path=miss, layout=("the position",))[0]


def fair_strokes(frame):
    """Strokes at each ball on, which is potted."""
    for ball in balls.ids_of(balls.balls_on(frame.ball_on, frame.on_table)):
        named = ball if frame.ball_on == balls.BallOn.ANY_COLOUR else AUTO
        yield Stroke(first=1 << ball, potted=1 << ball, nominated=named)


def run_option(case):
    before, what = case["before"], case["action"]["choice"]
    if what == "miss_again":
        problem = unknown(before, "offender consecutive_misses_from_same_position_full_ball warned")
        if problem:
            return problem
        failures = before["consecutive_misses_from_same_position_full_ball"]
        offender, warned = PLAYERS.index(before["offender"]), before["warned"]
        frame = Frame(striker=offender, miss="clear_path", failures=failures, warned=warned)
        after, _ = frame.play(Stroke(), clear_path=True, full_ball_path=True)
        return compare(case["expect"], frame_answers(after))
    problem = unknown(before, "foul_by ball_on ball_on_before_foul free_ball miss scores penalty")
    if problem or what not in CHOICES:
        return problem or f"not understood: choice {what}"
    start, foul = fouled(before)
    if PLAYERS[foul.striker] != case["action"]["player"]:
        return f"the choice is {PLAYERS[foul.striker]}'s"
    if CHOICES[what] not in foul.choices:
        return f"{what} is not open"
    after = foul.choose(CHOICES[what])
    played = [after.play(stroke)[1] for stroke in fair_strokes(after)]
    free_choice = not any(verdict.fouls for verdict in played)
    restored = (
        (after.on_table, after.saved.layout) == (start.on_table, ("the position",)) if after.saved else False
    )
    answers = frame_answers(after) | {
        "may_change_intended_ball": free_choice,
        "may_score": all(v.points > 0 for v in played),
        "revocable": not refused(lambda: after.choose("play")),
        "position": "as before the stroke (incl. potted balls)" if restored else "as left",
        "nomination_free": after.ball_on == balls.BallOn.ANY_COLOUR and free_choice,
    }
    return compare(case["expect"], answers)


def run_end(case):
    """Kinds "claim" and "concede": an act that the code refuses leaves the frame as it was."""
    before, action = case["before"], case["action"]
    problem = unknown(before, BEFORE_FIELDS)
    if problem:
        return problem
    frame = frame_before(
        {"ball_on": "red", "reds": 15, "colours": list(balls.NAMES[balls.YELLOW :])} | before, "off"
    )
    player = PLAYERS.index(action["player"])
    if action["choice"] == "claim":
        can = player == frame.striker and not refused(frame.claim)
        return compare(case["expect"], frame_answers(frame.claim() if can else frame))
    if action["choice"] == "concede":
        after = frame if refused(lambda: frame.concede(player)) else frame.concede(player)
        return compare(case["expect"], frame_answers(after))
    return f"not understood: choice {action['choice']}"


def run_stalemate(case):
    before = case["before"]
    problem = unknown(before, "scores breaker")
    if problem or case["action"]["choice"] != "restart":
        return problem or f"not understood: choice {case['action']['choice']}"
    breaker, scores = PLAYERS.index(before["breaker"]), tuple(before["scores"][p] for p in PLAYERS)
    frame = Frame(scores=scores, striker=1 - breaker, breaker=breaker, in_hand=False)
    return compare(case["expect"], frame_answers(frame.restart()))


def best_break(free_ball):
    """The points of a visit that pots all there is, always with the black."""
    frame = Frame(free_ball=free_ball)
    while frame.phase == "stroke":
        choosing = frame.free_ball or frame.ball_on == balls.BallOn.ANY_COLOUR
        ball = balls.BLACK if choosing else balls.ids_of(balls.balls_on(frame.ball_on, frame.on_table))[0]
        total = frame.scores[0]
        frame, verdict = frame.play(
            Stroke(first=1 << ball, potted=1 << ball, nominated=balls.BLACK if choosing else AUTO)
        )
        assert frame.scores[0] == total + verdict.points
    return frame.scores[0]


def run_arithmetic(case):
    """The best break that the code allows, with or without a free ball first."""
    title, formula = case["title"].lower(), case["expect"].get("formula", "0")
    if "maximum" not in title or not re.fullmatch(r"(?!.*\*\*)[\d+*() -]+", formula):
        return f"not understood: {title}, {formula}"
    value = best_break("free ball" in title and "without" not in title)
    same = eval(formula) == value
    return compare(case["expect"], {"value": value, "formula": formula if same else "other"})


KINDS = {
    "shot": run_shot,
    "option": run_option,
    "claim": run_end,
    "concede": run_end,
    "stalemate": run_stalemate,
    "arithmetic": run_arithmetic,
    "spotting": geometry_cases.run_spotting,
    "snooker_geometry": geometry_cases.run_snooker_geometry,
}


def run(case):
    """What is wrong with the code's answer to a case, or None."""
    if case["kind"] not in KINDS:
        return f"not understood: kind {case['kind']}"
    try:
        return KINDS[case["kind"]](case)
    except (ValueError, KeyError) as error:
        return f"{type(error).__name__}: {error}"


def main(arguments):
    if len(arguments) != 1:
        print(__doc__)
        return 2
    with open(arguments[0], encoding="utf-8") as file:
        cases = json.load(file)["cases"]
    failed = 0
    for case in cases:
        problem = run(case)
        failed += problem is not None
        print(f"{'FAIL' if problem else 'pass'} {case['id']} {case['kind']}: {case['title']}")
        if problem:
            print(f"     {problem}")
    print(f"{len(cases) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
