"""May people use this, and how?"""

import re
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
import yaml

import snooker_env as sn

ROOT = Path(__file__).parents[2]
SKIPPED = {".venv", "tests", ".git", "build", "runs"}
TEXTS = [
    p
    for p in ROOT.rglob("*")
    if p.suffix in (".py", ".md", ".sh", ".toml") and not set(p.relative_to(ROOT).parts) & SKIPPED
]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The metadata of a wheel built from this tree."""
    out = tmp_path_factory.mktemp("wheel")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        name = pytest.importorskip("hatchling.build").build_wheel(str(out))
    with zipfile.ZipFile(out / name) as wheel:
        wheel.extractall(out)
    (info,) = out.glob("*.dist-info")
    return metadata.Distribution.at(info)


def test_the_wheel_says_who_may_use_it(built):
    found = built.metadata
    assert found["License-Expression"] == "MIT"
    assert found.get_all("License-File") == ["LICENSE", "snooker_env/render/fonts/OFL.txt"]
    assert found["Author"] == "the snooker_env authors" and found["Version"] == sn.__version__
    text = built.read_text("licenses/LICENSE")
    assert text == (ROOT / "LICENSE").read_text()
    assert "SIL OPEN FONT LICENSE" in built.read_text("licenses/snooker_env/render/fonts/OFL.txt").upper()
    assert text.startswith("MIT License\n") and "the snooker_env authors" in text


def released():
    """The versions in the change log, newest first."""
    return re.findall(r"^## (\d+\.\d+\.\d+)", (ROOT / "CHANGELOG.md").read_text(), re.M)


def number(version):
    return tuple(map(int, version.split(".")[:3]))


def test_the_citation_names_the_last_release():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cited["version"] == released()[0] and cited["license"] == "MIT" and cited["cff-version"] == "1.2.0"
    assert cited["authors"] == [{"name": "the snooker_env authors"}]


def test_the_change_log_has_this_version_and_every_one_before():
    versions, text = released(), (ROOT / "CHANGELOG.md").read_text()
    assert versions[-1] == "0.1.0" and versions == sorted(versions, key=number, reverse=True)
    if ".dev" in sn.__version__:  # of the release to come
        assert number(sn.__version__) > number(versions[0]) and "## Unreleased\n" in text
    else:
        assert sn.__version__ == versions[0] and "## Unreleased\n" not in text


def test_no_text_says_to_install_from_an_index_that_does_not_have_it():
    """The package is on no index."""
    said = [
        f"{p.relative_to(ROOT)}: {line}"
        for p in TEXTS
        for line in p.read_text(encoding="utf-8").splitlines()
        if "pip install" in line
    ]
    assert len(said) > 5
    # for who has it from a wheel: the extra's libraries
    said = [line for line in said if not line.startswith("snooker_env/_install.py")]
    assert not [line for line in said if re.search(r"pip install [\"'\w -]*snooker[-_]env", line)]
