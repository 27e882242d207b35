"""Is a clone clean after its pages were followed? What their commands and examples write is ignored by git."""

import re
import subprocess
from itertools import pairwise

import pytest

from tests.docs.pages import PAGES, ROOT, blocks, commands

WRITES = re.compile(r"""(?:\.save|\breplay|RecordReplay)\((?:[^"\n]*, )?"([\w./-]+)\"""")


def written():
    """What pages write, relative to the clone: the values of --out, --json and the like, and of save and replay."""
    found = set()
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for _, words in commands(text):
            found |= {
                after
                for word, after in pairwise(words)
                if word in ("--out", "--json", "--keep", "--markdown", "--save")
            }
        for block in blocks(text):
            found |= set(WRITES.findall(block))
    return sorted(one.rstrip("`.,:") for one in found if "://" not in one and not one.isupper())


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="only a clone can say what git ignores")
def test_what_the_pages_write_is_ignored():
    names = written()
    assert len(names) > 20 and {"mine.zip", "break.html"} <= set(names)
    command = ["git", "check-ignore", "--no-index", "--stdin"]
    # as folders too: a pattern for a folder takes no file of that name
    asked = "\n".join([*names, *(f"{name}/file" for name in names)])
    ignored = subprocess.run(command, cwd=ROOT, input=asked, capture_output=True, text=True).stdout.split(
        "\n"
    )
    tracked = set(subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).split("\n"))
    left = [name for name in names if name not in ignored and f"{name}/file" not in ignored]
    assert not [name for name in left if not any(one.startswith(name) for one in tracked)], left
