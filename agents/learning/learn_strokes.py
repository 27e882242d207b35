"""How is ``stroke_value`` trained: what strokes are worth, without simulating them when it plays?

``python train.py --agent stroke_value``. Each round of visits is played under errors from ``SCALES[0]`` to ``SCALES[1]``
times a professional's, with what the rounds before have learned (the first one half with the planner), and in each
position that comes about tries some of the strokes that the player looks at, each under ``ERRORS`` execution errors. What
they bring and what the planner's value says of what they leave is their worth: a network is fitted to it, on the
positions of its own visits (DAgger; Ross, Gordon & Bagnell 2011), after the last round for longer. Rounds of frames follow,
against itself, ``best_pot`` and ``tactician_60``: a second network learns what the strokes of frames, safeties too, are worth
beside what they seem to be worth. After each round the run's folder holds its data and its weights: a resumed run goes on
from there.
"""

import json
from dataclasses import asdict, astuple, dataclass, fields
from itertools import pairwise

import numpy as np
import torch
from torch import nn

import snooker_env as sn
from commands.files import read_json, strict_json, with_checksum, write_atomic, write_json
from commands.noise_option import noise_option
from snooker_env.benchmark import simulated
from snooker_env.checks import choice, integer, refuse
from snooker_env.planning import Planner, Positions, processors
from snooker_env.planning.learned import frame_strokes
from snooker_env.planning.learned.stroke_value import LOOKS, POINTS, SAMPLES, SIZE, StrokeValue
from snooker_env.players import VISITS, Strokes
from snooker_env.players.player import placed
from snooker_env.players.search import SearchPlayer
from snooker_env.players.stroke_value import StrokeValuePlayer
from snooker_env.players.weights import STROKES, StrokeLayers, layers_of

from ..cluster.keep import keep_arrays, kept_arrays, packed
from .hyperparameters import changes_of
from .stroke_frames import frames_tried

SETTINGS = "stroke_value.json"
"""The file of a run's settings."""
STROKES_EACH, PARTS = 8, 8
"""Strokes that are played on each table of a round, and parts of the tables with errors of their own."""
SCALES = 0.7, 4.5
"""Errors of the visits and frames, times those of a professional; evenly spread in the logarithm."""
BEST, OTHERS, ERRORS = 10, 10, 4
"""Strokes of a position that are tried: those that seem best, others at random; and execution errors of each."""
EXPLORE, AMONG = 0.1, 8
"""Share of strokes that are not the one that seems best, but one of the ``AMONG`` best."""
WIDTHS, BATCH, RATE, DECAY = (128, 64), 512, 2e-3, 1e-4
PASSES, LAST_PASSES = 15, {"visits": 60, "frames": 20}
"""Over the positions after each round, and after the last one."""
AGAINST = None, None, "best_pot", "tactician_60"
"""Who plays the parts of a round of frames against it, in turn; None: itself."""
COMPARED = 2.0
"""Weight of what the strokes of a position are worth beside each other; that of the worth itself is 1."""
HELD = 10
"""One table in so many is kept from the fit, to say how good it is."""
FIRST_SEED = 30_000_000
"""The seed of the first table."""


class StrokeNetwork(nn.Sequential):
    """What is seen of strokes (..., size) -> what they are worth (..., 1), in units of ``POINTS``."""

    def __init__(self, size):
        parts = [nn.Linear(a, b) for a, b in pairwise((size, *WIDTHS, 1))]
        super().__init__(*[part for one in parts for part in (one, nn.ReLU())][:-1])

    def layers(self, mean, deviation):
        """Weight (out, in) and bias (out,) of each layer for what is seen as it is; it was trained on what is seen less
        ``mean``, over ``deviation``."""
        linear = [one for one in self if isinstance(one, nn.Linear)]
        made = [(one.weight.detach().numpy().copy(), one.bias.detach().numpy().copy()) for one in linear]
        weight, bias = made[0]
        made[0] = weight / deviation, bias - (weight / deviation) @ mean
        return made


