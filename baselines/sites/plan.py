"""This module finds the drives of sites: ``python -m baselines.sites.plan docks-6``.

The command writes them to the folder that tests and pictures read. It takes a minute or two for a
site.
"""

import sys

from baselines.sites.drives import plan_site, write_plans
from hav_env.cli.errors import report_errors
from hav_env.models.text import visible
from hav_env.scenarios.presets import SITES
from hav_env.scenarios.sites import SITE_VEHICLES


def main(names: list[str] | None = None) -> int:
    """Find the drives of the named sites, of all by default; return the exit code."""
    return report_errors(_plan, sys.argv[1:] if names is None else names, "files are whole")


def _plan(names: list[str]) -> None:
    for name in names or SITES:
        if name not in SITES:
            raise ValueError(f"unknown site {name!r}; known: {', '.join(SITES)}")
        print(visible(str(write_plans(plan_site(name, SITE_VEHICLES[name])))), flush=True)


if __name__ == "__main__":
    sys.exit(main())
