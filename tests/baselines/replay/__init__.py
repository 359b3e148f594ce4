"""This package tests recorded episodes and how they are watched."""
