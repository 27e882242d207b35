"""How do I get a match of two players? ``match_env``: the PettingZoo environment, with PettingZoo loaded only when it is asked for."""


def match_env(
    *, layout="break_off", aim="absolute", observation="flat", noise="none", reward="points", elevation=False, placement=True,
    decision=True, miss="off", physics="paper", table="match", fidelity="standard", max_strokes=1000, render_mode=None,
):  # fmt: skip
    """A frame of snooker between "player_0" and "player_1": a PettingZoo AEC environment (``snooker_env.envs.match.MatchEnv``).

    The arguments are those of ``Snooker-v0`` with ``task="frame"``; placement in the D and the decision after a foul are part of the action
    unless switched off. max_strokes: the referee stops the frame, both players are truncated, after so many strokes of both together; None
    for never.

    Raises ImportError without PettingZoo, ValueError on a bad argument.
    """
    try:
        from .envs.match import MatchEnv
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "pettingzoo":
            raise
        raise ImportError('match_env needs PettingZoo; install it, in a clone of snooker_env, with: pip install -e ".[multi]"') from error
    return MatchEnv(
        layout=layout, aim=aim, observation=observation, noise=noise, reward=reward, elevation=elevation, placement=placement,
        decision=decision, miss=miss, physics=physics, table=table, fidelity=fidelity, max_strokes=max_strokes, render_mode=render_mode,
    )  # fmt: skip
