"""Does the Python of the pages run? The blocks of a page in one process, with warnings as errors."""

import json
import os
import subprocess
import sys

import pytest

from tests.docs.pages import NAMES, PAGES, ROOT, blocks

RUNNER = """if True:
    import json, sys, warnings
    warnings.simplefilter("error")
    for number, block in enumerate(json.load(sys.stdin)):
        print("block", number, flush=True)
        exec(compile(block, f"block {number}", "exec"), {"__name__": "__main__"})
"""
CODE = {name: blocks(page.read_text(encoding="utf-8")) for name, page in zip(NAMES, PAGES, strict=True)}


@pytest.mark.parametrize("page", [name for name, code in CODE.items() if code])
def test_python_blocks_run(page, tmp_path):
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"PYTHONPATH": path, "MPLBACKEND": "Agg", "SDL_VIDEODRIVER": "dummy"}
    command = [sys.executable, "-c", RUNNER]
    text = {"input": json.dumps(CODE[page]), "text": True, "capture_output": True}
    done = subprocess.run(command, cwd=tmp_path, env=env, timeout=600, check=False, **text)
    assert done.returncode == 0, f"{page}\n{done.stdout[-1500:]}\n{done.stderr[-3000:]}"


def test_the_python_of_a_command_line_runs():
    """``python -c "..."`` of the specification."""
    page = (ROOT / "docs/environment/specification.md").read_text(encoding="utf-8")
    code = page.partition('python -c "')[2].partition('"')[0]
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True)
    assert "Action space" in done.stdout
