"""How does a trained run become a pre-trained model? Its weights and a card that says where they come from.

    python -m agents.publish runs/ppo_foresight-0 --limits "what it cannot do"

writes ``agents/pretrained/AGENT.zip`` and ``AGENT.json``; ``python -m agents.evaluate --agent AGENT`` plays it.
"""

import argparse
import json
import shutil
from pathlib import Path

from .models import PRETRAINED


def card_of(run, limits):
    """What is told of a run folder's model."""
    found = json.loads((run / "results.json").read_text())
    return {
        "command": found["command"], "seed": found["settings"]["seed"], "commit": found["git_commit"],
        "hours": round(found["seconds"] / 3600.0, 3), "shots": found["steps"], "imitated": found["settings"]["imitate"],
        "scores": found["evaluation"], "learned": found["learned"], "versions": found["versions"], "limits": limits,
    }  # fmt: skip


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path, help="a run's folder")
    parser.add_argument("--name", help="of the model [the agent's]")
    parser.add_argument("--limits", required=True, help="what a user should know that it cannot do")
    options = parser.parse_args()
    for name in ("model.zip", "results.json"):
        if not (options.run / name).is_file():
            parser.error(f"{options.run} holds no {name}: it must be the folder of a finished run")
    card = card_of(options.run, options.limits)
    name = options.name or json.loads((options.run / "results.json").read_text())["settings"]["agent"]
    PRETRAINED.mkdir(exist_ok=True)
    shutil.copy(options.run / "model.zip", PRETRAINED / f"{name}.zip")
    (PRETRAINED / f"{name}.json").write_text(json.dumps(card, indent=1) + "\n")
    print(f"{PRETRAINED / name}.zip and its card: {card['learned']}")


if __name__ == "__main__":
    main()
