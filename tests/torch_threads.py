"""On how many threads of PyTorch does a network of Stable-Baselines3 decide?"""

from contextlib import contextmanager

import pytest
import torch


@contextmanager
def deciding_on_one_thread(network):
    """Fails unless the network is asked, each time on one thread, with three before and afterwards."""
    found, usual, predict = [], torch.get_num_threads(), network.predict

    def counted(*arguments, **options):
        found.append(torch.get_num_threads())
        return predict(*arguments, **options)

    torch.set_num_threads(3)
    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(network, "predict", counted)
            yield
        assert found and set(found) == {1} and torch.get_num_threads() == 3
    finally:
        torch.set_num_threads(usual)
