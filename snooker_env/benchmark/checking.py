"""Is a submitted result what it says? Its fields, seeds, number of episodes, rows and figures, each fault in one line."""

from typing import Any

from .._check import refuse
from .agents import KINDS, Agent
from .figures import figures_of
from .playing import COLUMNS, PlayedEpisodes
from .possible import faults_of_row
from .results import budget_of, class_of, missing
from .run import add, begin, play_episodes
from .schema import MOST_WHOLE, NAME, PROTOCOL, VERSION, faults_of_fields, shortened
from .statistics import RESAMPLES
from .tasks import FREE, HELD_OUT_SEED, TASKS

MOST = 12
"""Faults of rows that are named."""


def faults(found: Any) -> list[str]:
    """Check a result: its fields, seeds, number of episodes, rows and figures.

    Parameters
    ----------
    found : object
        The content of a result file, as ``read_result`` returns it.

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
    said = faults_of_fields(found)
    if said:
        return said
    for name, want in (
        ("schema.name", NAME), ("schema.version", VERSION), ("protocol.version", PROTOCOL), ("protocol.first_seed", HELD_OUT_SEED),
        ("protocol.resamples", RESAMPLES),
    ):  # fmt: skip
        part, key = name.split(".")
        if found[part][key] != want:
            said.append(f"{name} = {found[part][key]!r}: must be {want!r} for this version of snooker_env")
    if found["task"] not in TASKS:
        said.append(f"task = {found['task']!r}: must be one of {', '.join(TASKS)}")
    if found["columns"] != list(COLUMNS):
        said.append(f"columns = {found['columns']!r}: must be {list(COLUMNS)}")
    if said:
        return said
    task = TASKS[found["task"]]
    if found["protocol"]["episodes"] > task.episodes:
        said.append(f"protocol.episodes = {found['protocol']['episodes']}: must be at most {task.episodes} on {task.id}")
    said += _faults_of_agent(found, task)
    sources = found["agent"]["sources"]
    if not sources or not all(isinstance(source, str) and source for source in sources):
        said.append("agent.sources: must be texts, one for each training seed")
    elif len(set(sources)) < len(sources):
        said.append("agent.sources: must be different: the same one twice makes nothing surer")
    elif len(sources) > 1 and found["agent"]["kind"] not in ("model", "repository"):
        said.append(f"agent.sources: must be one for an agent of kind {found['agent']['kind']}")
    return said or _faults_of_rows(found, task)


def _faults_of_agent(found, task):
    said, agent, timing = [], found["agent"], found["timing"]
    if agent["kind"] not in KINDS:
        said.append(f"agent.kind = {agent['kind']!r}: must be one of {', '.join(KINDS)}")
    other = [name for name in agent["options"] if name not in FREE]
    try:
        if other:
            raise refuse("key of options", other[0], f"must be one of {', '.join(FREE)}")
        task.judged(**agent["options"])
    except (ValueError, TypeError) as error:
        said.append(f"agent.options: {error}"[:160])
    if agent["budget"] != budget_of(agent["training_shots"]):
        said.append(f"agent.budget = {agent['budget']!r}: must be {budget_of(agent['training_shots'])!r} by agent.training_shots")
    if agent["class"] != class_of(agent["simulated_shots"]):
        said.append(f"agent.class = {agent['class']!r}: must be {class_of(agent['simulated_shots'])!r} by agent.simulated_shots")
    if agent["kind"] == "program":
        if not agent["declared"]:
            said.append("agent.declared = False: must be True: the shots of a program cannot be counted")
        if timing["tables_at_once"] != 1:
            said.append(f"timing.tables_at_once = {timing['tables_at_once']}: must be 1 for a program")
    elif agent["simulated_shots"] is None:
        said.append(f"agent.simulated_shots = None: must be a number for an agent of kind {agent['kind']}")
    else:
        counted = timing["simulated_shots"] / timing["decisions"] if timing["decisions"] else 0.0
        if agent["simulated_shots"] < counted * (1 - 1e-9):
            said.append(f"agent.simulated_shots = {agent['simulated_shots']:g}: must be at least {counted:g}, as timing counts them")
        elif not agent["declared"] and agent["simulated_shots"] > counted * (1 + 1e-9):
            said.append(f"agent.simulated_shots = {agent['simulated_shots']:g}: must be {counted:g}, as timing counts them, or declared")
    if (timing["one_table_ms"] is None) != (timing["one_table_decisions"] == 0):
        said.append("timing.one_table_ms: must be null if one_table_decisions is 0, and only then")
    return said


def _faults_of_rows(found, task):
    rows, said = found["rows"], []
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != len(COLUMNS) or any(type(x) is not int or abs(x) > MOST_WHOLE for x in row):
            return [f"rows[{k}] = {shortened(row)}: must be {len(COLUMNS)} whole numbers"]
    seeds = task.seeds(found["protocol"]["episodes"])
    runs = len(found["agent"]["sources"])
    want = [(run, seed) for run in range(runs) for seed in seeds]
    got = [(row[0], row[1]) for row in rows]
    if found["incomplete"] is None and len(rows) != len(want):
        said.append(f"rows: must be {len(want)} episodes ({runs} x {len(seeds)}), not {len(rows)}; or incomplete must say why")
    known = set(want)
    for k, (one, other) in enumerate(zip(got, want[: len(got)] + [None] * len(got), strict=False)):
        if one != other and not (found["incomplete"] is not None and one in known):
            allowed = "no more rows" if other is None else f"run {other[0]}, table {other[1]}, as the protocol says"
            said.append(f"rows[{k}]: run {one[0]}, table {one[1]}: must be {allowed}")
            break
    if len(set(got)) < len(got):
        said.append("rows: an episode stands there twice")
    wrong = [line for k, row in enumerate(rows) for line in faults_of_row(k, dict(zip(COLUMNS, row, strict=True)), task)]
    said += wrong[:MOST]
    if len(wrong) > MOST:
        said.append(f"rows: {len(wrong) - MOST} more faults")
    if sum(row[COLUMNS.index("strokes")] for row in rows) > found["timing"]["decisions"]:
        said.append("timing.decisions: must be at least the strokes of all rows")
    if said:
        return said
    said += _faults_of_figures(found["figures"], figures_of(task, found["agent"]["label"], rows) if rows else None)
    if not said and found["protocol"]["official"] != (not missing(found, task)):
        said.append(f"protocol.official = {found['protocol']['official']}: must be {(not missing(found, task))} by the rules")
    return said


def _faults_of_figures(got: Any, want: Any, name: str = "figures") -> list[str]:
    """Where figures differ from those that follow from the rows."""
    if isinstance(want, dict) and isinstance(got, dict):
        other = [f"{name}.{key}: is no figure" for key in got if key not in want]
        return other + [line for key in want for line in _faults_of_figures(got.get(key), want[key], f"{name}.{key}")]
    if isinstance(want, list) and isinstance(got, list) and len(want) == len(got):
        return [line for k in range(len(want)) for line in _faults_of_figures(got[k], want[k], f"{name}[{k}]")]
    if got == want or (type(got) in (int, float) and type(want) in (int, float) and _close(got, want)):
        return []
    shown = want if isinstance(want, int | float | type(None)) else "what follows from the rows"
    return [f"{name} = {shortened(got)}: must be {shown}"]


def _close(got: Any, want: Any) -> bool:
    return abs(got) <= MOST_WHOLE and abs(got - want) <= 1e-9 * max(1.0, abs(want))


def replayed(found: dict[str, Any], agent: Agent, episodes: int, threads: int | None = None) -> list[str]:
    """Play the first episodes of a result again, of every training seed, and compare the rows.

    Only whole batches are played, so the number of episodes may be larger than ``episodes``.

    Parameters
    ----------
    found : dict
        A result without faults.
    agent : Agent
        The agent of the result.
    episodes : int
        The least number of episodes of each training seed.
    threads : int, optional
        As in ``SnookerVectorEnv``.

    Returns
    -------
    list of str
        One line for each row that differs.

    Raises
    ------
    ValueError
        If the agent is not that of the file: another kind, another number of training seeds, or other options.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS, Agent, judge, replayed
    >>> agent = Agent.of("random")
    >>> replayed(judge(TASKS["SnookerPotHard-v0"], agent, episodes=2), agent, 2)
    []
    """
    task, batch, own = TASKS[found["task"]], found["timing"]["tables_at_once"], found["agent"]
    seeds, again = task.seeds(found["protocol"]["episodes"]), PlayedEpisodes([])
    if agent.kind != own["kind"]:
        raise refuse("agent", agent.kind, f"must be of the kind that the file says: {own['kind']}")
    if len(agent.sources) != len(own["sources"]):
        raise refuse("agent", ",".join(agent.sources), f"must have the {len(own['sources'])} training seeds of the file")
    for run in range(len(agent.sources)):
        player = agent.player(task, run)
        try:
            if dict(player.options) != own["options"] and found["rows"]:
                raise refuse("options", dict(player.options), f"must be those of the file: {own['options']}")
            for first in range(0, min(episodes, len(seeds)), batch):
                begin(player, first // batch)
                add(again, play_episodes(task, player, seeds[first : first + batch], run, threads))
        finally:
            if callable(getattr(player, "close", None)):
                player.close()
    kept = {(row[0], row[1]): row for row in found["rows"]}
    return [
        f"run {row[0]}, table {row[1]}: played again {dict(zip(COLUMNS[2:], row[2:], strict=True))}, the file has {old[2:]}"
        for row in again.rows if (old := kept.get((row[0], row[1]), row)) != row
    ]  # fmt: skip
