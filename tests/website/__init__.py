"""This package tests the site and the notebooks; it needs the extra ``docs``."""
