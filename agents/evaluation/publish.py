"""How does a trained run become a pre-trained model? Its weights and a card that says where they come from.

    python -m agents.publish runs/ppo_foresight-0 --limits "what it cannot do"

writes ``agents/pretrained/AGENT.zip`` and ``AGENT.json``; ``python -m agents.evaluate --agent AGENT`` plays
it. The zip holds figures as JSON and weights, no pickled code as a run's own model.zip does, so that nobody
needs to trust it (agents/learning/model_files.py).
"""

import argparse
import json
import re
from pathlib import Path

from commands.lifecycle import command, needs

with needs("agents.publish"):
    from commands.files import write_atomic, write_json
    from snooker_env.checks import refuse
    from snooker_env.players.resolver import is_name

    from ..learning.model_files import packed
    from ..learning.models import PRETRAINED, load_trained, pretrained

AS_IT_STANDS = {"layout": "", "noise": "", "fidelity": "", "physics": "", "start": "", "set": []}
"""What these settings are in a run of its recipe as it stands. A fidelity that was given is also that of its
final evaluation."""


def results_of(run):
    """Every figure of a finished run and its ``Trained`` agent, once both are sound. Raises ValueError."""
    try:
        found = json.loads((run / "results.json").read_text(encoding="utf-8"))
        card_of(found, "")
        name_of(found, "any")
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        raise refuse(
            "run", str(run), "must be the folder of a finished run, with a whole results.json"
        ) from None
    return found, load_trained(run, "run")


def card_of(found, limits):
    """The card of the model of a run with these results: where it comes from, and how well it plays."""
    imitated = found["imitation"][-1]["states"] if found["imitation"] else 0
    return {
        "command": found["command"],
        "seed": found["settings"]["seed"],
        "commit": found["git_commit"],
        "hours": round(found["seconds"] / 3600.0, 3),
        "shots": found["steps"],
        "imitated": imitated,
        "start": found["settings"]["start"] or None,
        "scores": found["evaluation"],
        "learned": found["learned"],
        "versions": found["versions"],
        "limits": limits,
    }


def name_of(found, name):
    """What the model is called: ``name``, or its recipe if the run is one of it. Raises ValueError."""
    agent, settings = found["settings"]["agent"], found["settings"]
    other = [key for key, usual in AS_IT_STANDS.items() if settings[key] != usual]
    if name is None and other:
        raise refuse(
            "name",
            name,
            f"must be given: the run is not one of {agent} as its recipe stands ({', '.join(other)} is not the same)",
        )
    name = agent if name is None else name
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", name):
        raise refuse("name", name, "must be letters, digits and _ . -")
    if is_name(name) and name not in pretrained():
        raise refuse("name", name, "must not be that of another player")
    return name


def publish(run, name, limits, replace=False):
    """Write the model and its card; (path without ending, card). Raises ValueError before anything is
    written."""
    if not limits.strip():
        raise refuse("limits", limits, "must say what a user should know that it cannot do")
    found, trained = results_of(run)
    path = PRETRAINED / name_of(found, name)
    card, model, about = (
        card_of(found, limits),
        path.with_name(f"{path.name}.zip"),
        path.with_name(f"{path.name}.json"),
    )
    if not replace and (model.exists() or about.exists()):
        raise refuse("name", path.name, "must be new: there is such a model; --replace overwrites it")
    PRETRAINED.mkdir(exist_ok=True)
    write_atomic(model, packed(trained))
    write_json(about, card)
    return path, card


@command("agents.publish")
def main(argv=None):
    """Command line."""
    parser = argparse.ArgumentParser(
        "python -m agents.publish", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", type=Path, help="a run's folder")
    parser.add_argument("--name", help="of the model [the agent's]")
    parser.add_argument("--limits", required=True, help="what the model cannot do, for its card")
    parser.add_argument("--replace", action="store_true", help="overwrite the model of that name")
    options = parser.parse_args(argv)
    try:
        path, card = publish(options.run, options.name, options.limits, options.replace)
    except ValueError as error:
        parser.error(str(error))
    print(f"{path}.zip and its card: {card['learned']}")
    return 0
