"""Is what makes no sense in planning refused by name: strokes, rows, keys, positions, aims, budgets?"""

import json

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env import planning
from snooker_env.benchmark import count_shots
from snooker_env.planning import FrameJudge, Planner, Position, Positions, Search, Strokes, VisitJudge
from tests.planning.test_position import FULL
from tests.refusals import refuse_each, refused

GOOD = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)], black=(0.0, 1.4605)).to_dict()
AT = Position(cue=(0.0, -0.5), reds=[(0.3, 0.3)])
STROKE, SOFT = [[0.0, 0.0, 0.0, 0.2]], [2.0, 0.0, 0.0, 0.3, 0.0]
SILENT, CLUB, CHOICES = Planner({}), Planner({"noise": "club"}, threads=1), Planner({"action": "discrete"})

PLANNED = """
club(strokes=[SOFT]) | keys | None | must be given with execution noise
club(strokes=[SOFT], keys=[1], errors=[[0] * 5]) | keys, errors | both | must
club(strokes=[SOFT], errors=[[0] * 4]) | errors | array of shape (1, 4) | must
club(strokes=[SOFT], errors=[[NAN] * 5]) | errors[0, 0] | nan | must be finite
club(strokes=[SOFT[:4]], keys=[1]) | strokes | float64 array of shape (1, 4) | must be real
club(strokes=[[9.0, *SOFT[1:]]], keys=[1]) | strokes[0], speed | 9.0 | must be a finite number
club(strokes=[[2.0, 0.0, NAN, 0.0, 0.0]], keys=[1]) | strokes[0], top | nan | must
club(strokes=[[2.0, 0.6, 0.0, 0.0, 0.0]], keys=[1]) | strokes[0], side | 0.6 | must
club(strokes=[[2.0, 0.0, 0.0, INF, 0.0]], keys=[1]) | strokes[0], aim | inf | must
club(strokes=[[2.0, 0.0, 0.0, 0.0, -0.1]], keys=[1]) | strokes[0], elevation | -0.1 | must
play(AT, [?], STROKE) | rows[0] | ? | must be an integer in [0, 0] | 1; -1
play(AT, [0.0], STROKE) | rows | float64 array | must
play(AT, [[0]], STROKE) | rows | int64 array of shape (1, 1) | must
play(AT, [0, 0], STROKE) | actions | array of shape (1, 4) | must
play(AT, [0], [[0.0, 0.0, 0.0]]) | actions | array of shape (1, 3) | must
play(AT, [0], [[0.0, 0.0, 0.0, ?]]) | actions[0] | ? | must be finite | NAN; 1.1
play(AT, [0], [["a", "b", "c", "d"]]) | actions | a | must
play(AT, [0], STROKE, [1, 2]) | keys | array of shape (2,) | must
play(AT, [0], STROKE, [-1]) | keys | array of object | must be 1 integers
play(AT, [0], STROKE, [0.5]) | keys | array of object | must
play(AT, [0], STROKE, np.array([-1])) | keys | negative numbers | must be 1
play(None, [0], STROKE) | positions | a NoneType | must be Positions, a Position
play([], [0], STROKE) | positions | a list | must be Positions, a Position
play({"points": 1}, [0], STROKE) | state | a dict without | must
chosen([540]) | actions[0] | 540 | must
chosen([0.5]) | actions | array of float64 | must
chosen([[0, 1]]) | actions | array of | must
row("positions", (1, 0), NAN) | positions[2], ball 1 | nan | must be finite
row("positions", 1, (0.0, -0.5)) | positions[2] | balls 0 and 1 | over
row("positions", (1, 0), 0.9) | positions[2][1] | (0.9, 0.3) | overlaps the
row("on_table", 0, False) | positions[2].cue | None | must be on the table
row("game", 0, 9) | positions[2].ball_on | 9 | must be in [-1, 7]
row("game", 0, ?) | positions[2].ball_on | ' | must name balls | 7; -1
row("game", 2, 200) | positions[2].points | 200 | must
row("game", 3, 1) | positions[2].over | True | must be False: the visit has
Planner({"aim": "north"}) | aim | 'north' | must
Planner({}, threads=0) | threads | 0 | must
Planner({}, noise="loud") | noise | 'loud' | must
Planner(?) | env_or_options | a  | must be an environment of snooker_env | CARTPOLE; None; 3; "Snooker-v0"
action([2.0, 0.0, 0.0, 0.3, 0.2]) | elevation | 0.2 | must be left out
action(SOFT) | strokes[0] | [2.0, 0.0, 0.0, 0.3, 0.0] | must be a stroke along one of the lines of aim="pot"
action(?) | strokes[0] | [ | **snooker_env.players.VISITS | SOFT; [6.0, 0.0, 0.0, 0.3, 0.0]; [2.0, 0.4, 0.0, 0.3, 0.0]
action([2.0, 0.0, 0.0, 0.3, 0.2]) | elevation | 0.2 | **snooker_env.players.VISITS
action(SOFT, aim="target") | aim[0] | 0.3 | must be within 3 degrees of the target
action(SOFT, aim="target") | aim[0] | 0.3 | **snooker_env.players.VISITS
action(SOFT, action="discrete") | options.action | 'discrete' | **snooker_env.players.VISITS
Strokes([SOFT]).actions(sn.Options(), MANY[[0, 0]]) | positions | 2 positions | must be 1, one for each stroke
Strokes([SOFT])[0] | rows | 0 | must be a slice, a mask or an array of rows
aim(rows=[1]) | rows[0] | 1 | must
aim(balls=[?]) | balls[0] | ? | must be an integer in [1, 21] | 0; 22
aim(balls=[2]) | balls[0] | 2 | must be on the table
aim(balls=[1.0]) | balls | float64 array | must
aim(targets=[0.8, 0.8]) | targets | array | must
aim(strokes=-1.0) | strokes[0], speed | -1.0 | must
aim(strokes=[1.0, 2.0]) | strokes | array | must
aim(strokes=[[2.3, 0.6, 0.0, 0.0, 0.0]]) | strokes[0], side | 0.6 | must
aim(strokes=[[2.3, 0.0, 0.0, 0.0, 2.0]]) | strokes[0], elevation | 2.0 | must
aim(ghosts=[[NAN, 0.0]]) | ghosts[0, 0] | nan | must
pots(AT, most=0) | most | 0 | must
VisitJudge({}, threads=0) | threads | 0 | must
VisitJudge(3) | env_or_options | a int | must be an environment
Search({}) | judge | a dict | must be a VisitJudge or a FrameJudge
Search(JUDGE, ?) | budget | ? | must | 7; -1; 30.0; "30"; None
Search(JUDGE).rank(3, [1]) | positions | a int | must be Positions, a Position
Search(JUDGE).rank(MANY[:2], ?) | seeds | array of shape | must be integers of shape (2,) | [1]; 1; [[1, 2]]; [1.0, 2.0]; [True, False]
Search(JUDGE).rank(spoilt("on_table", 0, False), [1, 2, 3, 4]) | positions[2].cue | None | must
Search(JUDGE).rank(spoilt("game", 3, 1), [1, 2, 3, 4]) | positions[2].over | True | must
Search(FRAMES).rank(AT, [0]) | positions | those of visits | must be of frames
Search(FRAMES, propose=(at_pots, at_pots)).rank(FRAME, [0]) | propose | 2 generators | must be one
"""


