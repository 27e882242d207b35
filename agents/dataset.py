"""How is a player's play saved as a data set? As episodes in Minari's format, with a data card.

    python -m agents.dataset --out runs/data --player stroke_value --strokes 20000

plays the training tables of a benchmark task, ``TABLES`` at once, and writes OUT/snooker/NAME-v0, which
``minari.load_dataset`` reads with MINARI_DATASETS_PATH=OUT. Each complete part of the tables is kept in OUT/parts. To continue
after an interruption or add strokes, repeat the command, with a larger --strokes if you like; the data set equals that of an
uninterrupted run. It contains no table of the evaluation.
"""

import shutil
import sys
import time
from pathlib import Path
from typing import Any

from agents._lib.lifecycle import command, needs, parser_of

with needs("agents.dataset"):
    import gymnasium
    import numpy as np

    import snooker_env as sn
    from agents import croissant
    from agents._lib.files import keep_arrays, kept_arrays, write_atomic, write_json
    from agents._lib.provenance import provenance
    from snooker_env.benchmark import HELD_OUT_SEED, TASKS
    from snooker_env.benchmark.tasks import task_of
    from snooker_env.checks import choice, integer, refuse, refuse_what
    from snooker_env.planning import Planner, Positions
    from snooker_env.players import FRAMES, VISITS, ask_player, decision_seeds
    from snooker_env.players.resolver import is_name
    from snooker_env.progress import Progress
    from snooker_env.tasks import POTS, SIDES, SPEEDS, TOPS, choice_of


TABLES = 256
"""Tables per part; each plays one episode."""
FIRST_SEED = 200_000
"""The seed of the first table. All seeds lie below ``HELD_OUT_SEED``, where those of the evaluation begin."""
FORMS = ("strokes", "choices")
INFOS = ("points", "foul")
"""Entries of the environment's info that are kept after each stroke."""
COLUMNS = ("observations", "masks", "actions", "rewards", "terminations", "truncations", *INFOS)


def free_options(task, form) -> dict[str, Any]:
    """Options of the environment that plays a data set."""
    if form == "choices":
        if task.frame:
            raise refuse("form", form, 'must be "strokes" in frames: choices cannot decide after a foul')
        return {"action": "discrete", "observation": "masked"}
    return {"observation": "flat"} | (FRAMES if task.frame else VISITS)


def nearest_choices(strokes, at, masks, planner):
    """Find the available choices nearest to strokes in n positions: int64 (n,); ``masks`` bool (n, 540), ``planner`` of choices.

    Speed (its logarithm), side and top are rounded to the nearest available values. The pot is then the one whose aim for
    this stroke is nearest."""
    values, n = strokes.values, len(at)
    logs = np.abs(np.log(values[:, :1]) - np.log(SPEEDS)).argmin(axis=1)
    side = np.abs(values[:, 1:2] - np.array(SIDES)).argmin(axis=1)
    top = np.abs(values[:, 2:3] - np.array(TOPS)).argmin(axis=1)
    choices = np.stack([choice_of(pot, logs, side, top) for pot in range(POTS)], axis=1)
    there = np.take_along_axis(masks, choices, axis=1)
    rows, pots = np.nonzero(there)
    aims = planner.strokes_of(at, rows, choices[rows, pots])[0][:, 3]
    off = np.full((n, POTS), np.inf)
    off[rows, pots] = np.abs((aims - values[rows, 3] + np.pi) % (2.0 * np.pi) - np.pi)
    first = masks.argmax(axis=1)  # if the cue has no room for any of them
    return np.where(there.any(axis=1), choices[np.arange(n), off.argmin(axis=1)], first)


