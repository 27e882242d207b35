"""Do commands go on after the head of their cluster was lost, and is every fault of an address one line?"""

import json
import os
import shlex
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager

import numpy as np
import pytest
import yaml

pytest.importorskip("ray", reason='Ray is not installed: pip install -e ".[cluster]"')
from ray.cluster_utils import Cluster as Nodes
from ray.scripts.scripts import start as ray_start
from ray.scripts.symmetric_run import symmetric_run

from agents.cluster.job import ClusterError
from agents.cluster.ray_cluster import checked_ray, connected
from agents.evaluation import protocol
from tests.docs.pages import blocks
from tests.processes import ROOT

NODE = {"num_cpus": 2, "object_store_memory": 100 * 2**20, "include_dashboard": False}
EVALUATE = str.split(
    "-m agents.evaluate --agent tests.cluster.players:Noted --against Noted --layouts held_out --visits "
    "500 --noise professional --resamples 200"
)
OFTEN = """
import sys, train
from agents.learning import callback
callback.LEAST = callback.SHARE = 1.0
sys.exit(train.main(sys.argv[1:]))
"""
"""train.py with a checkpoint every second."""
SHORT = str.split("--imitate 3072 --envs 128 --steps 1 --eval-visits 2 --no-progress")


@pytest.fixture
def environment(tmp_path, monkeypatch):
    usual = {"PYTHONPATH": ROOT, "OMP_NUM_THREADS": 1, "NOTED": tmp_path / "noted", "SLOW": 0.7}
    for name, value in usual.items():
        monkeypatch.setenv(name, str(value))
    return dict(os.environ)


@pytest.fixture
def nodes(environment):
    """A cluster, whose workers take that environment; its head may be lost and another one begun."""
    made = [Nodes(initialize_head=True, head_node_args=NODE)]
    yield made
    made[-1].shutdown()


def started(command, environment, at=ROOT):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([sys.executable, *map(str, command)], cwd=at, env=environment, **pipes)


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


@contextmanager
def running(command, environment, at=ROOT):
    """A command that is killed if it has not ended."""
    process = started(command, environment, at)
    try:
        yield process
    finally:
        process.kill()


@pytest.mark.parametrize(("end", "code"), [("the head is lost", 1), ("Ctrl-C", 130), ("kill -9", -9)])
def test_an_evaluation_goes_on_after(end, code, tmp_path, environment, alone, nodes):
    parts, out = tmp_path / "parts", tmp_path / "out.json"
    command = [*EVALUATE, "--keep", parts, "--json", out, "--ray"]
    with running([*command, nodes[0].address], environment) as process:
        until(lambda: len(list(parts.glob("parts/*.npz"))) >= 2, process)
        if end == "the head is lost":
            nodes[0].shutdown()
        else:
            process.send_signal(signal.SIGINT if end == "Ctrl-C" else signal.SIGKILL)
        _, err = process.communicate(timeout=120)
    assert process.returncode == code, err
    if end == "Ctrl-C":
        assert lines_of(err)[-1].startswith("agents.evaluate: interrupted")
        assert "the same command goes on" in err
    kept = {file.name: file.stat().st_mtime_ns for file in parts.glob("parts/*.npz")}
    assert 2 <= len(kept) < 5 and not out.exists()
    if end == "the head is lost":
        nodes.append(Nodes(initialize_head=True, head_node_args=NODE))
    code, _, err = finished([*command, nodes[-1].address], environment)
    assert code == 0, err
    assert {name: (parts / "parts" / name).stat().st_mtime_ns for name in kept} == kept
    assert len(list(parts.glob("parts/*.npz"))) == 5
    assert rows(out) == alone


def test_of_two_equal_jobs_at_once_the_second_is_refused(tmp_path, environment, nodes):
    """Both keep their parts in one folder, which goes with the one that ends first."""
    command, kept = [*EVALUATE, "--ray", nodes[0].address], tmp_path / "runs" / "kept"
    with running([*command, "--json", tmp_path / "out.json"], environment, tmp_path) as first:
        until(lambda: len(list(kept.glob("*/parts/*.npz"))) >= 1, first)
        first.send_signal(signal.SIGSTOP)  # so that it does not end before the second has begun
        code, _, err = finished(command, environment, tmp_path)
        first.send_signal(signal.SIGCONT)
        says = f"must be a folder that no other process uses: process {first.pid} on "
        assert code == 2 and says in err.splitlines()[-1], err
        _, err = first.communicate(timeout=300)
    assert first.returncode == 0 and not lines_of(err), err
    assert len(rows(tmp_path / "out.json")) == 1 and not list(kept.iterdir())


