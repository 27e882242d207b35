"""Has every shipped model a card in the hub's format, and does it say what its figures say?"""

import json

import pytest
import yaml

from agents.cards import OWN, cards
from agents.learning.models import PRETRAINED
from snooker_env.players.weights import FOLDER

CARDS = cards()


def front(text):
    """The YAML at the head of a card, and the text below it."""
    empty, head, text = text.split("---\n", 2)
    assert empty == ""
    return yaml.safe_load(head), text


@pytest.mark.parametrize("path", CARDS, ids=lambda path: path.stem)
def test_the_card_beside_the_model_is_the_one_that_the_command_writes(path):
    assert path.read_text(encoding="utf-8") == CARDS[path], "run: python -m agents.cards"


@pytest.mark.parametrize("path", CARDS, ids=lambda path: path.stem)
def test_the_front_matter_has_what_the_hub_reads(path):
    head, text = front(CARDS[path])
    assert head["license"] == "mit" and head["pipeline_tag"] == "reinforcement-learning"
    for model in head["model-index"]:
        (result,) = model["results"]
        assert (
            model["name"]
            and result["task"]["type"]
            and result["dataset"]["type"]
            and result["dataset"]["name"]
        )
        (metric,) = result["metrics"]
        mean, error = map(float, metric["value"].split(" +/- "))
        assert mean > 0 and error > 0
    assert text.lstrip().startswith("# ") and "**Limits.**" in text


def test_every_model_has_one_and_its_figures_are_in_it():
    names = {path.stem for path in PRETRAINED.glob("*.zip")}
    assert names and {path.stem for path in CARDS if path.parent == PRETRAINED} == names
    for name in names:
        figures = json.loads((PRETRAINED / f"{name}.json").read_text(encoding="utf-8"))["scores"]["trained"]
        head, _ = front(CARDS[PRETRAINED / f"{name}.md"])
        value = head["model-index"][0]["results"][0]["metrics"][0]["value"]
        assert value == f"{figures['points_a_visit']:.2f} +/- {figures['points_a_visit_se']:.2f}"


def test_every_file_of_weights_is_in_the_card_of_the_package():
    text = CARDS[FOLDER / "README.md"]
    files = {path.name for path in FOLDER.glob("*.npz")}
    assert set(OWN) < files and all(f"| `{file}` |" in text for file in files)
