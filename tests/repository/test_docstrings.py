"""Is every public name documented as numpy does it: parameters as in the signature, what is returned, an example?"""

import ast
import dataclasses
import importlib
import inspect
import re
from itertools import pairwise

import pytest

from tests.processes import ROOT
from tests.repository.test_public_names import ALL

BODIES = [ast.parse(p.read_text(encoding="utf-8")).body for p in (ROOT / "snooker_env").rglob("*.py")]
EXPLAINED = {
    name.id
    for body in BODIES
    for node, below in pairwise(body)
    if isinstance(node, ast.Assign | ast.AnnAssign)
    and isinstance(getattr(below, "value", None), ast.Constant)
    for name in ast.walk(node)
    if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
}
"""The constants that have words below them where they are made."""
IMPORTS = [node for body in BODIES for node in body if isinstance(node, ast.ImportFrom)]
EXPLAINED |= {alias.asname for node in IMPORTS for alias in node.names if alias.name in EXPLAINED}
NAMES = sorted({(module, name) for module, names in ALL.items() for name in names})


def sections(text):
    """Heading -> the text below it; the text before the first heading is under ""."""
    first, *parts = re.split(r"^(\w[\w ]*)\n-{3,}$", text, flags=re.MULTILINE)
    return {"": first} | dict(zip(parts[::2], parts[1::2], strict=True))


def entries(text):
    """The names that a section such as Parameters describes, in order; ``a, b : float`` are two names."""
    lines = re.findall(r"^([*\w][\w*, ]*)(?: : .*)?\n(?= +\S)", text + "\n", re.MULTILINE)
    return [name.strip() for line in lines for name in line.split(",")]


def plain(thing):
    """The function below a kernel, a class method or a cache."""
    thing = getattr(thing, "__func__", thing)
    return inspect.unwrap(getattr(thing, "py_func", thing))


def parameters(thing):
    """The names of a function's parameters, with their stars, without the receiver."""
    stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    every = inspect.signature(plain(thing)).parameters.items()
    names = [(stars.get(p.kind, ""), name) for name, p in every if name not in ("self", "cls")]
    return [star + name for star, name in names if not name.startswith("_")]


def class_faults(thing, parts):
    """What a class's docstring lacks, and those of its public methods and properties."""
    described = entries(parts.get("Parameters", "")) + entries(parts.get("Attributes", ""))
    wanted = []
    if members := getattr(thing, "__members__", ()):
        described, wanted = re.findall(r"\w+", thing.__doc__), list(members)
    elif dataclasses.is_dataclass(thing) or hasattr(thing, "_fields"):
        fields = getattr(thing, "_fields", None) or [field.name for field in dataclasses.fields(thing)]
        wanted = [*parameters(thing), *(name for name in fields if not name.startswith("_"))]
    elif "__init__" in vars(thing) and not issubclass(thing, BaseException):
        wanted = [] if getattr(thing, "_is_protocol", False) else parameters(thing.__init__)
    if missing := set(wanted) - set(described):
        yield f"does not describe {sorted(missing)}"
    for name, member in vars(thing).items():
        ours = inspect.isfunction(plain(member)) and plain(member).__module__.startswith("snooker_env")
        if not name.startswith("_") and (ours or isinstance(member, property)) and not inspect.getdoc(member):
            yield f".{name} has no docstring"


def faults(module, name):
    """What is wrong with the documentation of a public name."""
    thing = getattr(importlib.import_module(module), name)
    function = callable(thing) and inspect.isfunction(plain(thing))
    if not (function or inspect.isclass(thing) or inspect.ismodule(thing)):
        return [] if name in EXPLAINED else ["is a constant without words below it"]
    text = inspect.cleandoc((plain(thing) if function else thing).__doc__ or "")
    if not text or inspect.ismodule(thing):
        return [] if text else ["has no docstring"]
    parts = sections(text)
    direct = [] if function else list(class_faults(thing, parts))
    # only kernels can call an inner kernel, so no example can
    exempt = type(thing).__name__ == "Inner" or (not function and issubclass(thing, BaseException))
    if not exempt and ">>> " not in parts.get("Examples", ""):
        direct.append("has no example")
    if function and entries(parts.get("Parameters", "")) != parameters(thing):
        direct.append(f"has Parameters {entries(parts.get('Parameters', ''))}, not {parameters(thing)}")
    returned = inspect.signature(plain(thing)).return_annotation if function else None
    if returned not in (None, "None", inspect.Signature.empty) and not {"Returns", "Yields"} & set(parts):
        direct.append("does not say what it returns")
    return direct


@pytest.mark.parametrize(("module", "name"), NAMES, ids=[f"{module}.{name}" for module, name in NAMES])
def test_each_public_name_is_there_once_and_documented_as_numpy_does_it(module, name):
    assert faults(module, name) == [] and ALL[module].count(name) == 1
