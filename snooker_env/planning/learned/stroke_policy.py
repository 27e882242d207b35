"""How does a learned policy score and propose strokes while it plays? By kernels: a table's scores depend on that table alone.
The network is that of ``agents.learning.networks``: for each ball, for each pot, sums, a context, scores of the 540 choices.
A softmax makes probabilities, which are sampled systematically; a Sobol point moves each stroke within its choice's cell."""

from collections.abc import Mapping
from math import hypot, log10

import numpy as np

from ..._lib.jit import entry, kernel
from ..._lib.types import Bools, Floats, Ints, Singles
from ...game.balls import N_BALLS, N_REDS, VALUES
from ...game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, find_pots
from ...game.pots import TOLERANCE as POT_TOLERANCE
from ...geometry import AIM_X, AIM_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from ...physics.cue_room import NO_RAILS
from ...tasks.discrete_actions import POTS, SIDES, SPEEDS, STROKES, TOPS
from ...tasks.discrete_actions import SIZE as CHOICES
from ...tasks.observations import SIZE as OBSERVATION_SIZE
from ..positions import Positions
from ..proposals import Asking, Proposals, strokes_at
from ..sobol import sobol_points
from ..strokes import action_masks
from .dense_layers import linear, relu

POT_ENTRIES = 13  # numbers shown of each of the ``tasks.POTS`` widest pots, see ``with_pots``
SHOWN = OBSERVATION_SIZE + POTS * POT_ENTRIES
# Entries that change sign when the table is mirrored, left and right exchanged.
BALL_X = 0
POT_X, CUT = (1, 9, 11), 3
TOLERANCE = 7  # the entry that shows the tolerance [rad], as 1 + log10(tolerance) / 2
LAYERS = ("ball_1", "ball_2", "pot_1", "pot_2", "context_1", "context_2", "shared", "joint", "scores")
"""The linear layers, in the order of their computation."""
BLOCK = 128  # tables that are scored together: their intermediate results stay in the processor's cache
SCORED = -(-STROKES // 16) * 16  # columns of the scores: 144 take less time than 135, in whole registers
STATE = OBSERVATION_SIZE - 5 * N_BALLS  # numbers of the game's state in an observation
BALL_INPUTS = 5 + 2
_TOPS, _TURN = len(TOPS), (len(SIDES) - 1) * len(TOPS)
_X1, _X2, _X3 = POT_X
NEVER = np.float32(-1e8)  # the score of a choice that is not available, as in ``sb3_contrib``
# literals are float64, and half as many of them fit into a register
_ZERO, _FIFTH = np.float32(0.0), np.float32(0.2)


@entry(what="the view of the pots", seconds=1)
def _add_pots(observations, shown):
    """Copy observations (n, OBSERVATION_SIZE) to ``shown``, and the pots read from them behind."""
    lines = np.empty((POTS, POT_COLUMNS))
    positions, on_table = np.empty((N_BALLS, 2)), np.empty(N_BALLS, np.bool_)
    for k in range(len(observations)):
        seen, row, on = observations[k], shown[k], 0
        for c in range(OBSERVATION_SIZE):
            row[c] = seen[c]
        for c in range(OBSERVATION_SIZE, row.shape[0]):
            row[c] = 0.0
        for i in range(N_BALLS):
            positions[i, 0], positions[i, 1] = seen[5 * i] * HALF_WIDTH, seen[5 * i + 1] * HALF_LENGTH
            on_table[i] = seen[5 * i + 2] > 0.0
            on |= (1 << i) if seen[5 * i + 4] > 0.0 else 0
        for p in range(find_pots(positions, on_table, on, BALL_RADIUS, lines) if on_table[0] else 0):
            ball, pocket = int(lines[p, POT_BALL]), int(lines[p, POT_POCKET])
            at = OBSERVATION_SIZE + POT_ENTRIES * p
            bx, by, gx, gy = positions[ball, 0], positions[ball, 1], lines[p, GHOST_X], lines[p, GHOST_Y]
            px, py, rx, ry = gx - positions[0, 0], gy - positions[0, 1], bx - gx, by - gy
            away, run = hypot(px, py), hypot(rx, ry)
            px, py, rx, ry = px / away, py / away, rx / run, ry / run
            to_pocket = hypot(POCKET_AIMS[pocket, AIM_X] - bx, POCKET_AIMS[pocket, AIM_Y] - by)
            row[at], row[at + 1], row[at + 2] = 1.0, px, py
            row[at + 3], row[at + 4] = px * ry - py * rx, lines[p, COS_CUT]
            row[at + 5], row[at + 6] = away / HALF_LENGTH - 1.0, to_pocket / HALF_LENGTH - 1.0
            row[at + TOLERANCE], row[at + 8] = 1.0 + log10(lines[p, POT_TOLERANCE]) / 2.0, VALUES[ball] / 7.0
            row[at + 9], row[at + 10] = bx / HALF_WIDTH, by / HALF_LENGTH
            row[at + 11] = POCKET_AIMS[pocket, AIM_X] / HALF_WIDTH
            row[at + 12] = POCKET_AIMS[pocket, AIM_Y] / HALF_LENGTH
            for c in range(at, at + POT_ENTRIES):
                row[c] = min(1.0, max(-1.0, row[c]))


def with_pots(observations: Singles) -> Singles:
    """Flat observations (n, OBSERVATION_SIZE), then of each of the four widest pots: 1, direction cue ball -> ghost ball (x, y),
    sine and cosine of the cut, both distances, tolerance, the ball's value and place, the pocket's place."""
    shown = np.empty((len(observations), SHOWN), np.float32)
    _add_pots(np.ascontiguousarray(observations), shown)
    return shown


@entry
def read_tables(rows, seen, inputs, at):
    """Write the inputs of the networks for the tables seen[rows]; returns the number of balls on them: balls (m, BALL_INPUTS);
    group (m,), 0 for a red that is not on, 1 for a red on, 2 and 3 likewise for colours; first (n + 1,), each table's first
    row of them; pots (n * POTS, POT_ENTRIES); context[:, at:], state, cue ball, side; sides (n,), -1 where mirrored, else 1."""
    balls, group, first, pots, context, sides = inputs
    m = 0
    for j in range(rows.shape[0]):
        row, first[j] = seen[rows[j]], m
        side = -1.0 if row[BALL_X] < 0.0 else 1.0
        sides[j] = side
        cue_x, cue_y = row[BALL_X] * side, row[1]
        for i in range(1, N_BALLS):
            b = 5 * i
            if row[b + 2] <= 0.0:
                continue
            ball = balls[m]
            x = row[b] * side
            ball[0], ball[5], ball[6] = x, x - cue_x, row[b + 1] - cue_y
            for c in range(1, 5):
                ball[c] = row[b + c]
            group[m] = (2 if i > N_REDS else 0) + (1 if row[b + 4] > 0.0 else 0)
            m += 1
        for p in range(POTS):
            pot, b = pots[POTS * j + p], OBSERVATION_SIZE + POT_ENTRIES * p
            for c in range(POT_ENTRIES):
                pot[c] = row[b + c]
            pot[_X1] *= side
            pot[_X2] *= side
            pot[_X3] *= side
            pot[CUT] *= side
        for c in range(STATE):
            context[j, at + c] = row[5 * N_BALLS + c]
        context[j, at + STATE], context[j, at + STATE + 1], context[j, at + STATE + 2] = cue_x, cue_y, side
    first[rows.shape[0]] = m
    return m


@entry
def sum_balls(codes, group, first, context, width):
    """ReLU of balls' codes (m, width) in place; sums / 5 of those on, reds, colours into context."""
    for j in range(first.shape[0] - 1):
        sums = context[j]
        for c in range(3 * width):
            sums[c] = _ZERO
        for b in range(first[j], first[j + 1]):
            code, kind = codes[b], group[b]
            of_kind = sums[width : 2 * width] if kind < 2 else sums[2 * width : 3 * width]
            for c in range(width):
                x = max(code[c], _ZERO)
                code[c] = x
                of_kind[c] += x
            if kind & 1:
                for c in range(width):
                    sums[c] += code[c]
        for c in range(3 * width):
            sums[c] *= _FIFTH


@entry
def sum_pots(codes, pots, context, at):
    """ReLU of pots' codes (n * POTS, width) in place, 0 for no pot; sums into context[:, at : at + width]."""
    width = codes.shape[1]
    for j in range(context.shape[0]):
        sums = context[j, at : at + width]
        for c in range(width):
            sums[c] = _ZERO
        for p in range(POTS * j, POTS * (j + 1)):
            code, exists = codes[p], pots[p, 0]
            for c in range(width):
                code[c] = max(code[c], _ZERO) * exists
                sums[c] += code[c]


@entry
def join(joint, shared, pots):
    """joint (n * POTS, width) = ReLU(joint + shared of the table), in place, 0 where there is no pot."""
    width = joint.shape[1]
    for j in range(shared.shape[0]):
        common = shared[j]
        for p in range(POTS * j, POTS * (j + 1)):
            row, exists = joint[p], pots[p, 0]
            for c in range(width):
                row[c] = max(row[c] + common[c], _ZERO) * exists


@kernel
def mirror_choice(choice):
    """The choice with the other side spin."""
    return choice + _TURN - 2 * _TOPS * (choice // _TOPS % (_TURN // _TOPS + 1))


@entry
def mask_scores(rows, masks, sides, scores, out):
    """Scores (n, choices) of each pot's (n * POTS, STROKES or more); ``NEVER`` where the mask is False."""
    for j in range(rows.shape[0]):
        mask, row = masks[rows[j]], out[j]
        for p in range(POTS):
            of_pot, at = scores[POTS * j + p], STROKES * p
            if sides[j] > 0.0:
                for c in range(STROKES):
                    row[at + c] = of_pot[c] if mask[at + c] else NEVER
            else:
                for c in range(0, STROKES, _TOPS):
                    other = mirror_choice(at + c)
                    for t in range(_TOPS):
                        row[at + c + t] = of_pot[c + t] if mask[other + t] else NEVER


@entry
def exchange_sides(scores, sides):
    """Exchange the sides of strokes in scores (n, choices), in place, where the table was read mirrored."""
    for j in range(scores.shape[0]):
        if sides[j] < 0.0:
            row = scores[j]
            for c in range(row.shape[0]):
                other = mirror_choice(c)
                if other > c:
                    row[c], row[other] = row[other], row[c]


class StrokePolicy:
    """Scores discrete choices; ``weights``: name in ``LAYERS`` -> (weight (out, in), bias (out,))."""

    def __init__(self, weights: Mapping[str, tuple[Singles, Singles]]):
        self._layers = {}
        for name in LAYERS:
            weight, bias = weights[name]
            columns = SCORED if name == "scores" else len(bias)
            turned, shift = np.zeros((weight.shape[1], columns), np.float32), np.zeros(columns, np.float32)
            turned[:, : len(bias)], shift[: len(bias)] = weight.T, bias
            self._layers[name] = turned, shift

    def scores(self, seen: Singles, masks: Bools) -> Singles:
        """Scores (n, CHOICES) on tables of ``with_pots`` (n, SHOWN); ``NEVER`` where masks are False."""
        scores = np.empty((len(seen), CHOICES), np.float32)
        for start in range(0, len(seen), BLOCK):
            rows = np.arange(start, min(start + BLOCK, len(seen)))
            self._score(rows, seen, masks, scores[rows[0] : rows[-1] + 1])
        return scores

    def _score(self, rows: Ints, seen: Singles, masks: Bools, out: Singles) -> None:
        """The scores of one block of tables."""
        n, width = len(rows), len(self._layers["ball_2"][1])
        state_at = 3 * width + len(self._layers["pot_2"][1])
        balls = np.empty((n * (N_BALLS - 1), BALL_INPUTS), np.float32)
        pots = np.empty((n * POTS, POT_ENTRIES), np.float32)
        groups, first = np.empty(len(balls), np.int64), np.empty(n + 1, np.int64)
        context, sides = np.empty((n, state_at + STATE + 3), np.float32), np.empty(n, np.float32)
        m = read_tables(rows, seen, (balls, groups, first, pots, context, sides), state_at)
        sum_balls(self._codes("ball", balls[:m]), groups, first, context, width)
        pot_codes = self._codes("pot", pots)
        sum_pots(pot_codes, pots, context, 3 * width)
        read = self._codes("context", context)
        relu(read)
        joint = self._linear("joint", pot_codes)
        join(joint, self._linear("shared", read), pots)
        mask_scores(rows, masks, sides, self._linear("scores", joint), out)
        exchange_sides(out, sides)

    def _codes(self, name: str, rows: Singles) -> Singles:
        """The results of two layers with a ReLU between them."""
        between = self._linear(f"{name}_1", rows)
        relu(between)
        return self._linear(f"{name}_2", between)

    def _linear(self, name: str, rows: Singles) -> Singles:
        weight, bias = self._layers[name]
        out = np.empty((len(rows), len(bias)), np.float32)
        linear(rows, weight, bias, out)
        return out


TEMPERATURE = 4.0  # of the scores: above 1, so that less likely ones are tried too
_SPEEDS, _SIDES, _HEIGHTS = np.array(SPEEDS), np.array(SIDES), np.array(TOPS)
_STEP = np.gradient(np.log(_SPEEDS))  # width of a cell in the logarithm of the speed
_SIDE_STEP, _TOP_STEP = _SIDES[1] - _SIDES[0], _HEIGHTS[1] - _HEIGHTS[0]


class PolicyProposals:
    """The proposals of a ``Search`` by a ``StrokePolicy`` on tables as ``with_pots`` shows them."""

    def __init__(self, policy: StrokePolicy):
        self.policy = policy

    def scores(self, at: Positions, rails: Floats = NO_RAILS) -> tuple[Singles, Bools]:
        """Scores of all choices in n ``Positions``, (n, CHOICES), and which are available, see ``action_masks``."""
        masks = action_masks(at, rails=rails)
        return self.policy.scores(with_pots(at.observations()), masks), masks

    def __call__(self, judge: Asking, at: Positions, m: int, seeds: Ints) -> Proposals:
        """m strokes for each position, see ``Propose``."""
        scores, masks = self.scores(at, judge.dynamics.rails)
        picks, tips = draw_choices(scores, masks, m, seeds)
        return strokes_at(at, picks // STROKES, tips, judge.spread, judge.dynamics)


def draw_choices(scores: Floats | Singles, masks: Bools, m: int, seeds: Ints) -> tuple[Ints, Floats]:
    """m choices of each position, drawn by their scores (n, CHOICES), and speeds and tips near them: (n, m), (n, m, 3)."""
    likely = np.where(masks, np.exp((scores - scores.max(axis=1, keepdims=True)) / TEMPERATURE), 0.0)
    sums = np.cumsum(likely, axis=1)
    points = np.stack([sobol_points(m, 4, seed ^ 0xBEEF) for seed in seeds.tolist()])
    levels = (np.arange(m) + points[:, :1, 3]) / m  # systematic sampling: one random start a position
    each = zip(sums, levels, strict=True)
    picks = np.stack([np.searchsorted(row, level * row[-1], side="right") for row, level in each])
    picks = np.minimum(picks, CHOICES - 1)
    stroke = picks % STROKES
    speed, side = stroke // (len(SIDES) * len(TOPS)), stroke // len(TOPS) % len(SIDES)
    top = stroke % len(TOPS)
    tips = np.empty((*picks.shape, 3))
    tips[..., 0] = _SPEEDS[speed] * np.exp(_STEP[speed] * (points[..., 0] - 0.5))
    plain = (side == SIDES.index(0.0)) & (points[..., 3] < 0.5)
    tips[..., 1] = np.where(plain, 0.0, _SIDES[side] + _SIDE_STEP * (points[..., 1] - 0.5))
    tips[..., 2] = _HEIGHTS[top] + _TOP_STEP * (points[..., 2] - 0.5)
    return picks, tips
