"""Does the server answer those alone who know its address, and stay within its bounds?"""

import http.client
import json
import signal
import socket
import subprocess
import sys
import time

import pytest

from snooker_env.play import server as module
from snooker_env.play.__main__ import _arguments, main, service_of
from snooker_env.play.routes import GET, POST
from tests.processes import ROOT


def refused(answer, status, words):
    """Is that an error of this status, as one JSON object, that says these words?"""
    code, body, headers = answer
    assert code == status and set(body) == {"error"}, answer[:2]
    assert set(body["error"]) == {"field", "value", "message"} and words in body["error"]["message"]
    assert headers["Content-Type"] == "application/json"
    return body["error"]


def test_it_listens_on_this_machine_alone_and_serves_its_own_page(line):
    assert line.server.server_address[0] == "127.0.0.1" and len(line.server.token) >= 32
    assert line.server.address == f"http://127.0.0.1:{line.server.server_port}/{line.server.token}/"
    own = {"Origin": f"http://127.0.0.1:{line.server.server_port}", "Sec-Fetch-Site": "same-origin"}
    assert line("api/undo", {}, headers=own)[0] == 200
    assert line("", headers={"Sec-Fetch-Site": "none"})[0] == 200


def test_the_page_and_the_protocol_are_served_with_headers_that_keep_others_out(line):
    kinds = {"": "text/html", "play.js": "text/javascript", "table.js": "text/javascript"}
    for name, kind in (kinds | {"play.css": "text/css", "api/state": "application/json"}).items():
        status, body, headers = line(name)
        assert status == 200 and body and headers["Content-Type"].startswith(kind)
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "unsafe" not in policy
        kept = [headers[one] for one in ("X-Content-Type-Options", "X-Frame-Options", "Cache-Control")]
        assert kept == ["nosniff", "DENY", "no-store"]
        assert headers["Referrer-Policy"] == "no-referrer" and "Python" not in headers["Server"]
    assert all(line(name)[0] == 200 for name in module.FILES)


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


def test_only_known_methods_are_answered(line):
    for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "FOO"):
        found = line("api/state", method=method)
        refused(found, 405, "GET or POST")
        assert found[2]["Allow"] == "GET, POST"
    for name in POST:
        assert refused(line(f"api/{name}"), 405, "must be POST") and name not in GET
    for name in [*(f"api/{one}" for one in GET), "play.js", ""]:
        refused(line(name, {}), 405, "must be GET")
    refused(line("api/state", method="PUT", token="x"), 403, "token")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"{", "JSON"),
        (b"[]", "object"),
        (b"3", "object"),
        (b"\xff\xfe", "JSON"),
        (b'{"place": [NaN, 0]}', "NaN"),
        (b'{"place": [Infinity, 0]}', "Infinity"),
        (b'{"place": [0, 0], "place": [1, 1]}', "twice"),
        (b"[" * 30_000, "JSON"),
        (b'{"place": ' + b"9" * 5000 + b"}", "JSON"),
        (b'{"a": 1} x', "JSON"),
    ],
)
def test_what_is_no_json_object_is_refused(line, body, words):
    refused(line("api/place", body), 400, words)


def test_wrong_fields_are_named(line):
    error = refused(line("api/stroke", {"speed": 99, "aim": 0}), 422, "must be a finite number in [0.2, 7]")
    assert (error["field"], error["value"]) == ("speed", "99")
    assert refused(line("api/stroke", {"speed": 1, "aim": "nan"}), 422, "finite")["field"] == "aim"
    refused(line("api/stroke", b'{"speed": 1e999, "aim": 0}'), 400, "1e999 is no number")
    assert refused(line("api/undo", {"steps": 2}), 422, "no fields")["value"] == "'steps'"
    assert refused(line("api/state?x=1"), 422, "must be one of")["value"] == "'x'"
    assert refused(line("api/state?after=1&after=2"), 400, "once")["field"] == "after"
    assert refused(line("api/state?after=-1"), 422, "integer")["field"] == "after"
    refused(line("api/undo?x=1", {}), 400, "in its body")


def test_a_post_without_a_body_has_no_fields_and_a_second_slash_does_no_harm(line):
    for length in (None, "0"):
        assert line("api/redo", b"", headers={"Content-Length": length, "Content-Type": None})[0] == 200
    assert line("/api/state")[1]["revision"] == line("api/state")[1]["revision"]
    refused(line("/api/state", token="x"), 403, "token")
    refused(line("/etc/passwd"), 404, "nothing")


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


def raw(line, *parts):
    """Bytes on a connection, one part after the other, and what comes back until it is closed."""
    with socket.create_connection(("127.0.0.1", line.server.server_port), timeout=20) as connection:
        for part in parts:
            connection.sendall(part)
        found = b""
        while part := connection.recv(65_536):
            found += part
        return found


