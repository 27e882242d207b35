"""How do weights get into the package? As plain arrays (``snooker_env.players.weights``): value and policy of the planners,
from the pre-trained ``ppo_value`` models, and the network of ``strokes``.
"""

import json
from pathlib import Path

import numpy as np
import torch

from agents._lib.files import packed_arrays, write_atomic, write_json
from snooker_env.players.weights import FOLDER, MENU
from snooker_env.tasks import LEVELS

from .model_files import pack_model
from .models import PRETRAINED, load_trained
from .networks import arrays_of
from .rounds import arrays_of as arrays_of_layers

LEARNED, STROKES, SELF_PLAYED = "ppo_value", "strokes", "self_play.pt"
"""The pre-trained models for a professional's errors; models for other levels append the level's name."""


def keep_models(folder):
    """Write the models of the runs FOLDER/ppo_value-0, FOLDER/ppo_value_LEVEL, FOLDER/strokes and FOLDER/self_play, if
    present, into results/weights: NAME.zip and its record NAME.json, and self_play.pt with its record."""
    played, file = Path(folder) / "self_play", PRETRAINED / SELF_PLAYED
    if (played / "results.json").is_file():
        write_atomic(file, (played / "weights.pt").read_bytes())
        write_atomic(file.with_suffix(".json"), (played / "results.json").read_bytes())
    for name in (*map(_name_of, LEVELS), STROKES):
        run = Path(folder) / (f"{name}-0" if name == LEARNED else name)
        if not run.is_dir():
            continue
        results = json.loads((run / "results.json").read_text(encoding="utf-8"))
        kept = {what: results[what] for what in ("command", "commit", "seed", "machine", "load", "software")}
        kept |= {"hours": round(results["seconds"] / 3600.0, 3), "shots": results["steps"]}
        kept |= {"imitated": results["settings"]["imitate"], "scores": results["evaluation"]}
        kept |= {"learned": results["learned"]}
        write_atomic(PRETRAINED / f"{name}.zip", pack_model(load_trained(run, "agent")))
        write_json(PRETRAINED / f"{name}.json", kept)


def export():
    """Write one file for each level with a pre-trained model, and one for the menu."""
    model, state = PRETRAINED / f"{STROKES}.zip", PRETRAINED / SELF_PLAYED
    if model.is_file() and state.is_file():
        arrays = arrays_of_layers("visits", layers_of_menu(load_trained(model, "agent").policy.state_dict()))
        arrays |= arrays_of_layers("frames", layers_of_menu(torch.load(state, weights_only=True)))
        write_atomic(FOLDER / MENU, packed_arrays(arrays))
    for level in LEVELS:
        model = PRETRAINED / f"{_name_of(level)}.zip"
        if model.is_file():
            path = FOLDER / f"{level}.npz"
            write_atomic(path, packed_arrays(arrays_of(load_trained(model, "agent").policy)))
            print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")


def layers_of_menu(state):
    """Weight and bias of each scoring layer of a ``StrokesPolicy``, from its ``state_dict``."""
    part = {name.removeprefix("mlp_extractor."): one.detach().numpy().copy() for name, one in state.items()}
    first = np.concatenate([part["of_stroke.weight"], part["of_state.weight"]], axis=1)
    layers = [(part[f"{name}.weight"], part[f"{name}.bias"]) for name in ("second", "score")]
    return [(first, part["of_stroke.bias"]), *layers]


def _name_of(level):
    """The name of a level's model."""
    return LEARNED if level == "professional" else f"{LEARNED}_{level}"
