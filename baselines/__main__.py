"""This module is the command line ``python -m baselines``, the same menu as ``hav-env``."""

import sys

from hav_env.cli.menu import run_menu as main

if __name__ == "__main__":
    sys.exit(main())
