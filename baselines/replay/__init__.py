"""This package records episodes, and shows them in a window, a film or a web page."""
