"""How does the ``tactician`` learn what positions of frames are worth? By self-play.

    python -m agents.learn_worth --out runs/worth [--rounds 2] [--chance | --against PLAYER] [--ray local]

Each round plays frames with errors from ``SCALES[0]`` to ``SCALES[1]`` times a professional's. It uses what the package and the
earlier rounds have learned. Half of the frames are against itself, the others against a league: past selves and the planner.
A search judges each position and the positions that its best strokes may leave (``frame_self_play``). A network is then fitted
to the last rounds, and the chance to win to their frames between equals. In a tenth of the positions, a teacher searches with
eight times the budget; its stroke is used if it is clearly better. After each round, OUT holds its data and weights: repeat the
command to continue from there. The last round's weights are written to OUT/worth.npz and play against the package's
``tactician`` and a population. With --export they are written into the package unless one of these players clearly beats them.
With --against all frames are against one player, from whom nothing is learned: the result is the best response. With --chance
the network of the package is kept: all frames are between equals, no position is judged, and only the chance to win is fitted.
"""

import sys
from pathlib import Path

from agents._lib.lifecycle import command, needs, parser_of

with needs("agents.learn_worth"):
    import numpy as np

    import snooker_env
    from agents._lib.files import packed_arrays, writable, write_atomic
    from snooker_env.checks import integer, refuse
    from snooker_env.planning import FrameJudge
    from snooker_env.planning.learned.dense_layers import Layers
    from snooker_env.planning.learned.frame_features import read_errors
    from snooker_env.planning.learned.learned_worth import worth_of
    from snooker_env.players import player
    from snooker_env.players.search_player import Tactician
    from snooker_env.players.weights import FOLDER, WORTH, learned_worth, worth_in
    from snooker_env.tasks import LEVELS

    from .cluster import add_ray, checked_ray, in_order, place
    from .learning.frame_self_play import FRAME, TABLES, frames, win_share
    from .learning.frame_worth import calibration, fit_network, fitted_chance, targets
    from .learning.loop import Loop
    from .learning.rounds import Rounds, arrays_of, shares_of_parts

SCALES = 0.6, 4.5
"""Errors of the frames relative to a professional's, evenly spread in the logarithm."""
EXPLORE = 0.08
"""Share of strokes that are not the best found, so that the data include positions after worse strokes."""
KEEP, PASSES = 4, 15
"""Number of rounds that a network is fitted to, and of passes over them."""
VISITORS = ("planner",)
"""Players of the league besides past selves."""
POPULATION = ("tactician", "planner", "stroke_value")
"""Players to whom new weights must not lose: the incumbent and others."""
JUDGED = 950_000_000
"""The first table of the evaluation: no training and no calibration plays it."""
HELD = 8
"""One frame in this many is held out from the fit, to measure its error."""
LEARNED_FROM = [
    "seen",
    "hand",
    "target",
    "held",
    "unit",
    "striker",
    "lead",
    "left",
    "last",
    "won",
    "decided",
    "equals",
]
"""The rows of ``frame_self_play.frames``, with their targets."""


