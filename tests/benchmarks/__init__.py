"""This package tests the benchmarks."""
