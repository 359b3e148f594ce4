"""This module names the extra that installs a missing library."""

EXTRAS = {
    "benchmarl": "benchmarl",
    "defusedxml": "maps",
    "matplotlib": "plots",
    "moviepy": "rendering",
    "PIL": "maps",
    "pygame": "rendering",
    "ray": "ray",
    "shapely": "maps",
    "stable_baselines3": "training",
    "tensorboard": "training",
    "torch": "training",
    "torchrl": "torchrl",
    "yaml": "maps",
}
"""The extra of this project that installs a library, by the library's module."""


def how_to_install(extra: str) -> str:
    """Return what to run to install an extra; the package is on no index."""
    return f"run pip install -e '.[{extra}]' in the clone"


def name_extra(user: str, error: ModuleNotFoundError) -> str:
    """Return the message about a library that is missing.

    Args:
        user: part of the project that needs it.
        error: of the import.
    """
    library = (error.name or "").partition(".")[0]
    if library not in EXTRAS:
        return str(error)
    return f"{user} needs {library}: {how_to_install(EXTRAS[library])}"
