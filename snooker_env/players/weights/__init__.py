"""Which weights does the package hold? Value (members, out, in) and policy of the planner, one file of NumPy arrays for each
noise level, and those of other players (``results/make.sh weights``). Reading them runs no code."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..._lib.check import refuse
from ..._lib.files import read_npz
from ..._lib.types import Singles
from ...planning.learned.dense_layers import Weights
from ...planning.learned.stroke_policy import LAYERS, StrokePolicy
from ...planning.worth import Chance
from ...tasks.noise import LEVELS, Noise

FOLDER = Path(__file__).parent
WORTH = "worth.npz"  # of the ``tactician``: what positions of frames are worth (python -m agents.learn_worth)
STROKES = "strokes.npz"  # the networks of ``stroke_value`` (python train.py --agent stroke_value)
MENU = "menu.npz"  # of ``strokes``: of visits (python train.py --seed 1 --steps 1000000), of frames (examples.self_play)
LAYERS_EACH = 3  # of each network but the policy


class Learned(NamedTuple):
    """What a planner has learned: a policy over strokes, and the layers of each network of its value."""

    policy: StrokePolicy
    value: Sequence[Weights]


class StrokeLayers(NamedTuple):
    """What ``stroke_value`` has learned: the layers of a ``StrokeValue`` and of a ``FrameStrokes``, empty before that."""

    visits: Weights = ()
    frames: Weights = ()


def layers_of(arrays: Mapping[str, Singles], of: str) -> Weights:
    """Weight and bias of each layer of a network in the arrays of a file; ValueError for numbers that are none."""
    layers = [(arrays[f"{of}/{k}/weight"], arrays[f"{of}/{k}/bias"]) for k in range(LAYERS_EACH)]
    for k, pair in enumerate(layers):
        if not all(part.dtype == np.float32 and np.isfinite(part).all() for part in pair):
            raise refuse(f"{of}/{k}", f"{pair[0].dtype}", "must be finite float32 numbers")
    return layers


def learned_of(arrays: Mapping[str, Singles]) -> Learned:
    policy = {name: (arrays[f"policy/{name}/weight"], arrays[f"policy/{name}/bias"]) for name in LAYERS}
    layers = layers_of(arrays, "value")
    members = [[(weight[m], bias[m]) for weight, bias in layers] for m in range(len(layers[0][0]))]
    return Learned(StrokePolicy(policy), members)


def worth_in(arrays: Mapping[str, Any]) -> tuple[Weights, Chance]:
    """The layers of a ``LearnedWorth`` and the chance to win in the arrays of a file."""
    return layers_of(arrays, "worth"), Chance(*arrays["chance"].tolist())


@cache
def learned_at(level: str) -> Learned:
    """What was learned under the errors of a level; ValueError if there is no file for it."""
    path = FOLDER / f"{level}.npz"
    if not path.is_file():
        raise refuse("level", level, f"must be one of {', '.join(levels())}")
    return learned_of(read_npz(path))


@cache
def learned_worth() -> tuple[Weights, Chance]:
    """The layers of a ``LearnedWorth``, for all levels, and the chance to win."""
    return worth_in(read_npz(FOLDER / WORTH))


@cache
def learned_menu(of: str) -> Weights:
    """The layers of the network of ``strokes`` for "visits" or "frames", which read a stroke on the menu and the state."""
    return layers_of(read_npz(FOLDER / MENU), of)


@cache
def learned_strokes(path: Path = FOLDER / STROKES) -> StrokeLayers:
    """The layers of the networks of ``stroke_value``; by default the package's."""
    arrays = read_npz(path)
    learned = StrokeLayers(*(layers_of(arrays, of) for of in StrokeLayers._fields))
    if path != FOLDER / STROKES:
        for of, mine, package in zip(StrokeLayers._fields, learned, learned_strokes(), strict=True):
            for k in range(LAYERS_EACH):
                shapes, wanted = ([part.shape for part in one[k]] for one in (mine, package))
                if shapes != wanted:
                    raise refuse(f"{of}/{k}", str(shapes), f"must have the shapes {wanted}")
    return learned


def levels() -> list[str]:
    return [level for level in LEVELS if (FOLDER / f"{level}.npz").is_file()]


def level_for(noise: Noise) -> str:
    """The level with weights whose error of direction is nearest to that of a noise, in the logarithm."""
    wanted = np.log(noise.direction_deg() + 1e-3)
    return min(levels(), key=lambda level: abs(np.log(LEVELS[level].direction_deg() + 1e-3) - wanted))
