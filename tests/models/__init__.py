"""This package tests names, fields and ranges of models."""
