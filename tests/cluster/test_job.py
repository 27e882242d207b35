"""Is a job the same in parts as in one go, and does it go on after it was stopped? In this process, without Ray."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from agents.cluster.job import Here, Part, ended, in_order, keys_of
from agents.cluster.keep import Keep, Store, digest_of, keep_arrays, kept_arrays, packed
from agents.evaluation import protocol, visits
from agents.evaluation.entrants import Entrant
from snooker_env import player
from snooker_env._seal import sealed
from snooker_env.benchmark import play_visits
from snooker_env.benchmark.tasks import tables_of
from tests.agents.training import interrupted_at
from tests.cluster.players import AT, same
from tests.flips import flipped
from tests.processes import ROOT


@pytest.mark.parametrize("name", ["random", "ghost_ball", "best_pot_30", "planner_30"])
@pytest.mark.parametrize("rekey", [False, True])
def test_parts_make_what_all_tables_at_once_make(name, rekey, monkeypatch):
    monkeypatch.setattr(visits, "SIZE", 8)
    seeds, agent = tables_of("held_out", 20), Entrant("a", (name,))
    at_once = play_visits(player(name), 20, first_seed=seeds, rekey=0 if rekey else None, **AT)
    (parted,) = protocol.play_agent(agent, AT, seeds, 100, rekey).strokes
    assert same(at_once, parted) and parted.simulated == at_once.simulated


class Sums(Here):
    """Plays parts without a simulator, the last first; ``fails``: at which part, by number."""

    def __init__(self, fails=None):
        super().__init__()
        self.played_parts, self.fails = [], fails

    def played(self, parts):
        for k, (_, _, args) in reversed(list(enumerate(parts))):
            if len(self.played_parts) == self.fails:
                raise KeyboardInterrupt
            self.played_parts.append(args["n"])
            yield k, {"n": np.array(args["n"]), "sum": np.arange(args["n"]).sum()}


PARTS = [Part("visits", "x", {"n": n}) for n in range(6)]
SHARED = {"x": {"weights": b"abc"}}


def sums(results):
    return [one["sum"].item() for one in results]


def test_each_part_is_played_once_and_results_keep_their_order():
    where = Sums()
    numbered = list(ended(PARTS, SHARED, where))
    assert [k for k, _ in numbered] == where.played_parts == [5, 4, 3, 2, 1, 0]
    assert sums(in_order(numbered)) == [0, 0, 1, 3, 6, 10]


@pytest.mark.parametrize("stop", range(6))
def test_a_stopped_job_goes_on_without_playing_anything_twice(tmp_path, stop):
    first, second, third = Sums(fails=stop), Sums(), Sums()
    with pytest.raises(KeyboardInterrupt):
        list(ended(PARTS, SHARED, first, Store(tmp_path)))
    for where in (second, third):
        assert sums(in_order(ended(PARTS, SHARED, where, Store(tmp_path)))) == [0, 0, 1, 3, 6, 10]
    assert sorted(first.played_parts + second.played_parts) == list(range(6))
    assert len(first.played_parts) == stop
    assert not third.played_parts


def test_another_job_is_refused_by_name(tmp_path):
    store, job = Store(tmp_path), {"noise": ["club"], "agents": {"a": "1"}}
    store.join(job)
    list(ended(PARTS, SHARED, Sums(), store))
    store.join(job)
    for change, says in (
        ({"noise": ["none"]}, r'its noise is \["club"\], and \["none"\] is asked for'),
        ({"agents": {"a": "2"}}, "its agents is"),
        ({"rekey": True}, "its rekey is null, and true is asked for"),
    ):
        with pytest.raises(ValueError, match=says):
            store.join(job | change)
    (tmp_path / "job.json").unlink()
    with pytest.raises(ValueError, match=r"holds parts and no job.json"):
        store.join({})
    (tmp_path / "job.json").write_text("{")
    with pytest.raises(ValueError, match="this one is damaged"):
        store.join({})


def test_other_weights_options_or_seeds_are_other_parts():
    def key(kind="visits", name="x", n=1, weights=b"abc"):
        return keys_of([Part(kind, name, {"n": n})], {name: {"weights": weights}})[0]

    assert key() == keys_of([PARTS[1]], SHARED)[0] == key(name="y")
    assert len({key(), key(n=2), key("worths"), key(weights=b"abd")}) == 4


def test_a_damaged_part_is_played_again(tmp_path):
    store, again = Store(tmp_path), Sums()
    list(ended(PARTS, SHARED, Sums(), store))
    whole, pickled, gone = (tmp_path / "parts" / f"{keys_of(PARTS, SHARED)[k]}.npz" for k in (1, 3, 4))
    before = whole.read_bytes()
    whole.write_bytes(before[:-30])
    hidden = packed({"a": np.array([{}], object)})
    pickled.write_bytes(sealed(hidden, pickled.stem))  # it would have to be unpickled
    gone.unlink()
    assert sums(in_order(ended(PARTS, SHARED, again, store))) == [0, 0, 1, 3, 6, 10]
    assert sorted(again.played_parts) == [1, 3, 4] and whole.read_bytes() == before


def test_a_part_under_another_name_is_played_again(tmp_path):
    store, again = Store(tmp_path), Sums()
    list(ended(PARTS, SHARED, Sums(), store))
    one, other = (tmp_path / "parts" / f"{keys_of(PARTS, SHARED)[k]}.npz" for k in (1, 3))
    one.write_bytes(other.read_bytes())
    assert sums(in_order(ended(PARTS, SHARED, again, store))) == [0, 0, 1, 3, 6, 10]
    assert again.played_parts == [1]


def test_no_flipped_bit_of_what_is_kept_is_used(tmp_path):
    """Parts are played again; what describes the job, and the data of a run, are refused by name."""
    store, rows = Store(tmp_path), {"a": np.arange(9.0), "figures": np.array('{"b": 1.25}')}
    store.join({"noise": ["club"], "seed": 3})
    store.write_json("index.json", {"parts": ["a", "b"]})
    store.keep_part("a", rows)
    keep_arrays(tmp_path / "round-0.npz", rows)
    for name in ("job.json", "index.json"):
        for _ in flipped(tmp_path / name):
            with pytest.raises(ValueError, match=rf"{tmp_path}.*{name}"):
                store.read_json(name)
    for _ in flipped(tmp_path / "parts/a.npz"):
        assert store.part("a") is None
    for _ in flipped(tmp_path / "round-0.npz"):
        with pytest.raises(ValueError, match=rf"^out = '{tmp_path}/round-0.npz': must be as it was written"):
            kept_arrays(tmp_path / "round-0.npz")
    assert np.array_equal(store.part("a")["a"], rows["a"]) and store.read_json("job.json")["seed"] == 3
    (tmp_path / "round-0.npz").rename(tmp_path / "round-1.npz")
    with pytest.raises(ValueError, match="was written under another name"):
        kept_arrays(tmp_path / "round-1.npz")


def test_a_full_disk_keeps_what_was_written_and_names_the_file(tmp_path, monkeypatch):
    store, again = Store(tmp_path), Sums()

    def full(source, target):
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match=r"No space left on device.*parts/"):
        for k, _ in ended(PARTS, SHARED, Sums(), store):
            if k == 3:
                monkeypatch.setattr("os.replace", full)
    monkeypatch.undo()
    list(ended(PARTS, SHARED, again, store))
    assert sorted(again.played_parts) == [0, 1, 2]


def test_an_evaluation_goes_on_from_what_it_kept(tmp_path, monkeypatch, capsys):
    """By the command: interrupted, then given again, then with another option."""
    monkeypatch.setattr(visits, "SIZE", 5)
    command = str.split("--agent random --visits 20 --layouts held_out --noise professional --resamples 200")
    plain, kept = tmp_path / "plain.json", tmp_path / "kept.json"
    assert protocol.main([*command, "--json", str(plain)]) == 0
    calls = interrupted_at(monkeypatch, visits, "play_visits", 6)
    command += ["--keep", str(tmp_path / "parts")]
    capsys.readouterr()
    assert protocol.main([*command, "--json", str(kept)]) == 130
    said = capsys.readouterr().err
    assert f"what was played is kept in {tmp_path / 'parts'}, the same command goes on" in said
    assert not kept.exists()
    assert protocol.main([*command, "--json", str(kept)]) == 0 and len(calls) == 6 + 3
    one, two = (json.loads(file.read_text())["results"] for file in (plain, kept))
    for row in (*one, *two):
        del row["ms_a_decision"]
    assert one == two
    with pytest.raises(SystemExit):
        protocol.main([*command, "--rekey"])
    assert "its rekey is false, and true is asked for" in capsys.readouterr().err


ABOUT = {"command": "agents.evaluate", "noise": ["club"]}
HOLDS = f"""
import sys
from agents.cluster.keep import Keep
with Keep(None, "local", {ABOUT!r}) as keep:
    keep.store.write("parts/a.npz", b"a")
    print(keep.store, flush=True)
    if sys.stdin.readline() == "complete\\n":
        keep.done()
