"""Archives as attackers craft them; ``python -m tests.support.strangers FOLDER`` opens a folder."""

import io
import json
import pathlib
import re
import resource
import sys
import time
import zipfile

import numpy as np

from baselines.policies.files import load_trained
from baselines.replay.trajectory_files import load_trajectory

ROOM = 200 << 20  # [bytes] of memory for reading


def head(shape, descr="<f4", fortran=False):
    """Return the first bytes of an array's file, with any claims."""
    text = f"{{'descr': {descr!r}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def packed(value):
    """Return an array as a file; bytes are taken as they are."""
    if isinstance(value, bytes):
        return value
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asarray(value))
    return file.getvalue()


def archive(path, members, kind=zipfile.ZIP_DEFLATED):
    """Write an archive of members (name, array or bytes), which may be double."""
    with zipfile.ZipFile(path, "w", kind) as file:
        for name, value in members:
            file.writestr(f"{name}.npy", packed(value))


def bomb(path, arrays, name):
    """Write an archive of which one array unpacks to a gigabyte of zeros."""
    archive(path, [(other, array) for other, array in arrays.items() if other != name])
    chunk = bytes(1 << 24)
    with (
        zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as file,
        file.open(f"{name}.npy", "w") as member,
    ):
        member.write(head((1 << 28,)))
        for _ in range(64):
            member.write(chunk)


def claim(path, name, size):
    """Let the directory of an archive say that a member unpacks to so many bytes."""
    content = bytearray(path.read_bytes())
    ends = re.finditer(f"{name}.npy".encode(), content)
    places = [end.start() - 46 for end in ends]
    (place,) = [place for place in places if content[place : place + 4] == b"PK\x01\x02"]
    content[place + 24 : place + 28] = size.to_bytes(4, "little")
    path.write_bytes(content)


def garble(content, rng):
    """Return a file with a few bytes flipped, cut off, put in or repeated."""
    content = bytearray(content)
    place, length = int(rng.integers(len(content))), int(rng.integers(1, 200))
    match rng.integers(5):
        case 0:
            content[place] ^= 1 << int(rng.integers(8))
        case 1:
            del content[place:]
        case 2:
            content[place:place] = rng.bytes(length)
        case 3:
            content[place : place + length] = rng.bytes(length)
        case 4:
            content += content[place : place + length]
    return bytes(content)


def main(folder):
    """Open every file with little memory left; print the messages, and the duration."""
    used = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + ROOM, used + ROOM))
    for path in sorted(folder.iterdir()):
        begun, said = time.perf_counter(), ""
        try:
            (load_trained if path.suffix == ".policy" else load_trajectory)(path)
        except ValueError as error:
            said = str(error)
        print(json.dumps([path.name, said, time.perf_counter() - begun]))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
