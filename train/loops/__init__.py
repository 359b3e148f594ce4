"""This package has the parts of the own training loops: worlds, networks, starts, files."""
