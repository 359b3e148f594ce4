"""This package shows that sites can be driven: drives of single HAVs, and a driver.

The plans are made off-line and kept; tests replay them in the simulator.
"""
