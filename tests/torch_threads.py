"""On how many threads of PyTorch does a network decide? For tests of those who play with networks of
Stable-Baselines3."""

from contextlib import contextmanager

import pytest
import torch


@contextmanager
def deciding_on_one_thread(network):
    """Fails unless the network is asked meanwhile, each time on one thread; the three threads from before are
    there again afterwards."""
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
