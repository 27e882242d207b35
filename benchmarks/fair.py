"""Is there a fair stroke where there is no direct pot? All choices of ``action="discrete"``, and
``aim="target"`` at offset 0.

    python -m benchmarks.fair [--tables 100] [--kinds break_off snookered ...] [--seed 0] [--json FILE] [--out
    FOLDER]

On each table every choice that the masks offer is played without execution errors and judged by the referee
of frames; so is the target line, struck in the middle at nine speeds. "frames": positions without a direct
pot from frames that the built-in opponent plays against itself with a professional's errors. Printed: tables
with a fair choice, share of the choices that are fair, mean number of lines, and tables whose target line is
fair at the best speed, at 2.3 and at 3.6 m/s.
"""

import numpy as np

from snooker_env.game.frame_columns import IN_HAND
from snooker_env.game.pots import pots
from snooker_env.players.opponents import opponent_of
from snooker_env.tasks import CHOICES, MAX_SPEED, MIN_SPEED, SPEEDS, STROKES
from snooker_env.tasks.carry_out import carry_out
from snooker_env.tasks.frame import AGENT, Frames, Seat
from snooker_env.tasks.options import Options
from snooker_env.tasks.stroke import ShotBuffers
from snooker_env.tasks.tables import I_FOULS, Crew

from ._common.command import Command, at_least, run, save_json

KINDS = {
    "break_off": {},
    "break_off_six_red": {"game": "six_red"},
    "break_off_shoot_out": {"game": "shoot_out"},
    "snookered": {"layout": "snookered"},
    "snookered_match": {"layout": "snookered", "physics": "match"},
    "frames": {},
}
"""Where the tables come from: the options of the frames."""
SHOWN = (2.3, 3.6)
"""The speeds of the target line that are printed [m/s]."""


def dealt(n, seed, **options):
    """n new frames."""
    game = Options(task="frame", **options)
    tables = Frames(game, n, seats=[Seat.of(game.rules)] * 2)
    for k in range(n):
        tables.seed(k, np.random.default_rng((seed, k)))
    tables.deal(np.arange(n), drawn=False)
    return tables


def states(tables, rows):
    """The positions, balls on the table and columns of the game of these rows."""
    return [(tables.positions[k].copy(), tables.on_table[k].copy(), tables.game[k].copy()) for k in rows]


def has_pot(tables, k):
    """Whether table k has a direct pot."""
    return len(pots(tables.positions[k], tables.on_table[k], tables.on(k))) > 0


def from_frames(n, seed):
    """n positions without a direct pot, the cue ball not in hand, from frames of the built-in opponent
    against itself."""
    given = {"aim": "target", "placement": True, "says": ["decision"], "noise": "professional"}
    found, player = [], opponent_of("ghost_ball", Options(task="frame", **given))
    while len(found) < n:
        tables, which = (
            dealt(20, seed, **given),
            np.arange(20),
        )
        while len(which):
            found += states(
                tables, [k for k in which if not tables.game[k, IN_HAND] and not has_pot(tables, k)]
            )
            buffers, out = ShotBuffers(len(which)), tables.output()
            crew = Crew(buffers)
            asked = player.strokes(tables, which, crew)
            struck = carry_out(tables, which, asked, buffers, AGENT)
            tables.complete(struck, out, buffers, crew, reported=True)
            which = which[~tables.ended()[which]]
        seed += 1
    return [found[k] for k in np.random.default_rng(seed).permutation(len(found))[:n]]


def fouls(tables, state, actions):
    """The fouls of each of the actions, played from a state: a mask of ``Foul``, 0 for a fair stroke."""
    n = len(actions)
    which, buffers, out = np.arange(n), ShotBuffers(n), tables.output()
    tables.positions[:n], tables.on_table[:n], tables.game[:n] = state
    tables.address(which, actions, buffers)
    tables.complete(which, out, buffers, Crew(buffers), reported=True)
    return out.counts[:n, I_FOULS].copy()


def measured(kind, n, seed):
    """The figures of n tables of a kind without a direct pot."""
    options = KINDS[kind]
    choosing, aiming = (
        dealt(CHOICES, 0, action="discrete", **options),
        dealt(len(SPEEDS), 0, aim="target", **options),
    )
    if kind == "frames":
        found = from_frames(n, seed)
    else:
        tables = dealt(n, seed, **options)
        found = states(tables, [k for k in range(n) if not has_pot(tables, k)])
    target = np.zeros((len(SPEEDS), aiming.rules.actions.size))
    target[:, 0] = [2.0 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0 for speed in SPEEDS]
    shares, lines, aimed = [], [], []
    for state in found:
        choosing.positions[0], choosing.on_table[0], choosing.game[0] = state
        offered = np.flatnonzero(choosing.action_masks()[0])
        shares.append((fouls(choosing, state, offered[:, None].astype(np.float64)) == 0).mean())
        lines.append(len(offered) // STROKES)
        aimed.append(fouls(aiming, state, target) == 0)
    return {
        "tables": len(found),
        "with_a_fair_choice": float(np.mean(np.array(shares) > 0.0)),
        "fair_choices": float(np.mean(shares)),
        "lines": float(np.mean(lines)),
        "target": float(np.mean(np.any(aimed, axis=1))),
        "target_at": {
            str(speed): float(share) for speed, share in zip(SPEEDS, np.mean(aimed, axis=0), strict=True)
        },
    }


def main():
    """Measure and print."""
    parser = Command("fair", __doc__, seed=0)
    parser.add_argument(
        "--tables", type=at_least(1), default=100, metavar="N", help="tables of each kind [100]"
    )
    parser.add_argument(
        "--kinds",
        nargs="+",
        choices=KINDS,
        default=list(KINDS),
        metavar="KIND",
        help=f"of {', '.join(KINDS)} [all]",
    )
    options = parser.options()
    figures = {}
    print(f"{'':20s}  tables  fair choice  choices fair  lines  target: best  2.3 m/s  3.6 m/s")
    for kind in options.kinds:
        one = figures[kind] = measured(kind, options.tables, options.seed)
        at = [100.0 * one["target_at"][str(speed)] for speed in SHOWN]
        print(
            f"{kind:20s}  {one['tables']:6d}  {100.0 * one['with_a_fair_choice']:9.1f} %  {100.0 * one['fair_choices']:10.1f} %"
            f"  {one['lines']:5.1f}  {100.0 * one['target']:10.1f} %  {at[0]:5.1f} %  {at[1]:5.1f} %",
            flush=True,
        )
    save_json(options.json, figures)
    return 0


if __name__ == "__main__":
    run(main)
