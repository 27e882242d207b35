"""Does each room import only what stands below it, by the contracts of ``lint-imports``?"""

import os
import subprocess
import sys

import pytest

from tests.processes import ROOT, python, replace


def lint(config):
    """Exit code and words of import-linter."""
    pytest.importorskip("importlinter")
    code = f"from importlinter.cli import lint_imports as lint; exit(lint({str(config)!r}, no_cache=True))"
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=env, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def test_import_contracts_are_kept_and_a_broken_one_is_seen(tmp_path):
    code, words = lint(ROOT / "pyproject.toml")
    assert code == 0, words
    assert "4 kept, 0 broken" in words
    # The lowest room put on top: all others import it, so that the check can fail
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    order = ', "snooker_env"]\n\n[[tool.importlinter.contracts]]\nname = "Rooms of the package"'
    replace(tmp_path / "pyproject.toml", order, order.replace(', "snooker_env"', ""))
    replace(tmp_path / "pyproject.toml", 'layers = ["benchmarks"', 'layers = ["snooker_env", "benchmarks"')
    code, words = lint(tmp_path / "pyproject.toml")
    assert code == 1 and "3 kept, 1 broken" in words


def test_the_built_in_players_load_no_learning_library():
    """Neither torch, Stable-Baselines3 nor what reads recipes, not even to play as the planner does."""
    code = """if True:
        import sys
        import numpy as np, snooker_env as sn
        at = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
        for name in ("random", "ghost_ball", "best_pot_8", "search_8", "planner_8"):
            sn.player(name).at({}).play(at, [0])
        ours = ("agents.learning.hyperparameters", "agents.learning.models", "agents.players.trained")
        print([name for name in ("torch", "stable_baselines3", "sb3_contrib", *ours) if name in sys.modules])
    """
    assert python(code, at=ROOT)[0].strip() == "[]"
