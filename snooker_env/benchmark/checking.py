"""Is a submitted result what it says? Its strokes are played again, without the agent; rows and figures must be theirs, to the last bit."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import refuse
from ..simulation import SimulationError
from ..tasks.options import MAX_STROKES
from .agents import KINDS, Agent, is_reserved, kind_by_name, plans
from .figures import figures_of
from .playing import BATCH, COLUMNS, PlayedEpisodes, begin, check_player, play_episodes
from .provenance import arithmetic
from .results import budget_of, class_of, missing, simulated_shots
from .schema import LONG_LINE, MOST_SOURCES, MOST_WHOLE, NAME, PACKAGES, PROTOCOL, VERSION, faults_of_fields, shortened
from .strokes import Repeater, unpacked
from .tasks import TASKS

MOST = 12
"""Faults of rows that are named."""
PLAYED_AGAIN = ("random", "ghost_ball")
"""Built-in players that decide fast enough to be played again by every check."""
SURE = 3.29
"""Standard errors that a fresh mean may be away: 99.9 %."""


def faults(found: Any, threads: int | None = None) -> list[str]:
    """Check a result: its fields, that they fit each other, and all rows and figures by a replay of its strokes.

    A result that says to be of ``random`` or ``ghost_ball`` must have the strokes that these play, too.

    Parameters
    ----------
    found : object
        The content of a result file, as ``read_result`` returns it.
    threads : int, optional
        As in ``SnookerVectorEnv``.

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
    for name, got, allowed in (
        ("schema.name", found["schema"]["name"], (NAME,)), ("schema.version", found["schema"]["version"], (VERSION,)),
        ("protocol.version", found["protocol"]["version"], (PROTOCOL,)), ("task", found["task"], tuple(TASKS)),
        ("software.snooker_env", found["software"]["snooker_env"], PACKAGES),
    ):  # fmt: skip
        if got not in allowed:
            said.append(f"{name} = {shortened(got)}: must be {'one of ' * (len(allowed) > 1)}{', '.join(map(str, allowed))}")
    if found["columns"] != list(COLUMNS):
        said.append(f"columns = {shortened(found['columns'])}: must be {list(COLUMNS)}")
    if said:
        return said
    task = TASKS[found["task"]]
    if found["protocol"]["episodes"] > task.episodes:
        return [f"protocol.episodes = {found['protocol']['episodes']}: must be at most {task.episodes} on {task.id}"]
    said += _faults_of_sources(found["agent"]) or _faults_of_agent(found["agent"], task) + (
        _faults_of_rows(found, task) or _of_shots(found)
    )
    if said:
        return said
    rows, label = found["rows"], found["agent"]["label"]
    try:
        strokes = strokes_of(found)
        said = _faults_of_runs(found, strokes) or _faults_of_play(found, task, strokes, threads)
        if not said:
            said = _faults_of_figures(found["figures"], figures_of(task, label, rows) if rows else None)
            if found["protocol"]["official"] != (not missing(found, task)):
                said.append(f"protocol.official = {found['protocol']['official']}: must be {(not missing(found, task))} by the rules")
        if not said and found["agent"]["sources"][0] in PLAYED_AGAIN:
            said = replayed(found, Agent.of(found["agent"]["sources"][0]), len(rows), threads)
    except (ValueError, SimulationError) as error:  # damaged, not in the action space, no shot that can be computed, another's options
        return [str(error)]
    return said


def strokes_of(found: dict[str, Any]) -> list[NDArray[Any]]:
    """The strokes of each row of a result whose rows have their form. ValueError if they are damaged.

    Parameters
    ----------
    found : dict

    Returns
    -------
    list of arrays
    """
    lengths = [row[COLUMNS.index("strokes")] for row in found["rows"]]
    return unpacked(found["strokes"], lengths, TASKS[found["task"]].judged(**found["agent"]["options"]).rules.actions)


def _faults_of_sources(agent):
    sources, kind = agent["sources"], agent["kind"]
    if kind not in KINDS:
        return [f"agent.kind = {shortened(kind)}: must be one of {', '.join(KINDS)}"]
    if not 0 < len(sources) <= MOST_SOURCES or not all(isinstance(one, str) and one and LONG_LINE[0].fullmatch(one) for one in sources):
        return ["agent.sources: must be texts, one for each training seed"]
    if len(set(sources)) < len(sources):
        return ["agent.sources: must be different: the same one twice makes nothing surer"]
    if len(sources) > 1 and kind not in ("model", "repository"):
        return [f"agent.sources: must be one for an agent of kind {kind}"]
    for of_name in map(kind_by_name, sources):
        if of_name not in (None, kind) or (of_name is None and kind in ("program", "built_in")):
            return [f"agent.kind = {kind!r}: must be {of_name or 'another'} with agent.sources {shortened(sources)}"]
    if is_reserved(agent["label"], sources):
        return [f"agent.label = {agent['label']!r}: must not be the name of another player than agent.sources"]
    return []


