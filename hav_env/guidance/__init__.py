"""This package guides trucks among walls: the length of the path to a goal, and its first turn."""

from hav_env.guidance.clearance import clearance_of
from hav_env.guidance.feasible_routes import Feasible, begin_feasible, follow_feasible
from hav_env.guidance.lattice import Lattice, LatticeTable, find_lengths
from hav_env.guidance.lattice_routes import begin_on_lattice, follow_on_lattices
from hav_env.guidance.lookup import lattice_length, lattice_turn
from hav_env.guidance.roads import RoadNetworks, Roads, begin_on_road, follow_on_roads
from hav_env.guidance.table_files import load_lengths
from hav_env.guidance.witness_routes import Witness, begin_on_witness, follow_on_witnesses
from hav_env.world.place.guidance import Dubins

__all__ = [
    "Dubins",
    "Feasible",
    "Lattice",
    "LatticeTable",
    "RoadNetworks",
    "Roads",
    "Witness",
    "begin_feasible",
    "begin_on_lattice",
    "begin_on_road",
    "begin_on_witness",
    "clearance_of",
    "find_lengths",
    "follow_feasible",
    "follow_on_lattices",
    "follow_on_roads",
    "follow_on_witnesses",
    "lattice_length",
    "lattice_turn",
    "load_lengths",
]
