"""Which players could a user write? Sound ones, and ones that are refused."""

from typing import ClassVar

import numpy as np

from snooker_env.tasks.observations import FRAME_ENTRIES


class Softly:
    """Every stroke along the potting line, at one speed."""

    options: ClassVar = {"aim": "target"}
    action = (-0.4, 0, 0, 0)

    def act(self, observations, masks, seeds):
        return np.tile(np.array(self.action, np.float32), (len(seeds), 1))


class Decides(Softly):
    options: ClassVar = {"aim": "target", "says": ["decision"]}


class Names(Softly):
    says: ClassVar = ["nominate", "decision", "concede", "lot"]
    options: ClassVar = {"task": "frame", "aim": "target", "says": says}
    action = (-0.4, 0, 0, 0, 0.9, -1, 0)

    def act(self, observations, masks, seeds):
        assert observations.shape == (len(seeds), 121 + len(FRAME_ENTRIES))
        return super().act(observations, masks, seeds)


class Loud(Softly):
    options: ClassVar = {"noise": "none"}


class Mute:
    options: ClassVar = {}
    act = None
