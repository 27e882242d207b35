"""Do the metadata of published data hold the files as they are, and does a reader of Croissant find their records?"""

import csv
import hashlib
import json

import pytest

from agents import croissant
from tests.processes import ROOT

DATA = ROOT / "benchmarks/data"
MEASURED = DATA / croissant.FILE


@pytest.mark.parametrize("folder", croissant.PUBLISHED)
def test_the_kept_metadata_are_those_of_the_files_as_they_are(folder):
    """After a file has changed: ``python -m agents.croissant``."""
    file = ROOT / folder / croissant.FILE
    kept = json.loads(file.read_text(encoding="utf-8"))
    assert croissant.metadata(file, file.parent, croissant.address_of(folder)) == kept


def test_the_command_writes_both(monkeypatch):
    written = []
    monkeypatch.setattr(
        croissant, "write_json", lambda file, content: written.append((file, content["name"]))
    )
    assert croissant.main([]) == 0
    files = [ROOT / folder / croissant.FILE for folder in croissant.PUBLISHED]
    assert written == list(zip(files, ("snooker_env_measurements", "snooker_env_results"), strict=True))


def test_every_measurement_is_described_with_all_its_columns():
    sets = json.loads(MEASURED.read_text(encoding="utf-8"))["recordSet"]
    columns = {}
    for field in (field for records in sets for field in records["field"]):
        source = field["source"]
        columns.setdefault(source["fileObject"]["@id"], []).append(source["extract"]["column"])
    card = (DATA / "README.md").read_text(encoding="utf-8")
    assert set(columns) == {file.name for file in DATA.glob("*.csv")}
    for name, described in columns.items():
        with (DATA / name).open(encoding="utf-8", newline="") as content:
            assert next(csv.reader(content)) == described
        assert f"| `{name}` |" in card


def test_an_address_is_given_where_there_is_one_alone():
    there = "https://example.org/raw/v9/benchmarks/data"
    made = [croissant.metadata(MEASURED, DATA, address) for address in ("", there)]
    assert [one.get("url") for one in made] == [None, there]
    without, given = ([file["contentUrl"] for file in one["distribution"]] for one in made)
    assert [f"{there}/{place}" for place in without] == given


@pytest.mark.parametrize("folder", croissant.PUBLISHED)
def test_a_reader_of_croissant_finds_a_record_of_each_set(folder):
    mlcroissant = pytest.importorskip("mlcroissant", reason="of the extra publish")
    data = mlcroissant.Dataset(jsonld=ROOT / folder / croissant.FILE)
    assert not data.metadata.ctx.issues.errors and data.metadata.data_limitations
    for file in data.metadata.distribution:
        assert file.sha256 == hashlib.sha256((ROOT / folder / file.content_url).read_bytes()).hexdigest()
    assert len(data.metadata.record_sets) >= 2
    for records in data.metadata.record_sets:
        record = next(iter(data.records(record_set=records.uuid)))
        assert len(record) == len(records.fields) and any(
            isinstance(value, float) for value in record.values()
        )