def test_what_cannot_be_planned_is_refused():
    def spoilt(part, at, value):
        positions = Positions.of([AT] * 4)
        getattr(positions, part)[2][at] = value
        return positions

    def row(*change):
        SILENT.play(spoilt(*change), [0, 1, 2, 3], STROKE * 4)

    pot = {"positions": Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)]), "rows": [0], "balls": [1]}
    pot |= {"targets": [(0.8, 0.8)], "strokes": 2.3}
    assert SILENT.pot_aim(**pot).shape == (1,)
    judge, frames = VisitJudge({}, threads=1), FrameJudge({"task": "frame"}, lambda some: np.zeros(len(some)))
    names = vars(planning) | globals() | {"NAN": np.nan, "INF": np.inf}
    names |= {"CARTPOLE": gymnasium.make("CartPole-v1"), "MANY": Positions.of([AT] * 4)}
    names |= {"JUDGE": judge, "FRAMES": frames, "spoilt": spoilt, "row": row, "play": SILENT.play}
    frame = sn.SnookerEnv(task="frame")
    frame.reset(seed=1)
    names |= {"FRAME": Positions.of(frame)}
    names |= {"club": lambda **passed: CLUB.play_strokes(AT, [0], **passed)}
    names |= {"chosen": lambda choice: CHOICES.play(AT, [0], choice)}
    at = Positions.of(AT)
    names |= {"action": lambda one, **options: Strokes([one]).actions(sn.Options(**options), at)}
    names |= {"aim": lambda **changes: SILENT.pot_aim(**pot | changes)}
    before = count_shots()
    refuse_each(PLANNED, names)
    assert count_shots() == before
    none = SILENT.play(AT, [], np.zeros((0, 4)))  # no strokes are no error
    assert {len(part) for part in none} == {0} and none.observations.shape == (0, 121)
    assert Search(judge).rank(Positions.of([AT])[np.zeros(0, int)], np.zeros(0, int)) == []


