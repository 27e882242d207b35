"""How long does a person wait at the page, and how long is a link? This measures the figures in docs/play.

    python -m benchmarks.page [--frames 20] [--seed 100] [--json FILE] [--out FOLDER]

tactician_100 plays frames against itself with a professional's, an amateur's and a club player's errors in turn. Printed are the
length of the links and the time to open one, the time for five suggestions in some positions, and the time and sampling error
of a review of both sides. With playwright and Chromium, the command also prints the time from a click on *Play* to the first
motion of twelve strokes.
"""

import shutil
import statistics
import threading
import time

import numpy as np

from snooker_env.play.link import open_link, write_link
from snooker_env.play.routes import POST, answer
from snooker_env.play.server import PlayServer
from snooker_env.play.service import PERSON, Seats, Service
from snooker_env.play.session import Session
from snooker_env.players import player

from ._common.command import Command, at_least, run, save_figures

LEVELS = "professional", "amateur", "club"
AGENT = "tactician_100"
ASKED, STROKES = 4, 12
"""Positions with advice in every fourth frame; and number of clicked strokes."""


def play_frame(service, seed, level):
    """Play a frame of two agents to its end; then seat two persons."""
    both = {"noise": [level, level], "practice": False}
    answer(service, POST["players"], {"players": [AGENT, AGENT], **both})
    answer(service, POST["new"], {"layout": "break_off", "seed": seed})
    while service.session.frame.phase != "over":
        answer(service, POST["go"], {})
        service.wait(service.revision, 25.0)
    answer(service, POST["players"], {"players": [PERSON, PERSON], **both})


def measure(what, *given):
    """Duration of a call in seconds."""
    began = time.perf_counter()
    what(*given)
    return time.perf_counter() - began


def review(service, seed):
    """Seconds until the review has seen every stroke once, and until its end; and the strokes."""
    began, first = time.perf_counter(), None
    found = answer(service, POST["review"], {"seed": seed})
    while found["running"]:
        time.sleep(0.02)
        found = answer(service, POST["reviewed"], {})
        if first is None and 2 * found["done"] >= found["total"] > 1:
            first = time.perf_counter() - began
    assert not found["trouble"], found["trouble"]
    return first, time.perf_counter() - began, found["strokes"]


def click(service):
    """Milliseconds from a click to the first motion for each stroke; none without a browser."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return []
    if shutil.which("chromium") is None:
        return []
    server, waits = PlayServer(service), []
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with sync_playwright() as playwright:
        page = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        ).new_page()
        page.add_init_script("localStorage.setItem('snooker', JSON.stringify({toured: true}))")
        answer(service, POST["new"], {"layout": "break_off", "seed": STROKES})
        page.goto(server.address)
        page.wait_for_selector("#play:not([hidden])")
        page.evaluate(
            "() => { const move = page.move.bind(page); page.move = (...a) => { window.moved = Date.now(); return move(...a); };"
            "document.getElementById('play').addEventListener('click', () => { window.clicked = Date.now(); }, true); }"
        )
        for seed in range(STROKES):
            answer(service, POST["new"], {"layout": "break_off", "seed": seed})
            while not page.evaluate("page.aiming && page.settled === page.state.revision && !page.moving"):
                time.sleep(0.02)
            page.evaluate("() => { window.moved = 0; }")
            page.click("#play")
            while not page.evaluate("window.moved"):
                time.sleep(0.005)
            waits.append(page.evaluate("window.moved - window.clicked"))
            page.evaluate("page.skip()")
    server.shutdown()
    return waits


def main():
    parser = Command("page", __doc__, seed=100)
    parser.add_argument("--frames", type=at_least(2), default=20, metavar="N", help="frames [20]")
    args = parser.options()
    seats = Seats({AGENT: player(AGENT)})
    service, opened, asked, links = Service(Session(seed=1), seats), Session(seed=2), [], []
    for k in range(args.frames):
        play_frame(service, args.seed + k, LEVELS[k % 3])
        link, strokes = write_link(service.session), len(service.session.strokes)
        seconds = min(measure(open_link, opened, link) for _ in range(2 if k else 3))
        links.append({"strokes": strokes, "letters": len(link), "seconds": seconds})
        for at in range(1, ASKED + 1) if k % 4 == 0 else ():
            while service.session.at > len(service.session.acts) * at // (ASKED + 1) or (
                service.session.frame.phase != "stroke"
            ):
                service.session.go_to(service.session.at - 1)
            asked.append(measure(answer, service, POST["advise"], {"n": 5}))
            while service.session.go_to(service.session.at + 1):
                pass
    first, whole, strokes = review(service, 0)
    again = review(service, 1)[2]
    choice = [
        abs(one["choice"] - other["choice"]) / 2**0.5 for one, other in zip(strokes, again, strict=True)
    ]
    luck = [abs(one["after"] - one["meant"] + one["execution"]) for one in strokes]
    errors = [float(np.quantile(some, 0.95)) for some in (choice, luck)]
    waits = click(service)
    service.close()
    each = {
        name: sorted(60.0 * one[name] / one["strokes"] for one in links) for name in ("letters", "seconds")
    }
    middle = statistics.median
    print(
        f"A link of 60 strokes: {middle(each['letters']):.0f} letters [{each['letters'][0]:.0f}, {each['letters'][-1]:.0f}]"
    )
    print(
        f"It opens in {middle(each['seconds']):.2f} s [{each['seconds'][0]:.2f}, {each['seconds'][-1]:.2f}]"
    )
    print(
        f"Five suggestions: {middle(asked):.2f} s [{min(asked):.2f}, {max(asked):.2f}], {len(asked)} positions"
    )
    print(f"A review of {links[-1]['strokes']} strokes: first look {first:.1f} s, complete {whole:.1f} s")
    print(f"Its errors, 95 % of strokes: choice {100 * errors[0]:.1f} %, luck {100 * errors[1]:.1f} %")
    if waits:
        print(
            f"From a click to motion: {middle(waits):.0f} ms, at most {max(waits):.0f}, over {len(waits)} strokes"
        )
    save_figures(args, {"links": links, "advice": asked, "review": [first, whole, *errors], "click": waits})
    return 0


if __name__ == "__main__":
    run(main)
