"""Does a review say what strokes cost? Against ``advise``, and strokes whose costs are known."""

import json
import time
from dataclasses import replace

import pytest

import snooker_env as sn
from snooker_env.advice import CueStroke
from snooker_env.advice.__main__ import main
from snooker_env.advice.recorded import REPLAY, read_document
from snooker_env.advice.review import go_through, read_frame
from snooker_env.play.session import Session
from snooker_env.replays import Replay
from snooker_env.replays.chances import win_chances
from tests.playing import Asked

HOW = {"agent": "tactician_100", "noise": "club", "samples": 60, "seed": 5}
OPTIONS = {"cue": "real", "miss": "clear_path", "game": "snooker"}


@pytest.fixture(scope="module")
def game(tmp_path_factory):
    """What advice says before each stroke of a frame, the replay's file, and who played: the first stroke is the advised one,
    the others are struck anyhow."""
    session, advice = Session(seed=2), []
    session.noise[:] = ["club", "club"]
    for k in range(4):
        if session.frame.phase == "choice":
            session.choose("play")
        advice.append(sn.advise(session.position, n=1, visits=0, options=OPTIONS, **HOW)[0])
        stroke = CueStroke(speed=2.0, aim=1.5 + 0.3 * k) if k else advice[0].stroke
        if stroke.place is not None:
            session.place(*stroke.place)
        session.play(replace(stroke, place=None))
    strokes = [session.acts[k].played for k in session.strokes]
    judge = sn.player("tactician").at(session.options_with("club"))
    file = tmp_path_factory.mktemp("review") / "frame.html"
    Replay(
        strokes, players=("Ann", "Bob"), judge=judge, luck=[act.luck for act in session.acts if act.played]
    ).save(file)
    return advice, file, [one.player for one in strokes]


def reviewed(file, *players, **how):
    *_, (done, total, found) = go_through(
        read_document(file, {REPLAY: read_frame}), players or (0, 1), **HOW | how
    )
    assert done == total and not any(one.rough for one in found.strokes)
    return found


def test_a_review_says_what_advice_says_at_the_same_budget(game):
    """Of the best stroke, and of the advised stroke as it was meant: its choice costs nothing."""
    advice, file, players = game
    found = reviewed(file)
    assert [one.player for one in found.strokes] == players and found.agent == HOW["agent"]
    assert [one.best.win for one in found.strokes] == [one.win for one in advice]
    assert [one.best.stroke for one in found.strokes] == [one.stroke for one in advice]
    first, *others = found.strokes
    # the page plays on a grid, on which the advised stroke lies but for its last digits
    assert abs(first.choice) < 2e-3 and first.meant.win == pytest.approx(advice[0].win, abs=2e-3)
    assert max(one.choice for one in others) > 0.05
    for one in found.strokes:
        assert one.choice == one.best.win - one.meant.win


def test_luck_is_that_of_the_replay_and_the_account_adds_up(game):
    """Whatever the errors of the review; a position that was set up, a decision and a concession are entries, too."""
    _, file, players = game
    kept = read_document(file, {REPLAY: lambda kept: kept})
    told = [sum(luck for luck, by in zip(kept["luck"], players, strict=True) if by == k) for k in (0, 1)]
    for found in (reviewed(file), reviewed(file, 0, noise="amateur", samples=20)):
        assert [side.luck for side in found.sides] == pytest.approx(told) and any(told)
        for one in found.strokes:
            assert one.execution == -kept["luck"][one.number - 1]
            for cost, words in ((0.2, "20 % lost by the execution"), (-0.2, "20 % gained by the execution")):
                assert words in str(replace(one, execution=cost))
        for k, side in enumerate(found.sides):
            own = [one for one in found.strokes if one.player == k]
            assert (side.strokes, side.name) == (len(own), ("Ann", "Bob")[k])
            assert side.choice == pytest.approx(sum(one.choice for one in own)) and side.execution == 0.0
        one, two = (side.luck - side.choice - side.execution + side.other for side in found.sides)
        assert found.result == pytest.approx(found.win_chance[0] + one - two + found.between)
        assert found.adjusted == pytest.approx(found.result - told[0] + told[1])
        (_, start), *changes, (_, end) = found.account
        assert start + sum(share for _, share in changes) == end == round(100 * found.result)
        assert dict(changes)["Bob: luck"] == round(-100 * told[1])
        assert dict(changes)["Ann: choice"] == round(-100 * found.sides[0].choice)
        if found.noise == "club":
            assert found.win_chance[0] == pytest.approx(kept["win_chance"][0])
    assert found.sides[1].strokes == 0 and len(found.win_chance) == 5