def play_table_episodes(task, name, form, seeds, threads=None):
    """Play one episode on each of the tables with these seeds. Returns arrays ``COLUMNS`` of all strokes, episode after episode,
    the ``last`` observations (and ``last_masks``) of each episode, and ``lengths`` (n,)."""
    n, reads = len(seeds), task.options(**free_options(task, "strokes"))
    envs = sn.SnookerVectorEnv(n, task.options(**free_options(task, form)), threads=threads)
    player, choices = sn.player(name).at(reads), form == "choices"
    planner = Planner(envs.options, threads=1) if choices else None
    observation, _ = envs.reset(seed=seeds)
    going, number, log = np.ones(n, bool), 0, []
    last: list[Any] = [None] * n
    while going.any():
        asked = going & ~envs.tables.are_over()
        keys = decision_seeds(0, np.asarray(seeds), number)
        if choices:
            rows, actions = np.flatnonzero(asked), np.zeros(n, np.int64)
            at, masks = Positions.of(envs)[rows], observation["action_mask"][rows] != 0
            actions[rows] = nearest_choices(player.play(at, keys[rows]), at, masks, planner)
        else:
            actions = ask_player(player, envs, asked, keys).astype(np.float32)
        before, (observation, rewards, *ended, info) = observation, envs.step(actions)
        rows = np.flatnonzero(going)
        seen = (
            (before["observations"], before["action_mask"])
            if choices
            else (before, np.zeros((n, 0), np.int8))
        )
        found = *seen, actions, rewards, *ended, *(info[name] for name in INFOS)
        log.append((rows, [part[rows] for part in found]))
        done = going & (ended[0] | ended[1])
        for k in np.flatnonzero(done).tolist():
            last[k] = {key: part[k] for key, part in observation.items()} if choices else observation[k]
        going &= ~done
        number += 1
    envs.close()
    table = np.concatenate([rows for rows, _ in log])
    order = np.argsort(table, kind="stable")
    whole = {
        column: np.concatenate([parts[c] for _, parts in log])[order] for c, column in enumerate(COLUMNS)
    }
    whole["lengths"] = np.bincount(table, minlength=n)
    whole["last"] = np.array([one["observations"] if choices else one for one in last])
    whole["last_masks"] = np.array([one["action_mask"] if choices else [] for one in last], np.int8)
    return whole


def episodes_of(part, seeds, first):
    """Yield the episodes of a part as Minari's ``EpisodeBuffer``; ``first`` numbers the first one."""
    from minari.data_collector import EpisodeBuffer

    ends = np.cumsum(part["lengths"])
    for k, (end, length) in enumerate(zip(ends.tolist(), part["lengths"].tolist(), strict=True)):
        one = {column: part[column][end - length : end] for column in COLUMNS}
        # Any: its type does not admit arrays as observations
        shown: Any = np.concatenate([one["observations"], part["last"][k : k + 1]])
        if part["masks"].shape[1]:
            shown = {
                "observations": shown,
                "action_mask": np.concatenate([one["masks"], part["last_masks"][k : k + 1]]),
            }
        # each observation has an info, including that of the reset
        infos = {name: np.concatenate([np.zeros(1, one[name].dtype), one[name]]) for name in INFOS}
        ended = {name: one[name] for name in ("actions", "rewards", "terminations", "truncations")}
        yield EpisodeBuffer(id=first + k, seed=seeds[k], observations=shown, infos=infos, **ended)