def fitted(seen, worth, table, seed, passes, seems=None):
    """The layers of a network fitted to ``worth`` (n, k) points of strokes seen as (n, k, SIZE) on the tables with these
    seeds (n,), and figures of the tables kept from the fit. ``seems`` (n, k): the network adds to these points, and errors
    beyond ``POINTS`` count less (Huber's loss)."""
    torch.manual_seed(seed)
    rng, held = np.random.default_rng(seed), table % HELD == HELD - 1
    mean, deviation = seen[~held].mean((0, 1), np.float64), seen[~held].std((0, 1), np.float64) + 1e-3
    scaled = torch.from_numpy(((seen - mean) / deviation).astype(np.float32))
    network, lossy = StrokeNetwork(seen.shape[-1]), nn.functional.mse_loss
    if seems is None:
        plain, base = seen[..., 0], np.zeros_like(worth)  # what the policy says
    else:
        plain, base, lossy = seems, seems, nn.functional.huber_loss
        with torch.no_grad():  # it begins by adding nothing
            last: nn.Linear = network[-1]  # type: ignore[assignment]
            last.weight.mul_(0.1)
            last.bias.zero_()
    wanted = torch.from_numpy(((worth - base) / POINTS).astype(np.float32))
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
            loss = lossy(off, torch.zeros_like(off)) + COMPARED * lossy(compared, torch.zeros_like(off))
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
    with torch.no_grad():
        said = network(scaled[held])[..., 0].numpy() + base[held] / POINTS
    true = worth[held] / POINTS
    beside = [one - one.mean(axis=1, keepdims=True) for one in (said, true)]
    chosen, before = (
        np.take_along_axis(true, by.argmax(axis=1)[:, None], 1)[:, 0] for by in (said, plain[held])
    )
    figures = {
        "positions": len(seen),
        "explained": float(1.0 - ((beside[0] - beside[1]) ** 2).mean() / (beside[1] ** 2).mean()),
        "worth_chosen": POINTS * float(chosen.mean()),
        "worth_chosen_unlearned": POINTS * float(before.mean()),
    }
    return network.layers(mean, deviation), figures


def visits_tried(layers, noise, cue, seeds, rng):
    """Visits from the tables ``seeds``: what is seen of the strokes tried, float16 (n, k, SIZE), their worth [points],
    float32 (n, k), and the seeds of the tables on which the visits began (n,)."""
    n, env = len(seeds), sn.SnookerVectorEnv(len(seeds), layout="opened", **VISITS, noise=noise, cue=cue)
    env.reset(seed=seeds.tolist())
    values: StrokeValue = StrokeValuePlayer(StrokeLayers(layers)).at(env).values
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
        kept_table.append(seeds[live[found.rows]])
        chosen = np.where(rng.random(len(scores)) < EXPLORE, rng.integers(AMONG, size=len(scores)), 0)
        strokes = plain.play(visits, keys[live]).values
        strokes[found.rows] = found.strokes[every[:, 0], order[every[:, 0], chosen]]
        if not layers:  # nothing is learned yet: half of the tables show where a good player comes
            half = np.flatnonzero(np.arange(len(live)) % 2)
            strokes[half] = expert.play(visits[half], keys[live][half]).values
        actions = np.zeros((n, env.options.rules.actions.size))
        actions[live] = Strokes(strokes, places).actions(env.options, at[live])
        env.step(actions)
    env.close()
    return tuple(map(np.concatenate, (kept_seen, kept_worth, kept_table)))


def arrays_of(of, layers):
    """The arrays of the network of "visits" or "frames" in a file that ``weights.learned_strokes`` reads."""
    made = {f"{of}/{k}/weight": weight.astype(np.float32) for k, (weight, _) in enumerate(layers)}
    return made | {f"{of}/{k}/bias": bias.astype(np.float32) for k, (_, bias) in enumerate(layers)}


@dataclass(frozen=True)
class StrokeSettings:
    """Of a run: what its rounds are made of."""

    seed: int = 0
    rounds: int = 8
    tables: int = 1024
    """Of a round of visits."""
    frame_rounds: int = 3
    frames: int = 512
    """Of a round of frames."""
    cue: str = "real"

    @classmethod
    def of(cls, seed, changes):
        """With "key=value" in ``changes``. Raises ValueError."""
        made = cls(seed, **changes_of(changes, [f.name for f in fields(cls)][1:]))
        integer("seed", made.seed, 0, 80)
        for name in ("rounds", "frame_rounds"):
            integer(name, getattr(made, name), 1, 50)
        for name in ("tables", "frames"):
            integer(name, getattr(made, name), HELD, 100_000)
        choice("cue", made.cue, ("real", "free"))
        return made

    def save(self, out):
        """Into the run's folder."""
        write_json(out / SETTINGS, with_checksum(asdict(self)))

    @classmethod
    def read(cls, out):
        """Of the run in that folder. Raises ValueError."""
        try:
            return cls(
                **read_json("out", out / SETTINGS, "must be a complete file of settings", checked=True)
            )
        except TypeError:
            raise refuse("out", str(out / SETTINGS), "must be a complete file of settings") from None

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


_VERSION = (
    LOOKS,
    SAMPLES,
    SIZE,
    frame_strokes.SIZE,
    STROKES_EACH,
    PARTS,
    SCALES,
    BEST,
    OTHERS,
    ERRORS,
    EXPLORE,
    AMONG,
    AGAINST,
    frame_strokes.SAFETIES,
    frame_strokes.SAMPLES,
    frame_strokes.FOUL,
    frame_strokes.POTTED,
)
"""What the data of rounds depend on beside the settings: rounds of other ones are not resumed."""


