"""How does ``stroke_value`` learn the values of strokes, so that it need not simulate them in play?

``python train.py --agent stroke_value``. Each round plays visits with errors from ``SCALES[0]`` to ``SCALES[1]`` times a
professional's, using what earlier rounds have learned (half of the first round uses the planner). In each position reached,
it simulates some of the strokes that the player considers, each with ``ERRORS`` execution errors. A stroke is worth its points
plus the planner's value of the position left. A network is fitted to this worth on the positions of its own visits (DAgger;
Ross, Gordon & Bagnell 2011), for longer after the last round. Rounds of frames follow, against itself, ``best_pot`` and
``tactician_60``: a second network learns the difference between the worth of strokes in frames, safeties included, and their
first estimate. After each round, the run's folder holds its data and weights, from which a resumed run continues.
"""

from dataclasses import asdict, astuple, dataclass, fields

import numpy as np
import torch
from torch import nn

import snooker_env as sn
from agents._lib.files import packed_arrays, write_atomic
from agents._lib.noise_option import noise_option
from snooker_env.benchmark import count_shots
from snooker_env.checks import choice, integer, refuse
from snooker_env.planning import Planner, Positions, processors
from snooker_env.planning.learned import frame_strokes
from snooker_env.planning.learned.frame_strokes import FrameStrokes
from snooker_env.planning.learned.stroke_value import LOOKS, POINTS, SAMPLES, SIZE, StrokeValue
from snooker_env.players import FRAMES, VISITS, Strokes
from snooker_env.players.player import place_cue_balls
from snooker_env.players.search_player import SearchPlayer, StrokeValuePlayer, Tactician
from snooker_env.players.weights import STROKES, StrokeLayers, layers_of

from .frame_self_play import play_frames
from .hyperparameters import changes_of
from .rounds import Perceptron, Rounds, arrays_of, descend, shares_of_parts

AGENT = "stroke_value"
STROKES_EACH, PARTS = 8, 8
"""Strokes played on each table of a round, and number of parts with different errors."""
SCALES = 0.7, 4.5
"""Errors of the visits and frames relative to a professional's, evenly spread in the logarithm."""
BEST, OTHERS, ERRORS = 10, 10, 4
"""Strokes tried in a position: the best by estimate, and random others; and execution errors for each."""
EXPLORE, AMONG = 0.1, 8
"""Share of strokes taken from the ``AMONG`` best instead of the best by estimate."""
WIDTHS, BATCH, DECAY = (128, 64), 512, 1e-4
PASSES, LAST_PASSES = 15, {"visits": 60, "frames": 20}
"""Passes over the positions after each round, and after the last one."""
AGAINST = None, None, "best_pot", "tactician_60"
"""Opponents in the parts of a round of frames, in turn; None: itself."""
COMPARED = 2.0
"""Weight of the differences between strokes of a position; the weight of the worth itself is 1."""
HELD = 10
"""One table in this many is held out from the fit, to measure its error."""
FIRST_SEED = 30_000_000
"""The seed of the first table."""


def fit_strokes(seen, worth, table, seed, passes, seems=None):
    """Fit a network to the ``worth`` (n, k) [points] of strokes with features (n, k, SIZE) on the tables with these seeds
    (n,). Returns its layers and figures of held-out tables. With ``seems`` (n, k), the network adds to these points, and
    errors beyond ``POINTS`` count less (Huber's loss)."""
    torch.manual_seed(seed)
    rng, held = np.random.default_rng(seed), table % HELD == HELD - 1
    mean, deviation = seen[~held].mean((0, 1), np.float64), seen[~held].std((0, 1), np.float64) + 1e-3
    scaled = torch.from_numpy(((seen - mean) / deviation).astype(np.float32))
    network, lossy = Perceptron(seen.shape[-1], *WIDTHS, 1), nn.functional.mse_loss
    if seems is None:
        plain, base = seen[..., 0], np.zeros_like(worth)  # the policy's estimate
    else:
        plain, base, lossy = seems, seems, nn.functional.huber_loss
        with torch.no_grad():  # at first the network adds nothing
            last: nn.Linear = network[-1]  # type: ignore[assignment]
            last.weight.mul_(0.1)
            last.bias.zero_()
    wanted = torch.from_numpy(((worth - base) / POINTS).astype(np.float32))

    def loss_of(rows):
        off = network(scaled[rows])[..., 0] - wanted[rows]
        compared = off - off.mean(dim=1, keepdim=True)
        return lossy(off, torch.zeros_like(off)) + COMPARED * lossy(compared, torch.zeros_like(off))

    descend(network, loss_of, np.flatnonzero(~held), rng, passes, BATCH, DECAY)
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
    layers = network.arrays()
    weight, bias = layers[0]  # for features as they are
    layers[0] = weight / deviation, bias - (weight / deviation) @ mean
    return layers, figures


