"""Write the model cards, in the hub's format (YAML and text): python -m agents.cards

One beside each pre-trained model, ``agents/pretrained/NAME.md``, from what ``agents.publish`` keeps of it in ``NAME.json``;
and one beside the package's weights, ``snooker_env/players/weights/README.md``.
"""

import json

from commands.files import read_json, write_atomic
from snooker_env.players.weights import FOLDER, STROKES, WORTH, levels

from .export import LEARNED
from .learning.models import PRETRAINED, pretrained

HEAD = """---
license: mit
library_name: {library}
pipeline_tag: reinforcement-learning
tags:
- reinforcement-learning
- snooker
- gymnasium
"""
OWN = {
    STROKES: "`stroke_value`: what strokes of visits and of frames are worth, for errors from 0.7 to 4.5 times a professional's "
    "(`python train.py --agent stroke_value`)",
    WORTH: "`tactician`: what positions of frames are worth, for all levels of errors (`python -m agents.learn_worth`)",
}
"""Of the files that are of no single level: who plays with them, and how they are made."""


def _results(name, scores):
    """The part ``model-index`` of the YAML: points a visit of the model, and of the players that use it."""
    lines = ["model-index:"]
    for player, figures in scores.items():
        error = figures["points_a_visit_se"]
        lines += [
            f"- name: {json.dumps(name if player == 'trained' else f'{player} with {name}')}",
            "  results:",
            "  - task:",
            "      type: reinforcement-learning",
            "    dataset:",
            "      type: snooker-held-out-tables",
            f"      name: {figures['visits']} opened tables, kept from training",
            "    metrics:",
            "    - type: mean_reward",
            f"      value: {figures['points_a_visit']:.2f} +/- {error:.2f}",
            "      name: points a visit",
        ]
    return "\n".join(lines)


def model_card(name):
    """The card of a pre-trained model."""
    card = read_json("model", PRETRAINED / f"{name}.json", "must be the JSON that agents.publish writes")
    own = {player: card["scores"][player] for player in ("trained", "planner") if player in card["scores"]}
    versions = ", ".join(f"{package} {version}" for package, version in card["versions"].items())
    origin = {
        "command": f"`{card['command']}`",
        "seed": card["seed"],
        "commit": card["commit"],
        "shots": f"{card['shots']:,}",
        "positions imitated, or of expert iteration": f"{card['imitated']:,}",
        "weights it began with": card["start"] or "none",
        "hours": card["hours"],
        "versions": versions,
    }
    rows = "\n".join(f"| {what} | {value} |" for what, value in origin.items())
    scores = "\n".join(
        f"| {'this model' if player == 'trained' else f'`{player}`'} | {one['points_a_visit']:.2f} "
        f"+- {one['points_a_visit_se']:.2f} | {one['pots_a_visit']:.2f} | {one['visits']} |"
        for player, one in card["scores"].items()
    )
    return f"""{HEAD.format(library="stable-baselines3")}{_results(name, own)}
---

# {name}

{card["learned"]}

| player | points a visit (standard error) | pots | visits |
|---|--:|--:|--:|
{scores}

**Limits.** {card["limits"]}

**Use.** In a clone: `python -m agents.evaluate --agent {name}`, `python -m agents.watch --agent {name}`. The file holds JSON and
weights: reading it runs no code.

| made by | |
|---|---|
{rows}
"""


def weights_card():
    """The card of the package's weights."""
    scores, rows = {}, []
    for level in levels():
        name = LEARNED if level == "professional" else f"{LEARNED}_{level}"
        card = read_json("model", PRETRAINED / f"{name}.json", "must be the JSON that agents.publish writes")
        planner = scores[f"planner, {level}"] = card["scores"]["planner"]
        points = f"{planner['points_a_visit']:.2f} +- {planner['points_a_visit_se']:.2f}"
        about = f"`planner`: policy and value, errors of the level {level!r}; from `{name}` (`python -m agents.export`)"
        rows.append(f"| `{level}.npz` | {about} | {points} |")
    rows += [f"| `{file}` | {about} | |" for file, about in OWN.items()]
    table = "\n".join(rows)
    index = _results("snooker_env", scores)
    return f"""{HEAD.format(library="snooker-env")}{index}
---

# Weights of the players in snooker_env

Plain NumPy arrays (`allow_pickle=False`), read by `snooker_env.players` without PyTorch.

| file | for | points a visit on held-out tables (standard error) |
|---|---|--:|
{table}

**Limits.** Trained on opened tables of the simulator under Gaussian errors, one training seed each. The planner plays
visits: no safety, no plants. Another level of errors takes the weights of the nearest one.

**Use.** `sn.player("planner").at({{"noise": "professional", "cue": "real"}}).play(position, seeds)`.
"""


def cards():
    """All cards: {path: text}."""
    made = {PRETRAINED / f"{name}.md": model_card(name) for name in pretrained()}
    return made | {FOLDER / "README.md": weights_card()}


def main():
    """Write them all."""
    for path, text in cards().items():
        write_atomic(path, text)
        print(path)


if __name__ == "__main__":
    main()
