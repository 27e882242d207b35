"""The command ``python -m agents.watch``: that of ``snooker_env.watch``, beside the other commands of agents."""

from commands.lifecycle import needs

with needs("agents.watch"):
    from snooker_env.watch import main

if __name__ == "__main__":
    raise SystemExit(main())
