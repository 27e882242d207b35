"""What do the commands of this folder share? How they start, stop and fail, what they need, and where their files go."""

import argparse
import contextlib
import io
import json
import os
import signal
import sys
import tempfile
import traceback
from pathlib import Path

STOPPED = 130
"""Exit code after Ctrl-C, as shells have it."""
_written = []


def command(name, doc):
    """The parser of ``python -m benchmarks.NAME``; ``doc``: of its module."""
    return argparse.ArgumentParser(
        prog=f"python -m benchmarks.{name}", description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )


def at_least(least):
    """An argparse type: whole numbers from ``least`` up."""

    def count(text):
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{value} is less than {least}")
        return value

    return count


def run(main):
    """Run a command's ``main`` and exit with what it returns. Ctrl-C and a library that is missing are said in one line."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without UTF-8 shows "?" for what it cannot show
    before = signal.signal(signal.SIGINT, _interrupt)
    try:
        code = main()
        sys.stdout.flush()
    except (KeyboardInterrupt, ImportError) as error:
        _alarm(0.0)
        code = _explained(error)
    except BrokenPipeError:  # nobody reads on: python -m benchmarks.paper | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 1
    finally:
        signal.signal(signal.SIGINT, before)
    sys.exit(code)


def _interrupt(_number, _frame):
    """Ctrl-C. numba clears errors in places and so may swallow an interruption (seen): raised again until ``run`` has it."""
    _alarm(2.0)
    raise KeyboardInterrupt


def _alarm(seconds):
    """Interrupt again after so long; 0 for never. Windows has no such clock: there one presses the keys again."""
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _interrupt)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def in_one_line(kind, error, trace):
    """``sys.excepthook`` while a command is loaded."""
    if isinstance(error, KeyboardInterrupt | ImportError):
        code = _explained(error)
        sys.stderr.flush()
        os._exit(code)  # Python itself would end an interrupted process by a signal
    traceback.print_exception(kind, error, trace)


def _explained(error):
    """Say in one line what stopped the command; its exit code."""
    if isinstance(error, KeyboardInterrupt):
        files = f"written: {', '.join(map(str, _written))}" if _written else "no file was written"
        print(f"\nstopped by Ctrl-C: what is printed so far stands, the rest was not measured; {files}", file=sys.stderr)
        return STOPPED
    library = (error.name or "").partition(".")[0]
    if not library:  # it says itself what is missing
        print(error, file=sys.stderr)
    elif library in ("snooker_env", "benchmarks", "commands", "agents"):
        traceback.print_exception(error)
    else:
        print(f'{library} is missing; in a clone of the repository:  pip install -e ".[test]"', file=sys.stderr)
    return 1


def writable(*files):
    """SystemExit before the work, not after it, where one of these files cannot be written; None is no file."""
    for file in filter(None, map(_path, files)):
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            if file.is_dir():
                raise IsADirectoryError(0, "is a folder")
            if _in_place(file):
                open(file, "ab").close()
            else:
                tempfile.TemporaryFile(dir=file.parent).close()
        except OSError as error:
            raise SystemExit(f"{file} cannot be written: {error.strerror}") from None


@contextlib.contextmanager
def saved(file):
    """For writing a file whole or not at all: gives the path to write to. SystemExit in one line where that fails, nothing left behind."""
    file = Path(file)
    place = file if _in_place(file) else file.with_name(f".{file.stem}.{os.getpid()}{file.suffix}")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        yield place
        if place is not file:
            os.replace(place, file)
    except OSError as error:
        raise SystemExit(f"{file} could not be written: {error.strerror or error}") from None
    finally:
        if place is not file:
            place.unlink(missing_ok=True)
    _written.append(file)


def save_json(file, figures):
    """Write every figure into ``file``; nothing if that is None."""
    if file is not None:
        with saved(file) as place:
            place.write_text(json.dumps(figures, indent=1) + "\n")


def save_image(file, pixels):
    """Write a picture (H, W, 3), in the format of the file's suffix. Not by pygame, which says nothing of a full disk."""
    import pygame

    drawn = io.BytesIO()
    pygame.image.save(pygame.surfarray.make_surface(pixels.swapaxes(0, 1)), drawn, file.name)
    with saved(file) as place:
        place.write_bytes(drawn.getvalue())


def _path(file):
    return None if file is None else Path(file)


def _in_place(file):
    """Is it a link or a device, to be written into as it is?"""
    return file.is_symlink() or (file.exists() and not file.is_file())


def pyplot(picture=None):
    """``matplotlib.pyplot`` drawing into files; SystemExit if the file ``picture`` has a suffix that it cannot draw."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.backend_bases import FigureCanvasBase

    kinds = FigureCanvasBase.get_supported_filetypes()
    if picture is not None and Path(picture).suffix[1:].lower() not in kinds:
        raise SystemExit(f"{picture} cannot be drawn: the suffix must be one of {', '.join(sorted(kinds))}")
    return plt
