"""Tables without a direct pot, and what the referee says of strokes on them: fair, or which foul?"""

import numpy as np

from snooker_env.game.frame_columns import IN_HAND
from snooker_env.game.pots import pots
from snooker_env.players.opponents import opponent_of
from snooker_env.tasks import CHOICES, MAX_SPEED, MIN_SPEED, SPEEDS
from snooker_env.tasks.frames import AGENT, Frames, Seat
from snooker_env.tasks.options import Options
from snooker_env.tasks.stroke import ShotBuffers
from snooker_env.tasks.tables import I_FOULS, Crew

KINDS = {
    "break_off": {},
    "break_off_six_red": {"game": "six_red"},
    "break_off_shoot_out": {"game": "shoot_out"},
    "snookered": {"layout": "snookered"},
    "snookered_match": {"layout": "snookered", "physics": "match"},
    "frames": {},
}
"""Where the tables come from: the options of the frames. "frames": positions that ghost_ball left itself."""


def deal(n, seed, **options):
    """n new frames."""
    game = Options(task="frame", **options)
    tables = Frames(game.rules, n, seats=[Seat.of(game.rules)] * 2)
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


def positions_of_frames(n, seed):
    """n positions without a direct pot, the cue ball not in hand, met by ghost_ball against itself."""
    given = {"aim": "target", "placement": True, "says": ["decision"], "noise": "professional"}
    found, player = [], opponent_of("ghost_ball", Options(task="frame", **given))
    while len(found) < n:
        tables, which = deal(20, seed, **given), np.arange(20)
        while len(which):
            lying = [k for k in which if not tables.game[k, IN_HAND]]
            found += states(tables, [k for k in lying if not has_pot(tables, k)])
            buffers, out = ShotBuffers(len(which)), tables.output()
            crew = Crew(buffers)
            asked = player.strokes(tables, which, crew)
            struck = tables.carry_out(which, asked, buffers, AGENT)
            tables.complete(struck, out, buffers, crew, reported=True)
            which = which[~tables.are_over()[which]]
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


def fair_strokes(kind, n, seed):
    """Of up to n tables of a kind: the share of the choices that are fair, (tables,), and which speeds of the target line
    are, bool (tables, speeds)."""
    options = KINDS[kind]
    choosing = deal(CHOICES, 0, action="discrete", **options)
    aiming = deal(len(SPEEDS), 0, aim="target", **options)
    if kind == "frames":
        found = positions_of_frames(n, seed)
    else:
        tables = deal(n, seed, **options)
        found = states(tables, [k for k in range(n) if not has_pot(tables, k)])
    target = np.zeros((len(SPEEDS), aiming.rules.actions.size))
    target[:, 0] = [2.0 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0 for speed in SPEEDS]
    shares, aimed = [], []
    for state in found:
        choosing.positions[0], choosing.on_table[0], choosing.game[0] = state
        offered = np.flatnonzero(choosing.action_masks()[0])
        shares.append((fouls(choosing, state, offered[:, None].astype(np.float64)) == 0).mean())
        aimed.append(fouls(aiming, state, target) == 0)
    return np.array(shares), np.array(aimed)
