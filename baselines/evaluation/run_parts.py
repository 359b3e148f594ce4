"""This module stores the parts of a table until it is complete; a part's name holds its digest."""

import hashlib
import logging
import pathlib
import re
import shutil
from collections.abc import Iterable

import pyarrow as pa
import pyarrow.parquet as pq

from baselines.storage.atomic_files import digest_of, whole_file

_NAME = re.compile(r"(\d{9,})-([0-9a-f]{64})\.parquet")


def write_table(table: pa.Table, path: pathlib.Path) -> None:
    """Write a Parquet file atomically."""
    with whole_file(path) as unfinished:
        pq.write_table(table, unfinished)


def write_part(table: pa.Table, folder: pathlib.Path, first: int) -> pathlib.Path:
    """Write a part of a table atomically.

    Args:
        table: Part to write.
        folder: Folder of the parts.
        first: Number of its first episode.
    """
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink)
    content = sink.getvalue().to_pybytes()
    path = folder / f"{first:09d}-{hashlib.sha256(content).hexdigest()}.parquet"
    with whole_file(path) as unfinished:
        unfinished.write_bytes(content)
    return path


def find_parts(folder: pathlib.Path) -> dict[int, pathlib.Path]:
    """Return the complete parts by their first episodes; remove broken ones."""
    found = {}
    for path in sorted(folder.iterdir()):
        name = _NAME.fullmatch(path.name)
        if name is None:
            continue
        if digest_of(path) == name[2]:
            found[int(name[1])] = path
            continue
        logging.getLogger(__name__).warning("%s is broken: its episodes are run again", path)
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()
    return found


def join_parts(parts: Iterable[pathlib.Path], target: pathlib.Path) -> str:
    """Write the table of all parts atomically; return its digest.

    Raises:
        OSError: If a part has been broken since it was written, or the table cannot be written.
    """
    with whole_file(target) as unfinished:
        writer = None
        try:
            for part in parts:
                table = _read(part)
                writer = writer or pq.ParquetWriter(unfinished, table.schema)
                writer.write_table(table)
        finally:
            if writer is not None:
                writer.close()
        digest = digest_of(unfinished)
    assert digest is not None
    return digest


def _read(path: pathlib.Path) -> pa.Table:
    content = path.read_bytes()
    name = _NAME.fullmatch(path.name)
    if name is None or hashlib.sha256(content).hexdigest() != name[2]:
        raise OSError(f"{path} is broken: the same command runs its episodes again")
    # pq.read_table would load the library of datasets, which is slow
    return pq.ParquetFile(pa.BufferReader(content)).read()
