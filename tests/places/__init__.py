"""This package tests places: sites, and the files that they come from."""
