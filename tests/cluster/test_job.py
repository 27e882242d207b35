"""Is a job the same in parts as in one go, and does it go on after it was stopped? Without Ray: every part is played in this process."""

import json
from dataclasses import fields

import numpy as np
import pytest

from agents.cluster.job import Here, Job, Part, digest_of
from agents.cluster.store import Folder, packed, unpacked
from agents.evaluation import protocol, visits
from agents.evaluation.entrants import Entrant
from agents.players.by_name import player_of
from snooker_env.benchmark import play_visits, tables_of

AT = {"layout": "held_out", "noise": "professional", "fidelity": "standard", "physics": "paper"}


def same(a, b):
    """All that does not measure time."""
    names = [f.name for f in fields(a) if f.name not in ("decision_seconds", "simulated")]
    return all(np.array_equal(getattr(a, name), getattr(b, name), equal_nan=name == "cue") for name in names)


@pytest.mark.parametrize("name", ["random", "random_absolute", "ghost_ball", "best_pot_30", "planner_30"])
@pytest.mark.parametrize("rekey", [False, True])
def test_parts_make_what_all_tables_at_once_make(name, rekey, monkeypatch):
    """Also for players that draw for all tables: they are told which of them are theirs."""
    monkeypatch.setattr(visits, "SIZE", 8)
    seeds, agent = tables_of("held_out", 20), Entrant("a", (name,))
    whole = player_of(name, seed=0)
    if rekey:
        whole = visits.Rekeyed(whole, 0, 0, 20)
    at_once = play_visits(whole, 20, first_seed=seeds, physics="paper", layout="held_out", noise="professional", fidelity="standard")
    (parted,) = protocol.play_agent(agent, AT, seeds, 100, 100, rekey).strokes
    assert same(at_once, parted) and parted.simulated == at_once.simulated


class Sums(Here):
    """Plays parts without a simulator; ``fails``: at which part, by number."""

    def __init__(self, fails=None, width=1):
        super().__init__()
        self.played, self.fails, self.width = [], fails, width

    def wait(self, submitted):
        return submitted[::-1][: self.width]  # the last first

    def get(self, submitted):
        n = submitted.given["n"]
        if len(self.played) == self.fails:
            raise KeyboardInterrupt
        self.played.append(n)
        return {"n": np.array(n), "sum": np.arange(n).sum()}


PARTS = [Part("visits", "x", {"n": n}) for n in range(6)]
SHARED = {"x": {"weights": b"abc"}}


@pytest.mark.parametrize("width", [1, 3, 100])
def test_each_part_is_played_once_and_results_keep_their_order(width):
    where, told = Sums(width=width), []
    job = Job(PARTS, SHARED, where, tick=lambda part, result: told.append(part.given["n"]))
    assert [one["sum"].item() for one in job.take(PARTS[:4])] == [0, 0, 1, 3]
    assert [one["n"].item() for one in job.take(PARTS[4:])] == [4, 5]
    assert sorted(where.played) == sorted(told) == list(range(6))
    with pytest.raises(KeyError, match="more often than it was announced"):
        job.take(PARTS[:1])


def test_equal_parts_are_played_once_and_taken_by_each_that_asks():
    """Two labels for one agent."""
    where, told = Sums(), []
    job = Job([*PARTS[:2], *PARTS[:2]], SHARED, where, tick=lambda part, result: told.append(part))
    assert job.total(lambda part: 1) == 4
    assert [one["n"].item() for _ in range(2) for one in job.take(PARTS[:2])] == [0, 1, 0, 1]
    assert where.played == [0, 1] and len(told) == 4


@pytest.mark.parametrize("stop", range(6))
def test_a_stopped_job_goes_on_without_playing_anything_twice(tmp_path, stop):
    store, first = Folder(tmp_path / "kept"), Sums(fails=stop)
    with pytest.raises(KeyboardInterrupt):
        Job(PARTS, SHARED, first, store, {"command": "x"}).take(PARTS)
    second, told = Sums(), []
    results = Job(PARTS, SHARED, second, Folder(tmp_path / "kept"), {"command": "x"}, lambda part, result: told.append(part)).take(PARTS)
    assert [one["sum"].item() for one in results] == [0, 0, 1, 3, 6, 10] and len(told) == 6
    assert sorted(first.played + second.played) == list(range(6)) and len(first.played) == stop
    third, seen = Sums(), []
    Job(PARTS, SHARED, third, Folder(tmp_path / "kept"), {"command": "x"}, lambda part, result: seen.append(result["n"].item())).finish()
    assert not third.played and sorted(seen) == list(range(6))


def test_what_ended_beside_a_failure_is_kept(tmp_path):
    class Failing(Sums):
        def get(self, submitted):
            if submitted.given["n"] == 2:
                raise RuntimeError("a fault")
            return super().get(submitted)

    with pytest.raises(RuntimeError, match="a fault"):
        Job(PARTS, SHARED, Failing(width=6), store := Folder(tmp_path), {"command": "x"}).take(PARTS)
    assert len(store.names("parts")) == 5


