"""How heavy is the house? ``python -m tests.repository.weight [COMMIT] [--names]`` counts lines, words and names.

It reads the files that git knows here and, given a COMMIT, those of that commit beside them ("then -> now").
A function's lines are those from ``def`` to its end. Its arguments are all that have a name, ``self`` included.
A participle is guessed from the last word of a function's name: what ends in -ed or -en, and a list of irregulars.
"""

import argparse
import ast
import io
import json
import re
import subprocess
import tarfile
from collections import Counter
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parents[2]
ROOMS = ("package", "agents + train.py", "other code", "tests")
ALL = "all but tests"
WEB = (".js", ".css", ".html")
TEXTS = (".md", ".rst", ".ipynb")
LONG, MANY = 80, 8
PARTICIPLE = re.compile(
    r"bent|bought|brought|built|caught|done|drawn|fed|felt|flown|found|gone|grown|heard|held|hung|kept|known|laid|led|left"
    r"|lost|made|meant|met|paid|said|sent|shown|sold|spent|spun|struck|stuck|sunk|taught|thought|thrown|told|torn|won|worn"
    r"|(?!(bed|between|even|feed|len|listen|need|open|red|screen|seed|speed|ten|then|token|when)$).*(ed|en)"
)


def files_of(commit: str | None = None) -> dict[str, str]:
    """Each file's text by its path: of the working tree, or of a commit."""
    if commit:
        packed = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True).stdout
        with tarfile.open(fileobj=io.BytesIO(packed)) as tar:
            return {m.name: tar.extractfile(m).read().decode() for m in tar if m.isfile() and _counts(m.name)}
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True).stdout.decode().split("\0")
    return {
        name: (ROOT / name).read_text("utf-8") for name in names if _counts(name) and (ROOT / name).is_file()
    }


def _counts(name):
    return name.endswith((".py", *WEB, *TEXTS))


def room_of(path: str) -> str:
    """One of ``ROOMS``; what lies in no other is other code."""
    tops = {"snooker_env": ROOMS[0], "agents": ROOMS[1], "train.py": ROOMS[1], "tests": ROOMS[3]}
    return tops.get(path.partition("/")[0], ROOMS[2])


def weigh(files: dict[str, str]) -> dict[str, dict[str, int | list[str]]]:
    """What each room weighs: by measure, a number or the names that are counted."""
    rooms = {room: {p: text for p, text in files.items() if room_of(p) == room} for room in ROOMS}
    rooms[ALL] = {p: text for p, text in files.items() if room_of(p) != "tests"}
    return {room: _room(inside) for room, inside in rooms.items()}


def _room(files):
    modules = {path: text for path, text in files.items() if path.endswith(".py")}
    nodes = [(path, node) for path, text in modules.items() for node in _nodes(text)]
    functions = [(path, n) for path, n in nodes if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    named = [(f"{path}:{n.name}", n) for path, n in functions]
    inner = [
        PurePosixPath(path).name for path in modules if not path.endswith(("__init__.py", "__main__.py"))
    ]
    return {
        "lines": sum(text.count("\n") for text in modules.values()),
        "files": len(modules),
        "lines of web files": sum(t.count("\n") for path, t in files.items() if path.endswith(WEB)),
        "words of documents": sum(_words(path, text) for path, text in files.items() if path.endswith(TEXTS)),
        "`: Any`": sum(len(re.findall(r": Any\b", text)) for text in modules.values()),
        "`noqa: E731`": sum(text.count("noqa: E731") for text in modules.values()),
        f"functions over {LONG} lines": _most(named, lambda f: f.end_lineno - f.lineno + 1, LONG),
        f"functions over {MANY} arguments": _most(named, _arguments, MANY),
        "functions named by a participle": [name for name, f in named if _is_participle(f.name)],
        "file names twice": _twice(inner),
        "class names twice": _twice([n.name for _, n in nodes if isinstance(n, ast.ClassDef)]),
        "commands": [path for path, text in modules.items() if _is_command(path, text)],
        "command-line arguments": sum(_options(_nodes(text)) for text in modules.values()),
    }


@cache
def _nodes(text):
    return list(ast.walk(ast.parse(text)))


def _words(path, text):
    if path.endswith(".ipynb"):
        text = " ".join(
            "".join(c["source"]) for c in json.loads(text)["cells"] if c["cell_type"] == "markdown"
        )
    return len(text.split())


def _most(named, size, bound):
    sizes = sorted(((size(f), name) for name, f in named), reverse=True)
    return [f"{name} {count}" for count, name in sizes if count > bound]


def _arguments(function):
    args = function.args
    return len(args.posonlyargs) + len(args.args) + len(args.kwonlyargs)


def _is_participle(name):
    return PARTICIPLE.fullmatch(name.rpartition("_")[2]) is not None


def _twice(names):
    return sorted(f"{name} {count}" for name, count in Counter(names).items() if count > 1)


def _is_command(path, text):
    return path.endswith("__main__.py") or re.search(r'^if __name__ == "__main__":', text, re.M) is not None


def _options(nodes):
    """Calls of ``add_argument``; those in a loop over ``fields(Class)`` count as the fields of the dataclass."""
    classes = {n.name: n for n in nodes if isinstance(n, ast.ClassDef)}
    total = sum(_is_call(n, "add_argument") for n in nodes)
    for loop in (n for n in nodes if isinstance(n, ast.For) and _is_call(n.iter, "fields")):
        calls = sum(_is_call(part, "add_argument") for part in ast.walk(loop))
        if calls and (options := classes.get(ast.unparse(loop.iter.args[0]))):
            total += sum(isinstance(part, ast.AnnAssign) for part in options.body) - calls
    return total


def _is_call(node, name):
    return isinstance(node, ast.Call) and name == getattr(node.func, "attr", getattr(node.func, "id", None))


def table(now: dict, then: dict | None = None) -> str:
    """One line a measure, one column a room; with ``then``, both figures."""
    weights = (then, now) if then else (now,)
    rows = [["", *now]]
    for measure in now[ALL]:
        rows.append([measure, *(" -> ".join(_figure(w[room][measure]) for w in weights) for room in now)])
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    rows.insert(1, ["-" * width for width in widths])
    return "\n".join(
        "| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |" for row in rows
    )


def _figure(value):
    return f"{value if isinstance(value, int) else len(value):,}"


def main() -> None:
    parser = argparse.ArgumentParser(
        "python -m tests.repository.weight", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("commit", nargs="?", help="the commit to compare with")
    parser.add_argument(
        "--names", action="store_true", help="list every name that is counted, not only the longest"
    )
    args = parser.parse_args()
    now = weigh(files_of())
    print(table(now, weigh(files_of(args.commit)) if args.commit else None))
    for measure in now[ALL]:
        for room in ROOMS:
            names = now[room][measure]
            if isinstance(names, list) and names and (args.names or measure.startswith("functions over")):
                print(f"\n{measure}, {room}:", *names, sep="\n  ")


if __name__ == "__main__":
    main()
