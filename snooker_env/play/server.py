"""How does the game answer a browser or a program? A small HTTP server, for those who have its token. Every request is checked
before anything is done: ``Host``, so that no other name leads here (DNS rebinding); ``Origin`` and ``Sec-Fetch-Site``, so that no
other page can send requests; the token, in constant time; method, path and body. Connections are bounded in number and time."""

import errno
import hmac
import io
import json
import re
import secrets
import socket
import sys
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socketserver import TCPServer
from time import monotonic
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from .._lib.check import refuse
from .._lib.files import strict_json
from .._lib.install import missing
from ..players.cue_stroke import read_object
from ..replays.web import table_js
from ..simulation import SimulationError
from .routes import GET, POST, answer, parts_of
from .service import ASKING, FRIEND, PERSON, WATCHER, BusyError, Service

WEB = Path(__file__).with_name("web")
FILES = {"": "text/html", "play.css": "text/css", "table.js": "text/javascript"}
FILES |= {path.name: "text/javascript" for path in WEB.glob("*.js")}
"""What is served besides the protocol: path -> its type. No other file is ever read."""
MOST_BODY = 131_072  # largest body of a request [bytes]; a replay has about 200 for each stroke
IDLE = 20.0  # how long a connection waits for the next byte, and for a whole request [s]
MOST_AT_ONCE = 64
"""Largest number of connections; a browser keeps six. One that waits gives way to a further one."""
MOST_EACH = 20  # of one client, where others than this machine are served
ROUTES = ("192.0.2.1", "10.255.255.254", "172.31.255.254", "192.168.255.254")
"""Where routes are looked up to find this machine's own addresses; nothing is sent there."""
LOCAL = ("127.0.0.1", "localhost", "[::1]")
_FULL = b'{"error": {"field": null, "value": null, "message": "busy: too many connections"}}'
_HEAD = b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nConnection: close\r\n"
FULL = b"%sContent-Length: %d\r\n\r\n%s" % (_HEAD, len(_FULL), _FULL)  # the answer to further connections
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class RefusedError(Exception):
    """A request that is refused, with its status and the JSON error."""

    def __init__(self, status: int, message: str, field: object = None, value: object = None, **headers: str):
        super().__init__(message)
        self.status, self.headers = status, headers
        self.body: dict[str, Any] = {"field": field, "value": value, "message": message}


