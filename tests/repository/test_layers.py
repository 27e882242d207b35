"""Does each part import only what stands above it, and do the layers agree on what they share? Read from the source with ``ast``."""

import ast
import dataclasses
from pathlib import Path

import numpy as np
import pytest

import snooker_env
from snooker_env import Physics, Table, geometry
from snooker_env.game import balls, in_hand, layouts, spotting
from snooker_env.physics import table
from snooker_env.tasks import observations
from snooker_env.tasks.box_actions import Actions

PACKAGE = Path(snooker_env.__file__).resolve().parent
FILES = sorted(PACKAGE.rglob("*.py"))
NAMES = [path.relative_to(PACKAGE).as_posix() for path in FILES]

# What a part may import of the package, besides itself; a dotted name means only that module of a part.
BASE = {"_jit", "_lanes", "_check", "_files", "_install", "_shots", "_types", "geometry"}
ALLOWED = {
    "_cache": set(),
    "_notices": {"_cache"},
    "_inner": set(),
    "_install": set(),
    "_lanes": set(),
    "_jit": {"_cache", "_notices", "_inner"},
    "_registration": set(),
    "_autoregister": set(),
    "_types": set(),
    "_files": set(),
    "_shots": set(),
    "_check": {"_types"},
    "checks": {"_check", "physics"},
    "progress": set(),
    "kernels": {"_jit", "game", "tasks"},
    "geometry": {"_check", "_types"},
    "physics": BASE,
    "shot": BASE | {"physics", "render"},
    "impacts": BASE | {"physics", "shot"},
    "simulation": BASE | {"physics", "shot"},
    "game": BASE,
    "tasks": BASE | {"physics", "simulation", "game"},
    "planning": BASE | {"physics", "simulation", "game", "tasks"},
    "advice": BASE | {"physics", "simulation", "game", "tasks", "planning", "envs"},
    "players": BASE | {"physics", "simulation", "game", "tasks", "planning"},
    "envs": BASE | {"physics", "simulation", "game", "tasks", "planning", "players", "render", "replays"},
    "replays": BASE | {"physics", "simulation", "game", "tasks", "planning", "render"},
    "render": BASE - {"_jit", "_lanes"} | {"physics", "game.balls", "impacts", "simulation"},
    "sb3": BASE | {"physics", "simulation", "game", "tasks", "envs"},
    "match": {"_install", "_types", "envs", "tasks"},
    "widget": {"_check", "_install", "replays"},
    "play": BASE | {"physics", "shot", "simulation", "game", "tasks", "planning", "advice", "render", "replays"},
    "benchmark": BASE
    | {"physics", "simulation", "game", "tasks", "planning", "advice", "envs", "play", "progress", "_warmup", "__version__"},
    "_warmup": {"_jit", "_notices", "impacts", "simulation", "game", "tasks", "planning", "envs"},
    "__init__": BASE | {"physics", "impacts", "shot", "simulation", "tasks", "planning", "advice", "envs", "match", "replays"},
}
ALLOWED["__init__"] |= {"_warmup", "_registration"}
OUTSIDE = {
    "gymnasium": {"benchmark", "envs", "tasks", "__init__", "sb3", "replays"},
    "pygame": {"render"},
    "matplotlib": {"render"},
    "pettingzoo": {"envs"},
    "imageio_ffmpeg": {"replays"},
    "anywidget": {"widget"},
    "traitlets": {"widget"},
    "llvmlite": {"_lanes"},
}
OUTSIDE |= {name: {"play"} for name in ("hmac", "http", "secrets", "socket", "urllib", "webbrowser")}  # the network, as well
OUTSIDE |= {name: {"benchmark"} for name in ("datetime", "platform", "queue", "shlex")}
OUTSIDE |= {"stable_baselines3": {"sb3", "tasks"}, "sb3_contrib": {"tasks"}, "torch": {"tasks"}}
"""Who may import these libraries; of any library that is named neither here nor in ALWAYS, nobody."""
ALWAYS = {"numpy", "numba"}
STANDARD = {
    "__future__", "abc", "argparse", "base64", "collections", "concurrent", "contextlib", "copy", "dataclasses", "enum", "functools",
    "hashlib", "html", "importlib", "io", "itertools", "json", "math", "operator", "os", "pathlib", "re", "subprocess", "sys", "tempfile",
    "shutil", "statistics", "textwrap", "threading", "time", "types", "typing", "warnings", "weakref", "zipfile", "zlib",
}  # fmt: skip


def part_of(name):
    """Which layer a file belongs to: its folder, or itself at the top."""
    head = name.split("/")[0]
    return head.removesuffix(".py")


