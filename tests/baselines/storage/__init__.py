"""This package tests files: archives, atomic writes, locks."""
