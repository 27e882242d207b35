"""Write the planners' weights into the package: python -m agents.export

Value and policy of the pre-trained ``ppo_value`` models as plain arrays, see ``snooker_env.players.weights``.
"""

import numpy as np

from commands.files import packed_arrays, write_atomic
from snooker_env.planning.learned.stroke_policy import LAYERS
from snooker_env.players.weights import FOLDER
from snooker_env.tasks import LEVELS

from .learning.models import PRETRAINED, load_trained

LEARNED = "ppo_value"
"""The pre-trained model of a professional's errors; those of another level have its name after it."""


def arrays_of(policy):
    """The arrays of a ``JudgedPolicy`` by name: {name: float32 array}."""
    parameters = [p.detach().numpy() for p in policy.fused.parameters]
    arrays = {}
    # the critic's own come last
    for name, weight, bias in zip(LAYERS, parameters[::2], parameters[1::2], strict=False):
        arrays |= {f"policy/{name}/weight": weight, f"policy/{name}/bias": bias}
    value = policy.position_value
    for k, (weight, bias) in enumerate(zip(value.weights, value.biases, strict=True)):
        arrays[f"value/{k}/weight"] = weight.detach().numpy().transpose(0, 2, 1)
        arrays[f"value/{k}/bias"] = bias.detach().numpy()[:, 0]
    return {name: np.ascontiguousarray(array, np.float32) for name, array in arrays.items()}


def main():
    """Write one file for each level that has a pre-trained model."""
    for level in LEVELS:
        model = PRETRAINED / f"{LEARNED if level == 'professional' else f'{LEARNED}_{level}'}.zip"
        if model.is_file():
            path = FOLDER / f"{level}.npz"
            write_atomic(path, packed_arrays(arrays_of(load_trained(model, "agent").policy)))
            print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
