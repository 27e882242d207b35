"""What does a process of ``benchmarks.learner`` do? It trains an agent, a rollout for each line that it
reads, and says what it took.

    python learner_worker.py AGENT MODEL STEPS SEED

Run in the root of the tree to be measured, which need not be this one: it uses only what all versions of
``train.py`` have. MODEL: a .zip with the weights to begin with. Prints, after the first rollout, which is not
timed, and then for each line: JSON with the shots and the processor time [s] of the tables (steps,
masks), of the update, and in all.
"""

import json
import sys
import time
import zipfile
from io import BytesIO

import torch


def timed(thing, name, spent, key):
    """Add the processor time of a method to ``spent[key]``."""
    inner = getattr(thing, name)

    def outer(*args, **kwargs):
        start = time.process_time()
        try:
            return inner(*args, **kwargs)
        finally:
            spent[key] += time.process_time() - start

    setattr(thing, name, outer)


def main():
    """Train until the input ends."""
    from train import Recipe, training_tables

    agent, weights, steps, seed = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    torch.set_num_threads(1)
    torch.distributions.Distribution.set_default_validate_args(False)  # as train.py
    recipe = Recipe.of(agent, [f"n_steps={steps}"] if steps else [], imitation=0)
    tables = training_tables(recipe.n_envs, threads=1, **recipe.env_kwargs)
    model = recipe.new_model(tables, seed)
    with zipfile.ZipFile(weights) as file:  # which may hold a value beside the policy
        given = torch.load(BytesIO(file.read("policy.pth")), weights_only=True)
    model.policy.load_state_dict({name: given[name] for name in model.policy.state_dict()})
    model.learn(1)
    spent = {"tables": 0.0, "update": 0.0, "all": 0.0}
    timed(tables, "step_wait", spent, "tables")
    timed(tables, "env_method", spent, "tables")
    timed(model, "train", spent, "update")
    print("ready", flush=True)
    for _ in sys.stdin:
        spent.update(dict.fromkeys(spent, 0.0))
        before, start = model.num_timesteps, time.process_time()
        model.learn(1, reset_num_timesteps=False)
        spent["all"] = time.process_time() - start
        print(json.dumps(spent | {"shots": model.num_timesteps - before}), flush=True)


if __name__ == "__main__":
    main()
