"""Is whatever others give us to read refused in one line that names the file, before it fills the memory?"""

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pytest

import snooker_env as sn
from agents import report
from agents._lib.files import kept_arrays, read_json
from agents.evaluation import tournament_file
from agents.learning.policy_files import read_policy
from agents.learning.run_folder import SETTINGS, keep_settings, kept_settings
from agents.learning.settings import Settings
from agents.players.trained import load_player
from snooker_env._lib.files import MOST_JSON, MOST_NPZ, read_npz, strict_json
from snooker_env.advice import read_strokes
from snooker_env.benchmark import TASKS, Agent, faults, judge
from snooker_env.benchmark.results import read_result
from snooker_env.players.cue_stroke import read_object
from snooker_env.players.saved_models import saved_player
from tests.flips import flipped

JSON = {
    "nothing": b"",
    "no JSON": b"nul",
    "no UTF-8": b'"\xff"',
    "UTF-16": '{"a": 1}'.encode("utf-16"),
    "NaN": b'{"a": NaN}',
    "infinite": b'{"a": -Infinity}',
    "1e999": b'{"a": 1e999}',
    "10^400": b'{"a": 1' + b"0" * 400 + b"}",
    "a key twice": b'{"format": 1, "format": 2}',
    "deep": b"[" * 200_000,
    "objects in objects": b'{"a":' * 40 + b"1" + b"}" * 40,
}
OTHER = {
    "no object": b"[[3]]",
    "a number": b"3",
    "a list as a name": b'{"format": [], "version": 1, "strokes": [], "schema": {"name": []}, "track": {}}',
}
"""Sound, but nothing that a reader looks for."""


def in_folder(name, read):
    """A reader of the file of that name in a folder."""

    def reader(file):
        file.rename(file.with_name(name))
        return read(file.parent)

    return reader


def zip_model(file):
    """The same bytes as the description of a model."""
    content = file.read_bytes()
    with zipfile.ZipFile(file, "w") as made:
        made.writestr("data", content)
    return saved_player(file, {}, True)


def result_of(file):
    """As ``python -m snooker_env.benchmark`` reads it."""
    if wrong := faults(found := read_result(file)):
        raise ValueError(f"{file}: {wrong[0]}")
    return found


READERS = {
    "a position": sn.Position.load,
    "strokes and replays": read_strokes,
    "a result": result_of,
    "a report": report.read,
    "a tournament": lambda file: tournament_file.read_incomplete(file, {}, {}, []),
    "settings of a run": in_folder(SETTINGS, lambda folder: kept_settings(folder, Settings)),
    "a model": zip_model,
}


BARE = {
    "a command's file": lambda file: read_json("file", file, "must be JSON"),
    "the page": lambda file: read_object(file.read_bytes() or b"[]"),
}
"""Readers of any object."""


@pytest.mark.parametrize(
    ("name", "content"),
    [
        pytest.param(name, content, id=f"{name}-{what}")
        for readers, contents in ((READERS, JSON | OTHER), (BARE, JSON))
        for name in readers
        for what, content in contents.items()
    ],
)
def test_json_of_others_is_refused_by_name(tmp_path, name, content):
    file = tmp_path / "mine.json"
    file.write_bytes(content)
    with pytest.raises(ValueError) as refused:
        (READERS | BARE)[name](file)
    said = str(refused.value)
    assert "\n" not in said and len(said) < 700 and (name == "the page" or str(tmp_path) in said)


def test_a_file_without_end_is_not_read_to_it(tmp_path):
    with (tmp_path / "large.json").open("wb") as file:
        file.truncate(MOST_JSON + 1)
    for endless in (tmp_path / "large.json", "/dev/zero"):
        with pytest.raises(ValueError, match=rf"{endless}.*has more than 67,108,864 bytes"):
            sn.Position.load(endless)


def test_numbers_of_json_are_as_they_were():
    """The state of a random generator has integers of 128 bits."""
    state = {"a": [2**128, -(2**128), 0, -0.0, 1e308, 5e-324, 1.5, True, None, "NaN"]}
    assert json.dumps(strict_json(json.dumps(state))) == json.dumps(state)


