"""This package tests hav_env, baselines, train, the benchmarks and the documentation."""
