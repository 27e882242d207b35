"""Is what a cluster plays what one process plays, even if a node dies amid it? On two nodes of this machine."""

import os
import socket
import threading
import time
from itertools import product

import numpy as np
import pytest

pytest.importorskip("ray", reason='Ray is not installed: pip install -e ".[cluster]"')
from ray.cluster_utils import Cluster as Nodes

from agents import cluster, evaluate, tournament
from agents.cluster import ClusterError, Here, in_order, place, play_and_keep
from agents.evaluation import visits
from agents.evaluation.entrants import Entrant
from agents.evaluation.travel import pack
from agents.learning.frame_self_play import frames
from snooker_env.benchmark.tasks import tables_of
from snooker_env.tasks import LEVELS
from tests.cluster.players import AT, same
from tests.processes import ROOT

NODE = {"num_cpus": 1, "object_store_memory": 100 * 2**20}
QUICK = str.split("--agent random --visits 2 --layouts held_out --noise none --ray")


@pytest.fixture(autouse=True, scope="module")
def folder(tmp_path_factory):
    """Workers find the tests by PYTHONPATH, compute with one thread each, and note here what they play."""
    made = tmp_path_factory.mktemp("notes")
    with pytest.MonkeyPatch.context() as patch:
        patience = {"RAY_task_oom_retry_delay_base_ms": 100}  # with workers and nodes that died
        for server, which in product(("raylet", "core_worker"), ("base", "max")):
            patience[f"RAY_{server}_rpc_server_reconnect_timeout_{which}_s"] = 1
        for name, value in {"PYTHONPATH": ROOT, "OMP_NUM_THREADS": 1, "SLOW": 0.15, **patience}.items():
            patch.setenv(name, str(value))
        for name in ("NOTED", "HANGS"):
            patch.setenv(name, str(made / name.lower()))
        patch.syspath_prepend(str(ROOT))
        yield made


@pytest.fixture(scope="module")
def head():
    """A node with one core, to which another is added; all their processes end with the module."""
    made = Nodes(initialize_head=True, head_node_args=NODE | {"include_dashboard": False})
    yield made
    made.shutdown()


@pytest.fixture
def nodes(head, folder, tmp_path, monkeypatch):
    """Two nodes with a core each, and the second of them, which may have been killed before."""
    monkeypatch.setattr(cluster, "KEPT", tmp_path / "kept")
    for file in folder.iterdir():
        file.unlink()
    others = [node for node in head.list_all_nodes() if node != head.head_node]
    second = others[0] if others else head.add_node(**NODE, env_vars={"DIES": "1"})
    head.wait_for_nodes()
    return head, second


@pytest.fixture
def where(nodes):
    with place(nodes[0].address) as joined:
        yield joined


def parts_of(name, many, size, monkeypatch):
    monkeypatch.setattr(visits, "SIZE", size)
    return visits.parts_of(pack(Entrant.of(name), 0), 0, AT, tables_of("held_out", many))


def alike(one, other):
    """Whether two results of visits are, but for the clock."""
    clock = ("seconds", "simulated")
    return all(np.array_equal(one[key], other[key], equal_nan=True) for key in one if key not in clock)


def test_two_nodes_of_which_one_is_killed_play_what_one_process_plays(nodes, where, folder, monkeypatch):
    """Nothing counts twice, and a part at which the node hung is played by the other."""
    parts, done, hangs = parts_of("tests.cluster.players:Noted", 60, 5, monkeypatch), [], folder / "hangs"
    hangs.touch()

    def kill():
        while not (hangs.read_text() and len(done) >= 3):
            time.sleep(0.05)
        nodes[0].remove_node(nodes[1], allow_graceful=False)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    far = {}
    for k, result in play_and_keep(visits.play, parts, where):
        done.append(k)
        far[k] = result
    killer.join(60)
    assert nodes[1] not in nodes[0].list_all_nodes() and sorted(done) == list(range(12))
    monkeypatch.delenv("NOTED")
    near = in_order(Here().play_parts(visits.play, parts))
    assert all(alike(far[k], one) for k, one in enumerate(near))


