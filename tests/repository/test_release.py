"""Is a release ready: its page, its addresses, its version and what docs/develop/release.md says of them?"""

import importlib.util
import re
import shutil
import subprocess
import sys
import zipfile

import pytest
import yaml

import snooker_env as sn
from tests.docs.pages import DOCS, blocks, links
from tests.docs.test_figures import unsourced
from tests.processes import ROOT

hatchling = pytest.importorskip("hatchling.build")
HOOK = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
assert HOOK is not None and HOOK.loader is not None
hatch_build = importlib.util.module_from_spec(HOOK)
HOOK.loader.exec_module(hatch_build)

README = (ROOT / "README.md").read_text(encoding="utf-8")
(ADDRESS,) = re.findall(
    '^address = "(.*)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE
)
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
RELEASE = (DOCS / "develop/release.md").read_text(encoding="utf-8")


def absolute(text):
    return re.findall(r"https://example\.org/snooker/(?:blob|raw)/v9/([^)#\s]+)", text)


def test_links_of_the_package_page_lead_to_files_of_the_release():
    page = hatch_build.page(README, "https://example.org/snooker", "v9")
    assert not links(page) and len(links(README)) > 30
    # every link and picture once, those by a name too
    assert len(absolute(page)) >= len(links(README)) - 1
    assert set(absolute(page)) == {link.partition("#")[0] for link in links(README)}
    for kind in ("python", "bash"):
        assert blocks(page, kind) == blocks(README, kind)
    assert "/raw/v9/results/pictures/break.gif)" in page and "/blob/v9/docs/index.md)" in page


def metadata(folder):
    """The text of METADATA in the wheel that the folder makes."""
    command = [sys.executable, "-c", "import hatchling.build as b; print(b.build_wheel('.'))"]
    name = subprocess.check_output(command, cwd=folder, text=True).split()[-1]
    with zipfile.ZipFile(folder / name) as wheel:
        return wheel.read(next(one for one in wheel.namelist() if one.endswith("/METADATA"))).decode()


@pytest.mark.skipif(sys.platform == "win32", reason="the line is of a shell")
def test_one_line_sets_the_address_everywhere(tmp_path):
    (tmp_path / "snooker_env").mkdir()
    (tmp_path / "snooker_env/__init__.py").write_text('__version__ = "9.0"\n')
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "CITATION.cff", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("pyproject.toml", "CITATION.cff"):  # as before it was set here
        text = (tmp_path / name).read_text(encoding="utf-8")
        text = re.sub(r'^address = ".*"', 'address = ""', text, flags=re.MULTILINE)
        text = re.sub(r"^repository-code: .*\n", "", text, flags=re.MULTILINE)
        (tmp_path / name).write_text(text, encoding="utf-8")
    before = metadata(tmp_path)
    assert "Project-URL" not in before and "\nVersion: 9.0\n" in before
    (line,) = [block for block in blocks(RELEASE, "bash") if "sed" in block]
    subprocess.run(["bash", "-ec", line], cwd=tmp_path, check=True)
    after, address = metadata(tmp_path), "https://github.com/OWNER/snooker_env"
    named = dict(re.findall(r"^Project-URL: (\w+), (\S+)$", after, re.MULTILINE))
    assert set(named) == {"Homepage", "Documentation", "Source", "Issues", "Changelog"}
    assert all(place.startswith(address) for place in named.values())
    assert f"{address}/raw/v9.0/results/pictures/break.gif" in after
    assert yaml.safe_load((tmp_path / "CITATION.cff").read_text())["repository-code"] == address


def test_the_wheel_and_the_list_of_gymnasium_name_the_same_lower_bound():
    (bound,) = re.findall(r'"gymnasium>=([\d.]+),', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (entry,) = blocks(RELEASE, "markdown")
    assert f"badge/Gymnasium-v{bound}-blue" in entry
    assert 2 <= len(re.findall(r"[.:] ", entry.rpartition("\n\n")[2])) <= 5


PAPER = (ROOT / "paper/paper.md").read_text(encoding="utf-8")
BODY = PAPER.split("\n---\n", 1)[1]


def test_the_paper_keeps_the_journal_s_form():
    head = yaml.safe_load(PAPER.split("\n---\n")[0])
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= set(head)
    parts = re.findall("^# (.*)$", BODY, re.MULTILINE)
    for part in (
        "Summary",
        "Statement of need",
        "State of the field",
        "Software design",
        "AI usage disclosure",
    ):
        assert part in parts
    assert parts[-1] == "References" and 750 <= len(BODY.split()) <= 1250
    cited = set(re.findall(r"@(\w+)", BODY))
    assert cited == set(
        re.findall(r"^@\w+\{(\w+),", (ROOT / "paper/paper.bib").read_text(encoding="utf-8"), re.M)
    )
    assert unsourced(PAPER) == []


def test_the_paper_becomes_a_page(tmp_path):
    pytest.importorskip("pypandoc", reason="of the extra publish")
    command = [sys.executable, str(ROOT / "paper/build.py"), str(tmp_path / "paper.html")]
    subprocess.run(command, check=True, capture_output=True, cwd=tmp_path)
    page = (tmp_path / "paper.html").read_text(encoding="utf-8")
    assert page.count('id="ref-') > 10 and page.count("data:image/png") == 2 and "(<strong>" not in page
    assert "numerical simulations of the frictional collisions" in page.lower()


def test_what_is_cited_is_what_is_released():
    assert str(CITATION["version"]) == sn.__version__
    assert CITATION.get("repository-code", "") == ADDRESS
