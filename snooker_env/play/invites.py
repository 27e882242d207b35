"""How do other devices come to the table? By addresses in the local network, each with a token, and as QR codes."""

import io
import socket
from contextlib import suppress
from typing import NamedTuple

from .._lib.install import missing

ROUTES = ("192.0.2.1", "10.255.255.254", "172.31.255.254", "192.168.255.254")
"""Where routes are looked up to find this machine's own addresses; nothing is sent there."""


class Invite(NamedTuple):
    who: str  # ``PERSON``, ``FRIEND`` or ``WATCHER`` of ``service``: what it may do there
    addresses: list[str]
    qr: str  # the QR code of the first address, as the source of an image; "" without segno
    drawn: str  # the same for a terminal, white on black; without segno what to install


def invite(who: str, addresses: list[str]) -> Invite:
    try:
        import segno
    except ImportError:
        return Invite(who, addresses, "", str(missing("The QR code needs segno", "play")))
    code, text = segno.make_qr(addresses[0]), io.StringIO()
    code.terminal(text, border=2, compact=True)
    return Invite(who, addresses, code.svg_data_uri(border=3, light="#fff", omitsize=True), text.getvalue())


def addresses_here() -> list[str]:
    """This machine's IPv4 addresses in its networks, that of the default route first."""
    found = []
    for far in ROUTES:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, suppress(OSError):
            one.connect((far, 9))  # of a datagram's socket this only looks up the route
            found.append(one.getsockname()[0])
    return [name for name in dict.fromkeys(found) if not name.startswith("127.")]
