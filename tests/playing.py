"""What do tests of play share? Positions, a game called as a request calls it, a connection."""

import http.client
import json
import threading
from contextlib import contextmanager
from math import atan2

from snooker_env.play import routes
from snooker_env.play.server import PlayServer
from snooker_env.play.service import Seats, Service
from snooker_env.play.session import Session

RED = [0.6, 1.4]
EASY = {"cue": [0.326, 1.031], "reds": [RED, [-0.5, 0.2]], "pink": [0.0, 0.89225], "black": [0.0, 1.4605]}
"""Red 1 lies straight before the top right pocket, red 2 out of the way."""
STRAIGHT = atan2(0.369, 0.274)
"""The aim [rad] that pots it."""
COLOURS = {"blue": [0.3, -0.5], "pink": [0.6, -0.5], "black": [-0.6, -0.9]}
COVERED = {"cue": [0.0, -0.5], "reds": [RED], **COLOURS, "on": "any_colour"}
"""Along +x the blue lies before the pink; the black is in sight."""
FROZEN = {"cue": [0.889 - 0.02625, 0.6], "reds": [[0.0, 0.6]], "black": [0.0, 1.4605]}
"""The cue ball on the right cushion, and a red square across."""


class Asked:
    """The routes of one game without the network, as a request calls them: JSON in, JSON out."""

    def __init__(self):
        self.service = Service(Session(seed=1), Seats({}))

    def __call__(self, name, /, **fields):
        """A POST."""
        return self._answer(routes.POST[name], json.loads(json.dumps(fields)))

    def get(self, name, /, **fields):
        return self._answer(routes.GET[name], fields)

    def _answer(self, route, fields):
        return json.loads(json.dumps(routes.answer(self.service, route, fields), allow_nan=False))

    @property
    def session(self):
        return self.service.session


class Line:
    """A connection to a server, with everything in order unless said otherwise."""

    def __init__(self, server):
        self.server = server

    def __call__(self, name, body=None, *, method=None, path=None, host=None, token=None, headers=None):
        """(status, JSON or bytes, headers) of one request; a body that is no bytes is sent as JSON."""
        connection = http.client.HTTPConnection("127.0.0.1", self.server.server_port, timeout=120)
        raw = body if body is None or isinstance(body, bytes) else json.dumps(body).encode()
        head = {"Host": host or f"127.0.0.1:{self.server.server_port}"}
        if raw is not None:
            head |= {"Content-Type": "application/json", "Content-Length": str(len(raw))}
        head = {key: value for key, value in (head | (headers or {})).items() if value is not None}
        path = path or f"/{self.server.token if token is None else token}/{name}"
        try:
            connection.putrequest(
                method or ("GET" if body is None else "POST"), path, skip_host=True, skip_accept_encoding=True
            )
            for key, value in head.items():
                connection.putheader(key, value)
            connection.endheaders(raw)
            reply = connection.getresponse()
            text = reply.read()
            as_json = reply.headers.get("Content-Type", "").startswith("application/json")
            return reply.status, json.loads(text) if as_json else text, reply.headers
        finally:
            connection.close()


@contextmanager
def served(host=None):
    """A connection to the server of a new game, on these addresses."""
    service = Service(Session(seed=1), Seats({}, friends=host is not None))
    server = PlayServer(service, 0, host)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
    thread.start()
    yield Line(server)
    server.shutdown()
    server.server_close()
    service.close()
    thread.join()


def refused(answer, status, words):
    """Is that an error of this status, as one JSON object, that says these words?"""
    code, body, headers = answer
    assert code == status and set(body) == {"error"}, answer[:2]
    assert set(body["error"]) == {"field", "value", "message"} and words in body["error"]["message"]
    assert headers["Content-Type"] == "application/json"
    return body["error"]
