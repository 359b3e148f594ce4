"""This package holds the commands ``python -m hav_env play | compile`` and their options."""
