"""This package tests places: sites, their files, and collisions with them."""
