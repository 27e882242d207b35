"""How does a benchmark run a changed package? It changes a copy of the source; the package itself stays unchanged.

The copy is kept under a hash of its source, so that numba finds its cache again.
"""

import hashlib
import importlib
import sys
from pathlib import Path

import snooker_env

from .kept import kept_folder


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

    def make(folder):
        for path, text in changed.items():
            target = folder / name / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")

    folder = kept_folder(f"{name}_{key}", make)
    sys.path.insert(0, str(folder))
    try:
        return [importlib.import_module(f"{name}.{module}") for module in modules]
    finally:
        sys.path.remove(str(folder))
