"""Is a submitted result what it says? Its strokes are played again; all that follows must be equal to the bit."""

import re
from typing import Any

import numpy as np

from ..players import player as player_named
from ..simulation import SimulationError
from ..tasks.options import MAX_STROKES
from . import playing, schema
from .agents import claims_player_name, is_player_name
from .playing import BATCH, COLUMNS, STROKES, Kept
from .provenance import arithmetic
from .results import complete, strokes_of
from .schema import fault, faults_of_fields, shorten
from .tasks import TASKS, Task

_BUDGET = re.compile(r"_\d+(?=@|$)")
MOST = 12  # faults of rows, and of strokes, that are named
WORK, SHOTS, TOGETHER = 1e5, 100, 50
"""How many decisions known players make again, where ``SHOTS`` simulated shots count as one more decision: enough for a whole
file, unless the budget is large. ``TOGETHER`` tables are played side by side."""


def faults(record: dict[str, Any], threads: int | None = None, *, asking: bool = True) -> list[str]:
    """Check a result: its fields, and every row and figure by a replay of its strokes.

    Players known by name must decide on the same strokes again: in all episodes or, if that would take long, in a random
    selection.

    Parameters
    ----------
    record : object
        The content of a result file, as ``read_result`` returns it.
    threads : int, optional
        As in ``SnookerVectorEnv``.
    asking : bool
        Whether known players are asked again.

    Returns
    -------
    list of str
        One line for each fault; empty if there is none.

    Examples
    --------
    >>> from snooker_env.benchmark import faults
    >>> len(faults({})) > 0
    True
    """
    if wrong := faults_of_fields(record) or _of_names(record):
        return wrong
    task = TASKS[record["task"]]
    if wrong := _of_sources(record["agent"]) + _of_rows(record, task):
        return wrong
    try:
        strokes = strokes_of(record)
        wrong = _of_runs(record, strokes) or _of_play(record, task, strokes, threads)
        wrong = wrong or _differences(record, complete(record, task))
        return wrong or (_of_decisions(record, task, strokes, threads) if asking else [])
    except (ValueError, SimulationError) as error:  # damaged, no actions, or no shot that can be computed
        return [str(error)]


def _of_names(record: dict[str, Any]) -> list[str]:
    """Check the fields that allow few values: without them nothing can be replayed."""
    here = (
        ("schema.version", record["schema"]["version"], (schema.VERSION,)),
        ("protocol.version", record["protocol"]["version"], (schema.PROTOCOL,)),
        ("task", record["task"], tuple(TASKS)),
        ("software.snooker_env", record["software"]["snooker_env"], schema.PACKAGES),
    )
    return [
        fault(name, value, "one of " * (len(allowed) > 1) + ", ".join(map(str, allowed)))
        for name, value, allowed in here
        if value not in allowed
    ]


def _of_sources(agent: dict[str, Any]) -> list[str]:
    """Check that the sources are different texts and that the label names no other player."""
    sources, form = agent["sources"], schema.LONG_LINE[0]
    texts = all(isinstance(one, str) and one and form.fullmatch(one) for one in sources)
    if not 0 < len(sources) <= schema.MOST_SOURCES or not texts:
        return ["agent.sources: must be texts, one for each training seed"]
    if len(set(map(_player_of, sources))) < len(sources):
        return ["agent.sources: must be different: the same one twice makes nothing surer"]
    if claims_player_name(agent["label"], sources):
        must = "must not be the name of another player than agent.sources"
        return [f"agent.label = {agent['label']!r}: {must}"]
    return []


def _player_of(source: str) -> tuple[str, int | None]:
    """A source as player and budget: search, search_120 and search_0120 are one player."""
    budget = getattr(player_named(source), "budget", None) if is_player_name(source) else None
    return (source if budget is None else _BUDGET.sub("", source)), budget


def _of_rows(result: dict[str, Any], task: Task) -> list[str]:
    """Check that the rows are the protocol's episodes, run by run; of a run that was stopped, the first ones."""
    rows, many, runs = result["rows"], result["protocol"]["episodes"], len(result["agent"]["sources"])
    if many > task.episodes:
        return [fault("protocol.episodes", many, f"at most {task.episodes} on {task.id}")]
    for k, row in enumerate(rows):
        numbers = isinstance(row, list) and len(row) == len(COLUMNS)
        if not numbers or not all(type(x) is int and abs(x) <= schema.MOST_WHOLE for x in row):
            return [fault(f"rows[{k}]", row, f"{len(COLUMNS)} whole numbers")]
        if not 0 <= row[STROKES] <= MAX_STROKES:
            return [fault(f"rows[{k}].strokes", row[STROKES], f"between 0 and {MAX_STROKES}")]
    want = [[run, seed] for run in range(runs) for seed in task.seeds(many)]
    if len(rows) > len(want) or (len(rows) < len(want) and result["incomplete"] is None):
        each = f"{len(want)} episodes, {many} for each training seed"
        return [f"rows: must be {each}, not {len(rows)}; or incomplete must say why"]
    for k, (row, (run, seed)) in enumerate(zip(rows, want, strict=False)):
        if row[:2] != [run, seed]:
            must = f"must be run {run}, table {seed}, as the protocol says"
            return [f"rows[{k}]: run {row[0]}, table {row[1]}: {must}"]
    return []


