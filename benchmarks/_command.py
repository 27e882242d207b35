"""What the commands of this folder share: counts on the command line, and pictures drawn without a screen."""

import argparse


def at_least(least):
    """An argparse type: whole numbers from ``least`` up."""

    def count(text):
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{value} is less than {least}")
        return value

    return count


def pyplot():
    """``matplotlib.pyplot`` drawing into files; SystemExit that says what to install where it is missing."""
    try:
        import matplotlib
    except ImportError:
        raise SystemExit('this command draws a picture and needs matplotlib: pip install -e ".[test]"') from None
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt
