"""What does a tournament's file hold? Fields and one row for each frame, with checks of their consistency.

Software, machine, command, commit and date are as in a benchmark result (``docs/benchmark.md``).
"""

from datetime import datetime, timezone
from itertools import groupby

from snooker_env.benchmark.provenance import commit, machine, software
from snooker_env.benchmark.results import read_result
from snooker_env.benchmark.schema import faults_of_fields
from snooker_env.checks import refuse

from .tournament_figures import ANCHOR_ELO, COLUMNS, PRIOR, figures_of, schedule
from .tournament_report import NAME

VERSION = 4
NUMBER = (int, float)

FIELDS = {
    "schema.name": (str, False, f'"{NAME}"'),
    "schema.version": (int, False, f"{VERSION}; another number means other fields"),
    "protocol.first_seed": (int, False, "seed of the first match of each pair"),
    "protocol.matches": (int, False, "matches of each pair, two on each seed"),
    "protocol.best_of": (int, False, "frames of a match"),
    "protocol.tables": (int, False, "tables side by side"),
    "protocol.chunk": (int, False, "seeds after which each player is created again"),
    "protocol.resamples": (int, False, "bootstrap samples of the intervals"),
    "protocol.prior": (NUMBER, False, "drawn matches added to each pair for the strengths"),
    "protocol.anchor": (str, False, "the player with fixed Elo"),
    "protocol.anchor_elo": (NUMBER, False, "its Elo"),
    "game": (dict, False, "options of the frames: noise, physics, max_strokes and changed options"),
    "players": (list, False, "one object per player, see below"),
    **{
        f"software.{name}": (str, name not in ("snooker_env", "python"), "version; null: not installed")
        for name in software()
    },
    "machine.platform": (str, False, "operating system and processor architecture"),
    "machine.cpu": (str, False, "the processor's name"),
    "machine.cores": (int, False, "logical processors"),
    "machine.load": (NUMBER, True, "load average of the minute before the first frame"),
    "machine.load_at_end": (NUMBER, True, "load average of the minute before the last frame ended"),
    "command": (str, False, "command that made this file"),
    "commit": (
        str,
        True,
        "commit of the checkout, with -dirty if files were changed; null outside a checkout",
    ),
    "date": (str, False, "date in UTC: 2026-11-22T19:00:00Z"),
    "columns": (list, False, "names of the columns of rows"),
    "rows": (list, False, "one list of whole numbers for each frame, see below"),
    "figures": (dict, True, "figures computed from the rows, see below; null if there are none"),
    "incomplete": (str, True, "why frames are missing; null if complete"),
}
"""Dotted name -> type, whether it may be null, meaning."""
PLAYER = {
    "label": (str, "the name in tables"),
    "source": (str, "argument of the command line: a name, a file or MODULE:CLASS"),
    "training": (dict, "its training according to its file"),
    "decisions": (int, "number of decisions, including tables that wait for others to end"),
    "seconds": (NUMBER, "total time of these decisions"),
    "shots": (int, "shots simulated for these decisions"),
}
"""Fields of a player -> type, meaning."""
RANGES = {
    "protocol.matches": (2, 2**20),
    "protocol.best_of": (1, 99),
    "protocol.resamples": (100, 10**6),
    "protocol.tables": (1, 2**20),
    "protocol.chunk": (1, 2**20),
    "protocol.prior": (0, 1000),
    "protocol.first_seed": (0, 2**53),
    "protocol.anchor_elo": (-(10**6), 10**6),
}


