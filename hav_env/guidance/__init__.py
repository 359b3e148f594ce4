"""This package guides trucks among walls: how far is it to the goal, and which turn comes first."""

from hav_env.guidance.clearance import clearance_of
from hav_env.guidance.lattice import Lattice, LatticeTable, find_lengths
from hav_env.guidance.lookup import lattice_length, lattice_turn
from hav_env.guidance.table_files import load_lengths

__all__ = [
    "Lattice",
    "LatticeTable",
    "clearance_of",
    "find_lengths",
    "lattice_length",
    "lattice_turn",
    "load_lengths",
]
