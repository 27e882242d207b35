"""What does a learning agent see, and how well does it play a visit? The view of the pots, held-out visits, and what their figures say.

``settings`` is any object with the fields of ``train.Settings`` that a function reads.
"""

from math import hypot, log10

import gymnasium
import numpy as np
from gymnasium import spaces

from snooker_env._jit import entry
from snooker_env.envs.actions import MAX_SPEED, MIN_SPEED
from snooker_env.envs.observations import SIZE
from snooker_env.game.balls import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, N_BALLS
from snooker_env.game.pots import POCKETS, POT_COLUMNS, find_pots

EVAL_LAYOUT, EVAL_SEED = "held_out", 1_000_000

MOST_POTS = 4
"""Pots shown."""
POT_ENTRIES = 8
"""Numbers shown of each."""


@entry
def _add_pots(observations, shown):
    """Copy the observations (n, SIZE) into ``shown`` and write the pots behind them, read from the observations alone."""
    found = np.empty((MOST_POTS, POT_COLUMNS))
    positions, on_table = np.empty((N_BALLS, 2)), np.empty(N_BALLS, np.bool_)
    for k in range(len(observations)):
        seen, row, on = observations[k], shown[k], 0
        for c in range(row.shape[0]):
            row[c] = seen[c] if c < SIZE else 0.0
        for i in range(N_BALLS):
            positions[i, 0], positions[i, 1] = seen[5 * i] * HALF_WIDTH, seen[5 * i + 1] * HALF_LENGTH
            on_table[i] = seen[5 * i + 2] > 0.0
            on |= (1 << i) if seen[5 * i + 4] > 0.0 else 0
        for p in range(find_pots(positions, on_table, on, BALL_RADIUS, found) if on_table[0] else 0):
            ball, pocket, at = int(found[p, 0]), int(found[p, 1]), SIZE + POT_ENTRIES * p
            bx, by, gx, gy = positions[ball, 0], positions[ball, 1], found[p, 2], found[p, 3]
            px, py, rx, ry = gx - positions[0, 0], gy - positions[0, 1], bx - gx, by - gy
            away, run = hypot(px, py), hypot(rx, ry)
            px, py, rx, ry = px / away, py / away, rx / run, ry / run
            to_pocket = hypot(POCKETS[pocket, 0] - bx, POCKETS[pocket, 1] - by)
            row[at], row[at + 1], row[at + 2], row[at + 3], row[at + 4] = 1.0, px, py, px * ry - py * rx, found[p, 4]
            row[at + 5], row[at + 6] = away / HALF_LENGTH - 1.0, to_pocket / HALF_LENGTH - 1.0
            row[at + 7] = 1.0 + log10(found[p, 5]) / 2.0
            for c in range(at, at + POT_ENTRIES):
                row[c] = min(1.0, max(-1.0, row[c]))


def with_pots(observations):
    """Flat observations (n, SIZE) with the four widest direct pots appended, eight numbers each; all 0 where there are fewer.

    1, direction cue ball -> ghost ball (x, y), sine and cosine of the cut, both distances, tolerance. A small network cannot find these
    lines itself in a few minutes: without them the same run makes a third of the pots.
    """
    shown = np.empty((len(observations), SIZE + MOST_POTS * POT_ENTRIES), np.float32)
    _add_pots(np.ascontiguousarray(observations), shown)
    return shown


VIEW_SPACE = spaces.Box(-1.0, 1.0, (SIZE + MOST_POTS * POT_ENTRIES,), np.float32)
"""What the agent sees."""


class PotView(gymnasium.ObservationWrapper):
    """``with_pots`` for one table."""

    def __init__(self, env):
        super().__init__(env)
        self.observation_space = VIEW_SPACE

    def observation(self, observation):
        return with_pots(observation[None])[0]


def _options(settings, layout):
    return {"layout": layout or settings.layout, "aim": settings.aim, "noise": settings.noise, "fidelity": settings.fidelity}


def make_env(settings, layout=None):
    """One table as the agent sees it."""
    return PotView(gymnasium.make("Snooker-v0", **_options(settings, layout)))


def make_envs(settings, threads=None):
    """The training tables side by side, as the agent sees them: an SB3 ``VecEnv``."""
    from stable_baselines3.common.vec_env import VecEnvWrapper

    from snooker_env.sb3 import SnookerVecEnv

    class PotsOfAll(VecEnvWrapper):
        """``with_pots`` for all tables in one go."""

        def reset(self):
            return with_pots(self.venv.reset())

        def step_wait(self):
            observations, rewards, done, infos = self.venv.step_wait()
            ended = [info for info in infos if "terminal_observation" in info]
            if ended:
                for info, row in zip(ended, with_pots(np.stack([info["terminal_observation"] for info in ended])), strict=True):
                    info["terminal_observation"] = row
            return with_pots(observations), rewards, done, infos

    return PotsOfAll(SnookerVecEnv(settings.envs, threads=threads, **_options(settings, None)), VIEW_SPACE)


