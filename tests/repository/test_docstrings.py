"""Is every public name documented as numpy does it? Summary, parameters in the signature's order, what is returned, raised, an example."""

import ast
import dataclasses
import enum
import importlib
import inspect
import re
import textwrap
from pathlib import Path

import pytest

import snooker_env
from tests.repository.test_public_names import ALL

ROOT = Path(snooker_env.__file__).resolve().parents[1]
SECTIONS = ["Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns", "See Also", "Notes", "References", "Examples"]
"""In numpydoc's order; a docstring may leave some out."""
CHECKS = {"number", "integer", "array", "choice", "truth", "flags", "parse_fidelity"}
"""Functions that refuse bad input: a function that calls one of them can raise ``ValueError``."""


def sections(text):
    """Heading -> the lines below it; the lines before the first heading are under ""."""
    lines, found, current = text.splitlines(), {"": []}, ""
    for k, line in enumerate(lines):
        below = lines[k + 1] if k + 1 < len(lines) else ""
        if line.strip() and re.fullmatch(r"-{3,}", below):
            assert line in SECTIONS, f"{line!r} is no section of numpydoc"
            assert len(below) == len(line), f"the line below {line!r} has not its length"
            assert line not in found, f"{line!r} comes twice"
            current = line
            found[current] = []
        elif not (re.fullmatch(r"-{3,}", line) and current and not found[current]):
            found[current].append(line)
    headings = [heading for heading in found if heading]
    assert headings == sorted(headings, key=SECTIONS.index), f"sections in the order {headings}"
    return found


def entries(lines):
    """Name -> its description, of a section such as Parameters; ``a, b : float`` are two names."""
    found, names = {}, []
    for line in lines:
        if line.strip() and not line[0].isspace():
            names = [name.strip() for name in line.split(" : ")[0].split(",")]
            found |= {name: line.partition(" : ")[2] for name in names}
        elif line.strip():
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
    return found


def plain(thing):
    """The function below a kernel, a class method or a cache."""
    thing = getattr(thing, "__func__", thing)
    return inspect.unwrap(getattr(thing, "py_func", thing))


def parameters(thing):
    """The names of a function's parameters, with their stars, without the receiver."""
    stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    given = inspect.signature(plain(thing)).parameters
    return [stars.get(p.kind, "") + name for name, p in given.items() if name not in ("self", "cls") and not name.startswith("_")]


def may_refuse(function):
    """Does it raise an error, or call a check that does? Read from its source."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    calls = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    return bool(calls & CHECKS) or any(isinstance(node, ast.Raise) for node in ast.walk(tree))


def summary_faults(text):
    """What is wrong with the first line."""
    lines = text.splitlines()
    if not lines[0].endswith((".", "?")) or (len(lines) > 1 and lines[1].strip()):
        yield f"must begin with a summary of one line and a full stop, not {lines[0]!r}"


def silent(written):
    """Names without words, in what ``entries`` returned."""
    yield from (f"says nothing of {name}" for name, words in written.items() if not words.strip())


def function_faults(thing, *, example):
    """What a function's docstring lacks."""
    text = inspect.getdoc(plain(thing))
    if not text:
        yield "has no docstring"
        return
    yield from summary_faults(text)
    found, names = sections(text), parameters(thing)
    written = entries(found.get("Parameters", []))
    if list(written) != names:
        yield f"has Parameters {list(written)}, its signature {names}"
    yield from silent(written)
    returned = inspect.signature(plain(thing)).return_annotation
    body = ast.parse(textwrap.dedent(inspect.getsource(plain(thing))))
    gives = returned not in (None, "None", inspect.Signature.empty) or any(
        isinstance(node, ast.Return) and node.value is not None for node in ast.walk(body)
    )
    if gives and not {"Returns", "Yields"} & set(found):
        yield "does not say what it returns"
    if may_refuse(plain(thing)) and "Raises" not in found:
        yield "does not say what it raises"
    if example and ">>> " not in "\n".join(found.get("Examples", [])):
        yield "has no example"


def record_faults(thing, found):
    """What is wrong with the parameters and attributes of a dataclass or a named tuple: each field is to be documented once."""
    fields = [f.name for f in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else thing._fields
    given, kept = entries(found.get("Parameters", [])), entries(found.get("Attributes", []))
    yield from silent(given | kept)
    given, kept = list(given), list(kept)
    others = [name for name in fields if not name.startswith("_") and name not in given]
    signature = list(inspect.signature(thing).parameters)
    if given and given != signature:
        yield f"has Parameters {given}, its signature {signature}"
    if kept != others:
        yield f"has Attributes {kept}, its other fields are {others}"


def class_faults(thing, *, example):
    """What a class's docstring lacks, and those of its public methods and properties."""
    text = thing.__doc__
    if not text:
        yield "has no docstring"
        return
    text = inspect.cleandoc(text)
    yield from summary_faults(text)
    found = sections(text)
    if issubclass(thing, enum.Enum):
        for member in thing.__members__:
            if not re.search(rf"\b{member}\b", text):
                yield f"does not explain {member}"
    elif dataclasses.is_dataclass(thing) or hasattr(thing, "_fields"):
        yield from record_faults(thing, found)
    elif "__init__" in vars(thing) and not issubclass(thing, BaseException):
        written, names = entries(found.get("Parameters", [])), parameters(thing.__init__)
        yield from silent(written)
        if list(written) != names:
            yield f"has Parameters {list(written)}, its signature {names}"
        if may_refuse(thing.__init__) and "Raises" not in found:
            yield "does not say what it raises"
    if example and not issubclass(thing, BaseException) and ">>> " not in "\n".join(found.get("Examples", [])):
        yield "has no example"
    for name, member in vars(thing).items():
        if name.startswith("_") or (issubclass(thing, enum.Enum) and name in thing.__members__):
            continue
        if isinstance(member, property):
            words = inspect.getdoc(member)
            faults = summary_faults(words) if words else ["has no docstring"]
        elif inspect.isfunction(plain(member)) and plain(member).__module__.startswith("snooker_env"):
            faults = function_faults(member, example=False)
        else:
            continue
        yield from (f".{name} {fault}" for fault in faults)


def explained(module, name):
    """The words that stand below a constant where it is made, followed through imports; None if there are none."""
    path = ROOT / (module.replace(".", "/") + ".py")
    path = path if path.is_file() else ROOT / module.replace(".", "/") / "__init__.py"
    body = ast.parse(path.read_text(encoding="utf-8")).body
    for k, node in enumerate(body):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        named = {part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)}
        if name in named:
            below = body[k + 1] if k + 1 < len(body) else None
            words = below.value if isinstance(below, ast.Expr) else None
            return words.value if isinstance(words, ast.Constant) and isinstance(words.value, str) else None
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
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
        return list(class_faults(thing, example=True))
    if callable(thing) and inspect.isfunction(plain(thing)):
        inner = type(thing).__name__ == "Inner"  # only kernels can call it, so no example can
        return list(function_faults(thing, example=not inner))
    return [] if explained(module, name) else ["is a constant without words below it"]


NAMES = sorted({(module, name) for module, names in ALL.items() for name in names})


@pytest.mark.parametrize(("module", "name"), NAMES, ids=[f"{module}.{name}" for module, name in NAMES])
def test_each_public_name_is_documented_as_numpy_does_it(module, name):
    assert faults(module, name) == []


def sample(a, b=1, **more):
    """Add up.

    Parameters
    ----------
    a, b : int
        Terms.
    **more
        Other terms.

    Returns
    -------
    int

    Raises
    ------
    ValueError
        If a is negative.

    Examples
    --------
    >>> sample(1)
    2
    """
    if a < 0:
        raise ValueError(a)
    return a + b + sum(more.values())


WRONG = {
    "summary of one line": ("Add up.", "Add up"),
    "its signature": ("a, b : int", "b, a : int"),
    "Parameters": ("**more", "more"),
    "says nothing of a": (" : int\n    Terms.", ""),
    "what it returns": ("Returns\n-------\nint\n\n", ""),
    "what it raises": ("Raises\n------\nValueError\n    If a is negative.\n\n", ""),
    "no example": (">>> sample(1)\n2", "sample(1)"),
}


def test_a_sound_docstring_has_no_faults():
    assert list(function_faults(sample, example=True)) == []


@pytest.mark.parametrize("fault", WRONG)
def test_each_fault_of_a_docstring_is_found(monkeypatch, fault):
    text, (old, new) = inspect.getdoc(sample), WRONG[fault]
    assert text.count(old) == 1
    monkeypatch.setattr(sample, "__doc__", text.replace(old, new))
    found = list(function_faults(sample, example=True))
    assert found and any(fault in words for words in found)


BROKEN = {"Raises\n------": "Throws\n------", "Returns\n-------": "Returns\n------", "Examples\n--------": "Attributes\n----------"}


@pytest.mark.parametrize("old", BROKEN)
def test_sections_that_numpydoc_does_not_have_there_are_found(old):
    text = inspect.getdoc(sample)
    assert list(sections(text)) == ["", "Parameters", "Returns", "Raises", "Examples"]
    with pytest.raises(AssertionError):
        sections(text.replace(old, BROKEN[old]))


@dataclasses.dataclass
class Sample:
    """Two numbers.

    Parameters
    ----------
    a : int
        A number.

    Attributes
    ----------
    b : int
        Another one.
    """

    a: int
    b: int = dataclasses.field(init=False)


FIELDS = [
    ("a : int", "c : int"), ("b : int", "a : int"), ("Attributes\n----------", "Notes\n-----"),
    (" : int\n    A number.", ""), (" : int\n    Another one.", ""),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new"), FIELDS)
def test_the_fields_of_a_dataclass_are_documented_once(old, new):
    text = inspect.getdoc(Sample)
    assert list(record_faults(Sample, sections(text))) == []
    assert list(record_faults(Sample, sections(text.replace(old, new)))) != []


def test_the_words_of_a_constant_are_found_through_imports():
    assert explained("snooker_env", "POCKETS").startswith("Names of the pockets")
    assert explained("snooker_env.game", "VALUES") == explained("snooker_env.game.balls", "VALUES") is not None
    assert explained("snooker_env.game.balls", "_BITS") is None and explained("snooker_env.game.balls", "NOWHERE") is None
