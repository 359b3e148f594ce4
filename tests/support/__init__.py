"""This package holds the shared helpers of tests."""
