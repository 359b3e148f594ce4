"""This module reads archives of arrays from untrusted sources within limits of size.

``numpy.load`` unpacks everything that an archive holds. This module first reads the directory of
the archive and the head of every array, which state its size. It never allocates more than the
limit.
"""

import math
import os
import zipfile
from collections.abc import Callable, Mapping
from typing import BinaryIO, NamedTuple

import numpy as np

MOST_TEXT = 1 << 20  # characters
_MOST_MEMBERS = 64
_MOST_DIRECTORY = 1 << 16  # [bytes]
_MOST_HEAD = 512  # characters that describe an array; NumPy accepts more, and parses them
_MOST_AXES = 8
_END_RECORD, _LARGE_END = b"PK\x05\x06", b"PK\x06\x07"
_END_SIZE, _LARGE_SIZE = 22, 20  # [bytes]


class Head(NamedTuple):
    """Type and shape of an array, from the first bytes of its file."""

    shape: tuple[int, ...]
    columns_first: bool  # Fortran's order
    dtype: np.dtype


def read_archive(
    file: BinaryIO,
    kinds: Mapping[str, str],
    most_bytes: int,
    check: Callable[[dict[str, Head]], None] = lambda heads: None,
) -> dict[str, np.ndarray]:
    """Return arrays of an archive that ``numpy.savez_compressed`` wrote, in the machine's order.

    Args:
        file: File open for reading.
        kinds: Arrays to read, with the allowed NumPy kinds of each: "b", "i", "u", "f" for numbers;
            "U" for a single text.
        most_bytes: Largest size of all of them together, unpacked [bytes].
        check: Function that raises ValueError for shapes that do not belong together; it is called
            before any array is unpacked.

    Raises:
        ValueError: If an array is missing, duplicated, of another kind or too large; if the file is
            not an archive, or has more members than ``kinds`` allows.
        Exception: Any other error of unpacking a broken archive.
    """
    _check_directory(file)
    with zipfile.ZipFile(file) as archive:
        members: dict[str, zipfile.ZipInfo] = {}
        for info in archive.infolist():
            if info.filename in members:
                raise ValueError(f"{info.filename!r} is in it twice")
            members[info.filename] = info
        for name in kinds:
            if f"{name}.npy" not in members:
                raise ValueError(f"{name!r} is missing")
        wanted = {name: members[f"{name}.npy"] for name in kinds}
        total = sum(info.file_size for info in wanted.values())
        if total > most_bytes:
            raise ValueError(
                f"it unpacks to {total:,} bytes, but must unpack to at most {most_bytes:,}"
            )
        heads = {name: _read_head(archive, name, wanted[name], kinds[name]) for name in kinds}
        check(heads)
        return {name: _read(archive, wanted[name], heads[name]) for name in kinds}


def one_line(error: Exception) -> str:
    """Return an error's text as one line, for a message."""
    return f"{' '.join(str(error).split()) or type(error).__name__:.300}"


def _check_directory(file: BinaryIO) -> None:
    """Check the length of the directory, because ``zipfile`` reads all of it at once."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - _END_SIZE - _LARGE_SIZE, 0))
    end = file.read()
    record = end[-_END_SIZE:]
    if len(record) < _END_SIZE or record[:4] != _END_RECORD or record[-2:] != b"\0\0":
        raise ValueError("it is not an archive, or is incomplete")
    members = int.from_bytes(record[10:12], "little")
    directory = int.from_bytes(record[12:16], "little")
    large = end[:4] == _LARGE_END and len(end) == _END_SIZE + _LARGE_SIZE
    if large or members > _MOST_MEMBERS or directory > _MOST_DIRECTORY:
        raise ValueError(f"the archive has more than {_MOST_MEMBERS} members")
    file.seek(0)


def _read_head(archive: zipfile.ZipFile, name: str, info: zipfile.ZipInfo, kinds: str) -> Head:
    """Read the description of an array, and check that the data match it."""
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name!r} is packed in a way that NumPy does not pack")
    with archive.open(info) as member:
        if np.lib.format.read_magic(member) != (1, 0):  # type: ignore[arg-type]
            raise ValueError(f"{name!r} has another version of NumPy's format than 1.0")
        length = int.from_bytes(member.peek(2)[:2], "little")  # type: ignore[attr-defined]
        if length > _MOST_HEAD:
            raise ValueError(f"{name!r} is described by {length} characters")
        head = Head(
            *np.lib.format.read_array_header_1_0(member)  # type: ignore[arg-type]
        )
        left = info.file_size - member.tell()
    shape, _, dtype = head
    odd = any(size < 0 for size in shape) or len(shape) > _MOST_AXES
    text = dtype.kind == "U"
    too_long = dtype.itemsize > (4 * MOST_TEXT if text else 8) or (text and shape)
    if dtype.kind not in kinds or odd or too_long:
        raise ValueError(f"{name!r} is {dtype} of shape {shape}")
    if math.prod(shape) * dtype.itemsize != left:
        raise ValueError(f"{name!r} is {dtype} of shape {shape}, but has {left} bytes")
    return head


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, head: Head) -> np.ndarray:
    with archive.open(info) as member:
        np.lib.format.read_magic(member)  # type: ignore[arg-type]
        np.lib.format.read_array_header_1_0(member)  # type: ignore[arg-type]
        content = bytearray(member.read(info.file_size))
        if member.read(1):  # also compares the checksum
            raise ValueError(f"{info.filename!r} continues beyond its end")
    flat = np.frombuffer(content, head.dtype, math.prod(head.shape))
    found = flat.reshape(head.shape[::-1]).T if head.columns_first else flat.reshape(head.shape)
    return np.ascontiguousarray(found, head.dtype.newbyteorder("=")).reshape(head.shape)
