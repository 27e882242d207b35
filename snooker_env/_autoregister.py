"""How does ``gymnasium.make("Snooker-v0")`` work without importing snooker_env? The id is registered as soon as Gymnasium is imported.

Gymnasium 1.x reads no entry points of other packages, and many worker processes import nothing but Gymnasium. So an installation holds a
copy of this file beside the package, ``_snooker_env_autoregister.py``, and a ``.pth`` file whose one line calls its ``wait`` when an
interpreter starts. That only puts a finder into ``sys.meta_path``, which steps aside once Gymnasium's registration is imported;
snooker_env itself and numba are imported when an environment is made. ``SNOOKER_ENV_AUTOREGISTER=0`` switches it off.
"""

import os
import sys

ID = "Snooker-v0"
ENTRY_POINT = "snooker_env.envs.snooker:SnookerEnv"
VECTOR_ENTRY_POINT = "snooker_env.envs.vector:SnookerVectorEnv"

_REGISTRATION = "gymnasium.envs.registration"


def register(registration):
    """Register the id with Gymnasium's module ``registration``, unless it is there already: a second import stays silent.

    String entry points keep the import light and the spec JSON-able.
    """
    if ID not in registration.registry:
        registration.register(id=ID, entry_point=ENTRY_POINT, vector_entry_point=VECTOR_ENTRY_POINT)


class _Finder:
    """Waits for the import of Gymnasium's registration, to register the id once that module is complete."""

    def find_spec(self, name, path=None, target=None):
        """The module's own spec, its loader told to register the id; None for all other modules."""
        if name != _REGISTRATION:
            return None
        sys.meta_path.remove(self)
        import importlib.util  # not at the top: interpreters that never import Gymnasium do not pay for it

        spec = importlib.util.find_spec(name)
        loader = getattr(spec, "loader", None)
        if loader is not None:
            complete = loader.exec_module

            def exec_module(module):
                complete(module)
                try:
                    register(module)
                except Exception as error:  # Gymnasium's own import must not fail for our sake
                    print(f"snooker_env: {ID} is not registered: {error}", file=sys.stderr)

            loader.exec_module = exec_module
        return spec


def wait():
    """Have the id registered when Gymnasium is imported, or now if it is already."""
    if os.environ.get("SNOOKER_ENV_AUTOREGISTER") == "0":
        return
    if _REGISTRATION in sys.modules:
        register(sys.modules[_REGISTRATION])
    else:
        sys.meta_path.insert(0, _Finder())
