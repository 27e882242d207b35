"""Write the weights of the planners into the package: python -m agents.export

Value and policy of the pre-trained ``ppo_value`` models, one file for each noise level, in ``snooker_env/players/weights``.
"""

import numpy as np

from commands.command_line import command_line  # noqa: F401  (kept in step with the other commands)
from snooker_env.players.weights import FOLDER, LEVELS_TRAINED

from .learning.models import PRETRAINED, load_trained


def weights_of(policy):
    """The arrays of a ``JudgedPolicy`` that ``snooker_env.players.weights`` reads."""
