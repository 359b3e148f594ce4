"""This module writes small maps and images for tests."""

import struct
import zlib

import numpy as np
import yaml
from PIL import Image

PLAIN = {
    "image": "yard.pgm",
    "resolution": 0.5,
    "origin": [0.0, 0.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
BLACK, GREY, WHITE = 0, 205, 254  # as map_saver writes occupied, unknown and free cells


def write_map(folder, shades, **entries):
    """Write a map; the first row of shades is the highest. An entry that is None is left out."""
    told = {name: value for name, value in (PLAIN | entries).items() if value is not None}
    picture = Image.fromarray(np.asarray(shades, np.uint8))
    picture.save(folder / str(told.get("image", "yard.pgm")))
    (folder / "yard.yaml").write_text(yaml.safe_dump(told))
    return folder / "yard.yaml"


def png_header(width, height):
    """Return a PNG that claims this size, and has almost no data."""

    def chunk(kind, data):
        checked = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checked)

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    data = chunk(b"IDAT", zlib.compress(bytes(1_000)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + data + chunk(b"IEND", b"")
