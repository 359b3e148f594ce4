"""This package holds the memory of a HAV under Reserve: its rows, their sizes and states."""
