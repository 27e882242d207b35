"""How do tests see the page of a game? In a real headless Chromium, by mouse, keys and touch."""

import json
import time

from tests.playing import Line
from tests.web.chromium import Watched

PERSONS = {"players": ["person", "person"], "noise": ["none", "none"], "practice": False, "cue": "real"}
SETTLED = "page.settled === page.state.revision"


class Shown(Watched):
    """The page of a server's game, its mouse in metres, and what went wrong in it."""

    names = "const page = window.page ?? {}"

    def __init__(self, browser, line: Line, *, new=False, address="", **options):
        self.line, address = line, address or line.server.address
        if not new:  # the tutorial has been seen, and the stroke is drawn with all that is known of it
            kept = {"name": "snooker", "value": json.dumps({"toured": True, "guide": "spread"})}
            origin = {"origin": f"http://127.0.0.1:{line.server.server_port}", "localStorage": [kept]}
            options["storage_state"] = {"cookies": [], "origins": [origin]}
        super().__init__(browser, address, (address, "blob:", "data:"), "page.state", **options)

    def set_up(self, position, **fields):
        """A position by the protocol, and wait until the page shows it."""
        self.line("api/players", PERSONS)
        self.line("api/new", {"layout": "break_off", "seed": 1})
        status, state, _ = self.line("api/position", {"position": position, **fields})
        assert status == 200
        self.until(f"page.state.revision >= argument && {SETTLED} && page.aiming", state["revision"])

    def at(self, x, y):
        """Where a place [m] is on the screen."""
        box = self.page.locator("#table").bounding_box()
        px, py = self("page.view.toScreen(...argument)", [x, y])
        return box["x"] + px, box["y"] + py

    def drag(self, start, end, steps=8):
        """The mouse from one place [m] to another, button down."""
        self.page.mouse.move(*self.at(*start))
        self.page.mouse.down()
        self.page.mouse.move(*self.at(*end), steps=steps)
        self.page.mouse.up()

    def played(self, strokes):
        """Cut the motion short and wait until so many strokes are shown."""
        self.until("page.moving || page.state.strokes >= argument", strokes)
        end = time.monotonic() + 120
        while not self(f"page.played >= argument && !page.busy && !page.moving && {SETTLED}", strokes):
            assert time.monotonic() < end
            self("page.skip()")
            time.sleep(0.02)

    @property
    def words(self):
        return self.page.inner_text("#asked")
