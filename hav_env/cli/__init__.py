"""This package holds the commands ``python -m hav_env play | compile | site`` and their options."""
