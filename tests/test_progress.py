"""Does a long command say how far it is?"""

import io

import pytest

from snooker_env import progress
from snooker_env.progress import Progress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def said(out):
    with Progress("part 1 of 2, play", 1000, "shots", to=out, done=300) as shown:
        shown.at(400, "round 4, loss 2.00")
    assert shown.done == 400
    return out.getvalue()


def test_a_terminal_is_told_what_is_done_and_with_which_figures(monkeypatch):
    monkeypatch.delenv("SNOOKER_ENV_QUIET", raising=False)
    text = said(Terminal())
    assert "part 1 of 2, play:  30%" in text and "300/1000" in text
    assert "400/1000" in text and " shots" in text and "round 4, loss 2.00" in text and text.endswith("\n")


@pytest.mark.parametrize("out", [io.StringIO(), Terminal()])
def test_a_quiet_process_is_told_nothing(out, monkeypatch):
    monkeypatch.setenv("SNOOKER_ENV_QUIET", "1")
    monkeypatch.setattr(progress, "EVERY", 0.0)
    assert said(out) == ""


def test_a_file_is_told_a_line_a_minute(monkeypatch):
    monkeypatch.delenv("SNOOKER_ENV_QUIET", raising=False)
    assert said(io.StringIO()) == ""
    monkeypatch.setattr(progress, "EVERY", 0.0)
    assert said(io.StringIO()) == "part 1 of 2, play: 400 of 1,000 shots, round 4, loss 2.00\n"
