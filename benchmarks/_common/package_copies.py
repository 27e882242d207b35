"""How does a benchmark run a changed package? It changes a copy of the source; the package itself stays unchanged.

The copy is kept under a hash of its source, so that numba finds its cache again.
"""

import hashlib
import importlib
import os
import shutil
import sys
import tempfile
from pathlib import Path

import snooker_env

BUILD = Path(__file__).parents[2] / "build" / "benchmarks"
"""Git ignores this folder. A known name under /tmp could belong to another user and hold their code."""


def texts():
    """The package's source: path in the package (posix) -> text."""
    root = Path(snooker_env.__file__).parent
    return {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(root.rglob("*.py"))
    }


def load(name, changed, modules, more=""):
    """Import modules (like "physics.engine") of the package ``name`` made from the texts ``changed``; ``more`` holds its
    other dependencies."""
    key = hashlib.sha256(repr((sorted(changed.items()), more)).encode()).hexdigest()[:16]
    folder = BUILD / f"{name}_{key}"
    if not folder.exists():
        _write(folder, {Path(name, path): text for path, text in changed.items()})
    sys.path.insert(0, str(folder))
    try:
        return [importlib.import_module(f"{name}.{module}") for module in modules]
    finally:
        sys.path.remove(str(folder))


def _write(folder, texts):
    """Make a folder of texts. They are written elsewhere first, so that a second process never sees it incomplete."""
    BUILD.mkdir(parents=True, exist_ok=True)
    aside = Path(tempfile.mkdtemp(prefix=f"{folder.name}.", dir=BUILD))
    try:
        for path, text in texts.items():
            (aside / path).parent.mkdir(parents=True, exist_ok=True)
            (aside / path).write_text(text, encoding="utf-8")
        os.replace(aside, folder)
    except OSError:
        if not folder.exists():  # otherwise another process was faster
            raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)