def try_visits(layers, noise, cue, seeds, rng):
    """Play visits from the tables ``seeds``. Returns the features of the strokes tried, float16 (n, k, SIZE), their worth
    [points], float32 (n, k), and the seeds of the tables on which the visits began (n,)."""
    n, env = len(seeds), sn.SnookerVectorEnv(len(seeds), layout="opened", **VISITS, noise=noise, cue=cue)
    env.reset(seed=seeds.tolist())
    values: StrokeValue = StrokeValuePlayer(StrokeLayers(layers)).at(env).values
    plain, planner = sn.player("ghost_ball").at(env), Planner(env)
    expert: SearchPlayer = sn.player("planner_60").at(env)  # type: ignore[assignment]
    values.value.threads = planner.threads
    judge = expert.judge.value
    kept_seen, kept_worth, kept_table, tried = [], [], [], BEST + OTHERS
    for _ in range(STROKES_EACH):
        at, keys = Positions.of(env), rng.integers(2**32, size=n)
        live = np.flatnonzero(~at.over)
        visits, places = place_cue_balls(at[live], keys[live])
        found = values.candidates(visits, LOOKS, keys[live])
        scores, every = values.scores(found.seen), np.arange(len(found.rows))[:, None]
        order = np.argsort(-scores, axis=1, kind="stable")
        rest = rng.permuted(order[:, BEST:], axis=1)[:, :OTHERS]
        picks = np.concatenate([order[:, :BEST], rest], axis=1)
        rows = np.repeat(found.rows, tried * ERRORS)
        trials = np.repeat(found.strokes[every, picks].reshape(-1, 5), ERRORS, axis=0)
        out = planner.play_strokes(
            visits, rows, trials, errors=planner.rules.noise.draw_errors(rng, len(rows))
        )
        worth, on = out.points, np.flatnonzero(out.goes_on)
        worth[on] += judge(out.afterstates[on])
        kept_seen.append(found.seen[every, picks].astype(np.float16))
        kept_worth.append(worth.reshape(-1, tried, ERRORS).mean(axis=2).astype(np.float32))
        kept_table.append(seeds[live[found.rows]])
        chosen = np.where(rng.random(len(scores)) < EXPLORE, rng.integers(AMONG, size=len(scores)), 0)
        strokes = plain.play(visits, keys[live]).values
        strokes[found.rows] = found.strokes[every[:, 0], order[every[:, 0], chosen]]
        if not layers:  # nothing is learned yet, so half of the tables show the positions of a good player
            half = np.flatnonzero(np.arange(len(live)) % 2)
            strokes[half] = expert.play(visits[half], keys[live][half]).values
        actions = np.zeros((n, env.options.rules.actions.size))
        actions[live] = Strokes(strokes, places).actions(env.options, at[live])
        env.step(actions)
    env.close()
    return tuple(map(np.concatenate, (kept_seen, kept_worth, kept_table)))