class WorthRounds(Rounds):
    """The frames, played at ``where``. ``chance_alone``: keep the package's network."""

    what, unit, now = "frames of self-play", "frames", "these frames"

    def __init__(self, out, rounds, asked, where):
        many, budget, seed, chance_alone, against = asked
        super().__init__(out, "worth", rounds, many, many // TABLES, asked)
        self._budget, self._seed, self._chance_alone, self._where = budget, seed, chance_alone, where
        self._against = against
        self.layers, self.chance = learned_worth()
        self._past = []

    @property
    def figures(self):
        return "  ".join(f"{name} {value:.4g}" for name, value in (self.curve or [{}])[-1].items())

    def parts_of(self, k):
        shared = {"options": FRAME, "layers": self.layers, "chance": self.chance, "explore": EXPLORE}
        shared |= {
            "budget": self._budget,
            "replies": not self._chance_alone,
            "taught": not self._chance_alone,
        }
        parts = [(shared, part) for part in self._list_arguments(k)]
        for j, part in enumerate(in_order(self._where.play_parts(frames, parts))):
            part["target"] = targets(part)
            part["held"] = (part["frame"] + j) % HELD == 0
            part["unit"] = part["frame"] + TABLES * j
            part |= {name: part[name].astype(np.float16) for name in ("seen", "hand")}
            yield {name: part[name] for name in LEARNED_FROM}

    def _list_arguments(self, k):
        """The arguments of the parts of round k."""
        rng, parts = np.random.default_rng([self._seed, k]), self.parts
        scales = SCALES[0] * (SCALES[1] / SCALES[0]) ** shares_of_parts(rng, parts)
        first, league = 10_000_000 * (self._seed + 1) + 100_000 * k, [*self._past, *VISITORS]
        others = [league[rng.integers(len(league))] if i % 2 else None for i in range(parts)]
        for i, (scale, other) in enumerate(zip(scales, others, strict=True)):
            other = None if self._chance_alone else self._against or other
            noise = LEVELS["professional"].scale(float(scale))
            yield {"noise": noise, "seed": first + TABLES * i, "many": TABLES, "other": other}

    def fit(self):
        given = self.layers if self._chance_alone else None
        known = self.chance if self._against else None  # no frame between equals reveals it
        layers, chance, figures = fit_worth(
            self.rounds[-KEEP:], self._seed + len(self.rounds) - 1, given, known
        )
        return arrays_of("worth", layers) | {"chance": np.array(chance)}, figures

    def take(self, arrays):
        self.layers, self.chance = worth_in(arrays)
        self._past.append((self.layers, self.chance))

    def pack_weights(self):
        """The file of weights."""
        return packed_arrays(arrays_of("worth", self.layers) | {"chance": np.array(self.chance)})


def fit_worth(rounds, seed, layers=None, chance=None):
    """Fit layers and chance, unless given, to the rows of some rounds. Returns them and figures of the held-out frames."""
    both = {name: np.concatenate([one[name] for one in rounds]) for name in rounds[0]}
    used = ~both["held"]
    in_hand = used & (both["seen"] != both["hand"]).any(axis=1)
    seen = np.concatenate([both["seen"][used], both["hand"][in_hand]]).astype(np.float32)
    wanted = np.concatenate([both["target"][used], both["target"][in_hand]])
    layers = fit_network(seen, wanted, seed, PASSES) if layers is None else layers
    said = worth_of(Layers(layers, "relu"), both["seen"].astype(np.float32))
    # a stopped frame has no winner; nor is it known what follows positions outside the frames, or what an
    # equal would have made of it
    ended, held = both["decided"] & (both["equals"] | (chance is not None)), both["held"]
    for some, what in ((used & ended, "fitted"), (held & ended, "kept from the fit")):
        if not some.any():
            raise refuse(
                "frames", len(np.unique(both["unit"])), f"must be more: none of those {what} has ended"
            )
    known = both["lead"], said.astype(np.float64), both["left"], both["last"], read_errors(both["seen"])
    chance = chance or fitted_chance(*(part[used & ended] for part in (*known, both["won"])))
    wins, won = chance(*known)[held & ended], both["won"][held & ended]
    rmse = lambda worth: float(np.sqrt(np.mean((worth - both["target"])[held] ** 2)))  # noqa: E731
    figures = {
        "positions": len(wanted),
        "rmse": rmse(said),
        "rmse_of_value": rmse(worth_of(None, both["seen"].astype(np.float32))),
        "correlation": float(np.corrcoef(said[held], both["target"][held])[0, 1]),
        "chance_error": calibration(wins, won)[1],
        "stopped": float(1.0 - both["decided"][both["striker"] >= 0].mean()),
    }
    return layers, chance, figures


@command("agents.learn_worth")
def main(argv=None):
    """Play, fit, write. Exit code 0, 1 if the weights were too weak to export, or 128 + the signal that stopped it."""
    p = parser_of("python -m agents.learn_worth", __doc__)
    p.add_argument("--out", type=Path, required=True, help="folder of rounds and weights")
    p.add_argument("--rounds", type=int, default=2, help="[2]")
    p.add_argument("--frames", type=int, default=384, help=f"frames per round, a multiple of {TABLES} [384]")
    p.add_argument("--budget", type=int, default=120, help="average simulated shots per decision [120]")
    p.add_argument("--seed", type=int, default=0, help="[0]")
    p.add_argument("--export", action="store_true", help="also write the weights into the package")
    p.add_argument("--chance", action="store_true", help="fit only the chance to win")
    p.add_argument("--against", metavar="PLAYER", help="learn only against this player")
    p.add_argument("--judged", type=int, default=200, help="frames against each player at the end [200]")
    add_ray(p)
    args = p.parse_args(sys.argv[1:] if argv is None else argv)
    try:
        integer("rounds", args.rounds, 1, 90)
        integer("frames", args.frames, TABLES, 100_000)
        integer("seed", args.seed, 0, 80)  # more would reach the tables of agents.calibrate
        integer("budget", args.budget, FrameJudge.least, 10**6)
        integer("judged", args.judged, 0, 10**6)
        if args.against is not None:
            player(args.against)
            if args.chance or args.export:
                raise refuse("against", args.against, "must be given without --chance and --export")
        if args.frames % TABLES:
            raise refuse("frames", args.frames, f"must be a multiple of {TABLES}")
        checked_ray(args.ray)
        writable("out", args.out / WORTH)
        snooker_env.warmup()
        with place(args.ray) as where:
            asked = args.frames, args.budget, args.seed, args.chance, args.against
            rounds = WorthRounds(args.out, args.rounds, asked, where)
            rounds.restore()
            again = "repeat the command to continue with the rounds in its folder"
            if (number := Loop("agents.learn_worth", [rounds], lambda: None, again).run()) is not None:
                return 128 + number
    except ValueError as error:
        p.error(str(error))
    write_atomic(args.out / WORTH, rounds.pack_weights())
    for k, figures in enumerate(rounds.curve):
        print(f"round {k}: " + "  ".join(f"{name} {value:.4g}" for name, value in figures.items()))
    beats = args.judged == 0 or judge_weights(rounds, args)
    if args.export and not beats:
        print(
            f"not exported, because the weights clearly lose; they are in {args.out / WORTH}", file=sys.stderr
        )
        return 1
    if args.export:
        write_atomic(FOLDER / WORTH, rounds.pack_weights())
    return 0


def judge_weights(rounds, args):
    """Print how often the weights win against each of ``POPULATION``, or ``--against``. Returns whether they clearly lose to none."""
    mine, fine = Tactician(args.budget, (rounds.layers, rounds.chance)), True
    for k, name in enumerate([args.against] if args.against else POPULATION):
        other = f"{name}_{args.budget}" if name in ("tactician", "planner") else name
        share, error = win_share(mine, player(other), JUDGED + 10_000 * k, args.judged)
        fine &= share + 2.0 * error >= 0.5
        print(f"wins {100.0 * share:.1f} ± {100.0 * error:.1f} % of {args.judged} frames against {other}")
    return fine


if __name__ == "__main__":
    raise SystemExit(main())
