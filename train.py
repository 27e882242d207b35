"""How is an agent trained to play Snooker-v0? Train one, compare it with simple players on held-out tables, and report the
result.

    python train.py                          MaskablePPO on the menu of strokes, from scratch: 3.5 minutes on two cores
    python train.py --steps 8192             a first try: half a minute
    python train.py --agent ppo_value --steps 1507328 --imitate 153600   policy and value of the planner: 45 minutes
    python train.py --agent stroke_value     a player that simulates no shots: 15 minutes
    python train.py --agent ppo_target --seed 1 --out runs/mine
    python train.py --resume --out runs/mine     continue, bit for bit, after Ctrl-C, a kill or a power cut

A run folder holds ``model.zip``, the trained model (for ``stroke_value``, ``strokes.npz``); ``results.json``, every figure;
``curve.png``, the learning curve compared with other players; ``tb/``, all curves (``tensorboard --logdir runs``); and, for
--resume, ``settings.json`` and ``checkpoint.pkl`` (for ``stroke_value``, the rounds).
A checkpoint is a pickle, and loading a pickle runs code: --resume only your own runs.

Read on in ``agents/hyperparams/`` (settings of each agent), ``agents/learning/loop.py`` (the loop), ``agents/learning/``
(the learners) and ``agents/train.py`` (start and end of a run).
"""

import sys

from agents._lib.lifecycle import needs

with needs("train.py"):
    import numpy  # noqa: F401, I001 - PyTorch would warn if it is missing
    from agents.train import main

if __name__ == "__main__":
    sys.exit(main())