def imports(name):
    """All imports of a file: (dotted target, does it run when the file is imported?). Targets inside the package start with a dot."""
    tree = ast.parse((PACKAGE / name).read_text())
    here = ["snooker_env", *name.split("/")[:-1]]
    lazy = {id(inner) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) for inner in ast.walk(node)}
    for node in ast.walk(tree):  # what only a type checker reads never runs
        if isinstance(node, ast.If) and ast.unparse(node.test).removeprefix("_typing.") == "TYPE_CHECKING":
            lazy |= {id(inner) for statement in node.body for inner in ast.walk(statement)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, id(node) not in lazy) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            folder = PACKAGE.parent / stem.replace(".", "/")
            # ``from .physics import cue`` names a module, ``from .physics.cue import strike`` a thing in one
            inside = [f"{stem}.{a.name}" for a in node.names] if folder.is_dir() and stem.startswith("snooker_env") else [stem]
            found += [(target, id(node) not in lazy) for target in inside]
    return [("." + t.removeprefix("snooker_env").lstrip(".") if t.split(".")[0] == "snooker_env" else t, top) for t, top in found]


def test_the_reader_of_imports_sees_every_kind():
    seen = dict(imports("tasks/stroke.py"))
    assert seen[".physics.cue"] and seen[".tasks.noise"] and seen["numpy"]
    assert dict(imports("envs/pictures.py"))[".render.pygame_view"] is False
    assert dict(imports("render/pygame_library.py"))["pygame"] is False
    assert dict(imports("tasks/stroke.py"))[".tasks.options"] is False  # for type checkers alone
    assert dict(imports("__init__.py"))[".physics.engine"]
    assert len(FILES) > 25


@pytest.mark.parametrize("name", NAMES)
def test_each_file_imports_only_what_stands_above_it(name):
    part = part_of(name)
    assert part in ALLOWED, f"{name} belongs to no layer of the plan"
    for target, _ in imports(name):
        if target.startswith("."):
            inner = target[1:]
            allowed = ALLOWED[part]
            fine = inner.split(".")[0] in allowed | {part} or any(inner == a or inner.startswith(a + ".") for a in allowed)
            assert fine, f"{name} imports {inner}; {part} may import {sorted(allowed)}"


@pytest.mark.parametrize("name", NAMES)
def test_each_file_imports_only_libraries_that_are_its_business(name):
    part = part_of(name)
    for target, top in imports(name):
        if target.startswith("."):
            continue
        library = target.split(".")[0]
        if library in ALWAYS | STANDARD:
            continue
        assert part in OUTSIDE.get(library, ()), f"{name} imports {library}"
        if (
            library in ("pygame", "matplotlib", "stable_baselines3", "sb3_contrib", "torch") and part != "sb3"
        ):  # sb3.py itself is only loaded when it is wanted
            assert not top, f"{name} imports {library} when it is imported, not when it is wanted"


LATE = {"shot": (".render",), "envs": (".render", ".planning", ".replays"), "_warmup": (".planning", ".envs")}
"""What these parts import only when it is asked for."""


@pytest.mark.parametrize("name", [n for n in NAMES if part_of(n) in LATE])
def test_pictures_planning_and_environments_are_loaded_only_when_asked(name):
    assert not [t for t, top in imports(name) if top and t.startswith(LATE[part_of(name)])]


def test_no_two_files_of_the_package_import_each_other():
    """No cycle among the imports that run when the package is imported."""
    modules = {"." + n.removesuffix(".py").removesuffix("/__init__").replace("/", "."): n for n in NAMES}

    def module_of(target):
        while target not in modules and "." in target[1:]:
            target = target.rpartition(".")[0]
        return modules.get(target)

    graph = {n: {module_of(t) for t, top in imports(n) if top and t.startswith(".")} - {None, n} for n in NAMES}
    graph = {n: {t for t in targets if not t.endswith("__init__.py")} for n, targets in graph.items()}
    done = set()

    def visit(name, trail):
        assert name not in trail, " -> ".join([*trail, name])
        if name not in done:
            for target in graph[name]:
                visit(target, (*trail, name))
            done.add(name)

    for name in NAMES:
        visit(name, ())
    assert "physics/engine.py" in graph["simulation.py"]


@pytest.mark.parametrize("name", NAMES)
def test_each_file_says_first_which_question_it_answers(name):
    docstring = ast.get_docstring(ast.parse((PACKAGE / name).read_text()))
    assert docstring, f"{name} has no docstring"
    first = docstring.splitlines()[0]
    if name.endswith("__init__.py"):  # a folder says what it holds
        assert len(first) > 20
    else:
        question, mark, rest = first.partition("?")
        assert mark and len(question.split()) >= 3, f"{name} starts with {first!r}, not with the question that it answers"
        assert question[0].isupper() and rest.strip(), f"{name} has the question {question!r}, but does not say more on the line"


