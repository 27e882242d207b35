"""Is a position kept in a file as it was, or not at all, and is any other file refused by name?"""

import json

import pytest

from snooker_env.planning import Position, Positions
from tests.refusals import refused

BALLS = {"cue": (0.1, -1.2), "reds": [(0.3, 0.5), (1 / 3, -0.7)], "black": (0.0, 1.4605)}
POSITION = Position(**BALLS, on="any_colour", points=9, in_hand=True)


def test_a_file_holds_the_position_to_the_last_bit_on_any_table(tmp_path):
    file = tmp_path / "one.json"
    POSITION.save(file)
    assert Position.load(file) == POSITION and Position.load(str(file)) == POSITION
    assert json.loads(file.read_text()) == POSITION.to_dict() and file.stat().st_size < 300
    assert [p.name for p in tmp_path.iterdir()] == ["one.json"]
    far = Position(cue=(0.0, 0.0), black=(3.0, 0.0), table=None)
    far.save(tmp_path / "far.json")
    assert Position.load(tmp_path / "far.json", table=None) == far
    refused(lambda: Position.load(tmp_path / "far.json"), "black", "3.0", "must be on the table")


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    file = tmp_path / "one.json"
    POSITION.save(file)
    monkeypatch.setattr(Position, "to_dict", lambda self: {"cue": object()})
    with pytest.raises(TypeError):
        Position(cue=(0.0, 0.0), black=(0.0, 1.0)).save(file)
    monkeypatch.undo()
    assert Position.load(file) == POSITION and len(list(tmp_path.iterdir())) == 1
    with pytest.raises(OSError, match="nowhere"):
        POSITION.save(tmp_path / "nowhere" / "one.json")


GOOD = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)], black=(0.0, 1.4605)).to_dict()
WRONG = [
    ({"reds": [[0.5, 0.5], [0.52, 0.5]]}, "reds[1]", "overlaps reds[0]", "at most 1e-06"),
    ({"whit": [0, 0]}, "key of position", "whit", "'cue'"),
    ({"cue": [0.0, True]}, "cue", "True", "must be two real numbers"),
    ({"reds": [[0.5, 0.5], [False, 1]]}, "reds", "False", "must be two real numbers for each ball"),
    ({"cue": [0.0]}, "cue", "shape (1,)", "must have shape (2,)"),
    ({"cue": "middle"}, "cue", "middle", "must be real numbers"),
    ({"points": 1.5}, "points", "1.5", "must be an integer"),
]


@pytest.mark.parametrize(("change", "field", "value", "allowed"), WRONG, ids=[str(w[0]) for w in WRONG])
def test_what_is_wrong_is_named(tmp_path, change, field, value, allowed):
    refused(lambda: Position.from_dict(GOOD | change), field, value, allowed)
    file = tmp_path / "wrong.json"
    file.write_text(json.dumps(GOOD | change))
    refused(lambda: Position.load(file), field if "key" not in field else f"key of {file}", value, allowed)


def test_what_is_no_json_is_refused(tmp_path):
    file = tmp_path / "wrong.json"
    for text in ("", "{", "\ud800".encode("utf-8", "surrogatepass"), "[" * 100_000):
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        refused(lambda: Position.load(file), "path", str(file), "must be a file of JSON")
    for text in ("[]", "3", '"black"'):
        file.write_text(text)
        refused(lambda: Position.load(file), str(file), "a ", "must be a dict with keys of cue")
    file.write_text('{"cue": [0, 0], "cue": [0.1, 0], "black": [0, 1]}')
    refused(lambda: Position.load(file), "key of the position", "'cue'", "must be there once")
    file.write_text('{"cue": [0, NaN], "black": [0, 1]}')
    refused(lambda: Position.load(file), "cue", "nan", "must be finite")
    with pytest.raises(OSError):
        Position.load(tmp_path / "none.json")


def test_a_position_in_words_is_taken_wherever_a_state_is():
    assert Positions.of(GOOD)[0] == Position.from_dict(GOOD) and len(Positions.of([GOOD, POSITION])) == 2
    wrong = {"cue": (0.0, 0.0), "blak": (0.0, 1.0)}
    refused(lambda: Positions.of(wrong), "key of position", "blak", "'black'")
    missing = "a dict without ['positions'", "must be a state of get_state() of a visit"
    refused(lambda: Positions.of({"on_table": []}), "state", *missing)
