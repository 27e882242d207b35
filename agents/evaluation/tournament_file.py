"""What is the file of a tournament? Its fields with their meanings, one row for each frame, and whether it is what it says.

The fields about software, machine, command, commit and date are those of a benchmark's result (``docs/benchmark.md``), written and checked
by the same code. The rest differs, since a tournament has many players and no frozen task: so the file has a name of its own.
"""

from datetime import datetime, timezone
from itertools import groupby

from snooker_env.benchmark import commit, faults_of_fields, machine, read_result, software
from snooker_env.checks import refuse

from .tournament_figures import ANCHOR_ELO, COLUMNS, COUNTED, figures_of, schedule
from .tournament_report import NAME
from .tournament_strengths import PRIOR

VERSION = 1
NUMBER = (int, float)

FIELDS = {
    "schema.name": (str, False, f'"{NAME}"'),
    "schema.version": (int, False, f"{VERSION}; another number means other fields"),
    "protocol.first_seed": (int, False, "seed of the first match of each pair"),
    "protocol.matches": (int, False, "matches of each pair, two on each seed"),
    "protocol.fewer": (dict, False, "label -> matches of each pair with this player, where they are fewer"),
    "protocol.best_of": (int, False, "frames of a match"),
    "protocol.tables": (int, False, "tables side by side"),
    "protocol.chunk": (int, False, "seeds for which a player is made anew"),
    "protocol.search_budget": (int, False, "simulated shots a decision of search"),
    "protocol.resamples": (int, False, "bootstrap samples of the intervals"),
    "protocol.prior": (NUMBER, False, "drawn matches added to each pair for the strengths"),
    "protocol.anchor": (str, False, "the player whose Elo is given"),
    "protocol.anchor_elo": (NUMBER, False, "his Elo"),
    "game": (dict, False, "options of the frames: noise, physics, max_strokes and those that were changed"),
    "players": (list, False, "one object for each, see below"),
    **{f"software.{name}": (str, name not in ("snooker_env", "python"), "version; null: not installed") for name in software()},
    "machine.platform": (str, False, "operating system and processor architecture"),
    "machine.cpu": (str, False, "the processor's name"),
    "machine.cores": (int, False, "logical processors"),
    "machine.load": (NUMBER, True, "load average of the minute before the first frame"),
    "machine.load_at_end": (NUMBER, True, "load average of the minute before the last one ended"),
    "command": (str, False, "how this file was made"),
    "commit": (str, True, "of the checkout, with -dirty if files were changed; null outside one"),
    "date": (str, False, "when, in UTC: 2026-11-22T19:00:00Z"),
    "columns": (list, False, "names of the columns of rows"),
    "rows": (list, False, "one list of whole numbers for each frame, see below"),
    "figures": (dict, True, "what follows from the rows, see below; null: there are none"),
    "incomplete": (str, True, "why frames are missing; null: none are"),
}
"""Dotted name: type, whether it may be null, meaning."""
PLAYER = {
    "label": (str, "the name in tables"),
    "source": (str, "what was given on the command line: a name, a file or MODULE:CLASS"),
    "options": (dict, "how it sees and acts"),
    "training": (dict, "how it was trained, as far as its file says"),
    "decisions": (int, "how often it decided, on tables that wait for others to end, too"),
    "seconds": (NUMBER, "what that took together"),
}
"""Fields of a player: type, meaning."""
RANGES = {
    "protocol.matches": (2, 2**20), "protocol.best_of": (1, 99), "protocol.resamples": (100, 10**6), "protocol.tables": (1, 2**20),
    "protocol.chunk": (1, 2**20), "protocol.search_budget": (2, 2**31), "protocol.prior": (0, 1000), "protocol.first_seed": (0, 2**53),
    "protocol.anchor_elo": (-(10**6), 10**6),
}  # fmt: skip
MOST = 12
"""Faults of rows that are named."""


