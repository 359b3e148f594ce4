"""This module is the command line ``python -m hav_env``, the same as ``hav-env``."""

import sys

from hav_env.cli.menu import run_menu as main

if __name__ == "__main__":
    sys.exit(main())
