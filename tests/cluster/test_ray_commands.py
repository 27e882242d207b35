"""Do the commands go on after the head of their cluster was lost, and is every fault of an address one line?
In processes of their own."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("ray", reason='Ray is not installed: pip install -e ".[cluster]"')
from ray.cluster_utils import Cluster as Nodes

ROOT = Path(__file__).resolve().parents[2]
NODE = {"num_cpus": 2, "object_store_memory": 100 * 2**20, "include_dashboard": False}
EVALUATE = str.split(
    "-m agents.evaluate --agent tests.cluster.players:Noted --against Noted --layouts held_out --visits "
    "500 --noise professional --resamples 200"
)
TRAIN = [
    "-c",
    "import sys, train, agents.learning.callback as often; often.LEAST, often.SHARE = 1.0, 1.0; sys.exit(train.main(sys.argv[1:]))",
]
"""train.py with a checkpoint every second."""
SHORT = ["--imitate", "3072", "--envs", "128", "--steps", "1", "--eval-visits", "2", "--no-progress"]


@pytest.fixture
def environment(tmp_path, monkeypatch):
    for name, value in {
        "PYTHONPATH": ROOT,
        "OMP_NUM_THREADS": "1",
        "NOTED": tmp_path / "noted",
        "SLOW": "0.7",
    }.items():
        monkeypatch.setenv(name, str(value))
    return dict(os.environ)


def started(command, environment, at=ROOT):
    return subprocess.Popen(
        [sys.executable, *command],
        cwd=at,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finished(command, environment, at=ROOT):
    process = started(command, environment, at)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err


def until(true, process, seconds=120):
    began = time.monotonic()
    while not true():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() - began < seconds
        time.sleep(0.05)


def rows(file):
    found = json.loads(file.read_text())["results"]
    for row in found:
        del row["ms_a_decision"]
    return found


def lines_of(err):
    """What this project said on stderr."""
    return [line for line in err.splitlines() if line.startswith(("agents.", "train.py:"))]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The rows of ``EVALUATE`` by one machine without an interruption."""
    out = tmp_path_factory.mktemp("alone") / "alone.json"
    here = os.environ | {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    assert finished([*EVALUATE, "--json", str(out)], here)[0] == 0
    return rows(out)


@pytest.mark.parametrize("end", ["the head is lost", "Ctrl-C", "kill -9"])
def test_an_evaluation_goes_on_after(end, tmp_path, environment, alone):
    parts, out = tmp_path / "parts", tmp_path / "out.json"
    nodes = Nodes(initialize_head=True, head_node_args=NODE)
    process = None
    try:
        command = [*EVALUATE, "--keep", str(parts), "--json", str(out), "--ray"]
        process = started([*command, nodes.address], environment)
        until(lambda: len(list(parts.glob("parts/*.npz"))) >= 2, process)
        if end == "the head is lost":
            nodes.shutdown()
        else:
            process.send_signal(signal.SIGINT if end == "Ctrl-C" else signal.SIGKILL)
        _, err = process.communicate(timeout=120)
        assert process.returncode == {"the head is lost": 1, "Ctrl-C": 130, "kill -9": -9}[end], err
        if end == "Ctrl-C":
            assert lines_of(err)[-1].startswith("agents.evaluate: interrupted")
            assert "the same command goes on" in err
        kept = {file.name: file.stat().st_mtime_ns for file in parts.glob("parts/*.npz")}
        assert 2 <= len(kept) < 5 and not out.exists()
        if end == "the head is lost":
            nodes = Nodes(initialize_head=True, head_node_args=NODE)
        code, _, err = finished([*command, nodes.address], environment)
        assert code == 0, err
        assert {name: (parts / "parts" / name).stat().st_mtime_ns for name in kept} == kept
        assert len(list(parts.glob("parts/*.npz"))) == 5
    finally:
        if process is not None and process.poll() is None:
            process.kill()
        nodes.shutdown()
    assert rows(out) == alone


def test_of_two_equal_jobs_at_once_the_second_is_refused(tmp_path, environment):
    """Both keep their parts in one folder, which goes with the one that ends first."""
    nodes = Nodes(initialize_head=True, head_node_args=NODE)
    command, kept, first = [*EVALUATE, "--ray", nodes.address], tmp_path / "runs" / "kept", None
    try:
        first = started([*command, "--json", str(tmp_path / "out.json")], environment, tmp_path)
        until(lambda: len(list(kept.glob("*/parts/*.npz"))) >= 1, first)
        code, _, err = finished(command, environment, tmp_path)
        assert (
            code == 2
            and f"must be a folder that no other process uses: process {first.pid} on "
            in err.splitlines()[-1]
        ), err
        _, err = first.communicate(timeout=300)
        assert first.returncode == 0 and not lines_of(err), err
    finally:
        if first is not None and first.poll() is None:
            first.kill()
        nodes.shutdown()
    assert len(rows(tmp_path / "out.json")) == 1 and not list(kept.iterdir())


def test_searched_data_are_the_same_files_with_a_cluster_and_without(tmp_path, environment):
    command = str.split("-m agents.search --agent search_30 --positions 300 --noise club --layout random:6")
    nodes = Nodes(initialize_head=True, head_node_args=NODE)
    try:
        code, out, err = finished(
            [*command, "--out", str(tmp_path / "there"), "--ray", nodes.address], environment
        )
    finally:
        nodes.shutdown()
    assert code == 0 and not lines_of(err) and out.startswith("384 positions"), err
    assert finished([*command, "--out", str(tmp_path / "here")], environment)[0] == 0
    here, there = (
        {
            file.relative_to(tmp_path / name): file.read_bytes()
            for file in (tmp_path / name).rglob("*")
            if file.is_file()
        }
        for name in ("here", "there")
    )
    assert here == there
    assert sorted(file.name for file in here if file.suffix == ".json") == ["index.json", "job.json"]
    assert len(here) == 2 + 3


@pytest.mark.slow
def test_a_training_goes_on_from_its_mirror_after_the_head_was_lost(tmp_path, environment):
    """On what could be another machine: with nothing but the mirror. The weights are those of one machine
    without a fault."""
    torch = pytest.importorskip("torch")
    from agents.learning.models import load_trained

    def weights(out):
        return load_trained(out, "out").policy.state_dict()

    nodes, mirror = (
        Nodes(initialize_head=True, head_node_args=NODE),
        ["--mirror", str(tmp_path / "mirror"), "--ray"],
    )
    first = started([*TRAIN, *SHORT, "--out", str(tmp_path / "first"), *mirror, nodes.address], environment)
    try:
        until(lambda: (tmp_path / "mirror" / "checkpoint.pkl").exists(), first, 240)
        nodes.shutdown()
        _, err = first.communicate(timeout=120)
        assert first.returncode not in (0, None), err
        nodes = Nodes(initialize_head=True, head_node_args=NODE)
        command = [
            "train.py",
            "--resume",
            "--out",
            str(tmp_path / "second"),
            *SHORT[-3:],
            *mirror,
            nodes.address,
        ]
        code, _, err = finished(command, environment)
        assert code == 0, err
    finally:
        if first.poll() is None:
            first.kill()
        nodes.shutdown()
    assert finished([*TRAIN, *SHORT, "--out", str(tmp_path / "alone")], environment)[0] == 0
    one, other = weights(tmp_path / "alone"), weights(tmp_path / "second")
    assert one.keys() == other.keys()
    assert all(torch.equal(tensor, other[name]) for name, tensor in one.items())


QUICK = str.split("-m agents.evaluate --agent random --visits 2 --layouts held_out --noise none --ray")


@pytest.mark.parametrize(
    "command", [QUICK, ["-m", "agents.tournament", "random", "ghost_ball", "--frames", "2", "--ray"]]
)
def test_an_address_without_a_head_is_one_line(command, environment):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    code, out, err = finished([*command, f"127.0.0.1:{port}"], environment)
    assert code == 1 and not out
    (line,) = err.splitlines()
    assert f"ray = '127.0.0.1:{port}': must be the head of a Ray cluster that runs" in line


@pytest.mark.parametrize("address", ["here", "ray://1.2.3.4:10001", "host:", "host:99999", ":6379"])
def test_what_is_no_address_is_refused(address, environment):
    code, _, err = finished([*QUICK, address], environment)
    assert code == 2 and f"ray = {address!r}: must be local, or HOST:PORT" in err.splitlines()[-1]


def test_the_benchmark_prints_what_a_part_costs(tmp_path, environment):
    command = str.split("-m benchmarks.cluster --shots 200 --parts 2 --positions 2 --repeats 1 --json")
    code, out, err = finished([*command, str(tmp_path / "f")], environment)
    assert code == 0 and not lines_of(err), err
    found = json.loads((tmp_path / "f").read_text())
    assert "cost of a part" in out and "a million positions in" in out and min(found["rates"].values()) > 0
    assert found["search"] > 0
