"""This module lists the built-in names of models, each with its meaning in one line."""

MEANINGS = {
    "scenario": {
        "paper-single": "the paper's: one HAV, random start, two random goals",
        "paper-pair": "the paper's: two HAVs in a square of four times their area",
        **{f"swarm-{n}": f"as paper-pair, with {n} HAVs" for n in (5, 10, 20, 50, 200)},
        "dense-2": "as paper-pair, in half the area",
        **{f"dense-{n}": f"as swarm-{n}, in half the area" for n in (5, 10, 20, 50)},
        "crossing-2": "2 HAVs cross a circle through its centre",
        "crossing-8": "8 HAVs cross a circle through its centre",
        "yard-4": "4 HAVs drive from a row of bays into random bays opposite",
        "yard-10": "10 HAVs drive from a row of bays into random bays opposite",
        "column-5": "5 HAVs, one behind the other, drive 200 m straight on",
    },
    "site": {
        "field-1": "1 real vehicle among 32 random walls in 120 m x 120 m",
        "field-4": "4 real vehicles among 32 random walls in 120 m x 120 m",
        "gate-2": "2 HAVs meet at a gate that is 1 m wider than they are",
        "docks-6": "6 HAVs in a yard: from waiting lanes through docks and back",
        "junction-4": "4 HAVs at a junction of two roads",
        "aisles-6": "6 tugger trains in a warehouse with aisles of 3 m",
        "haul-road-4": "4 long trucks on a two-way road between two loops",
        "parking-8": "8 HAVs in two rows of oblique places, which they drive through",
        "roundabout-6": "6 HAVs at a roundabout with four arms",
        "apron-6": "6 baggage trains between a hall and parked aircraft",
    },
    "vehicle": {
        "on_axle": "the paper's: each trailer is hitched on the axle ahead of it",
        "limited": "on_axle, with limited acceleration and steering rate",
        "off_axle": "hitches may be off the axles; bodies are lines",
        "rectangular": "off_axle, with rectangular bodies",
        "realistic": "off_axle, with rectangular bodies and limited rates",
    },
    "guidance": {
        "dubins": "shortest Dubins path; it ignores walls",
        "witness": "the path that a field keeps free for each HAV",
        "lattice": "shortest route among walls, for sites with fixed goals",
        "roads": "road network on which all bodies keep clear of walls",
        "feasible": "shortest route that the HAV's own chain can drive",
    },
    "reward": {
        "default": "progress and arrival, less jackknifes and collisions",
        "site": "the default reward, and obstacles",
    },
}
"""Built-in names of each kind of model, with their meanings."""
