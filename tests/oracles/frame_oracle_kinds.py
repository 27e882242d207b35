"""Which kinds of frames does the oracle check? The options of each, and who plays."""

from __future__ import annotations

from .frame_oracle_play import Kind

NAMED = ["nominate", "decision"]
KINDS = {
    kind.name: kind
    for kind in (
        Kind("random", "random", {}),
        Kind("off", "steady", {}),
        Kind("clear_path", "steady", {"miss": "clear_path"}),
        Kind("nominate", "steady", {"says": NAMED}),
        Kind("nominate_miss", "steady", {"miss": "clear_path", "says": NAMED}),
        Kind("declare", "steady", {"says": [*NAMED, "concede", "claim", "lot"]}),
        Kind("match", "steady", {"task": "match", "frames": 3, "says": [*NAMED, "concede"]}),
        Kind("ghost_ball", "ghost_ball", {"miss": "clear_path", "noise": "club"}),
        Kind("against_ghost_ball", "steady", {"miss": "clear_path", "opponent": "ghost_ball"}),
        Kind("attempt", "steady", {"miss": "attempt"}),
        Kind("six_red", "steady", {"game": "six_red", "miss": "clear_path", "says": NAMED}),
        Kind("six_red_tables", "steady", {"game": "six_red", "miss": "clear_path"}, tables=True),
        Kind("shoot_out", "steady", {"game": "shoot_out"}),
        Kind("shoot_out_late", "steady", {"game": "shoot_out", "time_to_play": 12.0}),
        Kind("tables", "steady", {"miss": "clear_path"}, tables=True),
        Kind(
            "tables_nominate",
            "steady",
            {"miss": "clear_path", "says": [*NAMED, "claim", "lot"]},
            tables=True,
        ),
    )
}
"""By name. "steady" pots now and then, so that frames are short; "tables" begins from random tables with
touching balls and taken spots."""
