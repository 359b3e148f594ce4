"""The command line: ``python -m hav_env play``."""

import sys

_COMMANDS = {"play": "drive one HAV by keyboard among others"}


def main(arguments: list[str] | None = None) -> int:
    """Run a command; return the exit code. What is wrong is said in one line."""
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        return _dispatch(arguments)
    except (ValueError, TypeError, OSError, ImportError) as error:
        message = " ".join(str(error).split())
        print(f"error: {message}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _dispatch(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help"):
        print("usage: python -m hav_env COMMAND [--help]\n")
        for name, meaning in _COMMANDS.items():
            print(f"  {name:6} {meaning}")
        return 0
    command, rest = arguments[0], arguments[1:]
    if command != "play":
        raise ValueError(f"unknown command {command!r}; known: {', '.join(_COMMANDS)}")
    # only what is run is imported: tyro and the simulator take their time
    from hav_env.cli.options import parse_options  # noqa: PLC0415
    from hav_env.cli.play import Play, play  # noqa: PLC0415

    play(parse_options(Play, "python -m hav_env play", _COMMANDS["play"], rest))
    return 0


if __name__ == "__main__":
    sys.exit(main())
