"""What does a package page show? The README with links that lead somewhere there, and the project's addresses.

``address`` in pyproject.toml is where the repository is published. While it is empty there are no addresses, and
links to files of the repository become plain text. docs/develop/release.md says how to set it.
"""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_FENCES = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)
_HERE = r"(?!https?:|mailto:|#)"
_PICTURE = re.compile(rf"!\[([^\]]*)\]\({_HERE}([^)\s]+)\)")
_LINK = re.compile(rf"(?<!!)\[([^\]]*)\]\({_HERE}([^)\s]+)\)")
_NAMED = re.compile(r"\[([^\]]+)\]\[(\w+)\]")
_TARGET = re.compile(rf"^\[(\w+)\]: *{_HERE}(\S+)$", re.MULTILINE)


def page(text: str, address: str, tag: str) -> str:
    """A README for a package page: links to files, outside of code, are those of ``tag`` at ``address``."""
    parts = _FENCES.split(text)
    targets = dict(_TARGET.findall("\n".join(parts[::2])))
    for k in range(0, len(parts), 2):
        one = _TARGET.sub("", parts[k])
        one = _NAMED.sub(lambda found: f"[{found[1]}]({targets.get(found[2], found[2])})", one)
        if address:
            one = _PICTURE.sub(rf"![\1]({address}/raw/{tag}/\2)", one)
            one = _LINK.sub(rf"[\1]({address}/blob/{tag}/\2)", one)
        else:
            one = _LINK.sub(r"\1", _PICTURE.sub("", one))
        parts[k] = one
    return "".join(parts).rstrip() + "\n"


class CustomMetadataHook(MetadataHookInterface):
    """Sets ``readme`` and ``urls``, which pyproject.toml declares as dynamic."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add both to ``metadata``, whose version is known."""
        address, tag = self.config["address"].rstrip("/"), f"v{metadata['version']}"
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": page(text, address, tag)}
        places = {
            "Homepage": "",
            "Documentation": f"/blob/{tag}/docs/index.md",
            "Source": "",
            "Issues": "/issues",
            "Changelog": f"/blob/{tag}/CHANGELOG.md",
        }
        metadata["urls"] = {name: address + path for name, path in places.items()} if address else {}
