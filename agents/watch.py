"""The command ``python -m agents.watch``: that of ``snooker_env.watch``, beside the other commands of agents."""

import runpy

from commands.lifecycle import needs

with needs("agents.watch"):
    import snooker_env  # noqa: F401 - so that a missing package is named

if __name__ == "__main__":
    runpy.run_module("snooker_env.watch", run_name="__main__")
