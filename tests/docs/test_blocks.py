"""Does the Python of the pages run? The blocks of a page in one process, with warnings as errors."""

import json
import os
import subprocess
import sys

import pytest

from tests.docs.pages import NAMES, PAGES, ROOT, blocks

RUNNER = """if True:
    import json, os, sys, traceback, warnings
    warnings.simplefilter("error")
    import gymnasium, numba, snooker_env

    def run(page, code):
        for number, block in enumerate(code):
            print(page, "block", number, flush=True)
            exec(compile(block, f"{page}, block {number}", "exec"), {"__name__": "__main__"})

    failed = []
    for page, code in json.load(sys.stdin).items():
        child = os.fork()  # of a process that has imported what nearly all pages import, and run nothing
        if child == 0:
            folder = page.replace("/", "-")
            os.mkdir(folder), os.chdir(folder)
            try:
                run(page, code)
            except BaseException:
                traceback.print_exc(limit=-2)  # so that each of a few pages is shown
                os._exit(1)
            sys.stdout.flush()
            os._exit(0)
        if os.waitpid(child, 0)[1]:
            failed.append(page)
    sys.exit(", ".join(failed) or 0)
"""
CODE = {name: blocks(page.read_text(encoding="utf-8")) for name, page in zip(NAMES, PAGES, strict=True)}
LONG, SHORT = "agent.learn(163_840)", "agent.learn(4_096)"
"""README's training: .ci/run trains as long, by README's main command."""
WITH_CODE = [name for name, code in CODE.items() if code and name != "README.md"]
GROUPS = {"README": ["README.md"], **{f"pages {k}": WITH_CODE[k::4] for k in range(4)}}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="pages are run in copies of one process")
@pytest.mark.parametrize(
    "group", [pytest.param(n, marks=[pytest.mark.slow] * (n != "README")) for n in GROUPS]
)
def test_python_blocks_run(group, tmp_path):
    """README, and every fourth page; .ci/run runs them all."""
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    env = os.environ | {"PYTHONPATH": path, "MPLBACKEND": "Agg", "SDL_VIDEODRIVER": "dummy"}
    pages = {name: [code.replace(LONG, SHORT) for code in CODE[name]] for name in GROUPS[group]}
    text = {"input": json.dumps(pages), "text": True, "capture_output": True}
    done = subprocess.run(
        [sys.executable, "-c", RUNNER], cwd=tmp_path, env=env, timeout=900, check=False, **text
    )
    assert done.returncode == 0, f"{done.stdout[-1500:]}\n{done.stderr[-3000:]}"
    assert all(f"{name} block {len(code) - 1}" in done.stdout for name, code in pages.items())


def test_the_python_of_a_command_line_runs():
    """``python -c "..."`` of the specification."""
    page = (ROOT / "docs/environment/specification.md").read_text(encoding="utf-8")
    code = page.partition('python -c "')[2].partition('"')[0]
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True)
    assert "Box(-1, 1, (4,), float32)" in done.stdout


def test_the_long_training_is_still_on_the_page():
    assert any(LONG in code for code in CODE["README.md"])