POSITIONS = """
words(reds=[(0.1, -1.21)]) | reds[0] | (0.1, -1.21) | overlaps cue at (0.1, -1.2) by 0.0425 m
words(pink=(0.0, 1.44)) | black | (0.0, 1.4605) | overlaps pink
words(blue=(0.88, 0.5)) | blue | (0.88, 0.5) | overlaps the cushion at x = 0.889
words(yellow=(3.0, 0.0)) | yellow | (3.0, 0.0) | must be on the table
words(green=(-0.889, -1.7845)) | green | (-0.889, -1.7845) | is over a pocket
words(black=(NAN, 0.0)) | black[0] | nan | must
words(brown=3.0) | brown | shape () | must
words(cue="centre") | cue | centre | must
words(reds=[(0.04 * k - 0.5, 0.3) for k in range(16)]) | reds | 16 places | must be at most 15
Position(cue=(0.1, 0.2)) | reds and colours | no ball | must hold at least one
words(on="puce") | on | 'puce' | must be one of
words(on="black") | on | 'black' | must be 'red' or 'any_colour'
words(on="blue") | on | 'blue' | must name balls of which one
words(reds=[], on="black") | on | 'black' | must be 'any_colour' or 'pink'
words(cue=None) | cue | None | must be on the table
words(reds=[], pink=None, black=None) | reds and colours | no ball | must hold at least one
words(points=156) | points | 156 | must
words(in_hand=1) | in_hand | 1 | must be True or False
words(in_hand=True, cue=(0.0, 0.0)) | in_hand | True | must be False with the cue ball at
words(table="oval") | table | 'oval' | must
words(yellow=(0.834, -1.766), table="tight") | yellow | (0.834, -1.766) | overlaps
said(reds=[[0.5, 0.5], [0.52, 0.5]]) | reds[1] | overlaps reds[0] | at most 1e-06
said(whit=[0, 0]) | key of position | whit | 'cue'
said(cue=[0.0, True]) | cue | True | must be two real numbers
said(reds=[[0.5, 0.5], [False, 1]]) | reds | False | must be two real numbers for each ball
said(cue=[0.0]) | cue | shape (1,) | must have shape (2,)
said(cue="middle") | cue | middle | must be real numbers
said(points=1.5) | points | 1.5 | must be an integer
Positions.of({"cue": (0.0, 0.0), "blak": (0.0, 1.0)}) | key of position | blak | 'black'
Positions.of({"on_table": []}) | state | a dict without ['positions' | must be a state of get_state() of a visit
arrays(positions=np.zeros((2, 21, 2))) | positions | array of shape | must
arrays(positions=np.full((2, 22, 2), NAN)) | positions[0, 0, 0] | nan | must
arrays(on_table=np.zeros((2, 22))) | on_table | float64 array | must
arrays(on_table=np.zeros((1, 22), bool)) | on_table | bool array of shape | must
arrays(game=np.zeros((2, 4), int)) | game | int64 array of shape | must
arrays(game=np.zeros((2, 5))) | game | float64 array | must
"""


def test_positions_that_cannot_be_are_refused(tmp_path):
    whole = {
        "positions": np.zeros((2, 22, 2)),
        "on_table": np.zeros((2, 22), bool),
        "game": np.zeros((2, 5), int),
    }
    names = vars(planning) | globals() | {"NAN": np.nan, "words": lambda **words: Position(**FULL | words)}
    names |= {"said": lambda **words: Position.from_dict(GOOD | words)}
    refuse_each(POSITIONS, names | {"arrays": lambda **changes: Positions(*(whole | changes).values())})
    with pytest.raises(TypeError, match=r"argument 'red'; the reds are one list, reds=\[\(x, y\), \.\.\.\]"):
        Position(cue=(0.0, 0.2), red=(0.1, 0.3))
    assert Position(**FULL, yellow=(5.0, 5.0), table=None).yellow == (5.0, 5.0)
    file = tmp_path / "wrong.json"
    for change, field, value, allowed in (
        ({"points": 1.5}, f"{file}: points", "1.5", "must be an integer"),
        ({"whit": [0, 0]}, f"key of {file}", "whit", "'cue'"),
        ({"black": [3.0, 0.0]}, f"{file}: black", "3.0", "must be on the table"),
    ):
        file.write_text(json.dumps(GOOD | change))
        refused(lambda: Position.load(file), field, value, allowed)
    with pytest.raises(OSError):
        Position.load(tmp_path / "none.json")


def test_an_unsound_table_is_refused_only_if_it_is_played():
    at = Positions.of([AT] * 4)
    at.positions[2][1] = 0.9
    assert len(SILENT.play(at, [0, 1, 3], STROKE * 3).points) == 3
    with pytest.raises(ValueError, match=r"positions\[2\]\[1\]"):
        SILENT.play(at, [0, 1, 2, 3], STROKE * 4)