def test_searched_data_are_the_same_files_with_a_cluster_and_without(tmp_path, environment, nodes):
    command = str.split("-m agents.search --agent search_30 --positions 300 --noise club --layout random:6")
    files = []
    for name, more in (("far", ["--ray", nodes[0].address]), ("here", [])):
        folder = tmp_path / name
        code, out, err = finished([*command, "--out", folder, *more], environment)
        assert code == 0 and not lines_of(err) and out.startswith("384 positions"), err
        written = [file for file in folder.rglob("*") if file.is_file()]
        files.append({file.relative_to(folder): file.read_bytes() for file in written})
    far, here = files
    assert here == far
    assert sorted(file.name for file in here if file.suffix == ".json") == ["index.json", "job.json"]
    assert len(here) == 2 + 3


@pytest.mark.slow
def test_a_training_goes_on_from_its_mirror_after_the_head_was_lost(tmp_path, environment, nodes):
    """With nothing but the mirror; the weights are those of one machine without a fault."""
    pytest.importorskip("torch")
    from tests.agents.training import weights

    mirror = ["--mirror", tmp_path / "mirror", "--ray"]
    train = ["-c", OFTEN, *SHORT, "--out"]
    with running([*train, tmp_path / "first", *mirror, nodes[0].address], environment) as first:
        until(lambda: (tmp_path / "mirror" / "checkpoint.pkl").exists(), first, 240)
        nodes[0].shutdown()
        _, err = first.communicate(timeout=120)
    assert first.returncode not in (0, None), err
    nodes.append(Nodes(initialize_head=True, head_node_args=NODE))
    more = ["--out", tmp_path / "second", *SHORT[-3:], *mirror, nodes[1].address]
    code, _, err = finished(["train.py", "--resume", *more], environment)
    assert code == 0, err
    assert finished([*train, tmp_path / "alone"], environment)[0] == 0
    assert np.array_equal(weights(tmp_path / "alone"), weights(tmp_path / "second"))


QUICK = str.split("-m agents.evaluate --agent random --visits 2 --layouts held_out --noise none --ray")


TOURNAMENT = str.split("-m agents.tournament random ghost_ball --frames 2 --ray")


@pytest.mark.parametrize("command", [QUICK, TOURNAMENT])
def test_an_address_without_a_head_is_one_line(command, environment):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    code, out, err = finished([*command, f"127.0.0.1:{port}"], environment)
    assert code == 1 and not out
    (line,) = err.splitlines()
    assert f"ray = '127.0.0.1:{port}': must be the head of a Ray cluster that runs" in line


PAGE = (ROOT / "docs/scale.md").read_text(encoding="utf-8")


def test_the_jobs_of_the_page_give_commands_that_exist():
    (manifest,), scripts = map(yaml.safe_load, blocks(PAGE, "yaml")), blocks(PAGE, "bash")
    (job,) = [script for script in scripts if "#SBATCH" in script]
    start, _, command = job.replace("\\\n", " ").partition("ray symmetric-run")[2].partition(" -- ")
    for line in (command, manifest["spec"]["entrypoint"]):
        words = shlex.split(line)
        assert words[:3] == ["python", "-m", "agents.evaluate"]
        args = protocol.parser().parse_args(words[3:])
        checked_ray(args.ray)
        assert args.ray == "auto" and args.keep
    known = {option for parameter in (*ray_start.params, *symmetric_run.params) for option in parameter.opts}
    assert {word for word in shlex.split(start) if word.startswith("--")} <= known
    cluster = manifest["spec"]["rayClusterSpec"]
    assert manifest["kind"] == "RayJob" and cluster["authOptions"] == {"mode": "token"}
    groups = [cluster["headGroupSpec"], *cluster["workerGroupSpecs"]]
    assert {f"--{name}" for group in groups for name in group["rayStartParams"]} <= known
    assert len({group["template"]["spec"]["containers"][0]["image"] for group in groups}) == 1


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "nowhere"])
def test_auto_takes_the_address_of_the_environment(address, monkeypatch):
    monkeypatch.setenv("RAY_ADDRESS", address)
    with pytest.raises(ClusterError, match=f"ray = '{address}': must be the head of a Ray cluster that runs"):
        connected("auto")


@pytest.mark.parametrize("address", ["here", "ray://1.2.3.4:10001", "host:", "host:99999", ":6379"])
def test_what_is_no_address_is_refused(address, environment):
    code, _, err = finished([*QUICK, address], environment)
    assert code == 2 and f"ray = {address!r}: must be local, auto, or HOST:PORT" in err.splitlines()[-1]


def test_the_benchmark_prints_what_a_part_costs(tmp_path, environment):
    command = str.split("-m benchmarks.cluster --shots 200 --parts 2 --positions 2 --repeats 1 --json")
    code, out, err = finished([*command, str(tmp_path / "f")], environment)
    assert code == 0 and not lines_of(err), err
    found = json.loads((tmp_path / "f").read_text())
    assert "cost of a part" in out and "a million positions in" in out and min(found["rates"].values()) > 0
    assert found["search"] > 0