def _faults_of_agent(agent, task):
    said = []
    try:
        check_player(Repeater(agent["options"], []), task)
    except (ValueError, TypeError) as error:
        said.append(f"agent.options: {error}"[:160])
    if agent["kind"] == "built_in" and agent["training_shots"] != 0:
        said.append(f"agent.training_shots = {agent['training_shots']}: must be 0 for a built-in player")
    if agent["budget"] != budget_of(agent["training_shots"]):
        said.append(f"agent.budget = {shortened(agent['budget'])}: must be {budget_of(agent['training_shots'])!r} by agent.training_shots")
    if agent["kind"] in ("built_in", "repository") and agent["class"] == "model_free" and any(map(plans, agent["sources"])):
        said.append(f"agent.class = 'model_free': must be 'planning': {shortened(agent['sources'])} simulates shots")
    if agent["class"] != class_of(agent["simulated_shots"]):
        said.append(f"agent.class = {shortened(agent['class'])}: must be {class_of(agent['simulated_shots'])!r} by agent.simulated_shots")
    return said


def _faults_of_rows(found, task):
    """The form of the rows, and whose they are: run by run the episodes of the protocol, or where it was stopped the first of them."""
    rows, incomplete = found["rows"], found["incomplete"]
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != len(COLUMNS) or any(type(x) is not int or abs(x) > MOST_WHOLE for x in row):
            return [f"rows[{k}] = {shortened(row)}: must be {len(COLUMNS)} whole numbers"]
        strokes = row[COLUMNS.index("strokes")]
        if not 0 <= strokes <= MAX_STROKES:
            return [f"rows[{k}].strokes = {strokes}: must be between 0 and {MAX_STROKES}"]
    seeds = task.seeds(found["protocol"]["episodes"])
    want = [[run, seed] for run in range(len(found["agent"]["sources"])) for seed in seeds]
    if len(rows) > len(want) or (len(rows) < len(want) and incomplete is None):
        return [f"rows: must be {len(want)} episodes, {len(seeds)} for each training seed, not {len(rows)}; or incomplete must say why"]
    for k, (row, (run, seed)) in enumerate(zip(rows, want, strict=False)):
        if row[:2] != [run, seed]:
            return [f"rows[{k}]: run {row[0]}, table {row[1]}: must be run {run}, table {seed}, as the protocol says"]
    return []


