"""How is a tournament shown? The order of the players, the cross table and what they did, for a terminal and
as Markdown."""

from commands.tables import TextTable, page, shown

from .tournament_strengths import PRIOR

NAME = "snooker_env.tournament"
"""Name of the schema of a tournament's file."""


def ranked(found):
    """The labels of those who played, the highest Elo first."""
    players = found["figures"]["players"]
    there = [label for label, one in players.items() if one is not None]
    return sorted(there, key=lambda label: (-(players[label]["elo"]["value"] or 0.0), label))


def _unit(found):
    return "frame" if found["protocol"]["best_of"] == 1 else "match"


def tables_of(found):
    """The tables of a tournament."""
    figures, order, unit = found["figures"], ranked(found), _unit(found)
    players, best_of = figures["players"], found["protocol"]["best_of"]
    won = "matches" if best_of > 1 else "frames"
    standing, play = [], []
    for rank, label in enumerate(order, 1):
        p = players[label]
        elo = shown(p["elo"], form="{:.0f}") + (" *" if p["elo_by_prior"] else "")
        frames = [shown(p["frame_rate"], 100.0)] if best_of > 1 else []
        standing.append(
            [
                str(rank),
                label,
                elo,
                shown(p["win_rate"], 100.0),
                *frames,
                f"{p['matches']:,}",
                f"{p['drawn']:,}",
            ]
        )
        highest = str(p["highest_break"])
        play.append(
            [
                label,
                shown(p["points_a_frame"]),
                shown(p["average_break"], form="{:.2f}"),
                highest,
                shown(p["fouls_a_frame"], form="{:.2f}"),
                shown(p["strokes_a_frame"]),
            ]
        )
    more = ["frames won [%]"] if best_of > 1 else []
    spent = {player["label"]: player for player in found["players"]}
    for row in play:
        one = spent[row[0]]
        row.append(f"{1e3 * one['seconds'] / one['decisions']:.3g}" if one["decisions"] else "")
    cross = [[label, *(_cell(figures["pairs"], label, other) for other in order)] for label in order]
    return [
        TextTable("Who wins", ["", "player", "Elo", f"{won} won [%]", *more, won, "draws"], standing, 2, 2),
        TextTable(
            "How they play",
            [
                "player",
                "points a frame",
                "average break",
                "highest",
                "fouls a frame",
                "strokes a frame",
                "ms a decision",
            ],
            play,
            1,
            1,
        ),
        TextTable(
            f"Share of the {won} that a player (row) won against another (column) [%]",
            [unit, *order],
            cross,
            1,
            1,
        ),
    ]


def _cell(pairs, label, other):
    """What a player won of another."""
    for pair in pairs:
        if (pair["first"], pair["second"]) == (label, other):
            return f"{100 * pair['win_rate']['value']:.1f}"
        if (pair["second"], pair["first"]) == (label, other):
            return f"{100 - 100 * pair['win_rate']['value']:.1f}"
    return ""


def sentences(found):
    """What a reader of the tables must know."""
    p, figures, game = found["protocol"], found["figures"], found["game"]
    unit, plural = (
        _unit(found),
        "frames" if p["best_of"] == 1 else f"matches, each the best of {p['best_of']} frames",
    )
    fewer = ", ".join(f"{n:,} with {label}" for label, n in p["fewer"].items())
    said = [
        f"Each pair plays {p['matches']:,} {plural}{f' ({fewer})' if fewer else ''}: two on each seed, each player breaking first in one.",
        "Options: " + ", ".join(f"{name}={value}" for name, value in game.items()) + ".",
        f"Who breaks first wins {shown(figures['opener'], 100.0)} %. Frames that were stopped, half for each: {figures['stopped']:,}.",
        "An average break is the points of a player's own pots, for each visit to the table. Intervals are 95 % bootstrap intervals over "
        "seeds; a share of 0 % or 100 % has the exact bound. They say nothing about other training seeds of the same recipe.",
        f"Elo: Bradley and Terry's model, {p['anchor']} at {p['anchor_elo']:.0f}; to each pair {PRIOR:g} drawn {unit} is added.",
    ]
    if any(one is not None and one["elo_by_prior"] for one in figures["players"].values()):
        said.append(
            f"* won or lost every {unit} against those who can be compared with {p['anchor']}: only the bound follows from results, "
            "the distance itself from the added draws."
        )
    if found["incomplete"]:
        said.append(f"INCOMPLETE: {found['incomplete']}.")
    return said


def is_tournament(found):
    """Whether that is the content of a tournament's file, and not another report."""
    schema = found.get("schema") if isinstance(found, dict) else None
    return isinstance(schema, dict) and schema.get("name") == NAME


def title(found):
    """Who met."""
    *others, last = ranked(found)
    where = (
        "frames"
        if found["protocol"]["best_of"] == 1
        else f"matches, the best of {found['protocol']['best_of']} frames"
    )
    return f"Tournament of {', '.join(others)} and {last}: {where}, noise {found['game']['noise']}"


def parts(found):
    """Tables no wider than a terminal and sentences, in order."""
    for table in tables_of(found):
        yield from table.narrow()
    yield from sentences(found)


def markdown(found):
    """The page of a tournament."""
    made, m = found["software"], found["machine"]
    how = f"snooker_env {made['snooker_env']}, at commit {found['commit'] or 'unknown'} on {m['cpu']}, {m['cores']} cores, "
    how += f"{m['platform']}, Python {made['python']}, {found['date'][:10]}"
    return page(
        title(found),
        found["command"],
        how,
        [*tables_of(found), "\n".join(f"* {line}" for line in sentences(found))],
    )
