"""``python -m snooker_env.play``: a server on this machine's own address, and a browser that opens its page."""

import argparse
import os
import secrets
import sys
import webbrowser
from pathlib import Path

from .._lib.check import integer
from .._lib.command import exit_code
from ..players.resolver import players_of
from ..players.saved_models import add_model_options, options_of_words
from .person import BY_NAME, USUAL, Person
from .routes import GET, POST, answer
from .server import PlayServer
from .service import PERSON, Seats, Service
from .session import Session

NAME = "snooker_env.play"
PORT = 8147  # always the same by default, since a browser keeps scores by the page's address


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    about = """Play snooker in the browser, against an agent or yourself, from any position, with an advisor. Programs can
        play too (docs/play/protocol.md). The server listens on 127.0.0.1 only, unless --host is given; it prints the address
        to open."""
    parser = argparse.ArgumentParser(prog="python -m snooker_env.play", description=about)
    add = parser.add_argument
    add("--port", type=int, help=f"port to listen on (default: {PORT} if it is free, else any)")
    host = """let a phone and a friend in the same network play: listen on all addresses of this machine, or on ADDRESS,
        and print the addresses to pass on"""
    add("--host", nargs="?", const="", metavar="ADDRESS", help=host)
    add("--no-browser", action="store_true", help="only print the address")
    agent = f"""an agent for the page's menu: a name of snooker_env.players(), a model's .zip, MODULE:CLASS, or one of the
        page's own, {", ".join(BY_NAME)}. The first one is your opponent (default: {USUAL}) and, if it knows frames, your
        adviser. May be given more than once"""
    add("--agent", action="append", default=[], metavar="NAME", help=agent)
    add_model_options(parser)
    folder = os.environ.get("APPDATA" if os.name == "nt" else "XDG_DATA_HOME") or "~/.local/share"
    file = Path(folder).expanduser() / "snooker_env" / "person.json"
    person = "file that keeps your frames and strokes; nothing is sent anywhere (default: %(default)s)"
    add("--person", type=Path, default=file, metavar="FILE", help=person)
    add("--layout", default="break_off", help="layout of the table (default: %(default)s)")
    add("--flight", action="store_true", help="let balls fly, and the cue be raised to 70 degrees")
    add("--seed", type=int, help="seed of all random numbers (default: a new one each time)")
    return parser.parse_args(argv)


def service_of(args: argparse.Namespace) -> Service:
    seed = secrets.randbits(62) if args.seed is None else args.seed
    session = Session(layout=args.layout, seed=seed, flight=args.flight)
    first = args.agent[0] if args.agent else USUAL
    names = [name for name in args.agent if name not in BY_NAME]
    shown = [Path(name).stem if name.endswith(".zip") else name for name in names]
    agents = dict(zip(shown, players_of(names, args.trust, options_of_words(args.options)), strict=True))
    seats = Seats(agents, friends=args.host is not None)
    seats.sit([PERSON, first if first in BY_NAME else shown[0]])
    session.noise[:] = ["amateur", BY_NAME[first].noise if first in BY_NAME else "professional"]
    return Service(session, seats, Person(args.person))


def warm_up(service: Service) -> None:
    """Compile the kernels of strokes and questions, so that nobody waits in the middle of a game."""
    answer(service, POST["destinations"], {"speed": 2.0, "aim": 1.0, "samples": 16})
    for name in {service.seats.advisers(service.session.practice)[0], service.seats.who[1]}:
        service.seats.decide(name, service.session.twin())
    answer(service, GET["state"], {})


def _server(service: Service, port: int | None, host: str | None = None) -> PlayServer:
    """The server on a port; by default ``PORT``, where a browser finds its settings again, or any if that is taken."""
    try:
        return PlayServer(service, PORT if port is None else integer("port", port, 0, 65535), host)
    except ValueError:
        if port is not None:
            raise
        return PlayServer(service, 0, host)


def _invite(server: PlayServer) -> None:
    """Print the addresses for other devices, and the one for the host's own phone as a QR code."""
    print("Addresses for the same network. Nothing is encrypted, so use a network that you trust:\n")
    for one, words in zip(server.service.invites, ("you, on a phone", "a friend", "watchers"), strict=True):
        print(*(f"    {words:16} {address}" for address in one["addresses"]), sep="\n")
    if sys.stdout.isatty():
        rows = server.service.invites[0]["drawn"].splitlines()
        print("", *(f"\x1b[97;40m{row}\x1b[0m" for row in rows), sep="\n")
    print()


def main(argv: list[str] | None = None) -> int:
    """Serve until Ctrl-C. Exit code 0; 2: wrong arguments; 130: Ctrl-C while it starts."""

    def run() -> int:
        args = _arguments(argv)
        try:
            service = service_of(args)
            server = _server(service, args.port, args.host)
            print("Loading the players and the simulator ...", file=sys.stderr, flush=True)
            warm_up(service)
        except (ValueError, OSError, OverflowError) as error:
            print(f"{NAME}: {error}", file=sys.stderr)
            return 2
        try:
            print(f"Snooker is played at\n\n    {server.address}\n")
            if args.host is not None:
                _invite(server)
            print("Programs play at its api/ (docs/play/protocol.md). Ctrl-C stops the server.", flush=True)
            if not args.no_browser and not webbrowser.open(server.address):
                print(f"No browser was found. Open {server.address} in one.", flush=True)
            server.serve_forever(poll_interval=0.2)
        except KeyboardInterrupt:
            print()
        finally:
            service.close()
            server.server_close()
        return 0

    return exit_code(NAME, run)


if __name__ == "__main__":
    raise SystemExit(main())
