"""How does a page list every public name of a module? ``.. public:: snooker_env.game`` documents what is in
its ``__all__``, constants too.

``:only: NAME ...`` takes some of the names, ``:but: NAME ...`` leaves some out. A name that is another public
module's too is documented there, and here linked to it. Constants have the text that stands below their
assignment.
"""

import ast
import importlib
import inspect
import re
from functools import cache
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList
from sphinx.ext.napoleon import NumpyDocstring

PACKAGE = Path(__file__).resolve().parents[2] / "snooker_env"
SHORT = 90
"""Characters of a constant's value that are shown."""


@cache
def modules():
    """The public modules that the package names in its docstring, the deepest first, the package itself
    last."""
    import snooker_env

    named = re.findall(r"^\* ``(snooker_env[.\w]*)``", str(snooker_env.__doc__), re.MULTILINE)
    return (*sorted(named, key=lambda name: (-name.count("."), name)), "snooker_env")


def home_of(module, name):
    """The public module that documents a name of ``module``: another one, if it has the same thing under the
    same name."""
    thing = getattr(importlib.import_module(module), name)
    for other in modules():
        found = importlib.import_module(other)
        if other != module and name in found.__all__ and getattr(found, name) is thing:
            return min((other, module), key=modules().index)
    return module


@cache
def texts():
    """Module -> constant -> the text below its assignment, of every file of the package."""
    out = {}
    for path in PACKAGE.rglob("*.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        own = out[
            ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        ] = {}
        for node, below in zip(body, [*body[1:], None], strict=True):
            targets = (
                node.targets
                if isinstance(node, ast.Assign)
                else [node.target]
                if isinstance(node, ast.AnnAssign)
                else []
            )
            text = (
                below.value if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) else None
            )
            for target in targets:
                for name in target.elts if isinstance(target, ast.Tuple) else [target]:
                    if isinstance(name, ast.Name):
                        own[name.id] = (
                            inspect.cleandoc(text.value)
                            if text is not None and isinstance(text.value, str)
                            else ""
                        )
        for node in body:  # names that are handed on, under their own name or another
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    package = out_of(path, node)
                    own.setdefault(alias.asname or alias.name, (package, alias.name))
    return out


def out_of(path, node):
    """The module that an import in a file names."""
    if not node.level:
        return node.module
    here = list(path.relative_to(PACKAGE.parent).parent.parts)
    base = here[: len(here) - node.level + 1]
    return ".".join([*base, *([node.module] if node.module else [])])


def text_of(module, name):
    """The text of a constant, wherever the package defines it."""
    found = texts().get(module, {}).get(name, "")
    return text_of(*found) if isinstance(found, tuple) else found


def kind_of(thing):
    """What a name is: "module", "class", "function", "kernel" or "data"."""
    if inspect.ismodule(thing):
        return "module"
    if inspect.isclass(thing):
        return "class"
    if inspect.isfunction(thing):
        return "function"
    return (
        "kernel"
        if callable(thing) and (hasattr(thing, "py_func") or hasattr(thing, "__wrapped__"))
        else "data"
    )


def kernel_of(thing):
    """The plain function of a compiled one."""
    while hasattr(thing, "py_func") or hasattr(thing, "__wrapped__"):
        thing = getattr(thing, "py_func", None) or thing.__wrapped__
    return thing


def entry(module, name, config):
    """The lines that document a name."""
    thing, full = getattr(importlib.import_module(module), name), f"{module}.{name}"
    home, kind = home_of(module, name), kind_of(thing)
    if kind == "module":
        return [f":py:mod:`{full}`: see its own page.", ""]
    if home != module:
        role = {"class": "py:class", "data": "py:data"}.get(kind, "py:func")
        return [f":{role}:`{name} <{home}.{name}>`: see ``{home}``.", ""]
    if kind == "class":
        others = sorted(
            {base.__name__ for base in thing.__mro__ if not base.__module__.startswith("snooker_env")}
        )
        # of its own bases alone
        return [f".. autoclass:: {full}", "   :members:", f"   :inherited-members: {', '.join(others)}", ""]
    if kind == "function":
        return [f".. autofunction:: {full}", ""]
    if kind == "kernel":
        plain = kernel_of(thing)
        lines = NumpyDocstring(inspect.getdoc(plain) or "", config, what="function").lines()
        return [
            f".. py:function:: {full}{inspect.signature(plain)}",
            "",
            *(f"   {line}" for line in lines),
            "",
        ]
    shown = repr(thing)
    value = (
        [f"   :value: {shown}"] if len(shown) <= SHORT and "\n" not in shown and " at 0x" not in shown else []
    )
    return [
        f".. py:data:: {full}",
        *value,
        "",
        *(f"   {line}" for line in text_of(module, name).splitlines()),
        "",
    ]


class Public(Directive):
    """``.. public:: MODULE``."""

    required_arguments = 1
    option_spec = {"only": str.split, "but": str.split}  # noqa: RUF012 - docutils' own convention
    has_content = False

    def run(self):
        """The nodes: classes first, then functions, then constants, each in the order of ``__all__``."""
        module = self.arguments[0]
        names = importlib.import_module(module).__all__
        for wrong in {*self.options.get("only", ()), *self.options.get("but", ())} - set(names):
            raise self.error(f"{module} has no public name {wrong}")
        chosen = [name for name in self.options.get("only", names) if name not in self.options.get("but", ())]
        if "only" not in self.options:
            order = ("module", "class", "function", "kernel", "data")
            chosen.sort(key=lambda name: order.index(kind_of(getattr(importlib.import_module(module), name))))
        config = self.state.document.settings.env.config
        lines = [line for name in chosen for line in entry(module, name, config)]
        node = nodes.container()
        self.state.nested_parse(StringList(lines, source=module), self.content_offset, node)
        return node.children


def setup(app):
    """Register with Sphinx."""
    app.add_directive("public", Public)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
