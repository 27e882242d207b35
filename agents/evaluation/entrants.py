"""Who is compared? Named players and trained models (one per training seed), with the training of each."""

import glob
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from agents._lib.files import read_json
from agents._lib.physics_option import physics_text
from snooker_env import Options, player, players
from snooker_env.checks import integer, number, refuse
from snooker_env.players import SeenPlayer
from snooker_env.players.resolver import is_name
from snooker_env.players.saved_models import SavedModel, options_of_words, saved_player

from ..learning.model_files import Trained
from ..learning.models import POLICY, PRETRAINED, file_of, pretrained_names
from ..players.trained import read_model

UNKNOWN = dict.fromkeys(("layout", "noise", "fidelity", "physics", "cue"), "unknown")
"""The training record of a model that train.py did not make."""


@dataclass(frozen=True)
class Entrant:
    """A player, or the models of one training method, one per seed."""

    label: str
    runs: tuple
    """Names, model files or run folders."""
    trust: bool = False
    """Whether code in its files may run; Stable-Baselines3 models not made by train.py need this."""
    options: tuple = ()
    """How to interpret the actions of such models: (key, value) of ``saved_models.KEYS``."""

    @classmethod
    def of(cls, text, trust=False, options=()):
        """Parse NAME, PATH or LABEL=PATH,PATH,... Raises ValueError."""
        label, equals, paths = text.partition("=") if not Path(text).exists() else ("", "", "")
        if not equals:
            label, paths = "", text
        runs = []
        for path in paths.split(","):
            if path in pretrained_names():
                path = str(PRETRAINED / f"{path}.zip")
            some = [path] if Path(path).exists() else _names(path) or sorted(glob.glob(path))
            if not some:
                if Path(path).suffix in (".zip", ".npz") and not glob.has_magic(path):
                    raise refuse("agent", path, "must be an existing model file")
                models = "MODULE:CLASS, or existing models: a .zip or .npz, a run folder, a pattern"
                raise refuse("agent", path, f"must be {', '.join(players())}, {models}")
            runs += some
        if equals and not label:
            raise refuse("agent", text, "must have a label before the =")
        if any(map(is_name, runs)) and not all(map(is_name, runs)):
            raise refuse("agent", text, "must be players or trained models, not both under one label")
        if is_name(runs[0]):
            return cls(label or runs[0].rpartition(":")[2], tuple(runs))
        path = Path(runs[0])
        named = path.parent if path.name in ("model.zip", POLICY) else path
        return cls(label or named.stem, tuple(runs), trust, options)

    def trained(self):
        """The training of each run according to its files: one dict per run, {} for an untrained player."""
        return [self._training(run) for run in self.runs]

    def origins(self):
        """The same with "from", the name or file of each run."""
        return [{"from": run, **how} for run, how in zip(self.runs, self.trained(), strict=True)]

    @property
    def foreign(self):
        """Whether any model was not made by train.py."""
        return any(isinstance(self.player(k), Foreign) for k in range(len(self.runs)))

    def player(self, k):
        """The player of run k; each model is read once."""
        run = self.runs[k]
        return player(run) if is_name(run) else _model(run, self.trust, self.options)

    def _training(self, run):
        if is_name(run):
            _ = player(run)  # a user's own player may be missing
            run = run.partition("@")[2]
            if (
                not run or not Path(run).exists() or run.endswith(".npz")
            ):  # the network of stroke_value keeps no record
                return {}
        model, path = _model(run, self.trust, self.options).model, Path(run)
        card, results = path.with_suffix(".json"), (path if path.is_dir() else path.parent) / "results.json"
        if path.is_file() and card.is_file():
            seconds, imitated = _number_in(card, "hours"), _number_in(card, "imitated")
            seconds = None if seconds is None else 3600.0 * seconds
        else:
            seconds, imitated = _number_in(results, "seconds"), model.imitated
        usual = {"layout": Options().layout, "noise": "none", "fidelity": "standard", "cue": "free"}
        return {
            "recipe": model.recipe,
            "shots": model.num_timesteps,
            "imitated": imitated,
            "seconds": seconds,
            "seed": model.seed,
            "gamma": model.gamma,
            **{key: model.env_options.get(key, value) for key, value in usual.items()},
            "physics": physics_text(model.env_options.get("physics", "paper")),
        }


def entrants_of(texts, args, field):
    """Parse the entrants of a command line, with distinct labels and readable models. Raises ValueError."""
    options = tuple(options_of_words(args.options).items())
    entrants = [Entrant.of(text, args.trust, options) for text in texts]
    labels = [entrant.label for entrant in entrants]
    for entrant in entrants:
        if labels.count(entrant.label) > 1:
            raise refuse(field, entrant.label, f"must differ for each {field}: give LABEL=PATH")
        entrant.trained()  # this reads its models
    if options and not any(entrant.foreign for entrant in entrants):
        unfit = "must be left out: it is for models not made by train.py"
        raise refuse("options", " ".join(args.options), unfit)
    return entrants


def _names(name):
    """The player with this name in a list; several for a planner with a pattern; [] for other text."""
    kind, at, pattern = name.partition("@")
    if at and is_name(name):
        return [f"{kind}@{model}" for model in sorted(glob.glob(pattern))] or [name]
    return [name] if is_name(name) else []


class Foreign(SeenPlayer):
    """A model not made by train.py, and its training according to its file."""

    def __init__(self, seen, name, data):
        super().__init__(seen, name=name)
        self.model = data


@cache
def _model(path, trust, options):
    file = file_of(Path(path), "agent")
    ours = read_model(file, "agent")
    if ours is not None:
        return ours
    told = _read_record(
        SavedModel.of(file, "agent"), dict(options)
    )  # check this before anything in the file runs
    return Foreign(saved_player(file, dict(options), trust, "agent").seen, path, told)


def _read_record(saved, options):
    """The training record of a model that train.py did not make."""
    steps, gamma, seed = (saved.data.get(name) for name in ("num_timesteps", "gamma", "seed"))
    try:
        steps, gamma = integer("num_timesteps", steps, 0, 10**18), number("gamma", gamma, 0, 1)
        seed = seed if seed is None else integer("seed", seed, 0, 2**64)
    except ValueError as error:
        raise saved.refuse_file(f"must be a model saved by Stable-Baselines3 ({error})") from None
    options = UNKNOWN | options
    return Trained(None, saved.algorithm[1], options, steps, gamma, seed, imitated=None)


def _number_in(file, name):
    """The number with this name in a JSON file; None if there is none. Raises ValueError."""
    content = read_json("agent", file, "must be JSON") if file.is_file() else {}
    if not isinstance(content, dict):
        raise refuse("agent", str(file), f"must hold {name} in an object")
    return None if content.get(name) is None else number(f"{file}: {name}", content[name], 0)
