"""How are the films and screenshots of the documentation made? In a clone with the extras train, test and render, and with
Chromium:

    python results/make_pictures.py WHAT [--out FOLDER]

WHAT: ``screens``, ``films``, or the name of one film.
"""

import argparse
from pathlib import Path

from films import FILMS
from films import make as make_films
from screens import make as take_screens

HERE = Path(__file__).resolve().parent


def main():
    """Make them."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n\n")[0])
    parser.add_argument(
        "what", choices=("screens", "films", *FILMS), metavar="WHAT", help="screens, films or one film"
    )
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="[results/pictures or results/films]")
    given = parser.parse_args()
    folder = given.out or HERE / ("pictures" if given.what == "screens" else "films")
    folder.mkdir(parents=True, exist_ok=True)
    if given.what == "screens":
        take_screens(folder)
    else:
        make_films(folder, list(FILMS) if given.what == "films" else [given.what])


if __name__ == "__main__":
    main()