def _faults_of_runs(found, strokes):
    """Two training seeds do not play whole results of a hundred episodes and more alike: they would be one."""
    many, known = found["protocol"]["episodes"], {}
    for run in range(len(strokes) // many if many >= 100 else 0):
        whole = b"".join(one.tobytes() for one in strokes[run * many : (run + 1) * many])
        if known.setdefault(whole, run) != run:
            return [f"agent.sources: {known[whole]} and {run} must be different training seeds: their strokes are equal"]
    return []


def _of_shots(found):
    agent, decisions = found["agent"], sum(row[COLUMNS.index("strokes")] for row in found["rows"])
    given, said = agent["simulated_shots"] if agent["declared"] else None, agent["declared"]
    want = simulated_shots(agent["kind"], given, found["timing"]["simulated_shots"], decisions)
    if (agent["simulated_shots"], said) == want:
        return []
    how = f"must be {want[0]}, {'declared' if want[1] else 'counted'}, by agent.kind and timing.simulated_shots"
    return [f"agent.simulated_shots = {agent['simulated_shots']}, {'declared' if said else 'counted'}: {how}"]


def _faults_of_play(found, task, strokes, threads):
    """Where the rows differ from what the strokes play."""
    said, rows = [], found["rows"]
    for first in range(0, len(rows), BATCH):
        some = rows[first : first + BATCH]
        player = Repeater(found["agent"]["options"], strokes[first : first + BATCH])
        played = play_episodes(task, player, [row[1] for row in some], threads=threads).rows
        for k, (row, want) in enumerate(zip(some, played, strict=True)):
            if player.short[k]:
                said.append(f"rows[{first + k}].strokes = {row[3]}: must be more: the episode goes on after them")
                continue
            wrong = [c for c in range(2, len(COLUMNS)) if row[c] != want[c]]
            said += [f"rows[{first + k}].{COLUMNS[c]} = {row[c]}: must be {want[c]}, as its strokes play" for c in wrong]
    made, here = found["machine"]["arithmetic"], arithmetic()
    if said and made != here:
        said = [f"machine.arithmetic = {made!r}: must be {here!r} to check it here, where strokes end otherwise in the last bits", *said]
    return said[:MOST] + ([f"rows: {len(said) - MOST} more faults"] if len(said) > MOST else [])


def _faults_of_figures(got: Any, want: Any, name: str = "figures") -> list[str]:
    """Where figures differ from those that follow from the rows."""
    if isinstance(want, dict) and isinstance(got, dict):
        other = [f"{name}.{key}: is no figure" for key in got if key not in want]
        return other + [line for key in want for line in _faults_of_figures(got.get(key), want[key], f"{name}.{key}")]
    if isinstance(want, list) and isinstance(got, list) and len(want) == len(got):
        return [line for k in range(len(want)) for line in _faults_of_figures(got[k], want[k], f"{name}[{k}]")]
    if type(got) is type(want) and got == want and str(got) == str(want):  # as texts: 0.0 is not -0.0
        return []
    shown = want if isinstance(want, int | float | type(None)) else "what follows from the rows"
    return [f"{name} = {shortened(got)}: must be {shown}"]


def replayed(found: dict[str, Any], agent: Agent, episodes: int, threads: int | None = None) -> list[str]:
    """Have the agent play the first episodes of a result again, of every training seed, and compare strokes and rows.

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
        One line for each episode that differs, and one if other shots were simulated for the same strokes.

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
    seeds = TASKS[found["task"]].seeds(found["protocol"]["episodes"])
    again = _by(agent, found, seeds, episodes, threads)
    kept = {(row[0], row[1]): (row, one.tobytes()) for row, one in zip(found["rows"], strokes_of(found), strict=True)}
    said = []
    for row, one in zip(again.rows, again.strokes, strict=True):
        mine = row, one.tobytes()
        old = kept.get((row[0], row[1]), mine)
        if old != mine:
            what = "other strokes" if old[0] == row else str(dict(zip(COLUMNS[2:], row[2:], strict=True)))
            said.append(f"run {row[0]}, table {row[1]}: played again {what}, the file has {old[0][2:]}")
    if not said and len(again.rows) == len(found["rows"]) and again.simulated != found["timing"]["simulated_shots"]:
        said.append(f"timing.simulated_shots = {found['timing']['simulated_shots']}: must be {again.simulated}, as the agent played again")
    return said


def afresh(found: dict[str, Any], agent: Agent, episodes: int, seed: int, threads: int | None = None) -> tuple[float, float, list[str]]:
    """Have the agent play a task on seeds that it cannot know, and compare its mean score and its class with those of the result.

    Parameters
    ----------
    found : dict
        A complete result without faults.
    agent : Agent
        The agent of the result.
    episodes : int
        Number of fresh episodes of each training seed, at least 2.
    seed : int
        The first of their seeds, drawn now: none that is public.
    threads : int, optional
        As in ``SnookerVectorEnv``.

    Returns
    -------
    mean, error : float
        The mean score of the fresh episodes, and the standard error of its difference to the result.
    faults : list of str
        One line if they differ by more than 3.29 standard errors, which one honest result in 1,000 does; one if a model-free agent
        simulates shots.

    Raises
    ------
    ValueError
        As ``replayed``.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS, Agent, afresh, judge
    >>> agent = Agent.of("random")
    >>> afresh(judge(TASKS["SnookerPotHard-v0"], agent, episodes=60), agent, 60, 2_000_000)[2]
    []
    """
    if found["figures"] is None:
        raise refuse("incomplete", found["incomplete"], "must be null to compare means")
    played = _by(agent, found, list(range(seed, seed + episodes)), episodes, threads)
    scores = [
        np.array([row[COLUMNS.index("score")] for row in rows], np.float64).reshape(len(agent.sources), -1).mean(0)
        for rows in (found["rows"], played.rows)
    ]
    (old, mean), error = (one.mean() for one in scores), float(np.sqrt(sum(one.var(ddof=1) / len(one) for one in scores)))
    said = [f"figures.score.value = {old:g}: must be within {SURE * error:.2g} of {mean:g}, as on fresh seeds"]
    said = said if abs(mean - old) > SURE * error else []
    if found["agent"]["class"] == "model_free" and played.simulated:
        shots = f"{played.simulated:,} shots for {played.decisions:,} strokes"
        said.append(f"agent.class = 'model_free': must be 'planning': it simulated {shots}")
    return float(mean), error, said


def _by(agent, found, seeds, episodes, threads):
    """What the agent of a result plays on these tables: whole batches, until so many episodes have been played."""
    own, batch, played = found["agent"], agent.tables_at_once or BATCH, PlayedEpisodes([])
    if agent.kind != own["kind"]:
        raise refuse("agent", agent.kind, f"must be of the kind that the file says: {own['kind']}")
    if len(agent.sources) != len(own["sources"]):
        raise refuse("agent", ",".join(agent.sources), f"must have the {len(own['sources'])} training seeds of the file")
    for run in range(len(agent.sources)):
        player = agent.player(TASKS[found["task"]], run)
        try:
            if dict(player.options) != own["options"] and found["rows"]:
                raise refuse("options", dict(player.options), f"must be those of the file: {own['options']}")
            for first in range(0, min(episodes, len(seeds)), batch):
                begin(player, first // batch)
                played.add(play_episodes(TASKS[found["task"]], player, seeds[first : first + batch], run, threads))
        finally:
            if callable(getattr(player, "close", None)):
                player.close()
    return played