def seeds_of(protocol, labels, pair):
    """The seeds on which two players meet.

    Parameters
    ----------
    protocol : dict
        As in the file.
    labels : list of str
        Of all players.
    pair : (int, int)
        Their indices.

    Returns
    -------
    list of int
    """
    matches = min(protocol["fewer"].get(labels[k], protocol["matches"]) for k in pair)
    return list(range(protocol["first_seed"], protocol["first_seed"] + matches // 2))


def result_of(protocol, game, players, rows, *, command, load, incomplete):
    """The object of a file.

    Parameters
    ----------
    protocol, game : dict
        As in the file.
    players : list of dict
        With the fields ``PLAYER``.
    rows : list of list of int
        One for each frame, columns ``tournament_figures.COLUMNS``.
    command : str
        The command line.
    load : dict
        ``machine()`` before the first frame.
    incomplete : str, optional
        Why frames are missing.

    Returns
    -------
    dict
    """
    labels = [player["label"] for player in players]
    return {
        "schema": {"name": NAME, "version": VERSION}, "protocol": protocol, "game": game, "players": players, "software": software(),
        "machine": load | {"load_at_end": machine()["load"]}, "command": command, "commit": commit(),
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"), "columns": list(COLUMNS), "rows": rows,
        "figures": figures_of(labels, rows, protocol["anchor"], protocol["resamples"]) if rows else None, "incomplete": incomplete,
    }  # fmt: skip


def faults(found):
    """Check the file of a tournament: fields, players, which frames are there, each frame, and the figures.

    Parameters
    ----------
    found : object
        As ``snooker_env.benchmark.read_result`` reads it.

    Returns
    -------
    list of str
        A line for each fault; empty if there is none.
    """
    said = faults_of_fields(found, FIELDS, RANGES, VERSION)
    if said:
        return said
    protocol = found["protocol"]
    for name, got, want in (
        ("schema.name", found["schema"]["name"], NAME), ("schema.version", found["schema"]["version"], VERSION),
        ("columns", found["columns"], list(COLUMNS)), ("protocol.prior", protocol["prior"], PRIOR),
        ("protocol.anchor_elo", protocol["anchor_elo"], ANCHOR_ELO),
    ):  # fmt: skip
        if got != want:
            said.append(f"{name} = {got!r}: must be {want!r} for this version of snooker_env")
    for k, player in enumerate(found["players"]):
        if not isinstance(player, dict) or set(player) != set(PLAYER):
            said.append(f"players[{k}]: must be an object with {', '.join(PLAYER)}")
        else:
            wrong = [name for name, (kind, _) in PLAYER.items() if not isinstance(player[name], kind) or isinstance(player[name], bool)]
            said += [f"players[{k}].{name} = {player[name]!r}: must be {PLAYER[name][1]}" for name in wrong]
    if said:
        return said
    labels = [player["label"] for player in found["players"]]
    if len(labels) < 2 or len(set(labels)) < len(labels) or protocol["anchor"] not in labels:
        return ["players: must be two or more with different labels, the anchor among them"]
    for name, matches in [("matches", protocol["matches"]), *protocol["fewer"].items()]:
        if type(matches) is not int or not 2 <= matches <= protocol["matches"] or matches % 2:
            said.append(f"protocol: {name} = {matches!r}: must be an even number, at least 2 and at most protocol.matches")
    said += [f"protocol.fewer: {label!r} is no player" for label in protocol["fewer"] if label not in labels]
    return said or _faults_of_rows(found, labels)


def _faults_of_rows(found, labels):
    rows, protocol = found["rows"], found["protocol"]
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != len(COLUMNS) or any(type(x) is not int or abs(x) > 2**53 for x in row):
            return [f"rows[{k}]: must be {len(COLUMNS)} whole numbers"]
    want = [
        (*pair, seed, opener) for pair in schedule(labels) for seed in seeds_of(protocol, labels, pair) for opener in (0, 1)
    ]  # fmt: skip
    matches = [(key, list(frames)) for key, frames in groupby(rows, key=lambda row: tuple(row[:4]))]
    said = []
    for (got, _), other in zip(matches, [*want, *[None] * len(matches)], strict=False):
        if got != other:
            said.append(f"rows: a match of players {got[:2]} on seed {got[2]}, opener {got[3]}: must be {other or 'no more'}")
            break
    if found["incomplete"] is None and len(matches) < len(want):
        said.append(f"rows: must be {len(want)} matches, not {len(matches)}; or incomplete must say why")
    said += [f"rows: players {key[:2]}, seed {key[2]}, opener {key[3]}: {why}" for key, f in matches if (why := _match(f, protocol))][:MOST]
    wrong = [f"rows[{k}]: {why}" for k, row in enumerate(rows) if (why := _frame(dict(zip(COLUMNS, row, strict=True))))]
    said += wrong[:MOST] + ([f"rows: {len(wrong) - MOST} more faults"] if len(wrong) > MOST else [])
    if said:
        return said
    figures = figures_of(labels, rows, protocol["anchor"], protocol["resamples"]) if rows else None
    return _differences(found["figures"], figures, "figures")


def _match(frames, protocol):
    """What is wrong with the frames of one match; "" if nothing is."""
    best_of, won = protocol["best_of"], [0.0, 0.0]
    for k, row in enumerate(frames):
        frame, winner = row[4], row[5]
        if winner not in (-1, 0, 1):
            return f"winner = {winner}: must be 0, 1, or -1 for a frame that was stopped"
        if frame != k or k >= best_of or max(won) > 0.5 * best_of:
            return f"frame {frame} must not follow: a match is the best of {best_of} frames"
        for side in (0, 1):
            won[side] += 0.5 if winner < 0 else float(winner == side)
    whole = len(frames) == best_of or max(won) > 0.5 * best_of
    return "" if whole else f"{len(frames)} frames: the best of {best_of} is not decided"


def _frame(row):
    """What cannot be of one frame; "" if nothing is."""
    for side, other in (("first", "second"), ("second", "first")):
        c = {name: row[f"{name}_{side}"] for name in COUNTED}
        given = c["points"] - c["scored"]
        if min(c.values()) < 0:
            return f"{side}: numbers must be 0 or more"
        if not (c["visits"] <= c["strokes"] and c["fouls"] <= c["visits"] and (c["visits"] > 0) == (c["strokes"] > 0)):
            return f"{side}: fouls must be at most the visits, and these at most the strokes"
        if not c["best"] <= c["scored"] <= c["best"] * c["visits"]:
            return f"{side}: scored = {c['scored']}: must be possible with {c['visits']} visits, the best of {c['best']}"
        if (given > 0) != (row[f"fouls_{other}"] > 0) or given < 4 * row[f"fouls_{other}"]:
            return f"{side}: points = {c['points']}: must be {c['scored']} and 4 or more for each of {row[f'fouls_{other}']} fouls"
    return ""


def _differences(got, want, name):
    """Where figures differ from those that follow from the rows."""
    if isinstance(want, dict) and isinstance(got, dict) and set(got) == set(want):
        return [line for key in want for line in _differences(got[key], want[key], f"{name}.{key}")]
    if isinstance(want, list) and isinstance(got, list) and len(got) == len(want):
        return [line for k in range(len(want)) for line in _differences(got[k], want[k], f"{name}[{k}]")]
    close = isinstance(want, float) and isinstance(got, int | float) and abs(got - want) <= 1e-6 * max(1.0, abs(want))
    if got == want or close:
        return []
    return [f"{name}: must be what follows from the rows"]


def kept(path, protocol, game, sources):
    """An incomplete file of the same tournament.

    Parameters
    ----------
    path : Path
        The file.
    protocol, game : dict
        What is to be played.
    sources : list of (str, str)
        Label and source of each player.

    Returns
    -------
    dict
        The file's content.

    Raises
    ------
    ValueError
        If it is no sound file, or one of another tournament.
    """
    found = read_result(path)
    said = faults(found)
    if said:
        raise refuse("out", str(path), f"must be the file of a tournament to go on with ({said[0]})")
    same = {"protocol": protocol, "game": game, "players": [list(pair) for pair in sources]}
    own = {"protocol": found["protocol"], "game": found["game"], "players": [[p["label"], p["source"]] for p in found["players"]]}
    for name in same:
        if same[name] != own[name]:
            raise refuse("out", str(path), f"must be a file with the same {name} to go on with: it has {own[name]}")
    return found
