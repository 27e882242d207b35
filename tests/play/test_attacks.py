"""Do those who may not get in, or may do less than the host, ever do more?"""

import http.client
import secrets
import socket
import sys
import time

import pytest

from snooker_env.play import server as module
from snooker_env.play.person import USUAL
from snooker_env.play.routes import GET, POST
from snooker_env.play.service import FRIEND, PERSON, WATCHER
from tests.playing import EASY, STRAIGHT, refused, served


@pytest.fixture(scope="module", params=[None, ""], ids=["this machine", "the network"])
def line(request):
    with served(request.param) as one:
        yield one


@pytest.fixture
def hosted():
    """A new game against an agent, served to others."""
    with served("") as one:
        one.server.service.seats.sit([PERSON, USUAL])
        yield one


def test_without_the_token_nothing_is_served(line):
    for name in ("", "play.js", "api/state"):
        for token in ("", "x", "TOKEN", "%2e%2e"):
            refused(line(name, token=token), 403, "token")


def test_this_machines_names_are_served_and_others_refused(line):
    port = line.server.server_port
    for name in ("127.0.0.1", "localhost", "[::1]", "LOCALHOST"):
        assert line("api/state", host=f"{name}:{port}")[0] == 200
    others = ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.1:1", "localhost:0"]
    for host in (*others, f"127.0.0.1.nip.io:{port}"):
        refused(line("api/state", host=host), 403, "Host")
    refused(line("api/state", headers={"Host": None}), 403, "Host")


def test_the_host_of_a_target_is_checked_as_host_is(line):
    """A proxy that is told to go to another host must not arrive here."""
    own, token = f"127.0.0.1:{line.server.server_port}", line.server.token
    for name in (own, own.replace("127.0.0.1", "LOCALHOST")):
        assert line("", path=f"http://{name}/{token}/api/state")[0] == 200
    targets = [f"http://{name}" for name in ("evil", "evil:80", "127.0.0.1", f"x@{own}", f"{own}.evil", "")]
    for target in (*targets, "foo:", "http:", f"foo://{own}/..", "//evil"):
        status, body, _ = line("", path=f"{target}/{token}/api/state")
        assert status == 403 and "must" in body["error"]["message"], target
    refused(line("", path=f"http://[evil/{token}/api/state"), 400, "must be an address")


def test_other_pages_are_refused(line):
    origins = [{"Origin": name} for name in ("http://evil.example", "null", "https://127.0.0.1")]
    for headers in (*origins, {"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"}):
        refused(line("api/undo", {}, headers=headers), 403, "must be")
        refused(line("api/state", headers=headers), 403, "must be")


def test_only_known_names_are_served(line):
    outside = ["etc/passwd", "../pyproject.toml", "..%2f..%2fpyproject.toml", "//play.js", "./play.js"]
    for name in ["api/none", "play.html", "replay.html", "api/", "api", *outside]:
        refused(line(name), 404, "nothing of that name")


def test_heads_and_bodies_are_bounded_and_typed(line):
    refused(line("api/state", headers={"X-Long": "x" * 70_000}), 431, "")
    refused(line("api/state", headers={f"X-{k}": "x" * 100 for k in range(200)}), 431, "")
    refused(line("api/load", b" " * (module.MOST_BODY + 1)), 413, "at most")
    refused(line("api/load", b"", headers={"Content-Length": "999999999999"}), 413, "at most")
    refused(line("api/undo", {}, headers={"Content-Type": "text/plain"}), 415, "application/json")
    refused(line("api/undo", {}, headers={"Content-Type": None}), 415, "application/json")
    for wrong in ("x", "-1", "1e3", "", "+2", "0x2"):
        refused(line("api/undo", {}, headers={"Content-Length": wrong}), 411, "bytes")
    chunked = {"Content-Length": None, "Transfer-Encoding": "chunked"}
    refused(line("api/undo", {}, headers=chunked), 411, "Content-Length")
    refused(line("api/state", b"{}", method="GET"), 400, "no body")


def connect(line, k=0):
    """A connection of a client that may have ten."""
    address = "127.0.0.1", line.server.server_port
    return socket.create_connection(address, timeout=20, source_address=(f"127.0.0.{2 + k // 10}", 0))


