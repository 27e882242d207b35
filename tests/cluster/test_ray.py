"""Is what a cluster plays what one machine plays, even if a node dies amid it? On two nodes of this machine."""

import os
import socket
import threading
import time
from contextlib import contextmanager
from itertools import product

import numpy as np
import pytest
from positions import tables

pytest.importorskip("ray", reason='Ray is not installed: pip install -e ".[cluster]"')
from ray.cluster_utils import Cluster as Nodes

from agents.cluster import ray_cluster
from agents.cluster.job import ClusterError, Here, ended, in_order, keys_of
from agents.cluster.keep import Store
from agents.cluster.ray_cluster import connected
from agents.evaluation import protocol, searched, visits
from agents.evaluation.entrants import Entrant
from agents.evaluation.travel import sent
from agents.learning import self_play
from snooker_env.benchmark.tasks import tables_of
from snooker_env.planning import Positions
from tests.cluster.players import AT, same
from tests.processes import ROOT

NODE = {"num_cpus": 1, "object_store_memory": 100 * 2**20, "include_dashboard": False}


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
    """A node with one core, to which others are added; all their processes end with the module."""
    made = Nodes(initialize_head=True, head_node_args=NODE)
    yield made
    made.shutdown()


@pytest.fixture
def nodes(head, folder):
    """Two nodes with a core each, and the second of them, which may have been killed before."""
    for file in folder.iterdir():
        file.unlink()
    others = [node for node in head.list_all_nodes() if node != head.head_node]
    node = {name: value for name, value in NODE.items() if name != "include_dashboard"}
    second = others[0] if others else head.add_node(**node, env_vars={"DIES": "1"})
    head.wait_for_nodes()
    return head, second


@pytest.fixture
def cluster(nodes):
    joined = connected(nodes[0].address)
    try:
        yield joined
    finally:
        joined.close()


def test_auto_is_the_cluster_of_this_machine(nodes, monkeypatch):
    monkeypatch.setenv("RAY_ADDRESS", nodes[0].address)
    joined = connected("auto")
    assert joined.cores == 2
    joined.close()


@contextmanager
def killed(nodes, folder, ready):
    """The second node is killed amid a part at which it hangs, once all is ``ready``."""
    hangs = folder / "hangs"
    hangs.touch()

    def kill():
        while not (hangs.read_text() and ready()):
            time.sleep(0.05)
        nodes[0].remove_node(nodes[1], allow_graceful=False)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    yield
    killer.join(60)
    assert nodes[1] not in nodes[0].list_all_nodes()


def noted(folder):
    """(process, decision, tables) of every decision of ``Noted``."""
    return [tuple(map(int, line.split())) for line in (folder / "noted").read_text().splitlines()]


def results_of(agents, seeds, where, count=None):
    """The results of all parts of these agents, in order; ``count`` gets the number of each that has ended."""
    shared = {f"{a.label} {k}": protocol.sent(a, k) for a in agents for k in range(len(a.runs))}
    parts = [one for a in agents for one in visits.parts_of(f"{a.label} 0", 0, AT, seeds, False)]

    def counted():
        for k, result in ended(parts, shared, where):
            if count is not None:
                count.append(k)
            yield k, result

    return in_order(counted())


def test_two_nodes_play_what_one_machine_plays(cluster, folder, monkeypatch):
    """Every kind of player; by the workers of both nodes."""
    monkeypatch.setattr(visits, "SIZE", 10)
    names = ("tests.cluster.players:Noted", "random", "ghost_ball", "best_pot_30", "planner_30", "ppo_value")
    agents = [Entrant.of(name) for name in names]
    seeds = tables_of("held_out", 24)
    assert cluster.cores == 2
    far, near = results_of(agents, seeds, cluster), results_of(agents, seeds, Here())
    for agent in agents:
        played = [protocol.play_agent(agent, AT, seeds, 100, False, one).strokes[0] for one in (far, near)]
        assert same(*played), agent.label
    assert len({process for process, *_ in noted(folder)} - {os.getpid()}) == 2


