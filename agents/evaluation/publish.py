"""How does a trained run become a pre-trained model? Its weights and a card that says where they come from.

    python -m agents.publish runs/ppo_value-0 --limits "what it cannot do"

writes ``agents/pretrained/AGENT.zip`` and ``AGENT.json``; ``python -m agents.evaluate --agent AGENT`` plays
it. The zip holds figures as JSON and weights, no pickled code as a run's own model.zip does, so that nobody
needs to trust it (agents/learning/model_files.py).
"""

import re
from pathlib import Path

from commands.lifecycle import command, needs, parser_of

with needs("agents.publish"):
    from commands.files import read_json, write_atomic, write_json
    from snooker_env.checks import refuse
    from snooker_env.players.resolver import is_name

    from ..learning.model_files import packed
    from ..learning.models import PRETRAINED, load_trained, pretrained

AS_IT_STANDS = {"layout": "", "noise": "", "fidelity": "", "physics": "", "start": "", "set": []}
"""These settings in a run of its recipe as it stands. A given fidelity is also that of its evaluation."""


def results_of(run):
    """Every figure of a finished run and its ``Trained`` agent, once both are sound. Raises ValueError."""
    wanted = "must be the folder of a finished run, with a whole results.json"
    try:
        results = read_json("run", run / "results.json", wanted)
        card_of(results, "")
        name_of(results, "any")
    except (ValueError, LookupError, TypeError, AttributeError):
        raise refuse("run", str(run), wanted) from None
    return results, load_trained(run, "run")


def card_of(results, limits):
    """The card of the model of a run with these results: where it comes from, and how well it plays."""
    imitated = results["imitation"][-1]["states"] if results["imitation"] else 0
    return {
        "command": results["command"],
        "seed": results["settings"]["seed"],
        "commit": results["git_commit"],
        "hours": round(results["seconds"] / 3600.0, 3),
        "shots": results["steps"],
        "imitated": imitated,
        "start": results["settings"]["start"] or None,
        "scores": results["evaluation"],
        "learned": results["learned"],
        "versions": results["versions"],
        "limits": limits,
    }


def name_of(results, name):
    """What the model is called: ``name``, or its recipe if the run is one of it. Raises ValueError."""
    agent, settings = results["settings"]["agent"], results["settings"]
    other = [key for key, usual in AS_IT_STANDS.items() if settings[key] != usual]
    if name is None and other:
        why = f"the run is not one of {agent} as its recipe stands ({', '.join(other)} is not the same)"
        raise refuse("name", name, f"must be given: {why}")
    name = agent if name is None else name
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", name):
        raise refuse("name", name, "must be letters, digits and _ . -")
    if is_name(name) and name not in pretrained():
        raise refuse("name", name, "must not be that of another player")
    return name


def publish(run, name, limits, replace=False):
    """Write the model and its card; (path without ending, card). Raises ValueError before it writes."""
    if not limits.strip():
        raise refuse("limits", limits, "must say what a user should know that it cannot do")
    results, trained = results_of(run)
    path = PRETRAINED / name_of(results, name)
    card = card_of(results, limits)
    model, about = (path.with_name(path.name + suffix) for suffix in (".zip", ".json"))
    if not replace and (model.exists() or about.exists()):
        raise refuse("name", path.name, "must be new: there is such a model; --replace overwrites it")
    PRETRAINED.mkdir(exist_ok=True)
    write_atomic(model, packed(trained))
    write_json(about, card)
    return path, card


@command("agents.publish")
def main(argv=None):
    parser = parser_of("python -m agents.publish", __doc__)
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
