"""Does a checkpoint outlive its machine, with one writer at a time, in a folder and at a URL?"""

import uuid

import pytest

from agents.cluster import mirror
from agents.cluster.job import ClusterError
from agents.cluster.keep import Store
from agents.cluster.mirror import Mirror, copied, left

RUN = {"agent": "ppo_value", "seed": 3, "set": ("gamma=0",)}


@pytest.fixture(params=["folder", "memory"])
def url(request, tmp_path):
    if request.param == "folder":
        return str(tmp_path / "there")
    pytest.importorskip("fsspec")
    return f"memory://{uuid.uuid4().hex}"


def test_a_run_goes_on_from_its_mirror_alone(url, tmp_path):
    here, there = tmp_path / "here", tmp_path / "elsewhere"
    first = Mirror(url)
    first.claim(here, RUN, resume=False)
    copied(here, b"one")
    copied(here, b"two")
    copied(here, b"weights", "model.zip")
    copied(tmp_path / "another", b"x")  # a run without a mirror
    second = Mirror(url)
    second.fetch(there)
    assert (there / "checkpoint.pkl").read_bytes() == b"two" and Store(url).read("model.zip") == b"weights"
    second.claim(there, RUN, resume=True)
    copied(there, b"three")
    with pytest.raises(ClusterError, match=r"was taken over by process \d+ on .* since .*: this one stops"):
        copied(here, b"four")
    left(there)
    copied(there, b"five")
    assert Store(url).read("checkpoint.pkl") == b"three"


def test_other_runs_are_refused(url, tmp_path):
    with pytest.raises(ValueError, match="holds no checkpoint: start the run without --resume"):
        Mirror(url).fetch(tmp_path / "x")
    first = Mirror(url)
    first.claim(tmp_path, RUN, resume=False)
    Mirror(url).claim(tmp_path, RUN, resume=False)  # nothing was saved yet: the run may start again
    copied(tmp_path, b"one")
    with pytest.raises(ValueError, match="holds a run: --resume continues it"):
        Mirror(url).claim(tmp_path, RUN, resume=False)
    with pytest.raises(ValueError, match="must be that of the same run: its seed is 3, not 4"):
        Mirror(url).claim(tmp_path, RUN | {"seed": 4}, resume=True)
    left(tmp_path)


def test_a_network_that_fails_is_tried_again_and_then_said(url, tmp_path, monkeypatch):
    monkeypatch.setattr(mirror, "PAUSE", 0.0)
    kept, calls = Mirror(url), []
    kept.claim(tmp_path, RUN, resume=False)
    original = kept.store.write

    def write(name, data, fails=2):
        calls.append(name)
        if len(calls) <= fails:
            raise OSError(5, "no route", name)
        original(name, data)

    monkeypatch.setattr(kept.store, "write", write)
    kept.save(b"one")
    assert len(calls) == 3 and kept.store.read("checkpoint.pkl") == b"one"
    monkeypatch.setattr(kept.store, "write", lambda name, data: write(name, data, 99))
    with pytest.raises(ClusterError, match="cannot be written: no route"):
        kept.save(b"two")
    assert kept.store.read("checkpoint.pkl") == b"one"
    left(tmp_path)


def test_a_file_is_written_whole_or_not_at_all(url, tmp_path, monkeypatch):
    store = Store(url)
    assert store.names("parts") == set() and store.read("parts/a") is None
    store.write("parts/a", b"1")
    store.write("parts/a", b"2")
    assert store.names("parts") == {"a"} and store.read("parts/a") == b"2"
    if "://" not in url:

        def full(source, target):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("os.replace", full)
        with pytest.raises(OSError, match=r"No space left on device.*parts/b"):
            store.write("parts/b", b"1")
        assert [file.name for file in (tmp_path / "there" / "parts").iterdir()] == ["a"]


def test_what_cannot_be_written_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"keep = .*file/x.*must be a folder or URL that can be written"):
        Store(str(tmp_path / "file" / "x"))
    pytest.importorskip("fsspec")
    says = "mirror = 'nothing://x': must be a folder or URL that can be written"
    with pytest.raises(ValueError, match=says):
        Store("nothing://x", "mirror")


def test_the_run_is_kept_in_words(url, tmp_path):
    Mirror(url).claim(tmp_path, RUN, resume=False)
    assert Store(url).read_json("run.json") == {"agent": "ppo_value", "seed": 3, "set": ["gamma=0"]}
    left(tmp_path)


def test_who_resumes_goes_on_from_the_newest_checkpoint(tmp_path):
    """A saves; B takes over and saves; A resumes. If A too has gone on, it is told so and nothing is lost."""
    a, b, url = tmp_path / "a", tmp_path / "b", str(tmp_path / "mirror")
    for out in (a, b):
        out.mkdir()

    def saved(out, data):
        (out / mirror.CHECKPOINT).write_bytes(data)
        copied(out, data)

    def resumed(out):
        again = Mirror(url)
        again.fetch(out)
        again.claim(out, {}, resume=True)
        return (out / mirror.CHECKPOINT).read_bytes()

    Mirror(url).claim(a, {}, resume=False)
    saved(a, b"100")
    assert resumed(b) == b"100"
    saved(b, b"500")
    assert resumed(a) == b"500"
    saved(a, b"600")
    (b / mirror.CHECKPOINT).write_bytes(b"550")  # B has gone on by itself
    with pytest.raises(ValueError, match="another machine"):
        Mirror(url).fetch(b)
    assert (b / mirror.CHECKPOINT).read_bytes() == b"550"
    for out in (a, b):
        left(out)
