"""How do strokes stand in a file? The first bytes of all numbers, then all second bytes and so on, packed."""

import base64
import hashlib
import zlib

import numpy as np

from .._check import refuse, refuse_what
from .playing import Kept


def packed(strokes: Kept) -> dict[str, str]:
    """The field ``strokes`` of a file: little-endian float32, by zlib, in base64, with a digest."""
    rows = [np.ascontiguousarray(one, "<f4") for one in strokes if len(one)]
    raw = np.concatenate(rows).view(np.uint8).T.tobytes() if rows else b""
    return {
        "sha256": hashlib.sha256(raw).hexdigest(),
        "data": base64.b64encode(zlib.compress(raw, 9)).decode(),
    }


def unpacked(field: dict[str, str], lengths: list[int], size: int) -> Kept:
    """Actions (n, ``size``) of each episode; ValueError if they are damaged or no actions."""
    n, width = sum(lengths), 4 * size
    try:
        packing = zlib.decompressobj()
        raw = packing.decompress(base64.b64decode(field["data"], validate=True), n * width + 1)
    except (zlib.error, ValueError) as error:
        much = f"{len(field['data']):,} characters"
        raise refuse_what("strokes.data", much, f"must be zlib in base64 ({error})") from None
    if len(raw) != n * width or not packing.eof or packing.unused_data:
        much = f"{len(raw):,} bytes" if packing.eof else f"more than {len(raw) - 1:,} bytes, or cut off"
        raise refuse_what(
            "strokes.data", much, f"must be {n * width:,} bytes, {width} for each of {n:,} strokes"
        )
    digest = hashlib.sha256(raw).hexdigest()
    if digest != field["sha256"]:
        raise refuse("strokes.sha256", field["sha256"], f"must be {digest}, the digest of the strokes")
    actions = np.frombuffer(raw, np.uint8).reshape(width, n).T.copy().view("<f4").reshape(n, size)
    sound = np.abs(actions) <= 1.0  # False for NaN
    if not sound.all():
        k, c = np.argwhere(~sound)[0].tolist()
        raise refuse(f"strokes.data[{k}, {c}]", float(actions[k, c]), "must be finite and within [-1, 1]")
    return np.split(actions, np.cumsum(lengths)[:-1]) if lengths else []