def test_a_node_killed_amid_an_evaluation_is_survived_and_nothing_counts_twice(
    nodes, cluster, folder, monkeypatch
):
    monkeypatch.setattr(visits, "SIZE", 5)
    agent, seeds, done = Entrant.of("tests.cluster.players:Noted"), tables_of("held_out", 60), []
    with killed(nodes, folder, lambda: len(done) >= 3):
        metrics = protocol.play_agent(agent, AT, seeds, 100, False, results_of([agent], seeds, cluster, done))
    assert sorted(done) == list(range(12))  # that at which the node hung was begun twice
    monkeypatch.delenv("NOTED")
    assert same(metrics.strokes[0], protocol.play_agent(agent, AT, seeds, 100).strokes[0])


def test_a_node_killed_amid_training_leaves_the_result_as_it_is(nodes, cluster, monkeypatch):
    """Expert iteration by this process alone, and by two nodes of which one dies in the fourth round."""
    torch = pytest.importorskip("torch")
    from agents.features.observed import training_tables
    from agents.learning.expert_iteration import ExpertIteration
    from agents.learning.hyperparameters import Recipe

    monkeypatch.setattr(self_play, "SLICE", 4)
    torch.set_num_threads(1)
    weights = []
    for where in (None, cluster):
        recipe = Recipe.of("ppo_value", n_envs=16)
        torch.manual_seed(1)
        venv = training_tables(16, threads=1, **recipe.env_kwargs)
        model = recipe.new_model(venv, 1)
        run = ExpertIteration(model, venv, 96, 1, 1, where=where)
        while run.done < 96:
            if where is not None and run.done == 48:
                threading.Timer(0.05, lambda: nodes[0].remove_node(nodes[1], allow_graceful=False)).start()
            run.round()
        weights.append({name: one.clone() for name, one in model.policy.state_dict().items()})
        venv.close()
    assert all(torch.equal(one, weights[1][name]) for name, one in weights[0].items())
    # the other node still plays
    assert cluster.map("agents.learning.self_play:choices", *_some_choices())[0]["gains"].shape == (3,)


def _some_choices():
    at = Positions.of(tables(3, seed=3, layout="random:9"))
    given = {"at": self_play.positions_given(at), "rows": np.arange(3), "picks": np.zeros(3, int)}
    given["keys"] = np.arange(3, dtype=np.uint64)
    return {"run": "r", "options": {"noise": "club"}, "value": lambda left: np.ones(len(left))}, [given]


FAULTS = {
    "Failing": (RuntimeError, "a fault of mine"),
    "Greedy": (ClusterError, r"a worker on [\d.]+ ran out of memory: give the node fewer workers"),
    "Full": (ClusterError, r"the disk of a worker on [\d.]+ is full \(/scratch/x\)"),
    "Deadly": (ClusterError, "a part was given up, its worker died 2 times"),
}


def test_what_befalls_a_worker_is_one_line(cluster, monkeypatch):
    monkeypatch.setattr(ray_cluster, "RETRIES", 1)
    cluster, seeds = ray_cluster.Cluster(cluster._ray), tables_of("held_out", 2)
    for name, (kind, says) in FAULTS.items():
        agent = Entrant.of(f"tests.cluster.players:{name}")
        with pytest.raises(kind, match=says) as error:
            protocol.play_agent(agent, AT, seeds, 100, False, results_of([agent], seeds, cluster))
        assert "\n" not in str(error.value)


def test_the_data_of_imitation_are_the_same(cluster, monkeypatch):
    from agents.learning.imitation import Expert

    monkeypatch.setattr(self_play, "SLICE", 3)
    env = tables(8, seed=5, action="discrete", noise="club", layout="random:9")
    picks = np.array([np.flatnonzero(mask)[[1, 8, 20]] for mask in env.action_masks()])
    there = np.ones(picks.shape, bool)
    here, there_too = (
        Expert(env, 1, np.random.default_rng(0), where=where).worth(picks, there) for where in (None, cluster)
    )
    assert np.array_equal(here, there_too) and here.any()


