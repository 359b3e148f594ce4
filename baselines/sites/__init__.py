"""This package shows that sites can be driven: drives of single HAVs, and a driver.

The plans are computed off-line and stored; tests replay them in the simulator.
"""
