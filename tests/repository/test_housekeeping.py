"""Do the files around the code agree with it? Workflows, forms and hooks parse, and name versions, paths and extras that exist."""

import re
import shlex
import subprocess
import sys

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.version import Version

from tests.processes import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomli")

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS = PROJECT["project"]["optional-dependencies"]
LOWEST = PROJECT["project"]["requires-python"].removeprefix(">=")
WORKFLOW = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text(encoding="utf-8"))
JOBS = WORKFLOW["jobs"]
FORMS = sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml"))
HOOKS = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
ONLY_LOWEST = 'uv pip install --resolution lowest-direct -e ".[test]"'


def commands(job):
    """The command lines of a job."""
    return [step["run"] for step in JOBS[job]["steps"] if "run" in step]


def test_the_workflow_has_three_systems_and_the_ends_of_the_python_versions():
    matrix = JOBS["tests"]["strategy"]["matrix"]
    assert matrix["os"] == ["ubuntu-latest", "macos-latest", "windows-latest"]
    lowest, newest = matrix["python"]
    assert lowest == LOWEST and Version(newest) > Version(LOWEST)
    classified = [name.rpartition(" ")[2] for name in PROJECT["project"]["classifiers"] if "Python :: 3." in name]
    assert (classified[0], classified[-1]) == (lowest, newest) and classified == sorted(classified, key=Version)
    for job in ("lint", "docs"):
        assert JOBS[job]["steps"][1]["with"]["python-version"] == newest, job
    assert PROJECT["tool"]["ruff"]["target-version"] == "py" + LOWEST.replace(".", "")
    assert PROJECT["tool"]["pyright"]["pythonVersion"] == LOWEST


def test_the_page_on_testing_names_the_python_versions_of_the_workflow():
    page = (ROOT / "docs/develop/testing.md").read_text(encoding="utf-8")
    lowest, newest = JOBS["tests"]["strategy"]["matrix"]["python"]
    jobs = dict(re.findall(r"^\| (\w+) \| (.*) \|$", page.partition("## Workflows")[2].partition("\n## ")[0], re.MULTILINE))
    jobs.pop("job")
    assert set(jobs) == set(JOBS)
    assert re.findall(r"\b3\.\d+", jobs["tests"]) == [lowest, newest]
    assert re.findall(r"\b3\.\d+", jobs["lowest"]) == [JOBS["lowest"]["steps"][1]["with"]["python-version"]]
    assert f"\n{newest} is the newest Python" in page


def test_one_job_has_the_lowest_declared_versions():
    assert ONLY_LOWEST in commands("lowest") and JOBS["lowest"]["steps"][1]["with"] == {"python-version": LOWEST}
    declared = [*PROJECT["project"]["dependencies"], *(line for extra in EXTRAS.values() for line in extra)]
    for requirement in map(Requirement, declared):
        if requirement.name != "snooker-env":
            assert ">=" in str(requirement.specifier), f"{requirement} has no lowest version"


def test_every_job_ends_and_may_only_read():
    assert WORKFLOW["permissions"] == {"contents": "read"}
    for name, job in JOBS.items():
        assert 0 < job["timeout-minutes"] <= 90, name


@pytest.mark.parametrize("job", JOBS)
def test_commands_name_paths_and_extras_that_exist(job):
    parts = [row["parts"] for row in JOBS[job].get("strategy", {}).get("matrix", {}).get("include", [])]
    words = [word for line in (*commands(job), *parts) for word in shlex.split(line)]
    assert len(words) > 3
    for word in words:
        if word.startswith("tests/"):
            assert (ROOT / word).exists(), word
        if extra := re.fullmatch(r"\.\[(\w+)\]", word):
            assert extra[1] in EXTRAS, word


def test_lint_runs_what_the_contributors_are_asked_to_run():
    asked = re.search(r"`(ruff check .*?)`", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    assert asked is not None and asked[1].split(" && ") == commands("lint")[1:]


def test_kernels_are_kept_in_the_folder_that_the_package_uses():
    assert WORKFLOW["env"]["NUMBA_CACHE_DIR"] == "${{ github.workspace }}/.kernels"
    cached = [step["with"] for job in JOBS.values() for step in job["steps"] if step.get("uses", "").startswith("actions/cache@")]
    assert len(cached) == 2 and all(one["path"] == ".kernels" and "hashFiles('snooker_env/**/*.py'" in one["key"] for one in cached)
    assert ".kernels/" in (ROOT / ".gitignore").read_text(encoding="utf-8").split()


@pytest.mark.parametrize("form", [form for form in FORMS if form.name != "config.yml"], ids=lambda form: form.stem)
def test_an_issue_form_is_whole(form):
    made = yaml.safe_load(form.read_text(encoding="utf-8"))
    assert made["name"] and made["description"] and made["labels"]
    fields = [part for part in made["body"] if part["type"] != "markdown"]
    assert len({part["id"] for part in fields}) == len(fields) >= 3
    for part in fields:
        assert part["type"] in ("input", "textarea", "dropdown", "checkboxes") and part["attributes"]["label"]
    required = [part["id"] for part in fields if part.get("validations", {}).get("required")]
    assert required, "nothing is required"


def test_there_is_a_form_for_each_kind_of_issue():
    assert [form.stem for form in FORMS] == ["benchmark_submission", "bug", "config", "feature", "physics_or_rules"]
    assert yaml.safe_load(FORMS[2].read_text(encoding="utf-8"))["blank_issues_enabled"] is True


@pytest.mark.parametrize("name", ["bug", "physics_or_rules"])
def test_the_command_that_prints_the_versions_runs(name):
    form = yaml.safe_load((ROOT / f".github/ISSUE_TEMPLATE/{name}.yml").read_text(encoding="utf-8"))
    (field,) = (part for part in form["body"] if part.get("id") == "versions")
    program, *arguments = shlex.split(field["attributes"]["placeholder"])
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    assert program == "python" and len(done.stdout.split()) == 6


def test_hooks_are_pinned_and_format_as_the_project_does():
    assert all(re.fullmatch(r"v?\d+\.\d+\.\d+", repository["rev"]) for repository in HOOKS)
    (ruff,) = (repository for repository in HOOKS if "ruff" in repository["repo"])
    assert [hook["id"] for hook in ruff["hooks"]] == ["ruff-check", "ruff-format"]
    (declared,) = (Requirement(line) for line in EXTRAS["dev"] if line.startswith("ruff"))
    assert declared.specifier.contains(ruff["rev"].removeprefix("v"))


def test_the_code_of_conduct_says_how_to_report():
    text = (ROOT / "CODE_OF_CONDUCT.md").read_text(encoding="utf-8")
    assert "\n## How to report\n" in text and "CODE_OF_CONDUCT.md" in (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