def seeds_of(protocol):
    """The seeds of each pair's matches."""
    return list(range(protocol["first_seed"], protocol["first_seed"] + protocol["matches"] // 2))


def result_of(protocol, game, players, rows, *, command, load, incomplete):
    """Make the content of a file."""
    labels = [player["label"] for player in players]
    return {
        "schema": {"name": NAME, "version": VERSION},
        "protocol": protocol,
        "game": game,
        "players": players,
        "software": software(),
        "machine": load | {"load_at_end": machine()["load"]},
        "command": command,
        "commit": commit(),
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "columns": list(COLUMNS),
        "rows": rows,
        "figures": figures_of(labels, rows, protocol["anchor"], protocol["resamples"]) if rows else None,
        "incomplete": incomplete,
    }


def faults(content):
    """Check a tournament's file: one line per fault of fields, players, frames and figures."""
    wrong = faults_of_fields(content, FIELDS, RANGES, VERSION)
    if wrong:
        return wrong
    protocol = content["protocol"]
    form = {"schema.name": NAME, "schema.version": VERSION, "columns": list(COLUMNS)}
    form |= {"protocol.prior": PRIOR, "protocol.anchor_elo": ANCHOR_ELO}
    for name, want in form.items():
        room, _, field = name.rpartition(".")
        value = (content[room] if room else content)[field]
        if value != want:
            wrong.append(f"{name} = {value!r}: must be {want!r} for this version of snooker_env")
    for k, player in enumerate(content["players"]):
        if not isinstance(player, dict) or set(player) != set(PLAYER):
            wrong.append(f"players[{k}]: must be an object with {', '.join(PLAYER)}")
            continue
        for name, (kind, meaning) in PLAYER.items():
            if not isinstance(player[name], kind) or isinstance(player[name], bool):
                wrong.append(f"players[{k}].{name} = {player[name]!r}: must be {meaning}")
    if wrong:
        return wrong
    labels = [player["label"] for player in content["players"]]
    if len(labels) < 2 or len(set(labels)) < len(labels) or protocol["anchor"] not in labels:
        return ["players: must be two or more with different labels, the anchor among them"]
    if protocol["matches"] % 2:
        return [f"protocol.matches = {protocol['matches']}: must be even"]
    return _faults_of_rows(content, labels)


def _faults_of_rows(content, labels):
    rows, protocol = content["rows"], content["protocol"]
    for k, row in enumerate(rows):
        whole = isinstance(row, list) and all(type(x) is int and abs(x) <= 2**53 for x in row)
        if not whole or len(row) != len(COLUMNS):
            return [f"rows[{k}]: must be {len(COLUMNS)} whole numbers"]
    matches = {key: list(frames) for key, frames in groupby(rows, key=lambda row: tuple(row[:4]))}
    seeds = [(*pair, seed) for pair in schedule(labels) for seed in seeds_of(protocol)]
    want = [(*seed, opener) for seed in seeds for opener in (0, 1)]
    order = {key: n for n, key in enumerate(want)}
    for key, frames in matches.items():
        where = f"rows: a match of players {key[:2]} on seed {key[2]}, opener {key[3]}"
        if key not in order:
            return [f"{where}: must be one of this tournament's"]
        why = _match(frames, protocol["best_of"])
        if why:
            return [f"{where}: {why}"]
    if rows != sorted(rows, key=lambda row: (order[tuple(row[:4])], row[4])):
        return ["rows: must be in the order of pairs, seeds, openers and frames"]
    if content["incomplete"] is None and len(matches) < len(want):
        return [f"rows: must be {len(want)} matches, not {len(matches)}; or incomplete must say why"]
    figures = figures_of(labels, rows, protocol["anchor"], protocol["resamples"]) if rows else None
    return _differences(content["figures"], figures, "figures")


def _match(frames, best_of):
    """The fault in the frames of one match, or ""."""
    won = [0.0, 0.0]
    for k, row in enumerate(frames):
        frame, winner = row[4], row[5]
        if winner not in (-1, 0, 1):
            return f"winner = {winner}: must be 0, 1, or -1 for a stopped frame"
        if frame != k or k >= best_of or max(won) > 0.5 * best_of:
            return f"frame {frame} must not follow: a match is the best of {best_of} frames"
        for side in (0, 1):
            won[side] += 0.5 if winner < 0 else float(winner == side)
    whole = len(frames) == best_of or max(won) > 0.5 * best_of
    return "" if whole else f"{len(frames)} frames: the best of {best_of} is not decided"


def _differences(value, want, name):
    """Yield the names of figures that differ from those computed from the rows."""
    if isinstance(want, dict) and isinstance(value, dict) and set(value) == set(want):
        return [line for key in want for line in _differences(value[key], want[key], f"{name}.{key}")]
    if isinstance(want, list) and isinstance(value, list) and len(value) == len(want):
        return [line for k in range(len(want)) for line in _differences(value[k], want[k], f"{name}[{k}]")]
    close = False
    if isinstance(want, float) and isinstance(value, int | float):
        close = abs(value - want) <= 1e-6 * max(1.0, abs(want))
    same = (
        not isinstance(value, dict | list) and value == want
    )  # NumPy compares a list with a number item by item
    return [] if same or close else [f"{name}: must follow from the rows"]


def read_incomplete(path, protocol, game, sources):
    """Read an incomplete file of the same tournament. Raises ValueError."""
    content = read_result(path)
    wrong = faults(content)
    if wrong:
        raise refuse("out", str(path), f"must be the file of a tournament to continue ({wrong[0]})")
    players = [(player["label"], player["source"]) for player in content["players"]]
    now = {"protocol": protocol, "game": game, "players": sources}
    for name, was in (content | {"players": players}).items():
        if name in now and was != now[name]:
            raise refuse(
                "out", str(path), f"must be a file with the same {name} to continue, but it has {was}"
            )
    return content
