"""This package guides HAVs on a road network: poses joined by drives that keep all bodies clear."""

from hav_env.guidance.roads.files import load_networks
from hav_env.guidance.roads.model import RoadNetworks, Roads
from hav_env.guidance.roads.routes import begin_on_road, follow_on_roads

__all__ = ["RoadNetworks", "Roads", "begin_on_road", "follow_on_roads", "load_networks"]
