"""The planners' weights in the package: value and policy of the pre-trained ``ppo_value`` models as plain arrays, see
``snooker_env.players.weights``.
"""

import json
from pathlib import Path

from agents._lib.files import packed_arrays, write_atomic, write_json
from snooker_env.players.weights import FOLDER
from snooker_env.tasks import LEVELS

from .model_files import pack_model
from .models import PRETRAINED, load_trained
from .networks import arrays_of

LEARNED = "ppo_value"
"""The pre-trained model of a professional's errors; those of another level have its name after it."""


def keep_models(folder):
    """Write the models of the runs FOLDER/ppo_value-0 and FOLDER/ppo_value_LEVEL, as far as they are there, into
    results/weights: NAME.zip, and its record NAME.json."""
    for name in map(_name_of, LEVELS):
        run = Path(folder) / (f"{name}-0" if name == LEARNED else name)
        if not run.is_dir():
            continue
        results = json.loads((run / "results.json").read_text(encoding="utf-8"))
        kept = {
            "command": results["command"],
            "seed": results["settings"]["seed"],
            "commit": results["git_commit"],
        }
        kept |= {"hours": round(results["seconds"] / 3600.0, 3), "shots": results["steps"]}
        kept |= {"imitated": results["settings"]["imitate"], "scores": results["evaluation"]}
        kept |= {what: results[what] for what in ("learned", "versions")}
        write_atomic(PRETRAINED / f"{name}.zip", pack_model(load_trained(run, "agent")))
        write_json(PRETRAINED / f"{name}.json", kept)


def export():
    """Write one file for each level that has a pre-trained model."""
    for level in LEVELS:
        model = PRETRAINED / f"{_name_of(level)}.zip"
        if model.is_file():
            path = FOLDER / f"{level}.npz"
            write_atomic(path, packed_arrays(arrays_of(load_trained(model, "agent").policy)))
            print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")


def _name_of(level):
    """The name of the model of a level."""
    return LEARNED if level == "professional" else f"{LEARNED}_{level}"
