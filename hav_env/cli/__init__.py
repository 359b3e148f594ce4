"""This package holds the menu ``hav-env``, the commands of the simulator and their options."""
