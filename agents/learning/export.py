"""The planners' weights in the package: value and policy of the pre-trained ``ppo_value`` models as plain arrays, see
``snooker_env.players.weights``.
"""

from agents._lib.files import packed_arrays, write_atomic
from snooker_env.players.weights import FOLDER
from snooker_env.tasks import LEVELS

from .models import PRETRAINED, load_trained
from .networks import arrays_of

LEARNED = "ppo_value"
"""The pre-trained model of a professional's errors; those of another level have its name after it."""


def export():
    """Write one file for each level that has a pre-trained model."""
    for level in LEVELS:
        model = PRETRAINED / f"{LEARNED if level == 'professional' else f'{LEARNED}_{level}'}.zip"
        if model.is_file():
            path = FOLDER / f"{level}.npz"
            write_atomic(path, packed_arrays(arrays_of(load_trained(model, "agent").policy)))
            print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")
