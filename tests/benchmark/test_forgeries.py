"""Does ``check`` refuse what nobody played: forged points, strokes, episodes, dates, and any other value?"""

import base64
import copy
import zlib

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import COLUMNS, TASKS, Agent, checking, judge
from snooker_env.benchmark.checking import faults
from snooker_env.benchmark.results import (
    complete,
    figures_of,
    pack_strokes,
    strokes_of,
)
from snooker_env.benchmark.schema import UNPROVED
from tests.benchmark.records import at, inner, leaves, others, put, resized

OTHER_STROKE = "strokes: run {}, table {}: {} plays another stroke than number {} of the file"
CLUB, BREAK, HARD = (TASKS[f"Snooker{name}-v0"] for name in ("BreakClub", "Break", "Escape"))


class Aims:
    """The strokes of ``ghost_ball``, with an error of its own from the seed."""

    def at(self, rules):
        self.plain = sn.player("ghost_ball").at(rules)
        return self

    def play(self, positions, seeds):
        strokes = self.plain.play(positions, seeds)
        strokes.values[:, 3] += [np.random.default_rng(seed).uniform(-0.05, 0.05) for seed in seeds]
        return strokes


def agent():
    return Agent(label="aims", sources=(Aims(),), training_shots=0)


@pytest.fixture(scope="module")
def official():
    """All 500 episodes of ghost_ball with a club player's errors."""
    return judge(CLUB, Agent.of("ghost_ball"), command="a test")


@pytest.fixture(scope="module")
def boxes():
    """24 episodes of box actions."""
    record = judge(HARD, agent(), episodes=24)
    assert faults(record) == [] and 0 < record["figures"]["score"]["value"] < 1
    return record


def consistent(task, record):
    """With the figures that follow from its rows."""
    record["figures"] = figures_of(task, record["agent"]["label"], record["rows"])
    return record


@pytest.mark.parametrize("label", ["random", "genius"])
def test_a_maximum_in_every_visit(label):
    """Rows that the rules of snooker allow, figures that follow from them."""
    record = judge(BREAK, Agent(label=label, sources=(sn.player("random"),)), episodes=100)
    record["rows"] = [[0, seed, 147, 36, 147, 36, 0, 1, 0, 1, 0] for seed in BREAK.seeds(100)]
    record["agent"]["sources"] = [label if label == "random" else "mine:Genius"]
    consistent(BREAK, record)
    assert faults(record)[0].startswith("strokes.data = ")
    record["strokes"] = pack_strokes([np.zeros((36, 7), "<f4")] * 100)
    assert faults(record)[0].startswith("rows[0].") and faults(record)[-1].endswith(" more faults")


@pytest.mark.parametrize("name", ["random", "ghost_ball", "search_30", "ppo_value"])
def test_the_name_of_a_known_player_for_other_strokes(name):
    """Sound in all that a replay can see; but this player does not play so."""
    record = judge(HARD, agent(), episodes=30)
    assert faults(record) == []
    record["agent"] |= {"label": name, "sources": [name]}
    first = OTHER_STROKE.format(0, HARD.seeds(1)[0], name, 0)
    assert first in faults(record)


@pytest.mark.slow
def test_a_decision_after_a_foul_that_the_player_does_not_make():
    """A safety of a planner that is fouled against, with another decision."""
    task = TASKS["SnookerSafety-v0"]
    record = judge(task, Agent.of("search_30"), episodes=20)
    longer = [k for k, row in enumerate(record["rows"]) if row[3] > 1]
    strokes = [one.copy() for one in strokes_of(record)]
    assert longer and faults(record) == []
    for k in longer:
        strokes[k][1:, -1] = -strokes[k][1:, -1] if strokes[k][1:, -1].any() else -1.0
    record["strokes"] = pack_strokes(strokes)
    assert any(line.startswith(("strokes: ", "rows[")) for line in faults(record))


@pytest.mark.parametrize("share", [0.1, 1.1])
def test_a_planner_may_not_state_other_shots(share, monkeypatch):
    """All strokes asked again: to the shot. Some of them: as many a decision as were seen."""
    record = judge(HARD, Agent.of("search_30"), episodes=12)
    assert faults(record) == []
    shots = record["timing"]["simulated_shots"]
    record["timing"]["simulated_shots"] = round(share * shots)
    record = complete(record, HARD)
    (line,) = faults(record)
    assert line.startswith(
        f"timing.simulated_shots = {round(share * shots)}: must be {shots}, as known players"
    )
    monkeypatch.setattr(checking, "TOGETHER", 2)
    monkeypatch.setattr(checking, "WORK", 1.0)
    (line,) = faults(record)
    assert line.startswith(f"timing.simulated_shots = {round(share * shots)}: must be ")