def write_dataset(folder, name, task, player, form, parts):
    """Write the parts as the data set ``name``, completely or not at all. Returns its figures."""
    import minari
    from minari.dataset.minari_storage import MinariStorage

    spec = gymnasium.make(task.id, **free_options(task, form)).spec
    made = folder.with_name(folder.name + ".unfinished")
    shutil.rmtree(made, ignore_errors=True)
    (made / "data").mkdir(parents=True)
    storage = MinariStorage.new(made / "data", env_spec=spec)
    about = f"{player} plays {task.id} ({task.title}): whole episodes, one step per stroke"
    more = {"dataset_id": name, "minari_version": minari.__version__, "algorithm_name": player}
    storage.update_metadata(more | {"description": about, "requirements": [f"snooker-env=={sn.__version__}"]})
    rows = []
    for k, part in enumerate(parts):
        storage.update_episodes(episodes_of(part, seeds_of(k), k * TABLES))
        first = np.cumsum(part["lengths"]) - part["lengths"]
        sums = [np.add.reduceat(part[name].astype(float), first) for name in ("rewards", *INFOS)]
        rows.append(np.column_stack([seeds_of(k), part["lengths"], *sums]))
    rows = np.concatenate(rows)
    returns = rows[:, 2]
    figures = {
        "episodes": len(returns),
        "strokes": storage.total_steps,
        "return": float(returns.mean()),
        "error": float(returns.std(ddof=1) / np.sqrt(len(returns))),
        "megabytes": float(storage.get_size()),
    }
    origin = provenance(
        f"python -m agents.dataset --task {task.id} --player {player} --form {form} --strokes {storage.total_steps} --out FOLDER",
        FIRST_SEED,
    )
    write_atomic(made / "README.md", card(name, task, player, figures, origin))
    lines = [f"{k},{','.join(f'{value:.12g}' for value in row)}" for k, row in enumerate(rows.tolist())]
    write_atomic(made / "episodes.csv", "\n".join(["episode,seed,strokes,reward,points,fouls", *lines, ""]))
    how = {"rai:dataCollection": f"Simulated by `{origin['command']}` at commit {origin['commit']}."}
    words = Path(croissant.__file__).with_suffix(".json")
    described = croissant.metadata(words, made, name=name, description=about, **how)
    write_json(made / croissant.FILE, described)
    shutil.rmtree(folder, ignore_errors=True)
    made.rename(folder)
    return figures


def differing(folder, many):
    """Replay ``many`` evenly spread episodes in the recovered environment from their seeds and actions. Returns the numbers of
    the episodes that differ in any bit, and how many were played."""
    import minari

    data = minari.MinariDataset(folder / "data")
    env = data.recover_environment()
    many = min(many, int(data.total_episodes))
    numbers = np.unique(np.linspace(0, data.total_episodes - 1, many).round().astype(int)).tolist()
    seeds = [one["seed"] for one in data.storage.get_episode_metadata(numbers)]
    wrong = []
    for episode, seed in zip(data.iterate_episodes(numbers), seeds, strict=True):
        seen, _ = env.reset(seed=int(seed))
        observations, infos, rest = [seen], {name: [0] for name in INFOS}, []
        for action in episode.actions:
            try:
                seen, *ended, info = env.step(action)
            except (gymnasium.error.ResetNeeded, ValueError):
                break  # too few rows: the episode has ended, or the action cannot be played
            observations.append(seen)
            rest.append(ended)
            for name in INFOS:
                infos[name].append(info[name])
        shown = episode.observations if isinstance(episode.observations, dict) else {"": episode.observations}
        again = {key: np.array([one[key] if key else one for one in observations]) for key in shown}
        kept = np.array([episode.rewards, episode.terminations, episode.truncations]).T
        same = all(np.array_equal(again[key], shown[key]) for key in shown) and np.array_equal(kept, rest)
        if not same or any(np.not_equal(infos[name], episode.infos[name]).any() for name in INFOS):
            wrong.append(episode.id)
    env.close()
    return wrong, len(numbers)


def card(name, task, player, figures, origin):
    """Write the card of a data set: its contents and origin. docs/agents/datasets.md explains the fields."""
    return f"""# {name}

{figures["strokes"]:,} strokes of {figures["episodes"]:,} whole episodes: `{player}` plays `{task.id}` ({task.title}),
with execution errors of the level "{task.frozen_options["noise"]}". An episode brings {figures["return"]:.2f} +- {figures["error"]:.2f}
(mean return, standard error).

Made by `{origin["command"]}`, snooker_env {sn.__version__},
commit {origin["commit"]}, {origin["machine"]}. `{croissant.FILE}` describes it for machines, `episodes.csv` has a line for each episode.
"""


