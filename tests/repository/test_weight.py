"""Does the scale weigh what it says?"""

import json

from tests.repository.weight import weigh

LONG = "def run(a, b, c, d, e, f, g, h, *, self_):\n" + "    a = a\n" * 79 + "    return a\n"
FILES = {
    "snooker_env/a/words.py": "from typing import Any\nx: Any = 1\ny: Anyone = 2\n" + LONG,
    "snooker_env/b/words.py": "def is_made(): ...\ndef tried(a, *b, **c): ...\ndef set_seed(): ...\n",
    "snooker_env/b/__main__.py": "parser.add_argument('--x')\n",
    "train.py": "class S:\n    a: int = 1\n    b: int = 2\n    c: int = 3\n"
    "for f in fields(S):\n    p.add_argument(f.name)\nif __name__ == '__main__':\n    main()\n".replace(
        "'", '"'
    ),
    "examples/words.py": "one = lambda: 1  # noqa: E731\n",
    "docs/a.md": "four words in all\n",
    "docs/b.ipynb": json.dumps(
        {"cells": [{"cell_type": "markdown", "source": ["a ", "b"]}, {"cell_type": "code", "source": ["c"]}]}
    ),
}


def test_figures():
    weight = weigh(FILES)
    package, rest = weight["package"], weight["other code"]
    assert (package["lines"], package["files"], package["`: Any`"], rest["`noqa: E731`"]) == (88, 3, 1, 1)
    assert package["functions over 80 lines"] == ["snooker_env/a/words.py:run 81"]
    assert package["functions over 8 arguments"] == ["snooker_env/a/words.py:run 9"]
    participles = [name.partition(":")[2] for name in package["functions named by a participle"]]
    assert participles == ["is_made", "tried"]
    assert package["file names twice"] == ["words.py 2"]
    assert weight["all but tests"]["file names twice"] == ["words.py 3"]
    assert weight["agents + train.py"]["commands"] == ["train.py"]
    assert weight["agents + train.py"]["command-line arguments"] == 3
    assert (package["commands"], package["command-line arguments"]) == (["snooker_env/b/__main__.py"], 1)
    assert rest["words of documents"] == 6
