"""This module puts scenarios with random or given poses on a site of the user."""

import functools
import os
from typing import Any

from hav_env.models.annotations import show
from hav_env.models.checks import check_fields
from hav_env.places import Site, load_site
from hav_env.scenarios.explicit import Explicit
from hav_env.scenarios.random_poses import RandomPoses
from hav_env.scenarios.sites.random_site_poses import RandomSitePoses


def read_site(site: Site | str | os.PathLike[str]) -> Site:
    """Return a checked site.

    Args:
        site: a site, or the path of its file, see ``load_site``.

    Raises:
        TypeError: if it is neither.
        ValueError: if the file, or an array of the site, is wrong.
        OSError: if the system cannot read the file.
        ImportError: if the file needs the missing extra ``maps``.
    """
    if isinstance(site, Site):
        check_fields("site", site)
        return site
    if not isinstance(site, str | os.PathLike):
        raise TypeError(f"site is {show(site)}, but must be a Site or the path of a file")
    return load_site(site)


@functools.singledispatch
def put_on_site(scenario: Any, site: Site) -> Any:
    """Return a scenario on a site; register a function for a class of your own.

    Raises:
        ValueError: if the scenario places HAVs by a rule without obstacles, or has a site.
    """
    raise ValueError(
        f"scenario is of the class {type(scenario).__name__}, but must be RandomPoses or written"
        " down (Explicit) without a site, to be put on a site"
    )


@put_on_site.register
def _(scenario: RandomPoses, site: Site) -> RandomSitePoses:
    """The site sets the area; the factor has no effect."""
    return RandomSitePoses(
        site,
        scenario.num_havs,
        scenario.num_goals,
        scenario.fleet,
        pose_attempts=scenario.pose_attempts,
        world_attempts=scenario.world_attempts,
    )


@put_on_site.register
def _(scenario: RandomSitePoses, site: Site) -> RandomSitePoses:
    return scenario._replace(site=site)


@put_on_site.register
def _(scenario: Explicit, site: Site) -> Explicit:
    if scenario.site.num_segments > 0:
        raise ValueError(f"scenario has {scenario.site!r}, but must have no site to be put on one")
    return scenario._replace(site=site)