def raw(line, *parts):
    """Bytes on a connection, one part after the other, and what comes back until it is closed."""
    with connect(line) as connection:
        for part in parts:
            connection.sendall(part)
        found = b""
        while part := connection.recv(65_536):
            found += part
        return found


def test_a_connection_that_says_nothing_more_is_cut_off(line, monkeypatch):
    monkeypatch.setattr(module.PlayHandler, "timeout", 0.3)
    start = time.monotonic()
    assert raw(line, b"GET /x HTTP/1.1\r\n", b"Host: x\r\n") == b"" and time.monotonic() - start < 5


def closed(connection):
    """Has the other side closed it?"""
    connection.settimeout(0.5)
    try:
        return connection.recv(1) == b""
    except TimeoutError:
        return False
    except OSError:
        return True
    finally:
        connection.settimeout(20)


def test_connections_that_wait_give_way(line):
    """Others who hold all places do not shut the player out, whose own connection stays."""
    address = "127.0.0.1", line.server.server_port
    own = http.client.HTTPConnection(*address, timeout=20)
    own.request("GET", f"/{line.server.token}/api/scene")
    assert own.getresponse().read()
    held = [connect(line, k) for k in range(module.MOST_AT_ONCE + 4)]
    for one in held[-8:]:
        one.sendall(b"GET /")  # a request that does not end
    try:
        assert line("api/state")[0] == 200
        assert closed(held[0]) and not closed(held[-1])
        own.request("GET", f"/{line.server.token}/api/scene")
        assert own.getresponse().status == 200
    finally:
        for one in (own, *held):
            one.close()


def test_connections_that_are_answered_are_bounded(line):
    """A further one is told so, and served once one of them has ended."""
    wait = f"GET /{line.server.token}/api/state?after={line('api/state')[1]['revision']}&wait=20 HTTP/1.1\r\n"
    held = [connect(line, k) for k in range(module.MOST_AT_ONCE)]
    try:
        for one in held:
            one.sendall(f"{wait}Host: localhost:{line.server.server_port}\r\n\r\n".encode())
        time.sleep(0.5)
        with connect(line, 90) as further:
            reply = further.recv(1000)
        assert reply.startswith(b"HTTP/1.1 503 ") and b'"message": "busy: too many connections"' in reply
        assert not closed(held[0])
        with line.server.service.acting():  # a change, which they wait for
            pass
        assert [one.recv(12) for one in held] == [b"HTTP/1.1 200"] * len(held)
        assert line("api/state")[0] == 200
    finally:
        for one in held:
            one.close()


def test_one_client_cannot_take_all_places(hosted):
    held = [connect(hosted) for _ in range(module.MOST_EACH)]
    try:
        assert b" 503 " in raw(hosted) and hosted("api/state")[0] == 200
        assert not closed(held[0])
    finally:
        for one in held:
            one.close()


def test_who_sends_slowly_is_cut_off(line, monkeypatch):
    """Each byte comes in time, the request does not."""
    monkeypatch.setattr(module, "IDLE", 0.4)
    path, host = (
        f"/{line.server.token}/api/undo HTTP/1.1\r\n",
        f"Host: localhost:{line.server.server_port}\r\n",
    )
    body = f"POST {path}{host}Content-Type: application/json\r\nContent-Length: 9000\r\n\r\n"
    for first in (b"G", f"GET {path}".encode(), body.encode()):
        start = time.monotonic()
        with connect(line) as slow:
            slow.sendall(first)
            with pytest.raises(OSError):
                while time.monotonic() < start + 10:
                    slow.sendall(b" ")
                    time.sleep(0.05)
        assert time.monotonic() - start < 8


def test_no_token_but_its_own_is_taken(line):
    server = line.server
    assert not any(server.whose(secrets.token_urlsafe(24)) for _ in range(1_000))
    near = server.token[:-1] + ("x" if server.token[-1] != "x" else "y")
    assert server.whose(near) == server.whose("") == server.whose(server.token + "x") == ""