class PlayHandler(BaseHTTPRequestHandler):
    server: "PlayServer"
    who: str  # whose token the request has shown
    protocol_version = default_request_version = "HTTP/1.1"
    server_version, sys_version = "snooker_env", ""
    timeout = IDLE
    # an answer is two writes: the second must not wait for the first to be acknowledged
    disable_nagle_algorithm = True

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing: a path holds the token."""

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Answer an error that ``http.server`` itself finds, as one JSON error."""
        self.close_connection = True
        if code == 501:
            self._refuse(RefusedError(405, "the method must be GET or POST", Allow="GET, POST"))
        else:
            self._refuse(RefusedError(code, message or "not a request that can be answered"))

    def handle_one_request(self) -> None:
        """Handle one request; then the connection waits again."""
        super().handle_one_request()
        self.server.waiting.setdefault(self.connection, (True, monotonic()))

    def finish(self) -> None:
        """Read the rest of a refused request: closing with unread bytes would lose the answer."""
        with suppress(OSError):
            self.connection.shutdown(socket.SHUT_WR)
            self.connection.settimeout(0.2)
            for _ in range(16):
                if not self.connection.recv(65_536):
                    break
        super().finish()

    def _serve(self):
        try:
            name, query = self._check_request()
            if not name.startswith("api/"):
                self._file(name)
                return
            route = (GET if self.command == "GET" else POST)[name[4:]]
            fields = query if self.command == "GET" else self._body()
            ASKING.set(self.who)
            reply = answer(self.server.service, route, fields)
            text = json.dumps(reply, allow_nan=False, separators=(",", ":"))
            self._send(200, text.encode(), "application/json")
        except RefusedError as refused:
            self.close_connection = True  # the rest of the request may not have been read
            self._refuse(refused)
        except ValueError as error:
            self._refuse(RefusedError(422, **parts_of(error)))
        except BusyError as error:
            self._refuse(RefusedError(503, f"busy: {error}"))
        except SimulationError as error:
            self._refuse(RefusedError(500, f"this stroke cannot be computed: {error}"))

    do_GET = do_POST = _serve  # noqa: N815

    def _check_request(self) -> tuple[str, dict[str, Any]]:
        """The path after the token and the query, of a valid request."""
        head = self.headers
        try:
            parts = urlsplit(self.path)
        except ValueError:
            raise RefusedError(400, "the target of a request must be an address") from None
        host = head.get_all("Host") or []
        asked = [*host, parts.netloc] if parts.scheme or parts.netloc else host
        known = self._hosts()
        if len(host) != 1 or not known.issuperset(map(str.lower, asked)):
            raise RefusedError(403, "Host must be " + " or ".join(sorted(known)))
        for field in ("Origin", "Sec-Fetch-Site", "Content-Length"):
            if len(head.get_all(field) or []) > 1:
                raise RefusedError(400, "must be given once", field)
        origin = head.get("Origin")
        if origin is not None and origin.lower() not in {f"http://{name}" for name in known}:
            raise RefusedError(403, "Origin must be this server's own")
        if head.get("Sec-Fetch-Site", "none").lower() not in ("none", "same-origin"):
            raise RefusedError(403, "Sec-Fetch-Site must be same-origin, or none")
        token, slash, name = parts.path.removeprefix("/").partition("/")
        name = re.sub("^/+(?=api/)", "", name)  # "/api/state" may be appended to the address, which ends so
        self.who = self.server.whose(token if parts.path.startswith("/") else "")
        if not self.who:
            raise RefusedError(403, "the address must hold this server's token: open the one that it printed")
        self.server.waiting.pop(self.connection, None)
        if not slash:  # the page's own files are named from there
            raise RefusedError(308, "the address must end in /", Location=f"/{token}/")
        known = {"GET": {*FILES, *(f"api/{key}" for key in GET)}, "POST": {f"api/{key}" for key in POST}}
        if name not in known[self.command]:
            other = next((method for method, names in known.items() if name in names), None)
            if other is None:
                raise RefusedError(404, "there is nothing of that name")
            raise RefusedError(405, f"the method must be {other}", Allow=other)
        friendly = self.who == FRIEND and self.command == "POST" and POST[name[4:]].friend
        if self.command == "POST" and self.who != PERSON and not friendly:
            raise RefusedError(403, "the host alone may do this")
        if "Transfer-Encoding" in head:
            raise RefusedError(411, "a body must come with its Content-Length")
        if self.command == "GET" and head.get("Content-Length", "0") != "0":
            raise RefusedError(400, "GET must have no body")
        return name, self._query(parts.query)

    def _hosts(self) -> set[str]:
        """The names by which this connection may call the server: the address that it came to, no name that may lead anywhere."""
        names = (self.connection.getsockname()[0], *(LOCAL if self._is_local() else ()))
        return {f"{name}:{self.server.server_port}" for name in names}

    def _is_local(self) -> bool:
        return self.connection.getsockname()[0].startswith("127.")

    def _query(self, text: str) -> dict[str, Any]:
        if text and self.command == "POST":
            raise RefusedError(400, "POST must have its fields in its body, not in its address")
        fields: dict[str, Any] = {}
        for name, value in parse_qsl(text, keep_blank_values=True):
            if name in fields:
                raise RefusedError(400, "must be given once", name, value)
            is_number = re.fullmatch(r"(0|[1-9][0-9]{0,14})(\.[0-9]{1,9})?", value)
            fields[name] = strict_json(value) if is_number else value
        return fields

    def _body(self) -> dict[str, Any]:
        length = self.headers.get("Content-Length")
        if length is None or length == "0":  # as ``curl -X POST`` sends it
            # there might be a body without a known end
            self.close_connection = self.close_connection or length is None
            return {}
        if not re.fullmatch(r"\d{1,12}", length):
            raise RefusedError(411, "must be one number of bytes", "Content-Length", length)
        if int(length) > MOST_BODY:
            raise RefusedError(413, f"must be at most {MOST_BODY} bytes", "Content-Length", int(length))
        kind = self.headers.get("Content-Type", "").partition(";")[0].strip().lower()
        if kind != "application/json":
            raise RefusedError(415, "must be application/json", "Content-Type", kind)
        self.server.waiting[self.connection] = True, monotonic()
        raw = self.rfile.read(int(length))
        self.server.waiting.pop(self.connection, None)
        if len(raw) < int(length):
            raise RefusedError(400, "the body ended before its Content-Length")
        try:
            return read_object(raw)
        except ValueError as error:
            raise RefusedError(400, str(error)) from None

    def _file(self, name):
        own = name or "play.html"
        text = table_js(player=False) if own == "table.js" else (WEB / own).read_text("utf-8")
        self._send(200, text.encode(), f"{FILES[name]}; charset=utf-8")

    def _refuse(self, refused: RefusedError) -> None:
        body = json.dumps({"error": refused.body}, allow_nan=False, default=str).encode()
        try:
            self._send(refused.status, body, "application/json", refused.headers)
        except OSError:
            self.close_connection = True

    def _send(self, status: int, body: bytes, kind: str, more: dict[str, str] | None = None) -> None:
        self.send_response(status)
        about = {"Content-Type": kind, "Content-Length": str(len(body)), **(more or {})}
        if self._is_local():  # others' addresses lack TLS
            about["Cross-Origin-Opener-Policy"] = "same-origin"
        for name, value in (HEADERS | about).items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)


