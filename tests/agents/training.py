"""How does a test train, stop what runs, and read what is left? Tiny runs, in this process."""

import json

import numpy as np

import train
from agents.learning.models import load_trained

TINY = str.split("--agent ppo_target --envs 2 --eval-visits 4 --parallel one --steps 512")


def run(out, *options):
    """``train.main`` in this process; the exit code."""
    return train.main([*TINY, "--out", str(out), *options])


def resume(out, *options):
    return train.main(["--resume", "--out", str(out), *options])


def interrupted_at(monkeypatch, owner, name, call, error=KeyboardInterrupt):
    """Let ``owner.name`` raise when it is called for the so-manyth time; a list with an item for each call."""
    original, calls = getattr(owner, name), []

    def counted(*arguments, **options):
        calls.append(1)
        if len(calls) == call:
            raise error
        return original(*arguments, **options)

    monkeypatch.setattr(owner, name, counted)
    return calls


def results(out):
    return json.loads((out / "results.json").read_text())


def weights(out):
    """Every parameter of the saved model, flat."""
    model = load_trained(out, "agent")
    return np.concatenate([p.detach().numpy().ravel() for p in model.policy.parameters()])
