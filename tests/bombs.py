"""How does a test see that nothing of a model's file was run? Its pickles leave a mark when loaded."""

import base64
import io
import json
import pickle
import zipfile
from pathlib import Path


class Bomb:
    """Unpickled, it makes a file."""

    def __init__(self, mark):
        self._mark = mark

    def __reduce__(self):
        return Path.touch, (Path(self._mark),)


def rezipped(source, target, **parts):
    """A copy of a zip with parts changed: name (_ for .) -> a function of the bytes, None to leave out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            change = parts.get(name.replace(".", "_"), lambda data: data)
            if change is not None:
                new.writestr(name, change(old.read(name)))
    return target


def edited(change):
    """A change of a JSON part: ``change(found)`` changes the dict."""

    def changed(data):
        found = json.loads(data)
        change(found)
        return json.dumps(found).encode()

    return changed


def bombed(source, target, mark, weights=False, change=lambda found: None):
    """A copy of an SB3 file with bombs as pickles, also in policy.pth if ``weights``; ``change`` does the rest."""
    bomb = pickle.dumps(Bomb(mark), protocol=2)

    def fill(found):
        for value in found.values():
            if isinstance(value, dict) and ":serialized:" in value:
                value[":serialized:"] = base64.b64encode(bomb).decode()
        change(found)

    def filled(data):
        file = io.BytesIO()
        with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(file, "w") as new:
            for name in old.namelist():
                new.writestr(name, bomb if name.endswith("data.pkl") else old.read(name))
        return file.getvalue()

    return rezipped(source, target, data=edited(fill), **({"policy_pth": filled} if weights else {}))
