"""Does the server answer a request as the protocol says, and does its command begin and end well?"""

import http.client
import re
import signal
import socket
import subprocess
import sys

import pytest

from snooker_env.play import __main__ as command
from snooker_env.play import server as module
from snooker_env.play.__main__ import main
from snooker_env.play.person import BY_NAME
from snooker_env.play.routes import GET, POST
from snooker_env.play.service import PERSON
from tests.playing import refused
from tests.processes import ROOT


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


def test_an_address_without_its_last_slash_leads_to_the_page(line):
    own = http.client.HTTPConnection("127.0.0.1", line.server.server_port, timeout=20)
    own.request("GET", f"/{line.server.token}")
    found = own.getresponse()
    assert (found.status, found.getheader("Location")) == (308, f"/{line.server.token}/")
    own.close()


@pytest.mark.parametrize(("agent", "noise"), [("Walter", None), ("ghost_ball", "professional")])
def test_an_agent_is_a_player_or_an_opponent_of_the_page(agent, noise):
    service = command.service_of(command._arguments(["--agent", agent, "--seed", "1"]))
    try:
        assert service.seats.who == [PERSON, agent]
        assert service.session.noise == ["amateur", noise or BY_NAME[agent].noise]
    finally:
        service.close()


def test_only_known_methods_are_answered(line):
    for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "FOO"):
        found = line("api/state", method=method)
        refused(found, 405, "GET or POST")
        assert found[2]["Allow"] == "GET, POST"
    for name in POST:
        assert refused(line(f"api/{name}"), 405, "must be POST") and name not in GET
    for name in [*(f"api/{one}" for one in GET), "play.js", ""]:
        refused(line(name, {}), 405, "must be GET")


NO_OBJECTS = [
    (b"{", "JSON"),
    (b"[]", "object"),
    (b"3", "object"),
    (b"\xff\xfe", "JSON"),
    (b'{"a": 1} x', "JSON"),
]
NO_OBJECTS += [
    (b'{"place": [NaN, 0]}', "NaN"),
    (b'{"place": [Infinity, 0]}', "Infinity"),
    (b"[" * 30_000, "JSON"),
]
NO_OBJECTS += [(b'{"place": [0, 0], "place": [1, 1]}', "twice"), (b'{"place": ' + b"9" * 5000 + b"}", "JSON")]


def test_what_is_no_json_object_is_refused(line):
    for body, words in NO_OBJECTS:
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


def test_a_post_without_a_body_has_no_fields(line):
    for length in (None, "0"):
        assert line("api/redo", b"", headers={"Content-Length": length, "Content-Type": None})[0] == 200
    refused(line("/etc/passwd"), 404, "nothing")


def test_a_second_slash_before_api_does_no_harm(line):
    """Clients append "/api/state" to the address, which ends with "/"."""
    assert line("/api/state")[1]["revision"] == line("api/state")[1]["revision"]
    refused(line("/api/state", token="x"), 403, "token")
    refused(line("/etc/passwd"), 404, "nothing")


def test_the_command_prints_its_address_and_ends_cleanly_at_ctrl_c():
    command = [sys.executable, "-m", "snooker_env.play", "--no-browser", "--layout", "colours", "--seed", "1"]
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
    assert (f"No browser was found. Open {opened[0]} in one." in said) is not found
    assert opened[0].startswith("http://127.0.0.1:") and opened[0] in said.split("\n\n")[1]


def test_with_host_the_command_prints_an_address_for_each_person_and_a_qr_code(monkeypatch, capsys):
    from snooker_env.play import __main__ as command

    monkeypatch.setattr(command, "warm_up", lambda service: None)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setattr("snooker_env.play.server.PlayServer.serve_forever", lambda self, **_: None)
    assert main(["--host", "127.0.0.1", "--no-browser", "--seed", "1"]) == 0
    said = capsys.readouterr().out
    first, _, others = said.partition("for the same network")
    addresses = re.findall(r"(?m)^    .*(http://127.0.0.1:\d+/[\w-]{32}/)$", others)
    assert len(set(addresses)) == 3 and addresses[0] in first
    rows = re.findall(r"(?m)^\x1b\[97;40m(.+)\x1b\[0m$", others)
    assert len({len(row) for row in rows}) == 1 and 2 * len(rows) >= len(rows[0]) >= 33


WRONG = """
--layout x | layout = 'x'
--agent nobody | player = 'nobody'
--options aim=target | options = {'aim': 'target'}: must be left out
--host 198.51.100.1 | host = '198.51.100.1': must be an IPv4 address of this machine
--host ::1 | host = '::1': must be an IPv4 address of this machine
--port 99999 | port = 99999: must be an integer in [0, 65535]
--seed -1 | seed = -1
"""


def test_what_cannot_be_is_said_in_one_line(capsys):
    for one in WRONG.strip().splitlines():
        arguments, _, words = one.partition(" | ")
        assert main(["--no-browser", *arguments.split()]) == 2
        out, err = capsys.readouterr()
        assert words in err and err.count("\n") == 1 and "Traceback" not in err and out == "", one


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
