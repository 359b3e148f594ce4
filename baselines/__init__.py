"""This package runs, evaluates and replays policies: AVOID-JACK, Reserve, trained networks."""