"""


@pytest.fixture
def holder(tmp_path, monkeypatch):
    """Another process with the same job, in whose folder is a part; and that folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", HOLDS], **pipes)
    yield process, tmp_path / process.stdout.readline().strip()
    process.kill()
    process.communicate()


def test_a_job_that_another_process_plays_is_refused_by_its_name(holder):
    process, folder = holder
    says = rf"keep = '.*{folder.name}'.*: process {process.pid} on .* does.*give another --keep"
    with pytest.raises(ValueError, match=says) as error:
        Keep(None, "10.0.0.1:6379", ABOUT)  # wherever it is played
    assert "\n" not in str(error.value) and (folder / "parts" / "a.npz").read_bytes() == b"a"
    other = ABOUT | {"noise": ["none"]}
    for url, address, about in (("other", "local", ABOUT), (None, "local", other), (None, None, ABOUT)):
        with Keep(url, address, about) as keep:
            assert keep.store is None or Path(keep.store.url).resolve() != folder.resolve()


@pytest.mark.parametrize("end", ["complete", "stopped", "killed"])
def test_its_folder_is_free_then_and_gone_when_it_is_complete(holder, end):
    process, folder = holder
    if end == "killed":
        process.kill()
    process.communicate(f"{end}\n")
    assert process.returncode == (-9 if end == "killed" else 0)
    assert list(folder.parent.iterdir()) == ([] if end == "complete" else [folder])
    with Keep(None, "local", ABOUT) as keep:
        assert Path(keep.store.url).resolve() == folder.resolve()
        assert keep.store.names("parts") == (set() if end == "complete" else {"a.npz"})
        keep.done()
    assert not list(folder.parent.iterdir())


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs").write_text("a file")
    with pytest.raises(ValueError, match=r"keep = .*must be a folder or URL that can be written"):
        Keep(None, "local", ABOUT)


def test_digests_know_bytes_from_texts():
    assert len({digest_of({"a": value}) for value in (b"1", "1", 1)} | {digest_of({"a": [b"1"]})}) == 4