def _of_runs(result: dict[str, Any], strokes: Kept) -> list[str]:
    """Refuse training seeds that play a hundred episodes or more alike: they are one."""
    many, known = result["protocol"]["episodes"], {}
    for run in range(len(strokes) // many if many >= 100 else 0):
        whole = b"".join(one.tobytes() for one in strokes[run * many : (run + 1) * many])
        if known.setdefault(whole, run) != run:
            both = f"{known[whole]} and {run}"
            return [f"agent.sources: {both} must be different training seeds: their strokes are equal"]
    return []


def _of_play(result: dict[str, Any], task: Task, strokes: Kept, threads: int | None) -> list[str]:
    """Replay the strokes and compare the rows."""
    wrong, rows = list[str](), result["rows"]
    for first in range(0, len(rows), BATCH):
        some = rows[first : first + BATCH]
        tables = playing.tables_for(task, len(some), threads)
        decide = playing.Repeater(strokes[first : first + BATCH], tables.options.rules.actions.size)
        played = playing.rows_of(task, tables, [row[1] for row in some], decide)
        each = zip(some, played, decide.short.tolist(), strict=True)
        for k, (row, want, short) in enumerate(each, first):
            name = f"rows[{k}]"
            if short:
                wrong.append(fault(f"{name}.strokes", row[STROKES], "more: the episode goes on after them"))
                continue
            other = [c for c in range(2, len(COLUMNS)) if row[c] != want[c]]
            wrong += [fault(f"{name}.{COLUMNS[c]}", row[c], f"{want[c]}, as its strokes play") for c in other]
    more = [f"rows: {len(wrong) - MOST} more faults"] if len(wrong) > MOST else []
    return _elsewhere(result, wrong[:MOST] + more)


def _elsewhere(result: dict[str, Any], wrong: list[str]) -> list[str]:
    """The faults, after a line that says so if the file's machine rounds differently."""
    made, here = result["machine"]["arithmetic"], arithmetic()
    if not wrong or made == here:
        return wrong
    must = f"{here!r} to check it here, where strokes end otherwise in the last bits"
    return [fault("machine.arithmetic", made, must), *wrong]


def _differences(value: object, want: object, name: str = "") -> list[str]:
    """List where a record differs from what was computed again."""
    if isinstance(want, dict) and isinstance(value, dict):
        if set(value) != set(want):
            return [f"{name}: must have the fields {', '.join(want)}"]
        inner = [(f"{name}.{key}".lstrip("."), value[key], want[key]) for key in want]
        return [line for key, one, other in inner for line in _differences(one, other, key)]
    if isinstance(want, list) and isinstance(value, list) and len(want) == len(value):
        return [line for k in range(len(want)) for line in _differences(value[k], want[k], f"{name}[{k}]")]
    if type(value) is type(want) and value == want and str(value) == str(want):  # as texts: 0.0 is not -0.0
        return []
    right = f"{want!r} by" if isinstance(want, str | int | float | None) else "what follows from"
    return [fault(name, value, f"{right} the other fields")]


def _of_decisions(result: dict[str, Any], task: Task, strokes: Kept, threads: int | None) -> list[str]:
    """Have known players play whole episodes again, in an order that nobody can predict, as many as ``WORK`` allows."""
    agent, rows, rng, wrong = result["agent"], result["rows"], np.random.default_rng(), list[str]()
    known = [(run, source) for run, source in enumerate(agent["sources"]) if is_player_name(source)]
    asked = {run: rng.permutation([k for k, row in enumerate(rows) if row[0] == run]) for run, _ in known}
    rates, simulated, left = list[float](), 0, 0
    for run, source in known:
        training, its = agent["training_shots"], getattr(player_named(source), "training_shots", None)
        if training != its and (its is not None or training == 0):
            must = "more than 0: something was learned" if its is None else f"{its}, as {source} says"
            wrong.append(fault("agent.training_shots", training, must))
        work = 0.0
        for some in np.split(asked[run], range(TOGETHER, len(asked[run]), TOGETHER)):
            if work > WORK / len(known) or len(wrong) >= MOST:
                left += len(some)
                continue
            its = [rows[k][1] for k in some]
            played = playing.play_episodes(task, source, its, run, threads, lucky=False)
            for k, again in zip(some.tolist(), played.strokes, strict=True):
                if again.tobytes() != strokes[k].tobytes():
                    pairs = zip(strokes[k], again, strict=False)
                    n = next((n for n, (a, b) in enumerate(pairs) if a.tobytes() != b.tobytes()), len(again))
                    which = f"{source} plays another stroke than number {n} of the file"
                    wrong.append(f"strokes: run {run}, table {rows[k][1]}: {which}")
            if agent["class"] in ("model_free", "foresight") and played.simulated:
                shots = f"simulated {played.simulated:,} shots for {played.decisions:,} strokes"
                must = f"must be 'planning': {shorten(source)} {shots}"
                wrong.append(f"agent.class = {agent['class']!r}: {must}")
            if agent["foresees"] != played.foresees:
                must = f"must be {played.foresees}, as of {shorten(source)}"
                wrong.append(f"agent.foresees = {agent['foresees']}: {must}")
            simulated += played.simulated
            rates += [played.simulated / played.decisions] if played.decisions else []
            work += played.decisions + played.simulated / SHOTS
    if not wrong and rates:
        of_known = sum(len(one) for one, row in zip(strokes, rows, strict=True) if row[0] in asked)
        few, many = (simulated, simulated) if not left else (min(rates) * of_known, max(rates) * of_known)
        many = many if len(known) == len(agent["sources"]) else np.inf
        shots = result["timing"]["simulated_shots"]
        if not np.floor(few) <= shots <= np.ceil(many):
            must = f"{few:.0f}" if few == many else f"from {few:.0f} to {many:.0f}"
            must += ", as known players simulate when they are asked again"
            wrong = [fault("timing.simulated_shots", shots, must)]
    return _elsewhere(result, sorted(set(wrong))[:MOST] if len(wrong) > 1 else wrong)
