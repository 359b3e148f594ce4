"""This module reads the images of maps as shares of white; files may come from strangers."""

import os
import warnings

import numpy as np

from hav_env.models.annotations import show
from hav_env.places.libraries import import_maps

_MOST_BYTES = 2**26
_MOST_CELLS = 2**24  # 4,096 by 4,096
_FORMATS = ("PPM", "PNG", "BMP")  # Pillow's names; PPM reads pgm
_MODES = {"1": 1, "L": 1, "LA": 2, "RGB": 3, "RGBA": 4}
_DEEP = ("I", "I;16", "I;16B")  # 16 bits


def read_shades(
    path: str | os.PathLike[str], average_alpha: bool
) -> tuple[np.ndarray, np.ndarray | None]:
    """Return the shares of white of the cells of a map.

    Args:
        path: path of a PGM, PNG or BMP file.
        average_alpha: whether opacity counts as one more colour, as in map_server's trinary maps.

    Returns:
        (H, W) float32 shares of white, the highest row first; and (H, W) bool, whether they are
        opaque, or None without opacity.

    Raises:
        ImportError: without the extra ``maps``.
        OSError: if the system cannot open the file.
        ValueError: if it is no such image, or too large.
    """
    image_module = import_maps("PIL.Image")
    with open(path, "rb") as file:
        if os.fstat(file.fileno()).st_size > _MOST_BYTES:
            raise ValueError(f"image {path} has more than {_MOST_BYTES} bytes")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # the size is checked below, before it is read
                picture = image_module.open(file, formats=_FORMATS)
        except image_module.DecompressionBombError:
            raise ValueError(f"image {path} is too large: {_least_told()}") from None
        except Exception as error:  # Pillow's readers raise errors of any type for a broken file
            told = f"image {path} is no PGM, PNG or BMP that can be read"
            raise ValueError(f"{told}: {show(error, str)}") from None
        width, height = picture.size
        if width * height > _MOST_CELLS:
            raise ValueError(f"image {path} has {width} by {height} cells: {_least_told()}")
        try:
            return _shades(picture, average_alpha)
        except Exception as error:
            told = f"image {path} cannot be read to its end"
            raise ValueError(f"{told}: {show(error, str)}") from None


def _least_told() -> str:
    return f"there must be at most {_MOST_CELLS}"


def _shades(picture, average_alpha: bool) -> tuple[np.ndarray, np.ndarray | None]:
    if picture.mode in _DEEP:
        return np.asarray(picture, np.float32) / np.float32(65535.0), None
    if picture.mode not in _MODES:  # a palette, for example
        picture = picture.convert("RGBA" if "transparency" in picture.info else "RGB")
    if picture.mode == "1":
        picture = picture.convert("L")
    values = np.asarray(picture)
    values = values.reshape(*values.shape[:2], -1)
    has_alpha = picture.mode in ("LA", "RGBA")
    colors = values if average_alpha or not has_alpha else values[..., :-1]
    shade = colors.sum(axis=-1, dtype=np.uint32).astype(np.float32)
    shade /= np.float32(255.0 * colors.shape[-1])
    return shade, values[..., -1] == 255 if has_alpha else None