def test_no_flipped_bit_of_json_that_a_command_goes_on_with_is_used(tmp_path):
    result, run = tmp_path / "result.json", tmp_path / "run"
    made = judge(TASKS["SnookerEscape-v0"], Agent.of("random"), episodes=2, out=result)
    run.mkdir()
    keep_settings(run, Settings(seed=3))
    for file, read in (
        (result, lambda: result_of(result)),
        (run / SETTINGS, lambda: kept_settings(run, Settings)),
    ):
        for _ in flipped(file):
            with pytest.raises(ValueError, match=str(file)):
                read()
    assert read_result(result) == json.loads(json.dumps(made))
    assert kept_settings(run, Settings).seed == 3


# Arrays


def npz(how=zipfile.ZIP_DEFLATED, **parts):
    """An .npz of these bytes."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", how) as made:
        for name, data in parts.items():
            made.writestr(f"{name}.npy", data)
    return file.getvalue()


def npy(array, **changed):
    """The bytes of an .npy, with entries of its header changed."""
    file = io.BytesIO()
    about = {"descr": array.dtype.str, "fortran_order": False, "shape": array.shape}
    np.lib.format.write_array_header_1_0(file, about | changed)
    return file.getvalue() + array.tobytes()


def lying(data, much):
    """A zip whose directory says that its only part has so many bytes."""
    at = data.rindex(b"PK\1\2") + 24
    return data[:at] + much.to_bytes(4, "little") + data[at + 4 :]


ONE = npy(np.arange(3.0))
LARGE = npz(a=npy(np.zeros(MOST_NPZ // 8 + 1)))
NPZ = {
    "nothing": b"",
    "no zip": b"PK\3\4" + bytes(99),
    "large": LARGE,
    "large, and says it is small": lying(LARGE, 100),
    "small, and says it is large": lying(npz(a=ONE), 2**32 - 2),
    "bzip2": npz(zipfile.ZIP_BZIP2, a=ONE),
    "no array": npz(a=b"hello"),
    "more than there is": npz(a=npy(np.arange(3.0), shape=(10**12,))),
    "less than there is": npz(a=npy(np.arange(3.0), shape=(2,))),
    "no size": npz(a=npy(np.arange(3.0), shape=(-1, -3))),
    "objects": npz(a=npy(np.arange(3.0), descr="|O")),
    "nothing each": npz(a=npy(np.arange(0.0), descr="|V0", shape=(10**12,))),
    "a flipped bit": npz(zipfile.ZIP_STORED, a=ONE).replace(ONE, ONE[:-3] + b"\1" + ONE[-2:]),
}
ARRAYS = {
    "arrays": read_npz,
    "a network": lambda file: sn.player(f"stroke_value@{file}"),
    "a policy": lambda file: read_policy(file, "agent"),
    "a player": load_player,
    "data of a run": kept_arrays,
}


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("content", NPZ.values(), ids=NPZ)
@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_of_others_are_refused_by_name(tmp_path, name, content):
    file = tmp_path / "mine.npz"
    file.write_bytes(content)
    tracemalloc.start()
    try:
        with pytest.raises(ValueError) as refused:
            ARRAYS[name](file)
        assert tracemalloc.get_traced_memory()[1] < MOST_NPZ
    finally:
        tracemalloc.stop()
    assert str(file) in str(refused.value) and "\n" not in str(refused.value)


def test_arrays_are_read_as_numpy_reads_them(tmp_path):
    arrays = {
        "a": np.arange(6.0).reshape(2, 3),
        "columns": np.asfortranarray(np.arange(6, dtype=">i2").reshape(2, 3)),
        "none": np.zeros((0, 5), np.float16),
        "number": np.array(3, np.uint8),
        "words": np.array(["a", "bcd"]),
        "rows": np.zeros(2, [("x", "f8"), ("y", "?")]),
    }
    for save in (np.savez, np.savez_compressed):
        save(tmp_path / "a.npz", **arrays)
        with np.load(tmp_path / "a.npz") as by_numpy:
            for name, mine in read_npz(tmp_path / "a.npz").items():
                its = by_numpy[name]
                assert mine.dtype == its.dtype and mine.shape == its.shape and mine.flags.fnc == its.flags.fnc
                assert mine.tobytes() == its.tobytes() and mine.flags.writeable
    file = io.BytesIO()
    np.savez(file, **dict.fromkeys("ab", np.zeros(3)))
    (tmp_path / "b.npz").write_bytes(file.getvalue().replace(b"b.npy", b"a.npy"))
    with pytest.raises(ValueError, match="the key 'a' stands there twice"):
        read_npz(tmp_path / "b.npz")