def test_another_job_is_refused_by_name(tmp_path):
    store = Folder(tmp_path)
    Job(PARTS, SHARED, Sums(), store, {"noise": ["club"], "agents": {"a": "1"}}).finish()
    for about, says in (
        ({"noise": ["none"], "agents": {"a": "1"}}, r'its noise is \["club"\], and \["none"\] is asked for'),
        ({"noise": ["club"], "agents": {"a": "2"}}, "its agents is"),
        ({"noise": ["club"], "agents": {"a": "1"}, "rekey": True}, "its rekey is null, and true is asked for"),
    ):
        with pytest.raises(ValueError, match=says):
            Job(PARTS, SHARED, Sums(), store, about)
    (tmp_path / "job.json").unlink()
    with pytest.raises(ValueError, match=r"holds parts and no job.json"):
        Job(PARTS, SHARED, Sums(), store, {})
    (tmp_path / "job.json").write_text("{")
    with pytest.raises(ValueError, match="this one is damaged"):
        Job(PARTS, SHARED, Sums(), store, {})


def test_other_weights_options_or_seeds_are_other_parts():
    key = lambda part, shared=SHARED: Job([part], shared, Sums()).key(part)  # noqa: E731
    first = key(PARTS[1])
    assert first == key(Part("visits", "x", {"n": 1})) == key(Part("visits", "y", {"n": 1}), {"y": {"weights": b"abc"}})
    others = [key(PARTS[2]), key(Part("worths", "x", {"n": 1})), key(PARTS[1], {"x": {"weights": b"abd"}})]
    assert len({first, *others}) == 4


def test_a_damaged_part_is_named_and_one_that_is_gone_is_played(tmp_path):
    store = Folder(tmp_path)
    Job(PARTS, SHARED, Sums(), store, {}).finish()
    job, *_ = Job(PARTS, SHARED, Sums(), store, {}), None
    file = tmp_path / "parts" / f"{job.key(PARTS[3])}.npz"
    file.write_bytes(file.read_bytes()[:-30])
    with pytest.raises(ValueError, match=f"{file.name}.*must be a part as it was written"):
        job.take(PARTS)
    assert unpacked(packed({"a": np.arange(3), "b": 2.5}), "x")["b"].item() == 2.5
    with pytest.raises(ValueError, match="must be a part"):
        unpacked(packed({"a": np.array([{}], object)}), "x")  # it would have to be unpickled


def test_a_full_disk_keeps_what_was_written_and_names_the_file(tmp_path, monkeypatch):
    written = []

    def write(name, data):
        if len(written) == 3:
            raise OSError(28, "No space left on device", str(tmp_path / name))
        written.append(name)
        return original(name, data)

    store = Folder(tmp_path)
    original = store.write
    monkeypatch.setattr(store, "write", write)
    with pytest.raises(OSError, match="No space left on device"):
        Job(PARTS, SHARED, Sums(), store, {}).take(PARTS)
    again = Sums()
    Job(PARTS, SHARED, again, Folder(tmp_path), {}).take(PARTS)
    assert len(again.played) == 4  # job.json and two parts were there


def test_an_evaluation_goes_on_from_what_it_kept(tmp_path, monkeypatch, capsys):
    """By the command: interrupted, then given again, then with another option."""
    monkeypatch.setattr(visits, "SIZE", 5)
    command = ["--agent", "random", "--visits", "20", "--layouts", "held_out", "--noise", "professional", "--resamples", "200"]
    plain, kept = tmp_path / "plain.json", tmp_path / "kept.json"
    assert protocol.main([*command, "--json", str(plain)]) == 0
    original, calls = visits.play_visits, []

    def play(*args, **options):
        calls.append(1)
        if len(calls) == 6:
            raise KeyboardInterrupt
        return original(*args, **options)

    monkeypatch.setattr(visits, "play_visits", play)
    command += ["--keep", str(tmp_path / "parts")]
    capsys.readouterr()
    assert protocol.main([*command, "--json", str(kept)]) == 130
    said = capsys.readouterr().err
    assert f"what was played is kept in {tmp_path / 'parts'}, the same command goes on" in said and not kept.exists()
    assert protocol.main([*command, "--json", str(kept)]) == 0 and len(calls) == 6 + 3
    one, two = (json.loads(file.read_text())["results"] for file in (plain, kept))
    for row in (*one, *two):
        del row["ms_a_decision"]
    assert one == two
    with pytest.raises(SystemExit):
        protocol.main([*command, "--rekey"])
    assert "its rekey is false, and true is asked for" in capsys.readouterr().err


def test_digests_know_bytes_from_texts():
    assert len({digest_of({"a": b"1"}), digest_of({"a": "1"}), digest_of({"a": 1}), digest_of({"a": [b"1"]})}) == 4