def seeds_of(part):
    """The table seeds of a part. ValueError if they would reach those of the evaluation."""
    if FIRST_SEED + (part + 1) * TABLES > HELD_OUT_SEED:
        most = (HELD_OUT_SEED - FIRST_SEED) // TABLES * TABLES
        raise refuse_what(
            "strokes", "more", f"must be at most the strokes of {most:,} episodes, where the seeds end"
        )
    return list(range(FIRST_SEED + part * TABLES, FIRST_SEED + (part + 1) * TABLES))


@command("agents.dataset")
def main(argv=None):
    """Play the missing episodes and write the data set and its card."""
    parser = parser_of("python -m agents.dataset", __doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of data sets (MINARI_DATASETS_PATH)")
    help_ = f"tables and rules: {', '.join(TASKS)} [SnookerBreak-v0]"
    parser.add_argument("--task", default="SnookerBreak-v0", metavar="TASK", help=help_)
    parser.add_argument("--player", default="stroke_value", help="name of a player [stroke_value]")
    parser.add_argument("--strokes", type=int, default=20_000, help="minimum number of strokes [20000]")
    help_ = "record actions as whole strokes, or as the nearest of 540 choices with masks [strokes]"
    parser.add_argument("--form", default="strokes", metavar="{strokes,choices}", help=help_)
    parser.add_argument("--threads", type=int, help="threads that play the tables [one per core]")
    help_ = "then replay this many episodes from their seeds and actions, and compare all bits"
    parser.add_argument("--check", type=int, default=0, metavar="N", help=help_)
    args = parser.parse_args(argv)
    try:
        import minari  # noqa: F401 - what is missing is said before anything is played
    except ImportError:
        raise SystemExit('agents.dataset: minari is missing; in a clone: pip install -e ".[data]"') from None
    try:
        task, form = task_of(args.task), choice("form", args.form, FORMS)
        integer("strokes", args.strokes, 1, 10**9)
        integer("check", args.check, 0, 10**9)
        free_options(task, form)
        if not is_name(args.player) or not args.player.replace("_", "").isalnum():
            raise refuse("player", args.player, f"must be the name of a player: {', '.join(sn.players())}")
        sn.player(args.player).at(task.options(**free_options(task, "strokes")))
    except ValueError as error:
        parser.error(str(error))
    kind = "" if form == "strokes" else f"-{form}"
    name = f"snooker/{task.id.removeprefix('Snooker').removesuffix('-v0').lower()}-{args.player}{kind}-v0"
    out = args.out.absolute()  # Minari would append a relative path to itself
    kept = out / "parts" / name.replace("/", "-")
    began, parts, strokes, new = time.perf_counter(), [], 0, 0
    with Progress(f"{args.player} plays {task.id}", args.strokes, "strokes") as progress:
        while strokes < args.strokes:
            file = kept / f"{len(parts):05d}.npz"
            if not file.is_file():
                try:
                    seeds = seeds_of(len(parts))
                except ValueError as error:
                    parser.error(str(error))
                file.parent.mkdir(parents=True, exist_ok=True)
                part = play_table_episodes(task, args.player, form, seeds, args.threads)
                keep_arrays(file, part)
                new += len(part["rewards"])
            parts.append(file)
            try:
                strokes += len(kept_arrays(file)["rewards"])
            except ValueError as error:
                parser.error(str(error))
            progress.at(strokes)
    seconds = time.perf_counter() - began
    folder = out / name
    figures = write_dataset(folder, name, task, args.player, form, map(kept_arrays, parts))
    if new:
        print(
            f"{new:,} strokes played at {new / seconds:,.0f} strokes/s: 1,000,000 take {1e6 / new * seconds / 3600:.2g} h"
        )
    counted = f"{figures['strokes']:,} strokes of {figures['episodes']:,} episodes"
    print(
        f"{folder}: {counted}, mean return {figures['return']:.2f} +- {figures['error']:.2f}, {figures['megabytes']:.1f} MB"
    )
    if args.check:
        wrong, many = differing(folder, args.check)
        print(f"{many - len(wrong)} of {many} replayed episodes are equal bit for bit")
        if wrong:
            print(f"replays differ in episodes {', '.join(map(str, wrong))}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