def test_two_nodes_play_every_kind_of_player(where, folder, monkeypatch):
    names = ("tests.cluster.players:Noted", "random", "best_pot_30", "planner_30", "ppo_value")
    seeds = tables_of("held_out", 24)
    for name in names:
        parts, agent = parts_of(name, 24, 12, monkeypatch), Entrant.of(name)
        far = in_order(where.play_parts(visits.play, parts))
        one, other = (evaluate.play_agent(agent, AT, seeds, 100, r).strokes[0] for r in (far, None))
        assert same(one, other), name
    processes = {line.split()[0] for line in (folder / "noted").read_text().splitlines()}
    assert len(processes - {str(os.getpid())}) == 2


def test_frames_of_self_play_are_the_same(where):
    shared = {"options": {"cue": "real", "max_strokes": 6}, "layers": None, "chance": None}
    shared |= {"budget": 30, "explore": 0.2, "replies": False}
    noise = LEVELS["professional"].scale(2.0)
    parts = [(shared, {"noise": noise, "seed": k, "many": 2, "other": None}) for k in (3, 5)]
    for one, other in zip(*(in_order(w.play_parts(frames, parts)) for w in (where, Here())), strict=True):
        assert all(np.array_equal(one[name], other[name]) for name in other)


def test_a_job_goes_on_with_what_was_kept(where, folder, monkeypatch):
    """The parts that had ended are not played again, but a damaged one is."""
    parts = parts_of("tests.cluster.players:Noted", 8, 2, monkeypatch)
    for k, _ in play_and_keep(visits.play, parts, where):
        if k == 1:
            break
    kept = sorted(cluster.kept_at(visits.play, parts).glob("*.npz"))
    kept[0].write_bytes(b"damaged")
    (folder / "noted").unlink()
    whole = dict(play_and_keep(visits.play, parts, where))
    asked = [line for line in (folder / "noted").read_text().splitlines() if line.split()[1] == "0"]
    assert sorted(whole) == [0, 1, 2, 3] and len(asked) >= 4 - len(kept) + 1
    assert all(alike(whole[k], one) for k, one in in_turn(parts, monkeypatch))
    other = parts_of("tests.cluster.players:Noted", 10, 2, monkeypatch)
    assert cluster.kept_at(visits.play, other) != cluster.kept_at(visits.play, parts)


def in_turn(parts, monkeypatch):
    monkeypatch.delenv("NOTED")
    return enumerate(in_order(Here().play_parts(visits.play, parts)))


@pytest.mark.parametrize(
    ("name", "kind", "says"),
    [("Failing", RuntimeError, "a fault of mine"), ("Deadly", ClusterError, "a part was given up")],
)
def test_what_befalls_a_worker_is_one_line(where, monkeypatch, name, kind, says):
    monkeypatch.setattr(cluster, "RETRIES", 1)
    with pytest.raises(kind, match=says) as error:
        list(where.play_parts(visits.play, parts_of(f"tests.cluster.players:{name}", 2, 2, monkeypatch)))
    assert "\n" not in str(error.value)


def test_a_node_with_another_source_is_refused(where, monkeypatch):
    monkeypatch.setattr(cluster, "source", lambda: "another")
    with pytest.raises(ClusterError, match="has different source code or libraries"):
        list(where.play_parts(visits.play, parts_of("random", 2, 2, monkeypatch)))


@pytest.mark.parametrize(
    ("command", "arguments"),
    [(evaluate, QUICK), (tournament, ["random", "ghost_ball", "--frames", "2", "--ray"])],
)
def test_an_address_without_a_head_is_one_line(command, arguments, capsys):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    assert command.main([*arguments, f"127.0.0.1:{port}"]) == 1
    said = [line for line in capsys.readouterr().err.splitlines() if "ray" in line]
    assert len(said) == 1
    assert f"ray = '127.0.0.1:{port}': must be the head of a running Ray cluster" in said[0]
