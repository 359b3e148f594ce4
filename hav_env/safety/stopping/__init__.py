"""This package has the safety filter for trucks that need time to brake.

A HAV brakes by commanding no speed and holding its wheels, as a waiting HAV does by itself. A
command passes if the HAV can brake after it until it stands: without a jackknife, without a
collision, and so that it can straighten from there. docs/safety-filter.md has the proofs.
"""
