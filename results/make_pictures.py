"""How are the pictures and films of the documentation made? In a clone with the extras train, test and render; screens need
Chromium as well:

    python results/make_pictures.py WHAT [--out FOLDER]

WHAT: ``charts`` and ``diagrams`` (a minute), ``screens``, ``films``, or the name of one film.
"""

import argparse
import importlib
import sys
from pathlib import Path

from films import FILMS
from films import make as make_films

HERE = Path(__file__).resolve().parent
PICTURES = ("charts", "diagrams", "screens")
"""Each is a module of this folder."""


def main():
    """Make them."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n\n")[0])
    parser.add_argument(
        "what",
        choices=(*PICTURES, "films", *FILMS),
        metavar="WHAT",
        help=f"{', '.join(PICTURES)}, films or one film",
    )
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="[results/pictures or results/films]")
    given = parser.parse_args()
    folder = given.out or HERE / ("pictures" if given.what in PICTURES else "films")
    folder.mkdir(parents=True, exist_ok=True)
    if given.what in PICTURES:
        importlib.import_module(given.what).make(folder)
    else:
        make_films(folder, list(FILMS) if given.what == "films" else [given.what])


if __name__ == "__main__":
    sys.path.insert(0, str(HERE.parent))  # agents
    main()
