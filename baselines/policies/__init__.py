"""This package holds the policies: AVOID-JACK, Reserve, Dubins pursuit, random, networks."""
