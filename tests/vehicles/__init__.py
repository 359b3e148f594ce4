"""This package tests the kinematics of trucks and trailers."""
