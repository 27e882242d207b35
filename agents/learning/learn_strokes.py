"""How is ``stroke_value`` trained: what strokes are worth, without simulating them when it plays?

``python train.py --agent stroke_value``. Each round plays visits, under errors from ``SCALES[0]`` to ``SCALES[1]`` times a
professional's, with what the rounds before have learned (the first one half with the planner), and in each
position that comes about tries some of the strokes that the player looks at, each under ``ERRORS`` execution errors. What
they bring and what the planner's value says of what they leave is their worth: a network is fitted to it, on the
positions of its own visits (DAgger; Ross, Gordon & Bagnell 2011). After each round the run's folder holds its data and
its weights: a resumed run goes on from there. After the last one a network is fitted for longer.
"""

import io
import json
from dataclasses import asdict, dataclass, fields
from itertools import pairwise

import numpy as np
import torch
from torch import nn

import snooker_env as sn
from commands.files import write_atomic
from commands.noise_option import noise_option
from snooker_env.benchmark import simulated
from snooker_env.checks import choice, integer, refuse
from snooker_env.planning import Planner, Positions
from snooker_env.planning.learned.stroke_value import LOOKS, POINTS, SAMPLES, SIZE, StrokeValue
from snooker_env.players import VISITS, Strokes
from snooker_env.players.player import placed
from snooker_env.players.search import SearchPlayer
from snooker_env.players.stroke_value import StrokeValuePlayer
from snooker_env.players.weights import STROKES, learned_strokes

from ..cluster.keep import packed
from .hyperparameters import changes_of

SETTINGS = "stroke_value.json"
"""The file of a run's settings."""
STROKES_EACH, PARTS = 8, 8
"""Strokes that are played on each table of a round, and parts of the tables with errors of their own."""
SCALES = 0.7, 4.5
"""Errors of the visits, times those of a professional: half of them below 1.12."""
BEST, OTHERS, ERRORS = 10, 10, 4
"""Strokes of a position that are tried: those that seem best, others at random; and execution errors of each."""
EXPLORE, AMONG = 0.1, 8
"""Share of strokes that are not the one that seems best, but one of the ``AMONG`` best."""
WIDTHS, BATCH, RATE, DECAY = (128, 64), 512, 2e-3, 1e-4
PASSES, LAST_PASSES = 15, 60
"""Over the positions after each round, and after the last one."""
COMPARED = 2.0
"""Weight of what the strokes of a position are worth beside each other; that of the worth itself is 1."""
HELD = 10
"""One table in so many is kept from the fit, to say how good it is."""
FIRST_SEED = 30_000_000
"""The seed of the first table."""


class StrokeNetwork(nn.Sequential):
    """What is seen of strokes (..., SIZE) -> what they are worth (..., 1), in units of ``POINTS``."""

    def __init__(self):
        parts = [nn.Linear(a, b) for a, b in pairwise((SIZE, *WIDTHS, 1))]
        super().__init__(*[part for one in parts for part in (one, nn.ReLU())][:-1])

    def layers(self, mean, deviation):
        """Weight (out, in) and bias (out,) of each layer for what is seen as it is; it was trained on what is seen less
        ``mean``, over ``deviation``."""
        linear = [one for one in self if isinstance(one, nn.Linear)]
        made = [(one.weight.detach().numpy().copy(), one.bias.detach().numpy().copy()) for one in linear]
        weight, bias = made[0]
        made[0] = weight / deviation, bias - (weight / deviation) @ mean
        return made


