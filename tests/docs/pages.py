"""What do the pages of the documentation hold? README and ``docs/``."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(path for path in DOCS.rglob("*.md") if "_build" not in path.parts)]
NAMES = [path.relative_to(ROOT).as_posix() for path in PAGES]
LINKED = [*PAGES, *(ROOT / f"{name}.md" for name in ("CHANGELOG", "CONTRIBUTING", "CODE_OF_CONDUCT"))]
"""The pages whose links are followed."""

_FENCE = re.compile(r"^(`{3,}|~{3,})([^\n]*)\n(.*?)^\1`*[ \t]*$", re.DOTALL | re.MULTILINE)
_COMMAND = re.compile(r"\bpython3? +((?:-m +[\w.]+|[\w./]+\.py)(?: +[^`|&;#\n]*)?)")


def blocks(text, kind="python"):
    """The fenced blocks of that kind."""
    return [found[3] for found in _FENCE.finditer(text) if found[2].strip() == kind]


def links(text):
    """Targets of links and pictures, films included, as they are written; not those of other sites."""
    text = _FENCE.sub(
        lambda found: f"[]({found[2].split()[1]})\n" if found[2].startswith("{image}") else "", text
    )
    text = re.sub(r"`+[^`\n]*`+", "code", text)
    found = re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'\b(?:src|href)="([^"]+)"', text)
    found += re.findall(r"^\[[^\]^][^\]]*\]: *(\S+)", text, re.MULTILINE)
    found = [
        target.replace("_static/", "../results/films/") for target in found
    ]  # where sphinx takes films from
    return [target for target in found if not re.match(r"(https?|mailto):", target)]


def paths(text):
    """Files and folders of the repository between backticks, as patterns, but for those of an older commit."""
    tops = "tests|benchmarks|agents|snooker_env|docs|examples|results|[.]github|[.]ci"
    found = re.findall(rf"`((?:{tops})/[\w./*-]+)`(?! at\s+commit\s+[0-9a-f]{{8}})", text)
    return [path for path in found if not re.search(r"NAME|\bmy_", path)]


def slug(heading):
    """The anchor of a heading, as GitHub and MyST make it."""
    return re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", heading).strip().lower()).replace(" ", "-")


def anchors(text):
    """The anchors of a page: of its headings, and those that it sets."""
    headings = re.findall(r"^#+ +(.*)$", _FENCE.sub("", text), re.MULTILINE)
    return {slug(heading) for heading in headings} | set(re.findall(r"^\(([\w-]+)\)=$", text, re.MULTILINE))


def commands(text):
    """What Python runs: ``python -m benchmarks.speed --parts start`` is (name, [options])."""
    text = re.sub(r"\\\n\s*", " ", text)
    every = [re.sub(r"^-m +", "", command).split() for command in _COMMAND.findall(text)]
    named = [words for words in every if not words[0].isupper() and not words[0].endswith("...")]
    return [(words[0].rstrip(".,:"), words[1:]) for words in named]
