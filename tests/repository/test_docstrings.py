"""Is every public name documented as numpy does it?"""

import ast
import dataclasses
import enum
import importlib
import inspect
import re
import textwrap

import pytest

from tests.processes import ROOT
from tests.repository.test_public_names import ALL

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
    return [
        stars.get(p.kind, "") + name
        for name, p in every
        if name not in ("self", "cls") and not name.startswith("_")
    ]


def returns(thing):
    """Whether a function gives anything back, by its annotation or its source."""
    annotation = inspect.signature(thing).return_annotation
    if annotation is not inspect.Signature.empty:
        return annotation not in (None, "None")
    body = ast.parse(textwrap.dedent(inspect.getsource(thing)))
    return any(isinstance(node, ast.Return) and node.value is not None for node in ast.walk(body))


def text_faults(text, *, example):
    """What is wrong with a docstring's first line and its example."""
    if not text.splitlines()[0].endswith((".", "?")):
        yield f"begins with {text.splitlines()[0]!r}, not with a sentence on one line"
    if example and ">>> " not in sections(text).get("Examples", ""):
        yield "has no example"


def function_faults(thing, *, example):
    """What a function's docstring lacks."""
    text = inspect.getdoc(plain(thing))
    if not text:
        yield "has no docstring"
        return
    yield from text_faults(text, example=example)
    parts = sections(text)
    if entries(parts.get("Parameters", "")) != parameters(thing):
        yield f"has Parameters {entries(parts.get('Parameters', ''))}, its signature {parameters(thing)}"
    if returns(plain(thing)) and not {"Returns", "Yields"} & set(parts):
        yield "does not say what it returns"


def class_faults(thing):
    """What a class's docstring lacks, and those of its public methods and properties."""
    if not thing.__doc__:
        yield "has no docstring"
        return
    text = inspect.cleandoc(thing.__doc__)
    yield from text_faults(text, example=not issubclass(thing, BaseException))
    parts = sections(text)
    described = [*entries(parts.get("Parameters", "")), *entries(parts.get("Attributes", ""))]
    wanted = []
    if issubclass(thing, enum.Enum):
        described, wanted = re.findall(r"\w+", text), list(thing.__members__)
    elif dataclasses.is_dataclass(thing) or hasattr(thing, "_fields"):
        fields = (
            [f.name for f in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else thing._fields
        )
        wanted = [*parameters(thing), *(name for name in fields if not name.startswith("_"))]
    elif (
        "__init__" in vars(thing)
        and not issubclass(thing, BaseException)
        and not getattr(thing, "_is_protocol", False)
    ):
        wanted = parameters(thing.__init__)
    if missing := set(wanted) - set(described):
        yield f"does not describe {sorted(missing)}"
    for name, member in vars(thing).items():
        if name.startswith("_") or (issubclass(thing, enum.Enum) and name in thing.__members__):
            continue
        if isinstance(member, property) or (
            inspect.isfunction(plain(member)) and plain(member).__module__.startswith("snooker_env")
        ):
            yield from () if inspect.getdoc(member) else [f".{name} has no docstring"]


def explained(module, name):
    """The words that stand below a constant where it is made, followed through imports."""
    path = ROOT / (module.replace(".", "/") + ".py")
    path = path if path.is_file() else ROOT / module.replace(".", "/") / "__init__.py"
    body = ast.parse(path.read_text(encoding="utf-8")).body
    for k, node in enumerate(body):
        targets = getattr(node, "targets", [getattr(node, "target", None)])
        if name in {
            part.id for target in targets if target for part in ast.walk(target) if isinstance(part, ast.Name)
        }:
            words = getattr(body[k + 1], "value", None) if k + 1 < len(body) else None
            return words.value if isinstance(words, ast.Constant) and isinstance(words.value, str) else None
        for alias in node.names if isinstance(node, ast.ImportFrom) else ():
            if (alias.asname or alias.name) == name:
                package = module if path.name == "__init__.py" else module.rpartition(".")[0]
                base = package.split(".")[: len(package.split(".")) + 1 - node.level] if node.level else []
                return explained(".".join([*base, *filter(None, [node.module])]), alias.name)
    return None


def faults(module, name):
    """What is wrong with the documentation of a public name."""
    thing = getattr(importlib.import_module(module), name)
    if inspect.ismodule(thing):
        return [] if inspect.getdoc(thing) else ["has no docstring"]
    if inspect.isclass(thing):
        return list(class_faults(thing))
    if callable(thing) and inspect.isfunction(plain(thing)):
        inner = type(thing).__name__ == "Inner"  # only kernels can call it, so no example can
        return list(function_faults(thing, example=not inner))
    return [] if explained(module, name) else ["is a constant without words below it"]


@pytest.mark.parametrize(("module", "name"), NAMES, ids=[f"{module}.{name}" for module, name in NAMES])
def test_each_public_name_is_documented_as_numpy_does_it(module, name):
    assert faults(module, name) == []
