"""How does ``gymnasium.make("Snooker-v0")`` work without importing snooker_env?

Gymnasium 1.x reads no entry points of other packages, and many worker processes import nothing but Gymnasium.
So an installation holds this file beside the package, as ``_snooker_env_autoregister.py``, and a ``.pth``
file whose one line calls its ``wait`` when an interpreter starts. That only puts a finder into
``sys.meta_path``, which steps aside once Gymnasium's registration is imported; snooker_env itself and numba
are imported when an environment is made. ``SNOOKER_ENV_AUTOREGISTER=0`` switches it off.
"""

import os
import sys

_REGISTRATION = "gymnasium.envs.registration"


def _register(registration):
    """Register without importing the package. Gymnasium must work whatever happens here."""
    from importlib import util  # not at the top: interpreters that never import Gymnasium do not pay for it

    try:
        package = util.find_spec("snooker_env")
        if package is None or not package.submodule_search_locations:  # its source is gone
            return
        path = os.path.join(package.submodule_search_locations[0], "_registration.py")
        with open(path, encoding="utf-8") as file:
            names = {}
            exec(compile(file.read(), path, "exec"), names)
        names["register"](registration)
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        print(f"snooker_env: its environments are not registered: {why}", file=sys.stderr)


class _Finder:
    """Waits for the import of Gymnasium's registration."""

    def find_spec(self, name, path=None, target=None):
        """The module's own spec, its loader extended to register the ids; None for all other modules."""
        if name != _REGISTRATION:
            return None
        sys.meta_path.remove(self)
        from importlib import util

        spec = util.find_spec(name)
        if spec is not None and spec.loader is not None:
            complete = spec.loader.exec_module

            def exec_module(module):
                complete(module)
                _register(module)

            spec.loader.exec_module = exec_module
        return spec


def wait():
    """Have the ids registered when Gymnasium is imported, or now if it is already."""
    if os.environ.get("SNOOKER_ENV_AUTOREGISTER") == "0":
        return
    if _REGISTRATION in sys.modules:
        _register(sys.modules[_REGISTRATION])
    # Python may read a .pth file twice
    elif not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())