def try_frames(learned, noise, cue, seeds, other, rng):
    """Play frames from the tables ``seeds``, with the layers ``learned``, against ``other``: the name of a player, or None for
    itself, in which case both sides count. Returns as ``try_visits``; a stroke's worth [points] is that of the ``tactician``,
    expected points minus the opponent's."""
    options = sn.Options(task="frame", **FRAMES, cue=cue, miss="clear_path", noise=noise)
    known = options.but(conditions="fixed")  # a player does not know the constants of a table
    player, judge = StrokeValuePlayer(learned).at(known), Tactician().at(known).judge
    search: FrameStrokes = player.search
    for value in (search.values.value, search.worth.value):
        value.threads = processors()
    rows = []

    def act(tables, mine, at, keys):
        strokes, compared, start = player.decide_frames(at, keys)
        here = [k for k, one in enumerate(compared) if one is not None and len(one.strokes) >= BEST + OTHERS]
        if here:
            looked = search.look(start[here], keys[here])
            scores = np.where(looked.there, search.scores(looked.seen), -np.inf)
            order, every = np.argsort(-scores, axis=1, kind="stable"), np.arange(len(here))[:, None]
            picks = order[:, : BEST + OTHERS]
            for j, count in enumerate(looked.there.sum(axis=1).tolist()):
                picks[j, BEST:] = rng.choice(order[j, BEST:count], OTHERS, replace=False)
            which = np.repeat(np.arange(len(here)), picks.shape[1] * ERRORS)
            trials = np.repeat(looked.strokes[every, picks].reshape(-1, 5), ERRORS, axis=0)
            met = judge.noise.draw_errors(rng, len(which))
            worth = judge.gains(start[here], which, trials, met)[:, 1].reshape(*picks.shape, ERRORS)
            seen = looked.seen[every, picks].astype(np.float16)
            rows.append((seen, worth.mean(axis=2).astype(np.float32), seeds[mine[here]]))
        for k, one in enumerate(compared):
            if one is not None and rng.random() < EXPLORE:
                strokes.values[k] = one.strokes.values[rng.integers(min(AMONG, len(one.strokes)))]
        return strokes

    against = None if other is None else sn.player(other).at(known)
    play_frames(options.rules, int(seeds[0]), len(seeds), act, against, processors())
    return tuple(map(np.concatenate, zip(*rows, strict=True)))


@dataclass(frozen=True)
class StrokeSettings:
    """Settings of a run's rounds."""

    seed: int = 0
    rounds: int = 8
    tables: int = 1024
    """Settings of a round of visits."""
    frame_rounds: int = 3
    frames: int = 512
    """Settings of a round of frames."""
    cue: str = "real"

    @classmethod
    def of(cls, seed, changes):
        """Apply "key=value" in ``changes``. Raises ValueError."""
        made = cls(seed, **changes_of(changes, [f.name for f in fields(cls)][1:]))
        integer("seed", made.seed, 0, 80)
        for name in ("rounds", "frame_rounds"):
            integer(name, getattr(made, name), 1, 50)
        for name in ("tables", "frames"):
            integer(name, getattr(made, name), HELD, 100_000)
        choice("cue", made.cue, ("real", "free"))
        return made


_FRAMES = frame_strokes.SAFETIES, frame_strokes.SAMPLES, frame_strokes.FOUL, frame_strokes.POTTED
_VISITS = LOOKS, SAMPLES, SIZE, frame_strokes.SIZE, STROKES_EACH, PARTS, SCALES
_VERSION = *_VISITS, BEST, OTHERS, ERRORS, EXPLORE, AMONG, AGAINST, *_FRAMES
"""Inputs of the rounds besides the settings; rounds with other inputs are not resumed."""


