"""Does a long command say how far it is?"""

import io
import re
import time

import pytest

from snooker_env import progress
from snooker_env.progress import Progress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.fixture
def quick(monkeypatch):
    """Lines every 50 ms."""
    monkeypatch.setattr(progress, "EVERY", 0.05)
    monkeypatch.setattr(progress, "REDRAWN", 0.02)


def test_a_pipe_gets_a_line_at_the_start_every_few_seconds_and_at_the_end(quick):
    out = io.StringIO()
    with Progress("part 1 of 2, play", 1000, "shots", to=out) as said:
        assert out.getvalue() == "part 1 of 2, play: 0 of 1,000 shots\n"  # before anything is done
        for k in range(1, 5):
            time.sleep(0.06)
            said.at(100 * k, f"round {k}, loss {0.5 * k:.2f}")
        time.sleep(0.3)  # nothing new is done: it still speaks
    lines = out.getvalue().splitlines()
    assert len(lines) >= 6 and "\r" not in out.getvalue()
    pattern = r"part 1 of 2, play: \d{3} of 1,000 shots, round \d, loss \d\.\d\d, [\d,.]+ shots/s, 0:0\d elapsed, 0:0\d left"
    assert [line for line in lines[2:-1] if re.fullmatch(pattern, line)] == lines[2:-1]
    last = r"part 1 of 2, play: 400 of 1,000 shots, round 4, loss 2\.00, [\d,.]+ shots/s, 0:0\d elapsed"
    assert re.fullmatch(last, lines[-1])


def test_a_terminal_gets_one_line_with_a_bar(quick, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    out = Terminal()
    with Progress("play", 200, "shots", to=out) as said:
        said.at(100, "a figure that is far too long for so narrow a terminal as this one is")
        time.sleep(0.1)
    *drawn, last = out.getvalue().split("\r")
    assert len(drawn) > 3 and all(len(one) < 60 and "\n" not in one for one in drawn)
    assert "[##########..........] 0:00 left, play: 100 of 200 shots" in drawn[-2]
    assert last.startswith("play: 100 of 200 shots, a figure that is far") and last.endswith(" elapsed\n")


def test_the_time_left_follows_the_latest_measurements(monkeypatch):
    """Ten a second for 100 s, then one a second: what is left takes as long as the slow part says."""
    clock = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: clock[0])
    said = Progress("play", 1200, "shots", to=io.StringIO())
    for _ in range(100):
        clock[0] += 1.0
        said.at(said.done + 10)
    assert said.rate == pytest.approx(10.0) and said.left == pytest.approx(20.0)
    for _ in range(100):
        clock[0] += 1.0
        said.at(said.done + 1)
    assert said.rate == pytest.approx(1.0) and said.left == pytest.approx(100.0)
    clock[0] += 30.0  # nothing has come since
    assert said.left == pytest.approx(70.0)
    resumed = Progress("play", 1000, "shots", done=900, to=io.StringIO())
    clock[0] += 10.0
    resumed.at(950)  # it measures only what it did itself
    assert resumed.rate == pytest.approx(5.0) and resumed.left == pytest.approx(10.0)


def test_an_error_inside_is_raised_and_the_last_state_said(quick):
    out = io.StringIO()
    with pytest.raises(ZeroDivisionError), Progress("play", 10, "shots", to=out) as said:
        said.at(7)
        1 / 0  # noqa: B018
    assert out.getvalue().splitlines()[-1].startswith("play: 7 of 10 shots, ")