def test_what_is_no_http_is_refused_in_json(line):
    for request in (b"hello\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"GET  /  x HTTP/1.1\r\n\r\n"):
        found = raw(line, request)
        assert (b'{"error"' in found and b"HTTP/1.1 4" in found) or b"HTTP/1.1 505" in found


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


def test_connections_that_wait_give_way(line):
    """Others on this machine who hold all places do not shut the player out, whose own connection stays."""
    address = "127.0.0.1", line.server.server_port
    own = http.client.HTTPConnection(*address, timeout=20)
    own.request("GET", f"/{line.server.token}/api/scene")
    assert own.getresponse().read()
    held = [socket.create_connection(address) for _ in range(module.MOST_AT_ONCE + 4)]
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
    address = "127.0.0.1", line.server.server_port
    held = [socket.create_connection(address) for _ in range(module.MOST_AT_ONCE)]
    try:
        for one in held:
            one.sendall(f"{wait}Host: localhost:{address[1]}\r\n\r\n".encode())
        time.sleep(0.5)
        with socket.create_connection(address, timeout=5) as further:
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


def test_one_connection_serves_many_requests(line):
    request = f"GET /{line.server.token}/api/state HTTP/1.1\r\nHost: localhost:{line.server.server_port}\r\n".encode()
    found = raw(line, (request + b"\r\n") * 2 + request + b"Connection: close\r\n\r\n")
    assert found.count(b"HTTP/1.1 200 OK") == 3


def test_the_replay_is_a_file_to_keep(line):
    balls = {"cue": [0.3, 0.1], "reds": [[0.5, 0.5]], "black": [0, 1.4605]}
    assert line("api/position", {"position": balls})[0] == 200
    assert line("api/stroke", {"speed": 1, "aim": 0.5})[0] == 200
    status, body, headers = line("api/replay.html")
    assert status == 200 and body.startswith(b"<!DOCTYPE html>")
    assert headers["Content-Disposition"].startswith("attachment")


def test_the_command_prints_its_address_and_ends_cleanly_at_ctrl_c(tmp_path):
    start = tmp_path / "position.json"
    start.write_text(json.dumps({"cue": [0.3, 0.1], "reds": [[0.5, 0.5]], "black": [0, 1.4605]}))
    command = [sys.executable, "-m", "snooker_env.play", "--no-browser", "--position", start, "--seed", "1"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout is not None
    lines = [process.stdout.readline() for _ in range(3)]
    assert lines[2].strip().startswith("http://127.0.0.1:") and len(lines[2].strip()) > 50
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 0 and err == "Loading the players and the simulator ...\n"
    assert "Traceback" not in out


@pytest.mark.parametrize("found", [True, False])
def test_a_browser_that_is_not_found_is_said_with_the_address(found, monkeypatch, capsys):
    from snooker_env.play import __main__ as command

    def end(self, **_):
        raise KeyboardInterrupt

    opened = []
    monkeypatch.setattr(command, "warm_up", lambda service: None)
    monkeypatch.setattr(command.webbrowser, "open", lambda address: opened.append(address) or found)
    monkeypatch.setattr("snooker_env.play.server.PlayServer.serve_forever", end)
    assert main(["--seed", "1"]) == 0
    said = capsys.readouterr().out
    assert (f"No browser was found: open {opened[0]} in one." in said) is not found
    assert opened[0].startswith("http://127.0.0.1:") and opened[0] in said.split("\n\n")[1]


@pytest.mark.parametrize(
    ("agents", "other"), [([], "tactician_500"), (["ghost_ball", "random"], "ghost_ball")]
)
def test_the_first_agent_or_the_tactician_sits_opposite(agents, other):
    arguments = [word for name in agents for word in ("--agent", name)]
    service = service_of(_arguments(["--seed", "1", "--noise", "club", *arguments]))
    assert service.seats.who == ["person", other] and service.session.noise == ["none", "club"]
    service.close()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--position", "nowhere.json"], "nowhere.json"),
        (["--layout", "x"], "layout = 'x'"),
        (["--agent", "nobody"], "player = 'nobody'"),
        (["--options", "aim=target"], "options = {'aim': 'target'}: must be left out"),
        (["--position", str(ROOT / "pyproject.toml")], "pyproject.toml': must be JSON ("),
        (["--port", "99999"], "port = 99999: must be an integer in [0, 65535]"),
        (["--seed", "-1"], "seed = -1"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(arguments, words, capsys):
    assert main(["--no-browser", *arguments]) == 2
    out, err = capsys.readouterr()
    assert words in err and err.count("\n") == 1 and "Traceback" not in err and out == ""


def test_a_port_in_use_is_said_with_what_to_do(line, capsys):
    port = line.server.server_port
    assert main(["--no-browser", "--port", str(port)]) == 2
    _, err = capsys.readouterr()
    assert err.startswith(f"snooker_env.play: port = {port}: must be free (") and "another with --port" in err
    assert err.count("\n") == 1


def test_the_port_is_always_the_same_unless_it_is_taken_and_then_any(monkeypatch, line):
    """A browser keeps a page's scores by its address."""
    from snooker_env.play import __main__ as command

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    monkeypatch.setattr(command, "PORT", port)
    server = command._server(line.server.service, None)
    other = command._server(line.server.service, None)
    assert server.server_port == port != other.server_port
    with pytest.raises(ValueError, match=f"port = {port}"):
        command._server(line.server.service, port)
    server.server_close()
    other.server_close()
