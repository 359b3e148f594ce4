"""This module runs ``python -m train.rllib``: PPO on Ray RLlib."""

import sys

from train.rllib.training import main

if __name__ == "__main__":
    sys.exit(main())
