"""Are the published data described as they are? Croissant metadata: what files hold, where it comes from, what it is not for.

    python -m agents.croissant

writes checksums, sizes, version and, once pyproject.toml has one, the address into ``benchmarks/data/croissant.json`` and
``results/croissant.json``; the words stand in these files. ``agents.dataset`` writes such a file beside each data set, from
``agents/croissant.json``. A test reads them with ``mlcroissant``, of the extra ``publish``.
"""

import hashlib
import json
import re
from pathlib import Path
from typing import Any

from agents._lib.files import write_json
from agents._lib.lifecycle import command, parser_of
from snooker_env import __version__

ROOT = Path(__file__).parents[1]
FILE = "croissant.json"
PUBLISHED = ("benchmarks/data", "results")


def metadata(words: Path, folder: Path, address: str = "", **changes: str) -> dict[str, Any]:
    """The metadata in the file ``words``, with ``changes``, of the files in a folder as they are now; ``address``: where the
    folder is published, "" if it is not."""
    content = json.loads(words.read_text(encoding="utf-8")) | changes
    content |= {"version": __version__} | ({"url": address} if address else {})
    for file in content["distribution"]:
        path = folder / file["@id"]
        with path.open("rb") as data:
            digest = hashlib.sha256()
            while part := data.read(1 << 20):
                digest.update(part)
        file["contentUrl"] = f"{address}/{file['@id']}" if address else file["@id"]
        file |= {"contentSize": f"{path.stat().st_size} B", "sha256": digest.hexdigest()}
    return content


def address_of(folder: str) -> str:
    """Where a folder of the repository is published: "" while pyproject.toml has no address."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (address,) = re.findall('^address = "(.*)"', text, re.MULTILINE)
    return address and f"{address}/raw/v{__version__}/{folder}"


@command("agents.croissant")
def main(argv=None):
    """Write both. Exit code 0."""
    parser_of("python -m agents.croissant", __doc__).parse_args(argv)
    for folder in PUBLISHED:
        file = ROOT / folder / FILE
        write_json(file, metadata(file, file.parent, address_of(folder)))
        print(file.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
