"""This package has the commands of the menu that run policies, a module for each."""