def test_tables_that_are_asked_again_are_not_known_beforehand(monkeypatch):
    """One forged episode of 24, a part of the file asked: found in some checks, and not in all."""
    record = judge(HARD, Agent.of("ghost_ball"), episodes=24)
    strokes = [one.copy() for one in strokes_of(record)]
    strokes[5][0, 1] = np.nextafter(strokes[5][0, 1], np.float32(1.0))
    record["strokes"] = pack_strokes(strokes)
    monkeypatch.setattr(checking, "TOGETHER", 4)
    monkeypatch.setattr(checking, "WORK", 8.0)
    found = {bool(faults(record)) for _ in range(20)}
    assert found == {True, False}


@pytest.mark.parametrize(("name", "training"), [("search_30", 0), ("planner_30", 10**7)])
def test_a_known_planner_is_not_model_free(name, training):
    """Its own strokes, as if no shot had been simulated for them."""
    record = judge(HARD, Agent.of(name, training_shots=training), episodes=4)
    assert faults(record) == [] and record["agent"]["class"] == "planning"
    record["timing"]["simulated_shots"] = 1
    (line,) = faults(complete(copy.deepcopy(record), HARD))
    assert line.startswith("timing.simulated_shots = 1: must be ")
    record["timing"]["simulated_shots"] = 0
    record["agent"] |= {"simulated_shots": 0.0, "class": "model_free"}
    (kind,) = faults(record)
    assert kind.startswith(f"agent.class = 'model_free': must be 'planning': '{name}' simulated ")


def test_a_player_of_the_menu_is_a_class_of_its_own():
    """A menu shows what its strokes do, and a file cannot deny that."""
    record = judge(HARD, Agent.of("strokes", training_shots=10**6), episodes=3)
    assert faults(record) == [] and record["agent"]["class"] == "foresight"
    record["agent"]["foresees"] = False
    assert faults(complete(record, HARD)) == ["agent.foresees = False: must be True, as of 'strokes'"]


@pytest.mark.parametrize(
    ("name", "training", "says"),
    [
        ("search_30", 50_000_000, "agent.training_shots = 50000000: must be 0, as search_30 says"),
        ("planner_30", 0, "agent.training_shots = 0: must be more than 0: something was learned"),
    ],
)
def test_known_players_were_trained_as_they_say(name, training, says):
    record = judge(HARD, Agent(label=name, sources=(name,), training_shots=training), episodes=3)
    assert faults(record) == [says]