def fitted(seen, worth, table, seed, passes):
    """The layers of a network fitted to ``worth`` (n, k) points of strokes seen as (n, k, SIZE) on the tables with these
    seeds (n,), and figures of the tables kept from the fit."""
    torch.manual_seed(seed)
    rng, held = np.random.default_rng(seed), table % HELD == HELD - 1
    mean, deviation = seen[~held].mean((0, 1), np.float64), seen[~held].std((0, 1), np.float64) + 1e-3
    scaled = torch.from_numpy(((seen - mean) / deviation).astype(np.float32))
    wanted, network = torch.from_numpy((worth / POINTS).astype(np.float32)), StrokeNetwork()
    used = np.flatnonzero(~held)
    batch = min(BATCH, len(used))
    optimiser = torch.optim.AdamW(network.parameters(), RATE, weight_decay=DECAY)
    steps = max(20, passes * (len(used) // batch))
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
    for _ in range(passes):
        order = torch.from_numpy(rng.permutation(used))
        for k in range(0, batch * (len(used) // batch), batch):
            off = network(scaled[order[k : k + batch]])[..., 0] - wanted[order[k : k + batch]]
            compared = off - off.mean(dim=1, keepdim=True)
            loss = (off**2).mean() + COMPARED * (compared**2).mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
    with torch.no_grad():
        said, true = network(scaled[held])[..., 0].numpy(), wanted[held].numpy()
    beside = [one - one.mean(axis=1, keepdims=True) for one in (said, true)]
    policy = np.where(np.arange(seen.shape[1]) == seen[held][..., 0].argmax(axis=1)[:, None], true, 0.0).sum(
        axis=1
    )
    chosen = np.take_along_axis(true, said.argmax(axis=1)[:, None], 1)[:, 0]
    figures = {
        "positions": len(seen),
        "explained": float(1.0 - ((beside[0] - beside[1]) ** 2).mean() / (beside[1] ** 2).mean()),
        "worth_chosen": POINTS * float(chosen.mean()),
        "worth_of_policy": POINTS * float(policy.mean()),
    }
    return network.layers(mean, deviation), figures


def played(layers, options, seeds, rng):
    """Visits from the tables ``seeds``: what is seen of the strokes tried, float16 (n, k, SIZE), their worth [points],
    float32 (n, k), and the seeds of the tables on which the visits began (n,)."""
    n, env = len(seeds), sn.SnookerVectorEnv(len(seeds), layout="opened", **VISITS, **options)
    env.reset(seed=seeds)
    values: StrokeValue = StrokeValuePlayer(layers or ()).at(env).values
    plain, planner = sn.player("ghost_ball").at(env), Planner(env)
    expert: SearchPlayer = sn.player("planner_60").at(env)  # type: ignore[assignment]
    values.value.threads = planner.threads
    judge = expert.search.value
    kept_seen, kept_worth, kept_table, tried = [], [], [], BEST + OTHERS
    for _ in range(STROKES_EACH):
        at, keys = Positions.of(env), rng.integers(2**32, size=n)
        live = np.flatnonzero(~at.over)
        visits, places = placed(at[live], keys[live])
        found = values.candidates(visits, LOOKS, keys[live])
        scores, every = values.scores(found.seen), np.arange(len(found.rows))[:, None]
        order = np.argsort(-scores, axis=1, kind="stable")
        rest = rng.permuted(order[:, BEST:], axis=1)[:, :OTHERS]
        picks = np.concatenate([order[:, :BEST], rest], axis=1)
        rows = np.repeat(found.rows, tried * ERRORS)
        trials = np.repeat(found.strokes[every, picks].reshape(-1, 5), ERRORS, axis=0)
        points, goes_on, left, _ = planner.play(
            visits, rows, strokes=trials, errors=rng.standard_normal((len(rows), 5))
        )
        worth, on = points.astype(np.float64), np.flatnonzero(goes_on)
        worth[on] += judge(left[on])
        kept_seen.append(found.seen[every, picks].astype(np.float16))
        kept_worth.append(worth.reshape(-1, tried, ERRORS).mean(axis=2).astype(np.float32))
        kept_table.append(np.asarray(seeds)[live[found.rows]])
        chosen = np.where(rng.random(len(scores)) < EXPLORE, rng.integers(AMONG, size=len(scores)), 0)
        strokes = plain.play(visits, keys[live]).values
        strokes[found.rows] = found.strokes[every[:, 0], order[every[:, 0], chosen]]
        if layers is None:  # nothing is learned yet: half of the tables show where a good player comes
            half = np.flatnonzero(np.arange(len(live)) % 2)
            strokes[half] = expert.play(visits[half], keys[live][half]).values
        actions = np.zeros((n, env.options.rules.actions.size))
        actions[live] = Strokes(strokes, places).actions(env.options, at[live])
        env.step(actions)
    env.close()
    return tuple(map(np.concatenate, (kept_seen, kept_worth, kept_table)))


def arrays_of(layers):
    """The arrays of a file that ``weights.learned_strokes`` reads."""
    made = {f"strokes/{k}/weight": weight.astype(np.float32) for k, (weight, _) in enumerate(layers)}
    return made | {f"strokes/{k}/bias": bias.astype(np.float32) for k, (_, bias) in enumerate(layers)}


def _kept(file):
    with np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


def _fitted_to(rounds, seed, passes):
    both = {name: np.concatenate([one[name] for one in rounds]) for name in ("seen", "worth", "table")}
    return fitted(both["seen"].astype(np.float32), both["worth"], both["table"], seed, passes)


@dataclass(frozen=True)
class StrokeSettings:
    """Of a run: what its rounds are made of."""

    seed: int = 0
    rounds: int = 8
    tables: int = 1024
    """Of a round."""
    cue: str = "real"

    @classmethod
    def of(cls, seed, changes):
        """With "key=value" in ``changes``. Raises ValueError."""
        made = cls(seed, **changes_of(changes, ("rounds", "tables", "cue")))
        integer("seed", made.seed, 0, 80)
        integer("rounds", made.rounds, 1, 99)
        integer("tables", made.tables, HELD, 100_000)
        choice("cue", made.cue, ("real", "free"))
        return made

    def save(self, out):
        """Into the run's folder."""
        write_atomic(out / SETTINGS, json.dumps(asdict(self)).encode())

    @classmethod
    def read(cls, out):
        """Of the run in that folder. Raises ValueError."""
        try:
            return cls(**json.loads((out / SETTINGS).read_text()))
        except (OSError, ValueError, TypeError):
            raise refuse("out", str(out), f"must hold a complete {SETTINGS}") from None

    def words(self):
        """The options of ``train.py`` that repeat the run."""
        changed = [
            f"{f.name}={getattr(self, f.name)}"
            for f in fields(self)
            if f.name != "seed" and getattr(self, f.name) != f.default
        ]
        return [
            "--agent",
            "stroke_value",
            "--seed",
            str(self.seed),
            *(["--set", *changed] if changed else []),
        ]


class StrokeTraining:
    """The rounds of a run in the folder ``out``; those that it holds already are read."""

    def __init__(self, out, settings):
        self.out, self.settings, self.rounds, self.curve, self.layers = out, settings, [], [], None
        asked = settings.tables, settings.seed, settings.cue, LOOKS, SAMPLES, SIZE, SCALES
        self._asked = list(map(str, asked))
        while len(self.rounds) < settings.rounds and self._file("round").is_file():
            rows = _kept(self._file("round"))
            if rows.pop("asked").tolist() != self._asked:
                raise refuse("out", str(out), "must hold rounds of this version and of the same settings")
            self._learn(rows)

    def _file(self, what):
        return self.out / f"{what}-{len(self.rounds)}.npz"

    @property
    def shots(self):
        """Shots that were simulated for the strokes that were tried."""
        return sum(one["worth"].size * ERRORS for one in self.rounds)

    @property
    def simulated(self):
        """All shots that the rounds simulated, visits and the planner's decisions too; None: not known."""
        shots = [one.get("shots") for one in self.rounds]
        return None if any(one is None for one in shots) else int(sum(shots))

    @property
    def total(self):
        """Tables of all rounds."""
        return self.settings.rounds * self.settings.tables

    @property
    def done(self):
        """Tables of the rounds that are complete."""
        return len(self.rounds) * self.settings.tables

    def run(self, progress, stop):
        """Play the rounds that are left and learn from each, until ``stop`` notes a signal."""
        while len(self.rounds) < self.settings.rounds and stop.signal is None:
            self._round(progress, stop)

    def _round(self, progress, stop):
        one, k = self.settings, len(self.rounds)
        first = FIRST_SEED + 10_000_000 * one.seed + 100_000 * k
        rng, parts, played_on, before = np.random.default_rng([one.seed, k]), [], self.done, simulated()
        shares = (np.arange(PARTS) + rng.random(PARTS)) / PARTS
        for share, seeds in zip(
            shares, np.array_split(np.arange(first, first + one.tables), PARTS), strict=True
        ):
            scale = SCALES[0] * (SCALES[1] / SCALES[0]) ** share**2
            options = {"noise": noise_option(f"professional*{scale}"), "cue": one.cue}
            parts.append(played(self.layers, options, seeds.tolist(), rng))
            progress.at(played_on := played_on + len(seeds), self.figures)
            if stop.signal is not None:
                return
        seen, worth, table = map(np.concatenate, zip(*parts, strict=True))
        rows = {"seen": seen, "worth": worth, "table": table, "shots": np.array(simulated() - before)}
        write_atomic(self._file("round"), packed(rows | {"asked": np.array(self._asked)}))
        self._learn(rows)

    @property
    def figures(self):
        """Those of the last fit, in words."""
        said = f"round {len(self.rounds) + 1} of {self.settings.rounds}"
        return said + (
            f", {self.curve[-1]['explained']:.0%} of the differences explained" if self.curve else ""
        )

    def _learn(self, rows):
        weights, seed = self._file("strokes"), self.settings.seed + len(self.rounds)
        self.rounds.append(rows)
        if weights.is_file():
            self.layers = learned_strokes(weights)
            self.curve.append(json.loads(str(_kept(weights)["figures"])))
        else:
            self.layers, figures = _fitted_to(self.rounds, seed, PASSES)
            self.curve.append(figures)
            write_atomic(weights, packed(arrays_of(self.layers) | {"figures": np.array(json.dumps(figures))}))

    def finish(self):
        """The last fit, into ``STROKES`` of the folder: figures of the tables kept from it."""
        layers, figures = _fitted_to(self.rounds, self.settings.seed, LAST_PASSES)
        write_atomic(self.out / STROKES, packed(arrays_of(layers)))
        return figures
