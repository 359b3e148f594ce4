"""This package reads and writes files safely: archives of arrays, atomic writes, locks."""