class StrokeRounds(Rounds):
    """Rounds of visits or frames, on tables from seed ``first`` on."""

    def __init__(self, out, settings, name, many, tables, first):
        super().__init__(out, name, many, tables, PARTS, (*astuple(settings), *_VERSION))
        self.what, self.settings, self.first, self.layers = f"its own {name}", settings, first, ()

    @property
    def trial_shots(self):
        """Shots simulated for the strokes tried."""
        return sum(one["worth"].size * ERRORS for one in self.rounds)

    @property
    def simulated(self):
        """All shots simulated in the rounds, including play and the decisions of other players."""
        return sum(int(one["shots"].sum()) for one in self.rounds)

    @property
    def figures(self):
        said = f"round {min(len(self.rounds) + 1, self.many)} of {self.many}"
        explained = f", {self.curve[-1]['explained']:.0%} of the differences explained" if self.curve else ""
        return said + explained

    def tried_on(self, noise, part, seeds, rng):
        """The features of the strokes tried on these tables, their worth, and the tables' seeds."""
        raise NotImplementedError

    def parts_of(self, k):
        first, rng = self.first + 100_000 * k, np.random.default_rng([self.settings.seed, k])
        shares = shares_of_parts(rng, PARTS)
        split = np.array_split(np.arange(first, first + self.tables), PARTS)
        for part, (share, seeds) in enumerate(zip(shares, split, strict=True)):
            scale, before = SCALES[0] * (SCALES[1] / SCALES[0]) ** share, count_shots()
            played = self.tried_on(noise_option(f"professional*{scale}"), part, seeds, rng)
            shots = np.array([count_shots() - before])
            yield dict(zip(("seen", "worth", "table", "shots"), (*played, shots), strict=True))

    def seems(self, seen):
        """The first estimate of the strokes' worth [points]; None: no estimate."""

    def fit(self):
        k = len(self.rounds)
        seed, passes = (0, LAST_PASSES[self.name]) if k == self.many else (k - 1, PASSES)
        names = ("seen", "worth", "table")
        seen, worth, table = (np.concatenate([one[name] for one in self.rounds]) for name in names)
        seen = seen.astype(np.float32)
        layers, figures = fit_strokes(seen, worth, table, self.settings.seed + seed, passes, self.seems(seen))
        return arrays_of(self.name, layers), figures

    def take(self, arrays):
        self.layers = layers_of(arrays, self.name)


class VisitRounds(StrokeRounds):
    """The rounds of visits of ``stroke_value``."""

    def tried_on(self, noise, part, seeds, rng):
        return try_visits(self.layers, noise, self.settings.cue, seeds, rng)


class FrameRounds(StrokeRounds):
    """The rounds of frames of ``stroke_value``, after those of visits."""

    visits: VisitRounds

    def tried_on(self, noise, part, seeds, rng):
        learned, other = StrokeLayers(self.visits.layers, self.layers), AGAINST[part % len(AGAINST)]
        return try_frames(learned, noise, self.settings.cue, seeds, other, rng)

    def seems(self, seen):
        return POINTS * seen[..., 0]


class StrokeTraining:
    """Open a run in the folder ``out``; of these settings only seed and changes count. Raises ValueError."""

    def __init__(self, settings, out, resume):
        for name, usual in asdict(type(settings)()).items():
            if getattr(settings, name) != usual and name not in ("agent", "seed", "set", "eval_visits"):
                raise refuse(name, getattr(settings, name), f"must be left out for {AGENT}")
        self.settings, self.out, self.strokes = settings, out, StrokeSettings.of(settings.seed, settings.set)
        mine, first = self.strokes, FIRST_SEED + 10_000_000 * settings.seed
        self.visits = VisitRounds(out, mine, "visits", mine.rounds, mine.tables, first)
        self.frames = FrameRounds(out, mine, "frames", mine.frame_rounds, mine.frames, first + 5_000_000)
        self.frames.visits, self.parts = self.visits, [self.visits, self.frames]
        for part in self.parts if resume else ():
            part.restore()

    def save(self):
        """Do nothing: each round is kept."""

    def close(self):
        """Do nothing: nothing is open."""

    def write(self):
        """Write both networks into ``STROKES`` of the folder. Returns its path."""
        both = [arrays_of(part.name, part.layers) for part in self.parts]
        write_atomic(self.out / STROKES, packed_arrays(both[0] | both[1]))
        return self.out / STROKES
