"""How do other devices come to the table? By addresses in the local network, each with a token, and as QR codes.

Whoever opens an address is ``PERSON``, who holds the page and all seats but a friend's; ``FRIEND``, who may play in their
own turn; or ``WATCHER``, who only looks."""

import io
import socket
from contextlib import suppress
from dataclasses import asdict, dataclass
from ipaddress import IPv4Address
from typing import TYPE_CHECKING, Any

from .._lib.check import refuse
from .._lib.install import missing

if TYPE_CHECKING:
    import segno

ROUTES = ("192.0.2.1", "10.255.255.254", "172.31.255.254", "192.168.255.254")
"""Where routes are looked up to find this machine's own addresses; nothing is sent there."""


def address_of(host: str) -> str:
    """The IPv4 address to listen on; "" stands for all of this machine's."""
    try:
        return str(IPv4Address(host or "0.0.0.0"))
    except ValueError:
        raise refuse("host", host, "must be an IPv4 address of this machine, or left out for all") from None


def addresses_here() -> list[str]:
    """This machine's IPv4 addresses in its networks, that of the default route first."""
    found = []
    for far in ROUTES:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, suppress(OSError):
            one.connect((far, 9))  # of a datagram's socket this only looks up the route
            found.append(one.getsockname()[0])
    return [name for name in dict.fromkeys(found) if not IPv4Address(name).is_loopback]


@dataclass(frozen=True)
class Invite:
    """What brings another device to the table: for ``PERSON``, ``FRIEND`` or ``WATCHER``."""

    who: str
    addresses: list[str]

    def to_dict(self) -> dict[str, Any]:
        """The invitation as JSON types, with the first address as a picture; ``qr`` is null where ``missing`` says why."""
        qr, trouble = None, ""
        try:
            qr = _code(self.addresses[0]).svg_data_uri(border=3, light="#fff", omitsize=True)
        except ImportError as error:
            trouble = str(error)
        return asdict(self) | {"qr": qr, "missing": trouble}

    def drawn(self, *, colours: bool) -> str:
        """The first address as a QR code of half blocks for a terminal; or the sentence that says what to install."""
        text = io.StringIO()
        try:
            _code(self.addresses[0]).terminal(text, border=2, compact=True)
        except ImportError as error:
            return str(error)
        return "\n".join(
            f"\x1b[97;40m{row}\x1b[0m" if colours else row for row in text.getvalue().splitlines()
        )


def _code(address: str) -> "segno.QRCode":
    try:
        import segno
    except ImportError:
        raise missing("The QR code needs segno", "play") from None
    return segno.make_qr(address)
