"""This module reads archives of arrays from strangers within limits of size.

``numpy.load`` unpacks everything that an archive holds. This module first reads the directory of
the archive and the head of every array, which tell its size. It allocates nothing too large.
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
_MOST_HEAD = 512  # characters that describe an array; NumPy takes more, and parses them
_MOST_AXES = 8
_END_RECORD, _LARGE_END = b"PK\x05\x06", b"PK\x06\x07"
_END_SIZE, _LARGE_SIZE = 22, 20  # [bytes]


class Head(NamedTuple):
    """The type and shape of an array, as the first bytes of its file tell."""

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
        file: open for reading.
        kinds: the arrays to read, and of each NumPy's kinds that are allowed: "b", "i", "u", "f"
            for numbers; "U" for a single text.
        most_bytes: of all of them together, unpacked.
        check: raises ValueError for shapes that do not belong together; it is called before any
            array is unpacked.

    Raises:
        ValueError: when an array is missing, doubled, of another kind or too large, or the archive
            is not one, or has more members than any that ``kinds`` could be of.
        Exception: whatever else breaks while a broken archive is unpacked.
    """
    _check_directory(file)
    with zipfile.ZipFile(file) as archive:
        members: dict[str, zipfile.ZipInfo] = {}
        for info in archive.infolist():
            if info.filename in members:
                raise ValueError(f"{info.filename!r} stands in it twice")
            members[info.filename] = info
        for name in kinds:
            if f"{name}.npy" not in members:
                raise ValueError(f"{name!r} is missing")
        wanted = {name: members[f"{name}.npy"] for name in kinds}
        total = sum(info.file_size for info in wanted.values())
        if total > most_bytes:
            raise ValueError(f"it unpacks to {total:,} bytes, but must to at most {most_bytes:,}")
        heads = {name: _read_head(archive, name, wanted[name], kinds[name]) for name in kinds}
        check(heads)
        return {name: _read(archive, wanted[name], heads[name]) for name in kinds}


def one_line(error: Exception) -> str:
    """Return what an error says, for a message of one line."""
    return f"{' '.join(str(error).split()) or type(error).__name__:.300}"


def _check_directory(file: BinaryIO) -> None:
    """Check how long the directory is, for ``zipfile`` reads all of it at once."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - _END_SIZE - _LARGE_SIZE, 0))
    end = file.read()
    record = end[-_END_SIZE:]
    if len(record) < _END_SIZE or record[:4] != _END_RECORD or record[-2:] != b"\0\0":
        raise ValueError("no archive, or cut short")
    members = int.from_bytes(record[10:12], "little")
    directory = int.from_bytes(record[12:16], "little")
    large = end[:4] == _LARGE_END and len(end) == _END_SIZE + _LARGE_SIZE
    if large or members > _MOST_MEMBERS or directory > _MOST_DIRECTORY:
        raise ValueError(f"the archive has more than {_MOST_MEMBERS} members")
    file.seek(0)


def _read_head(archive: zipfile.ZipFile, name: str, info: zipfile.ZipInfo, kinds: str) -> Head:
    """Read what an array is, and check that it is what it says."""
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
            raise ValueError(f"{info.filename!r} goes on beyond its end")
    flat = np.frombuffer(content, head.dtype, math.prod(head.shape))
    found = flat.reshape(head.shape[::-1]).T if head.columns_first else flat.reshape(head.shape)
    return np.ascontiguousarray(found, head.dtype.newbyteorder("=")).reshape(head.shape)
