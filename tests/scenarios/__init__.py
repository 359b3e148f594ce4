"""This package tests scenarios and fleets."""