def evaluate(settings, act, visits):
    """Figures of ``visits`` held-out visits, seeds EVAL_SEED, EVAL_SEED + 1, ...: the same tables for every agent ``act(observations)``.

    All are played side by side; what is played on a table after its visit has ended does not count.
    """
    tables = gymnasium.make_vec("Snooker-v0", visits, vectorization_mode="vector_entry_point", **_options(settings, EVAL_LAYOUT))
    observations, _ = tables.reset(seed=EVAL_SEED)
    played = np.zeros((visits, 4))  # strokes, pots, points, fouls
    going = np.ones(visits, bool)
    while going.any():
        actions = np.zeros((visits, tables.single_action_space.shape[0]), np.float32)
        actions[going] = act(with_pots(observations[going]))
        observations, _, ended, _, info = tables.step(actions)
        played[going] += np.column_stack([going, info["points"] > 0, info["points"], info["foul"]])[going]
        going &= ~ended
    tables.close()
    strokes, scoring, points, fouls = played.T
    rate = scoring.sum() / strokes.sum()
    error = lambda x: float(np.std(x, ddof=1) / np.sqrt(visits))  # noqa: E731
    return {
        "pots_a_visit": float(scoring.mean()), "pots_a_visit_se": error(scoring), "points_a_visit": float(points.mean()),
        "points_a_visit_se": error(points), "pot_rate": float(rate), "pot_rate_se": error(scoring - rate * strokes) / float(strokes.mean()),
        "fouls_a_visit": float(fouls.mean()), "fouls_a_visit_se": error(fouls), "longest_break": int(points.max()), "visits": visits,
        "strokes": int(strokes.sum()),
    }  # fmt: skip


def evaluate_all(settings, model):
    """The trained agent, its own average shot played every time (has it learned to read the table, or just one good shot?), random play."""
    shots, rng = [], np.random.default_rng(settings.seed)

    def trained(observations):
        shots.append(model.predict(observations, deterministic=True)[0])
        return shots[-1]

    figures = {"trained": evaluate(settings, trained, settings.eval_visits)}
    shots = np.concatenate(shots)
    average = np.mean(shots, axis=0)
    figures["average_shot"] = evaluate(settings, lambda _: average, settings.eval_visits)
    figures["random"] = evaluate(settings, lambda seen: rng.uniform(-1.0, 1.0, (len(seen), len(average))), settings.eval_visits)
    style = {"action_mean": average.tolist(), "action_sd": np.std(shots, axis=0).tolist()}
    style["cue_speed_mean"] = MIN_SPEED + 0.5 * (style["action_mean"][0] + 1.0) * (MAX_SPEED - MIN_SPEED)
    return {"layout": EVAL_LAYOUT, "first_seed": EVAL_SEED, "agents": figures, "style": style}


def lesson(settings, steps, evaluation):
    """What was learned, in one sentence that follows from the figures: a difference counts from two standard errors on."""
    trained, average, random = (evaluation["agents"][name] for name in ("trained", "average_shot", "random"))

    def better(a, b):
        return a["points_a_visit"] - b["points_a_visit"] > 2.0 * np.hypot(a["points_a_visit_se"], b["points_a_visit_se"])

    def made(agent):
        return f"{agent['pots_a_visit']:.2f} pots and {agent['points_a_visit']:.2f} points a visit"

    start, figures = f"In {steps:,} shots {settings.algo.upper()} learned", f"{made(trained)} against {made(random)} of random play"
    if not better(trained, random):
        return f"{start} nothing that {trained['visits']} visits can show: {figures}."
    if better(trained, average):
        return f"{start} to pot and to read the table: {figures}, and {made(average)} of its own average shot played every time."
    return f"{start} one shot that pots, but not to read the table: {figures}, and {made(average)} of its average shot played every time."


def show(evaluation):
    """Print the figures."""
    import rich.box
    import rich.console
    import rich.table

    visits = evaluation["agents"]["random"]["visits"]
    title = f"A visit, over {visits} held-out ones, the same for all (± standard error)"
    table = rich.table.Table(title=title, box=rich.box.SIMPLE, pad_edge=False)
    table.add_column("agent", no_wrap=True)
    for name in ("pots", "points", "fouls", "pot rate", "best"):
        table.add_column(name, justify="right", no_wrap=True)
    for name, f in evaluation["agents"].items():
        cells = [f"{f[key]:.2f} ± {f[key + '_se']:.2f}" for key in ("pots_a_visit", "points_a_visit", "fouls_a_visit")]
        cells += [f"{100 * f['pot_rate']:.1f} ± {100 * f['pot_rate_se']:.1f} %", str(f["longest_break"])]
        table.add_row(name.replace("_", " "), *cells)
    rich.console.Console().print(table)