class Rounds:
    """Rounds of "visits" or "frames", ``of``, of a run in the folder ``out``; those that it holds already are read.

    ``many`` rounds on so many ``tables`` each, from ``first`` on."""

    def __init__(self, out, settings, of, many, tables, first):
        self.out, self.settings, self.of, self.many, self.tables = out, settings, of, many, tables
        self.first, self.rounds, self.curve, self.layers = first, [], [], ()
        self._asked = [*map(str, (*astuple(settings), *_VERSION))]
        while len(self.rounds) < many and self._file().is_file():
            rows = kept_arrays(self._file())
            if rows.pop("asked").tolist() != self._asked:
                raise refuse("out", str(out), "must hold rounds of this version and of the same settings")
            self._learn(rows)

    def _file(self, what=""):
        return self.out / f"{self.of}-{len(self.rounds)}{what}.npz"

    @property
    def tried(self):
        """Shots that were simulated for the strokes that were tried."""
        return sum(one["worth"].size * ERRORS for one in self.rounds)

    @property
    def simulated(self):
        """All shots that the rounds simulated, play and the decisions of other players too."""
        return sum(int(one["shots"]) for one in self.rounds)

    @property
    def total(self):
        """Tables of all rounds."""
        return self.many * self.tables

    @property
    def done(self):
        """Tables of the rounds that are complete."""
        return len(self.rounds) * self.tables

    @property
    def complete(self):
        """Whether all rounds are."""
        return len(self.rounds) == self.many

    def run(self, play, progress, stop):
        """Play the rounds that are left and learn from each, until ``stop`` notes a signal. ``play(layers, noise, k, seeds,
        rng)`` plays the tables ``seeds`` of a round's part k and returns what ``visits_tried`` does."""
        while not self.complete and stop.signal is None:
            self._round(play, progress, stop)

    def _round(self, play, progress, stop):
        k, parts, played_on, before = len(self.rounds), [], self.done, simulated()
        first, rng = self.first + 100_000 * k, np.random.default_rng([self.settings.seed, k])
        shares = (np.arange(PARTS) + rng.random(PARTS)) / PARTS
        split = np.array_split(np.arange(first, first + self.tables), PARTS)
        for part, (share, seeds) in enumerate(zip(shares, split, strict=True)):
            scale = SCALES[0] * (SCALES[1] / SCALES[0]) ** share
            parts.append(play(self.layers, noise_option(f"professional*{scale}"), part, seeds, rng))
            progress.at(played_on := played_on + len(seeds), self.figures)
            if stop.signal is not None and part + 1 < PARTS:
                return
        seen, worth, table = map(np.concatenate, zip(*parts, strict=True))
        rows = {"seen": seen, "worth": worth, "table": table, "shots": np.array(simulated() - before)}
        keep_arrays(self._file(), rows | {"asked": np.array(self._asked)})
        self._learn(rows)

    @property
    def figures(self):
        """Those of the last fit, in words."""
        said = f"round {len(self.rounds) + 1} of {self.many}"
        return said + (
            f", {self.curve[-1]['explained']:.0%} of the differences explained" if self.curve else ""
        )

    def _learn(self, rows):
        weights, k, of = self._file("-weights"), len(self.rounds), self.of
        self.rounds.append(rows)
        if weights.is_file():
            arrays = kept_arrays(weights)
            self.layers = layers_of(arrays, of)
            self.curve.append(strict_json(str(arrays["figures"])))
            return
        seed, passes = (0, LAST_PASSES[of]) if self.complete else (k, PASSES)
        seen, worth, table = (
            np.concatenate([one[name] for one in self.rounds]) for name in ("seen", "worth", "table")
        )
        seen = seen.astype(np.float32)
        seems = POINTS * seen[..., 0] if of == "frames" else None
        self.layers, figures = fitted(seen, worth, table, self.settings.seed + seed, passes, seems)
        self.curve.append(figures)
        keep_arrays(weights, arrays_of(of, self.layers) | {"figures": np.array(json.dumps(figures))})


class StrokeTraining:
    """A run in the folder ``out``: rounds of visits, then of frames."""

    def __init__(self, out, settings):
        self.out, self.settings, first = out, settings, FIRST_SEED + 10_000_000 * settings.seed
        self.visits = Rounds(out, settings, "visits", settings.rounds, settings.tables, first)
        self.frames = Rounds(
            out, settings, "frames", settings.frame_rounds, settings.frames, first + 5_000_000
        )

    def play_visits(self, progress, stop):
        """Play the rounds of visits that are left."""

        def play(layers, noise, _part, seeds, rng):
            return visits_tried(layers, noise, self.settings.cue, seeds, rng)

        self.visits.run(play, progress, stop)

    def play_frames(self, progress, stop):
        """Play the rounds of frames that are left, when those of visits are complete."""
        tried, threads = (BEST, OTHERS, ERRORS, EXPLORE, AMONG), processors()

        def play(layers, noise, part, seeds, rng):
            learned, other = StrokeLayers(self.visits.layers, layers), AGAINST[part % len(AGAINST)]
            return frames_tried(learned, noise, self.settings.cue, seeds, other, tried, rng, threads)

        self.frames.run(play, progress, stop)

    def save(self):
        """Both networks, into ``STROKES`` of the folder."""
        both = arrays_of("visits", self.visits.layers) | arrays_of("frames", self.frames.layers)
        write_atomic(self.out / STROKES, packed(both))
