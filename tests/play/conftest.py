"""Which fixtures do tests of play share?"""

import threading

import pytest

from snooker_env.play.server import PlayServer
from snooker_env.play.service import Seats, Service
from snooker_env.play.session import Session
from tests.playing import Asked, Line


@pytest.fixture
def game():
    asked = Asked()
    yield asked
    asked.service.close()


@pytest.fixture(scope="module")
def line():
    service = Service(Session(seed=1), Seats({}))
    server = PlayServer(service)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
    thread.start()
    yield Line(server)
    server.shutdown()
    server.server_close()
    service.close()
    thread.join()