def test_a_node_killed_amid_a_search_for_data_is_survived_and_nothing_counts_twice(
    nodes, cluster, folder, tmp_path, monkeypatch
):
    shared, done = {"search": sent(Entrant.of("tests.cluster.players:Thinking"), 0)}, []
    parts = searched.parts_of(6 * searched.TABLES * searched.ROUNDS, 0, AT | {"layout": "random:6"})
    store = Store(tmp_path / "data")
    with killed(nodes, folder, lambda: len(done) >= 2):
        for k, _ in ended(parts, shared, cluster, store):
            done.append(k)
    assert sorted(done) == list(range(6))  # that at which the node hung was begun twice
    monkeypatch.delenv("NOTED")
    keys = keys_of(parts, shared)
    assert store.names("parts") == {f"{key}.npz" for key in keys}
    for key, alone in zip(keys, in_order(ended(parts, shared, Here())), strict=True):
        far = store.part(key)
        assert far.keys() == alone.keys() and len(alone["scores"]) == searched.TABLES * searched.ROUNDS
        for name, one in alone.items():
            assert np.array_equal(one, far[name], equal_nan=one.dtype.kind == "f"), name


@contextmanager
def only_node(**variables):
    """A cluster of which one node plays, with these in its environment; the head has none of it."""
    made, joined = Nodes(initialize_head=True, head_node_args=NODE | {"num_cpus": 0}), None
    try:
        made.add_node(num_cpus=1, object_store_memory=100 * 2**20, env_vars=variables)
        made.wait_for_nodes()
        joined = connected(made.address)
        yield joined
    finally:
        if joined is not None:
            joined.close()
        made.shutdown()


def test_a_worker_that_ray_ends_for_its_memory_is_one_line(monkeypatch):
    """On a node whose limit is already passed."""
    monkeypatch.setenv("SLOW", "60")
    limit = {"RAY_memory_usage_threshold": "0.001", "RAY_memory_monitor_refresh_ms": "100"}
    agent, seeds = Entrant.of("tests.cluster.players:Noted"), tables_of("held_out", 2)
    with only_node(**limit) as where, pytest.raises(ClusterError, match=r"^a part was given up, .*memory"):
        protocol.play_agent(agent, AT, seeds, 100, False, results_of([agent], seeds, where))


def test_a_cluster_on_this_machine_is_its_own_whatever_the_environment_says(nodes, monkeypatch):
    monkeypatch.setenv("RAY_ADDRESS", nodes[0].address)
    found = connected("local", 1)
    try:
        assert found._ray.get_runtime_context().gcs_address != nodes[0].address and found.cores == 1
    finally:
        found.close()


@pytest.mark.parametrize("lack", ["numba is missing", "numpy is older"])
def test_a_node_with_other_software_or_none_is_refused(tmp_path, lack):
    """The only node that plays finds another version of a library first, or one that cannot be imported."""
    if lack == "numba is missing":
        (tmp_path / "numba.py").write_text("raise ModuleNotFoundError('none', name='numba')\n")
        says = r"the node [\d.]+ has no numba: install the same clone on every node \(pip install"
    else:
        info = tmp_path / "numpy-1.2.3.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: numpy\nVersion: 1.2.3\n")
        says = r"the node [\d.]+: it holds other software: numpy is 1.2.3 there and [\d.]+ here. Install the same"
    path, seeds = f"{tmp_path}{os.pathsep}{ROOT}", tables_of("held_out", 2)
    with only_node(PYTHONPATH=path) as where, pytest.raises(ClusterError, match=says):
        list(results_of([Entrant.of("random")], seeds, where))


def test_nothing_is_left_running():
    """After a cluster on this machine alone was closed."""
    found = connected("local")
    host, _, port = found._ray.get_runtime_context().gcs_address.rpartition(":")

    def answers():
        with socket.socket() as tried:
            return tried.connect_ex((host, int(port))) == 0

    assert answers()
    found.close()
    began = time.monotonic()
    while answers() and time.monotonic() - began < 20:
        time.sleep(0.5)
    assert not answers()
