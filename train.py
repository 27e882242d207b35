"""How is an agent trained to play Snooker-v0? Train one, evaluate it on held-out tables beside simple
players, and report the result.

    python train.py                          three minutes on two cores: MaskablePPO on the menu of strokes, from nothing
    python train.py --steps 8192             a first try, in half a minute
    python train.py --agent ppo_value --steps 1507328 --imitate 153600   policy and value of the planner: 17 minutes
    python train.py --agent stroke_value     a player that simulates no shot, in 15 minutes
    python train.py --agent ppo_target --seed 1 --out runs/mine
    python train.py --resume --out runs/mine     continue after Ctrl-C, a kill or a power cut, with the same bits

Files of a run folder: ``model.zip``, the trained model (of ``stroke_value``: ``strokes.npz``), ``results.json``, every figure,
``curve.png``, how it learned beside other players, ``tb/``, all curves (``tensorboard --logdir runs``), and what --resume
needs: ``settings.json``, ``checkpoint.pkl`` (of ``stroke_value``: the rounds).
A checkpoint is a pickle, and loading a pickle runs code: --resume only your own runs.

Where to read on: ``agents/hyperparams/``, the settings of each agent; ``agents/learning/loop.py``, the loop;
``agents/learning/``, what learns; ``agents/train.py``, how a run begins and ends.
"""

import sys

from agents._lib.lifecycle import needs

with needs("train.py"):
    import numpy  # noqa: F401, I001 - PyTorch would warn if it is missing
    from agents.train import main

if __name__ == "__main__":
    sys.exit(main())