class PlayServer(ThreadingHTTPServer):
    """The server of one game, on 127.0.0.1, or on ``host`` for other devices too; port 0 stands for any that is free."""

    daemon_threads = True
    request_queue_size = MOST_AT_ONCE

    def __init__(self, service: Service, port: int = 0, host: str | None = None):
        try:
            super().__init__(("127.0.0.1" if host is None else host, port), PlayHandler)
        except OSError as error:
            if error.errno == errno.EADDRNOTAVAIL or isinstance(error, socket.gaierror):
                raise refuse("host", host, "must be an IPv4 address of this machine") from error
            allowed = f"must be free ({error.strerror}): choose another with --port, or leave it out for any that is"
            raise refuse("port", port, allowed) from error
        doors = [PERSON] if host is None else [PERSON, FRIEND, WATCHER]
        self.service, self.tokens = service, {who: secrets.token_urlsafe(24) for who in doors}
        self.token: str = self.tokens[PERSON]
        self._most = MOST_AT_ONCE if host is None else MOST_EACH
        self._free = threading.BoundedSemaphore(MOST_AT_ONCE)
        self._clients: dict[socket.socket, str] = {}  # the client of each connection
        self.waiting: dict[socket.socket, tuple[bool, float]] = {}
        """The connections without a whole request that shows a token: whether one did so before, and since when."""
        everywhere = self.server_name == "0.0.0.0"
        here = "127.0.0.1" if everywhere else self.server_name
        self.address: str = self._address(PERSON, here)
        """Address of the host's page; the protocol is at its ``api/``."""
        if host is not None:
            found = (addresses_here() if everywhere else []) or [here]
            service.invites = [_invite(who, [self._address(who, at) for at in found]) for who in doors]

    def _address(self, who: str, at: str) -> str:
        return f"http://{at}:{self.server_port}/{self.tokens[who]}/"

    def server_bind(self) -> None:
        """Bind, without asking for the machine's name: that might ask a server outside."""
        TCPServer.server_bind(self)
        self.server_name, self.server_port = str(self.server_address[0]), self.server_address[1]

    def whose(self, token: str) -> str:
        """Who holds a token, or ""; every token is compared, in constant time."""
        same = {who: hmac.compare_digest(token.encode(), own.encode()) for who, own in self.tokens.items()}
        return next((who for who, is_same in same.items() if is_same), "")

    def service_actions(self) -> None:
        """Close the connections that have sent no whole request for too long, slowly or not at all."""
        for one, (_, since) in self.waiting.copy().items():
            if since < monotonic() - IDLE:
                _cut(one)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Serve a connection in its own thread, unless there are too many that do not wait."""
        theirs = list(self._clients.copy().values()).count(client_address[0])
        if theirs >= self._most or not (self._free.acquire(blocking=False) or self._make_room()):
            with suppress(OSError):
                request.settimeout(1.0)
                request.sendall(FULL)
            self.shutdown_request(request)
            return
        self.waiting[request], self._clients[request] = (False, monotonic()), client_address[0]
        super().process_request(request, client_address)

    def _make_room(self) -> bool:
        """Close the connection that has waited longest, of those that never showed a token if there are any."""
        for one, _ in sorted(self.waiting.copy().items(), key=lambda item: item[1])[:1]:
            _cut(one)
            return self._free.acquire(timeout=1.0)
        return False

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self.waiting.pop(request, None)
            self._clients.pop(request, None)
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Report errors, except for connections that were cut."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


def _invite(who: str, addresses: list[str]) -> dict[str, Any]:
    """Addresses for another device, the first one as a QR code: an image's source, and for a terminal, white on black."""
    try:
        import segno
    except ImportError:
        drawn = str(missing("The QR code needs segno", "play"))
        return {"who": who, "addresses": addresses, "qr": "", "drawn": drawn}
    code, text = segno.make_qr(addresses[0]), io.StringIO()
    code.terminal(text, border=2, compact=True)
    qr = code.svg_data_uri(border=3, light="#fff", omitsize=True)
    return {"who": who, "addresses": addresses, "qr": qr, "drawn": text.getvalue()}


def addresses_here() -> list[str]:
    """This machine's IPv4 addresses in its networks, that of the default route first."""
    found = []
    for far in ROUTES:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, suppress(OSError):
            one.connect((far, 9))  # of a datagram's socket this only looks up the route
            found.append(one.getsockname()[0])
    return [name for name in dict.fromkeys(found) if not name.startswith("127.")]


def _cut(connection: socket.socket) -> None:
    """End a connection; its thread notices it."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