@pytest.mark.parametrize("name", NAMES)
def test_no_file_is_too_long_to_read(name):
    text = (PACKAGE / name).read_text()
    assert len(text.splitlines()) <= 400
    assert not {"TODO", "FIXME", "XXX"} & set(text.split())


# What one layer takes for granted of another.


@pytest.mark.parametrize("name", ["match", "tight"])
def test_wherever_a_layout_may_put_a_ball_the_table_of_the_physics_has_room(name):
    x, y = np.meshgrid(np.linspace(-0.9, 0.9, 61), np.linspace(-1.8, 1.8, 121))
    places = np.column_stack([x.ravel(), y.ravel()])
    room = np.array([geometry.HALF_WIDTH, geometry.HALF_LENGTH]) - geometry.BALL_RADIUS - layouts.CUSHION_GAP
    clear = np.all(np.abs(places) <= room, axis=1)
    clear &= np.all(np.hypot(*(places[:, None] - geometry.POCKET_PLACES).transpose(2, 0, 1)) >= layouts.POCKET_GAP, axis=1)
    assert clear.sum() > 5000
    Table.preset(name).check(places[clear][:, None], geometry.BALL_RADIUS)  # each by itself


def test_touching_and_overlapping_are_measured_alike():
    assert balls.TOUCH == table.OVERLAP_ALLOWED == 1e-6
    assert spotting.CLEARANCE is in_hand.CLEARANCE is balls.CLEARANCE  # of every ball that a hand puts down
    assert layouts.GAP > balls.PINK_GAP > balls.CLEARANCE > balls.REFEREE_TOUCH > balls.TOUCH


def test_actions_reach_to_the_miscue_limit_of_the_physics():
    """Half a radius at the end of the action's scale is what ``Physics.max_offset`` allows by default."""
    actions = Actions("absolute", False, False, Physics())
    assert actions.shot([0, 1, 0, 0], balls.SPOTS, np.ones(22, bool), 2)[1] == actions.physics.max_offset == 0.5


def test_observations_have_a_row_for_each_ball_and_an_entry_for_each_thing_on():
    kinds = observations.STATE_ENTRIES[1:9]
    assert kinds == tuple(b.name.lower() for b in balls.BallOn if b >= 0)
    assert observations.space("flat").shape == (balls.N_BALLS * len(observations.BALL_COLUMNS) + len(observations.STATE_ENTRIES),)
    assert balls.NAMES[16:] == balls.COLOUR_NAMES and len(balls.NAMES) == balls.N_BALLS == len(balls.VALUES) == len(balls.SPOTS)


def test_physics_packs_every_field_that_a_kernel_needs_in_its_place():
    """Each field changed alone moves exactly its own places of the vector."""
    from snooker_env.physics import parameters as p

    places = {
        "R": [p.P_R], "M": [p.P_M], "g": [p.P_G], "mu_s": [p.P_MU_S], "mu_r": [p.P_MU_R], "spin_decel": [p.P_SPIN], "e_b": [p.P_E_B],
        "e_c": [p.P_E_C], "e_c_knee": [p.P_E_KNEE], "e_c_power": [p.P_E_POWER], "e_j": [p.P_E_J], "mu_c": [p.P_MU_C],
        "sin_theta": [p.P_SIN], "nap": [p.P_NAP], "end_mass_ratio": [], "max_offset": [],
    }  # fmt: skip
    base = Physics(e_c_knee=1.0, e_j=0.9)  # where the power may be changed, and a jaw has a restitution of its own
    for field in dataclasses.fields(Physics):
        if field.name == "mu_bb":
            continue
        value = getattr(base, field.name) + 1e-3
        changed = dataclasses.replace(base, **{field.name: value}).pack()
        assert np.flatnonzero(changed != base.pack()).tolist() == places[field.name], field.name
        for k in places[field.name]:
            assert changed[k] == value
    assert Physics(e_c=0.7).pack()[p.P_E_J] == 0.7
    law = [p.P_MU_BB_LEAST, p.P_MU_BB_EXTRA, p.P_MU_BB_FADE]
    assert Physics(mu_bb=(0.01, 0.1, 2.0)).pack()[law].tolist() == [0.01, 0.1, 2.0]
    assert Physics(mu_bb=0.07).pack()[law].tolist() == [0.07, 0.0, 0.0]
    assert Physics(mu_bb="marlow").pack()[law].tolist() == list(p.MARLOW)