def test_in_the_network_it_answers_to_its_address_alone(hosted):
    """A name that an attacker points to this machine (DNS rebinding) leads to nothing."""
    here, port = module.addresses_here(), hosted.server.server_port
    if not here:
        pytest.skip("this machine is in no network")
    target = f"/{hosted.server.token}/api/state"

    def ask(host, origin=None):
        connection = http.client.HTTPConnection(here[0], port, timeout=20)
        connection.request("GET", target, headers={"Host": host} | ({"Origin": origin} if origin else {}))
        try:
            return connection.getresponse().status
        finally:
            connection.close()

    own = f"{here[0]}:{port}"
    assert ask(own) == ask(own, f"http://{own}") == 200
    for name in ("evil.example", "localhost", "127.0.0.1", f"{here[0]}.nip.io", "192.0.2.77"):
        assert ask(f"{name}:{port}") == ask(own, f"http://{name}:{port}") == 403
    assert ask(here[0]) == 403
    refused(hosted("api/state", host=own), 403, "Host")


def test_a_game_for_one_device_has_one_door():
    with served() as alone:
        scene = alone("api/scene")[1]
        assert list(alone.server.tokens) == [PERSON] == scene["players"][:1] and scene["invites"] == []
        assert FRIEND not in scene["players"]
        refused(alone("api/players", {"players": [PERSON, FRIEND]}), 422, "must be one of")


def seat(line, who):
    """Requests with the token of one of the doors."""
    return lambda name, body=None: line(name, body, token=line.server.tokens[who])


def test_a_watcher_reads_and_posts_nothing(hosted):
    watcher, before = seat(hosted, WATCHER), hosted("api/state")[1]["revision"]
    for name in POST:
        refused(watcher(f"api/{name}", {}), 403, "the host alone")
    assert {name for name in GET if watcher(f"api/{name}")[0] != 200} == {
        "replay",
        "replay_page",
    }  # of no stroke, and without a review
    assert watcher("api/scene")[1]["invites"] == [] and hosted("api/state")[1]["revision"] == before
    assert watcher("api/state")[1]["labels"] == ["Player 1", USUAL]


def test_each_seat_plays_in_its_own_turn_alone(hosted):
    friend, watcher = seat(hosted, FRIEND), seat(hosted, WATCHER)
    asked = [name for name, route in POST.items() if route.friend]
    for name in set(POST) - set(asked):
        refused(friend(f"api/{name}", {}), 403, "the host alone")
    hosted("api/players", {"players": [PERSON, FRIEND]})
    state = friend("api/state")[1]
    assert state["players"] == ["friend", "person"] and state["labels"] == ["Friend", "You"]
    assert hosted("api/state")[1]["labels"] == ["You", "Friend"]
    assert watcher("api/state")[1]["labels"] == ["Player 1", "Player 2"]
    stroke = {"speed": 2, "aim": STRAIGHT}
    acts = {"stroke": stroke, "place": {"place": [0.1, -1.1]}, "concede": {}}
    questions = {"advise": {"samples": 1}, "destinations": stroke}
    assert {*acts, *questions, "room"} == set(asked)
    for name, body in (acts | questions).items():
        assert refused(friend(f"api/{name}", body), 422, "must be yours")["value"] == "'Friend'"
    hosted("api/position", {"position": EASY, "striker": 1})
    for name, body in acts.items():
        refused(hosted(f"api/{name}", body), 422, "must be yours")
    assert friend("api/destinations", stroke)[0] == 200
    status, played, _ = friend("api/stroke", stroke)
    assert status == 200 and played["state"]["last"].startswith("You: Red potted")
    assert hosted("api/state")[1]["last"].startswith("Friend: Red potted")
    assert hosted("api/undo", {})[0] == 200 and not friend("api/state")[1]["redo"]
    assert friend("api/concede", {})[1]["words"].startswith("Frame over: Friend won")


def test_invitations_hold_their_tokens_and_say_what_is_missing(hosted, monkeypatch):
    server = hosted.server
    for one in hosted("api/scene")[1]["invites"]:
        assert all(
            at.endswith(f":{server.server_port}/{server.tokens[one['who']]}/") for at in one["addresses"]
        )
        assert one["qr"].startswith("data:image/svg+xml") and "\u2588" in one["drawn"]
    monkeypatch.setitem(sys.modules, "segno", None)
    without = module._invite(PERSON, ["http://x/"])
    assert without["qr"] == "" and "[play]" in without["drawn"]


def test_nobody_outside_is_asked_for_names(monkeypatch):
    def ask(*_):
        raise AssertionError("a name was looked up")

    for name in ("getfqdn", "gethostbyname", "gethostbyaddr", "gethostbyname_ex"):
        monkeypatch.setattr(socket, name, ask)
    with served(""):
        pass
