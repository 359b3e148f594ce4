"""This package reads the options of commands, checks them, and shows progress."""