def test_what_was_set_up_begins_from_its_own_value_and_a_concession_costs_what_was_left():
    session = Session(seed=4)
    session.play(CueStroke(speed=2.5, aim=1.5))
    position = sn.Position(cue=(0.6, 1.0), pink=(0.6, 1.4), black=(0.0, 1.4605), on="pink")
    session.set_up(position, scores=(0, 6), striker=0, free_ball=False)
    session.play(CueStroke(speed=1.0, aim=-1.57))
    if session.frame.phase == "choice":
        session.choose("play")
    end = session.acts[session.at - 1].standing
    frame = read_frame(Replay([session.acts[k].played for k in session.strokes]).to_dict())
    session.concede()
    steps = go_through(frame, (0,), winner=session.frame.winner, end=end, **HOW)
    *_, (_, _, found) = steps
    judge = sn.player("tactician").at(session.options_with("club"))
    chances = win_chances(judge, [session.acts[2].standing, end])
    assert found.win_chance[1:] == chances
    assert found.result == (session.frame.winner == 0)
    assert abs(found.concession) == pytest.approx(abs(found.result - chances[1])) and found.concession
    loser = ("Player 1", "Player 2")[1 - session.frame.winner]
    changes = dict(found.account)
    assert changes[f"{loser}: concession"] == round(100 * found.concession)
    assert abs(found.between) > 0.02 and changes["between the strokes"] == round(100 * found.between)


def test_what_was_left_is_worth_what_the_stroke_is_worth_without_errors(game, tmp_path):
    """A stroke without errors leaves what its own mean is: the replay and the simulation agree on the chance to win. What
    errors cost is the rest where nobody knows the luck."""
    session = Session(seed=4)
    for aim in (1.5, 1.8, 1.2):
        if session.frame.phase == "choice":
            session.choose("play")
        session.play(CueStroke(speed=2.5, aim=aim))
    file = tmp_path / "frame.json"
    Replay([session.acts[k].played for k in session.strokes]).save(file)
    found = reviewed(file, noise="none")
    assert [one.execution for one in found.strokes] == pytest.approx([0.0] * 3, abs=1e-9)
    assert found.adjusted is None
    untold = read_document(game[1], {REPLAY: read_frame})._replace(luck=None)
    *_, (_, _, found) = go_through(untold, **HOW)
    for one in found.strokes:
        assert one.execution == one.meant.win - one.after
    for side, sign in zip(found.sides, (-100, 100), strict=True):
        assert dict(found.account)[f"{side.name}: execution"] == round(sign * side.execution)
    assert max(abs(side.execution) for side in found.sides) > 0.01


@pytest.mark.parametrize("seat", [0, 1])
def test_on_the_page_the_persons_strokes_alone_are_reviewed(seat):
    game = Asked()
    game("players", players=["person", "ghost_ball"][:: 1 - 2 * seat], noise=["club", "club"])
    game("new", breaker=seat)
    with game.service.acting() as session:
        session.play(CueStroke(speed=3.0, aim=1.5))
        if session.frame.phase == "choice":
            session.choose("play")
        session.play(CueStroke(speed=2.0, aim=1.8))
    game("review", samples=1)
    while game.service.reviewing.running:
        time.sleep(0.05)
    found = game.service.reviewing.found[2]
    assert [(one.number, one.player) for one in found.strokes] == [(1, seat)]
    game.service.close()


@pytest.mark.slow
def test_the_command_prints_the_costliest_and_one_error(game, tmp_path, capsys):
    _, file, _ = game
    asked = f"review {file} --noise club --agent tactician_100 --samples 60 --seed 5".split()
    assert main(asked) == 0
    said = capsys.readouterr().out
    worst = reviewed(file).costliest[0]
    assert f"stroke {worst.number}, " in said and "lost by the choice; the best was " in said
    assert "Ann: luck " in said and "Bob: other " in said and "without luck" in said
    assert main([*asked, "--json", "--player", "1"]) == 0
    assert {one["player"] for one in json.loads(capsys.readouterr().out)["strokes"]} == {1}
    visit = sn.SnookerEnv(action="discrete")
    visit.keep_history = True
    visit.reset(seed=1)
    visit.step(67)
    sn.replay(visit, tmp_path / "visit.json")
    (tmp_path / "no.json").write_text("{}")
    for name, word in (
        ("visit.json", "nobody wins a visit"),
        ("no.json", "must have the format"),
        ("gone", "gone"),
    ):
        assert main(["review", str(tmp_path / name)]) == 2
        error = capsys.readouterr().err
        assert word in error and error.startswith("error: ") and error.count("\n") == 1
    assert main([*asked[:2], "--agent", "planner"]) == 2
    assert "must know frames" in capsys.readouterr().err
