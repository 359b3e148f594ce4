"""This package tests places: sites, the files that they come from, and who touches them."""
