"""What do the commands of this folder share? Their options, how they start, stop and fail, and how they write
files."""

import argparse
import contextlib
import io
import json
import shlex
import signal
import sys
from pathlib import Path

from agents._lib import files
from agents._lib.lifecycle import command
from agents._lib.provenance import provenance

RESULTS = Path(__file__).parents[2] / "results"
PICTURES, FIGURES = RESULTS / "pictures", RESULTS / "physics"
_transcripts = []
"""The file for the printed text, if a command has ``--out``."""


class Command(argparse.ArgumentParser):
    """The parser of ``python -m benchmarks.NAME``, with the common options.

    ``doc``: its module's docstring. ``pictures``: names of pictures that it draws with matplotlib; ``files``:
    names of other files that it always writes. Both go into ``folder`` unless ``--out`` names another.
    ``redraws``: ``--from`` draws the pictures from the figures that ``--json`` wrote. ``seed``: the default
    seed, if anything is random.
    """

    def __init__(self, name, doc, *, pictures=(), files=(), folder=PICTURES, seed=None, redraws=False):
        super().__init__(
            f"python -m benchmarks.{name}",
            description=doc,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        self._name, self._pictures, self._files, self._folder = name, pictures, files, folder
        made = " and ".join((*pictures, *files))
        root = RESULTS.parent
        usual = (
            f"{made} [{folder.relative_to(root) if folder.is_relative_to(root) else folder}] and "
            if made
            else ""
        )
        self.add_argument(
            "--out",
            type=Path,
            metavar="FOLDER",
            help=f"write {usual}the printed text as {name}.txt into this folder",
        )
        self.add_argument("--json", type=Path, metavar="FILE", help="write every figure into this file")
        if pictures:
            self.add_argument("--no-pictures", action="store_true", help="draw nothing")
        if redraws:
            kept = FIGURES / f"{name}.json"
            says = f"draw from the figures that --json wrote, without measuring [{kept.relative_to(root)}]"
            self.add_argument(
                "--from", dest="kept", type=Path, nargs="?", const=kept, metavar="FILE", help=says
            )
        if seed is not None:
            self.add_argument(
                "--seed",
                type=at_least(0),
                default=seed,
                metavar="N",
                help=f"seed of all random numbers [{seed}]",
            )

    def options(self, argv=None):
        """Parse the options and check that the files can be written.

        ``folder``: the folder of the files; ``pictures``: whether any are drawn; ``figures``: those of ``--from``,
        or None if everything is measured; ``made``: what its file says about its origin.
        """
        argv = sys.argv[1:] if argv is None else argv
        found = self.parse_args(argv)
        found.figures = None
        if getattr(found, "kept", None) is not None:
            try:
                found.figures = json.loads(found.kept.read_text(encoding="utf-8"))
            except (OSError, ValueError) as error:
                self.error(f"argument --from: {found.kept}: {getattr(error, 'strerror', None) or error}")
        found.folder = found.out or self._folder
        found.pictures = bool(self._pictures) and not found.no_pictures
        written = [
            found.folder / name for name in (*(self._pictures if found.pictures else ()), *self._files)
        ]
        if found.out is not None:
            _transcripts[:] = [found.out / f"{self._name}.txt"]
            written += _transcripts
        try:
            files.writable("json", found.json)
            for file in written:
                files.writable("out", file)
        except ValueError as error:
            self.error(str(error))
        if found.pictures:
            pyplot()  # report a missing matplotlib before the work
        if found.figures is None:
            words = shlex.join(["python", "-m", f"benchmarks.{self._name}", *argv])
            found.made = provenance(words, getattr(found, "seed", None))
        return found


def at_least(least):
    """An argparse type for whole numbers from ``least`` up."""

    def count(text):
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{value} is less than {least}")
        return value

    return count


class _Copied(io.StringIO):
    """Passes printed text on and keeps it."""

    def __init__(self, terminal):
        super().__init__()
        self._terminal = terminal

    def write(self, text):
        self._terminal.write(text)
        return super().write(text)

    def flush(self):
        self._terminal.flush()


def run(main):
    """Run a command's ``main``, keep the printed text in its file, and exit with the returned code."""
    loaded = sys.modules["__main__"].__spec__
    _transcripts.clear()

    @command(loaded.name.removesuffix(".__main__") if loaded else sys.argv[0])
    def run_copy(_argv):
        before, printed = signal.signal(signal.SIGINT, _interrupt), _Copied(sys.stdout)
        try:
            with contextlib.redirect_stdout(printed):
                code = main()
            for file in _transcripts:
                save_text(file, printed.getvalue())
        finally:
            _alarm(0.0)
            signal.signal(signal.SIGINT, before)
        return code

    sys.exit(run_copy(None))


def _interrupt(_number, _frame):
    """Ctrl-C. numba sometimes clears errors and may swallow an interruption, so this raises it again until
    ``run`` receives it."""
    _alarm(2.0)
    raise KeyboardInterrupt


def _alarm(seconds):
    """Interrupt again after ``seconds``, or never for 0. Windows has no such timer; there you press the keys
    again."""
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _interrupt)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def save_bytes(file, data):
    """Write a file completely or not at all."""
    file.parent.mkdir(parents=True, exist_ok=True)
    files.write_atomic(file, data)


def save_text(file, text):
    """Write text in UTF-8, completely or not at all."""
    save_bytes(file, text.encode())


def save_figures(options, figures):
    """Write the figures and their origin into the file of ``--json``, if one was given. Returns them all."""
    figures = options.made | figures
    if options.json is not None:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        files.write_json(options.json, figures)
    return figures


def save_figure(figure, file, **options):
    """Write a matplotlib figure in the format of the file's suffix, and close it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    files.save_figure(figure, file, **options)
    pyplot().close(figure)


def pyplot():
    """``matplotlib.pyplot`` for drawing into files."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt
