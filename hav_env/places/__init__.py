"""This package defines sites: obstacles and bounds, built by hand or read from maps."""

from hav_env.places.loading import load_site
from hav_env.places.site import (
    BOUNDARY,
    LINE,
    NOWHERE,
    POLYGON,
    Site,
    build_site,
    chains_of,
    is_inside,
)

__all__ = [
    "BOUNDARY",
    "LINE",
    "NOWHERE",
    "POLYGON",
    "Site",
    "build_site",
    "chains_of",
    "is_inside",
    "load_site",
]