def test_one_flipped_bit_of_a_stroke(boxes):
    """Bits of the first stroke, bits that the file gives, and the digest."""
    record, strokes = copy.deepcopy(boxes), strokes_of(boxes)
    for bit in range(0, 8 * strokes[0][0].nbytes, 5):
        raw = bytearray(strokes[0].tobytes())
        raw[bit // 8] ^= 1 << bit % 8
        flipped = np.frombuffer(bytes(raw), "<f4").reshape(strokes[0].shape)
        record["strokes"] = pack_strokes([flipped, *strokes[1:]]) | {"sha256": boxes["strokes"]["sha256"]}
        assert faults(record)[0].startswith("strokes.sha256 = ")
    raw = base64.b64decode(boxes["strokes"]["data"])
    for bit in np.random.default_rng(0).integers(0, 8 * len(raw), 30).tolist():
        other = bytearray(raw)
        other[bit // 8] ^= 1 << bit % 8
        record["strokes"] = boxes["strokes"] | {"data": base64.b64encode(bytes(other)).decode()}
        if wrong := faults(record):
            assert wrong[0].startswith("strokes."), bit
        else:
            assert zlib.decompress(other) == zlib.decompress(raw), bit
    record["strokes"] = boxes["strokes"] | {"sha256": "0" * 64}
    assert faults(record)[0].startswith("strokes.sha256 = ")


def test_other_strokes_are_found_by_what_they_score(boxes):
    """With a digest of their own: the softest stroke in each episode that escaped."""
    record, strokes = copy.deepcopy(boxes), [one.copy() for one in strokes_of(boxes)]
    fair = [k for k, row in enumerate(record["rows"]) if row[2]]
    for k in fair:
        strokes[k][0, 0] = -1.0
    record["strokes"] = pack_strokes(strokes)
    assert {line.split(".")[0] for line in faults(record)[:-1]} <= {f"rows[{k}]" for k in fair}
    assert faults(record)[0].startswith(f"rows[{fair[0]}].score = 1: must be 0, as its strokes play")


def test_strokes_too_few_and_too_many(boxes):
    for more, line in ((1, "2: must be 1, as its strokes play"), (-1, "0: must be more: the episode")):
        record, strokes = copy.deepcopy(boxes), strokes_of(boxes)
        record["rows"][3][COLUMNS.index("strokes")] += more
        strokes[3] = np.resize(strokes[3], (1 + more, 7))
        record["strokes"] = pack_strokes(strokes)
        record["agent"]["simulated_shots"] = 0.0
        refused = faults(consistent(HARD, record))
        assert any(one.startswith(f"rows[3].strokes = {line}") for one in refused), refused


def test_swapped_episodes_and_other_seeds(boxes):
    rows, strokes = copy.deepcopy(boxes["rows"]), strokes_of(boxes)
    a, b = (next(k for k, row in enumerate(rows) if row[2] == fair) for fair in (0, 1))
    record = copy.deepcopy(boxes)
    record["rows"][a], record["rows"][b] = copy.deepcopy((rows[b], rows[a]))
    assert faults(consistent(HARD, record))[0].startswith(f"rows[{min(a, b)}]: run 0, table ")
    for row, old in ((record["rows"][a], rows[a]), (record["rows"][b], rows[b])):
        row[1] = old[1]
    strokes[a], strokes[b] = strokes[b], strokes[a]
    record["strokes"] = pack_strokes(strokes)
    assert faults(consistent(HARD, record))[0].startswith((f"rows[{a}].", f"rows[{b}]."))
    later = copy.deepcopy(boxes)
    for row in later["rows"]:
        row[1] += 1
    says = "rows[0]: run 0, table 1000001: must be run 0, table 1000000, as the protocol says"
    assert faults(later) == [says]


@pytest.mark.slow
def test_a_change_of_any_field_is_refused_or_one_of_those_that_nothing_proves():
    """Of one row all columns are tried. What passes must be a field that the page calls unproved; none may be missing, none
    may be more."""
    boxes, passed = judge(HARD, agent(), episodes=4), set()
    for path in leaves(boxes):
        if path[0] == "rows" and path[1] != 3:
            continue
        for value in others(at(boxes, path)):
            refused = faults(put(boxes, path, value))
            assert all("\n" not in line for line in refused), (path, value)
            if refused == []:
                passed.add(".".join(part for part in path if isinstance(part, str)))
    for path in inner(boxes):
        if path[:1] != ("rows",) or path[1:] in ((), (3,)):
            for value in resized(at(boxes, path)):
                assert faults(put(boxes, path, value) if path else value), (path, value)
    assert passed <= set(UNPROVED), passed - set(UNPROVED)
    least = "agent.label agent.sources machine.cpu timing.seconds commit software.numpy"
    assert passed.issuperset(least.split())


def forged(record, task, episodes, better):
    """The record with the strokes from the second on that ``better`` plays after the same first ones, and its rows."""
    hindsight, played = sn.player(better), strokes_of(record)

    class After:
        def at(self, rules):
            self.player, self.number = hindsight.at(rules), -1
            return self

        def play(self, positions, seeds):
            self.number += 1
            if self.number:
                return self.player.play(positions, seeds)
            return sn.player(record["agent"]["label"]).at(self.player.options).play(positions, seeds)

    other = judge(task, Agent(label="after", sources=(After(),), training_shots=0), episodes=episodes)
    assert all(a[0].tobytes() == b[0].tobytes() for a, b in zip(strokes_of(other), played, strict=True))
    other["agent"] |= {name: record["agent"][name] for name in ("label", "sources", "training_shots")}
    other["timing"]["simulated_shots"] = record["timing"]["simulated_shots"]
    return complete(other, task)


def test_hindsight_from_the_second_stroke_on():
    """The first stroke is that of ghost_ball, all others are a better player's."""
    record = judge(BREAK, Agent.of("ghost_ball"), episodes=40)
    other = forged(record, BREAK, 40, "best_pot")
    assert other["figures"]["score"]["value"] > 1.5 * record["figures"]["score"]["value"]
    refused = faults(other)
    assert refused and all("ghost_ball plays another stroke than number " in line for line in refused)
    assert not any("number 0 " in line for line in refused)
