"""This package guides trucks among walls: how far is it to the goal, and which turn comes first."""

from hav_env.guidance.clearance import clearance_of
from hav_env.guidance.lattice import Lattice, LatticeTable, find_lengths
from hav_env.guidance.table_files import load_lengths

__all__ = ["Lattice", "LatticeTable", "clearance_of", "find_lengths", "load_lengths"]
