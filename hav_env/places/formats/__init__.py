"""This package reads sites from the files of other programs: a module for each format."""
