"""How does a benchmark run a changed package? A copy of its source with the change, beside the product, which stays as it is.

The copy lies in the temporary folder under a hash of its source, so that numba's cache of it is found again.
"""

import hashlib
import importlib
import os
import sys
import tempfile
from pathlib import Path

import snooker_env


def texts():
    """The package's source: path from the package (posix) -> text."""
    root = Path(snooker_env.__file__).parent
    return {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in sorted(root.rglob("*.py"))}


def load(name, changed, modules, more=""):
    """The modules (as "physics.engine") of the package ``name`` made from the texts ``changed``; more: what else it depends on."""
    key = hashlib.sha256(repr((sorted(changed.items()), more)).encode()).hexdigest()[:16]
    folder = Path(tempfile.gettempdir()) / f"{name}_{key}"
    if not folder.exists():  # made aside and moved, so that a second process never sees half of it
        aside = Path(tempfile.mkdtemp(prefix=name, dir=folder.parent))
        for path, text in changed.items():
            target = aside / name / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        os.replace(aside, folder)
    sys.path.insert(0, str(folder))
    try:
        return [importlib.import_module(f"{name}.{module}") for module in modules]
    finally:
        sys.path.remove(str(folder))
