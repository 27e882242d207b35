"""How is a tournament shown? As tables of winners, pairs and playing styles, for a terminal or in Markdown."""

from agents._lib.tables import TextTable, format_figure, page

from .tournament_figures import PRIOR

NAME = "snooker_env.tournament"
"""Name of the schema of a tournament's file."""


def labels_by_elo(content):
    """The labels of the players, highest Elo first."""
    players = content["figures"]["players"]
    played = [label for label, one in players.items() if one is not None]
    return sorted(played, key=lambda label: (-(players[label]["elo"]["value"] or 0.0), label))


def _unit(content):
    return "frame" if content["protocol"]["best_of"] == 1 else "match"


def tables_of(content):
    """The tables of a tournament."""
    figures, order, best_of = content["figures"], labels_by_elo(content), content["protocol"]["best_of"]
    won = "matches" if best_of > 1 else "frames"
    spent = {player["label"]: player for player in content["players"]}
    standing, play = [], []
    for label in order:
        p, one = figures["players"][label], spent[label]
        elo = format_figure(p["elo"], form="{:.0f}") + (" *" if p["elo_by_prior"] else "")
        shares = [
            format_figure(p[name], 100.0)
            for name in ("win_rate", "adjusted", "frame_rate")[: 3 if best_of > 1 else 2]
        ]
        standing.append([label, elo, *shares, f"{p['drawn']:,}" if p["drawn"] else ""])
        average, fouls = (
            format_figure(p[name], form="{:.2f}") for name in ("average_break", "fouls_a_frame")
        )
        asked = one["decisions"]
        took = [f"{1e3 * one['seconds'] / asked:.3g}", f"{one['shots'] / asked:.0f}"] if asked else ["", ""]
        play.append(
            [label, format_figure(p["points_a_frame"]), average, str(p["highest_break"]), fouls, *took]
        )
    more = ["frames won [%]"] if best_of > 1 else []
    wins = ["player", "Elo", f"{won} won [%]", "luck-adjusted [%]", *more, "draws"]
    does = ["points a frame", "average break", "highest", "fouls a frame"]
    does += ["ms a decision", "shots a decision"]
    won_of = {}
    for pair in figures["pairs"]:
        first, second, share = pair["first"], pair["second"], 100 * pair["win_rate"]["value"]
        won_of |= {(first, second): f"{share:.1f}", (second, first): f"{100 - share:.1f}"}
    cross = [[label, *(won_of.get((label, other), "") for other in order)] for label in order]
    of_each = f"Share of {won} won by a player (row) against another (column) [%]"
    return [
        TextTable("Who wins", wins, standing, 1, 1).tidy(),
        TextTable("How they play", ["player", *does], play, 1, 1),
        TextTable(of_each, [_unit(content), *order], cross, 1, 1),
    ]


def sentences(content):
    """Notes for readers of the tables."""
    p, figures, game = content["protocol"], content["figures"], content["game"]
    unit = _unit(content)
    plural = "frames" if p["best_of"] == 1 else f"matches, each the best of {p['best_of']} frames"
    notes = [
        f"Each pair plays {p['matches']:,} {plural}: two on each seed; each player breaks off first in one.",
        "Options: " + ", ".join(f"{name}={value}" for name, value in game.items()) + ".",
        f"The player who breaks off first wins {format_figure(figures['opener'], 100.0)} %. "
        f"Stopped frames (half a win each): {figures['stopped']:,}.",
        "docs/agents/tournament.md explains the figures. "
        f"Elo: {p['anchor']} at {p['anchor_elo']:.0f}; {PRIOR:g} drawn {unit} is added to each pair.",
    ]
    if any(one is not None and one["elo_by_prior"] for one in figures["players"].values()):
        notes.append(
            f"* won or lost every {unit} against the players comparable with {p['anchor']}: only the bound follows from the results; "
            "the distance follows from the added draws."
        )
    if content["incomplete"]:
        notes.append(f"INCOMPLETE: {content['incomplete']}.")
    return notes


def is_tournament(content):
    """Whether this is the content of a tournament's file, not another report."""
    schema = content.get("schema") if isinstance(content, dict) else None
    return isinstance(schema, dict) and schema.get("name") == NAME


def title(content):
    """Who met."""
    *others, last = labels_by_elo(content)
    best_of = content["protocol"]["best_of"]
    where = "frames" if best_of == 1 else f"matches, the best of {best_of} frames"
    return f"Tournament of {', '.join(others)} and {last}: {where}, noise {content['game']['noise']}"


def parts(content):
    """Yield tables no wider than a terminal, and sentences, in order."""
    for table in tables_of(content):
        yield from table.narrow()
    yield from sentences(content)


def markdown(content):
    """The page of a tournament."""
    made, m = content["software"], content["machine"]
    how = f"snooker_env {made['snooker_env']}, at commit {content['commit'] or 'unknown'} on {m['cpu']}, {m['cores']} cores, "
    how += f"{m['platform']}, Python {made['python']}, {content['date'][:10]}"
    notes = "\n".join(f"* {line}" for line in sentences(content))
    return page(title(content), content["command"], how, [*tables_of(content), notes])
