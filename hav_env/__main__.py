"""This module is the command line ``python -m hav_env play | compile | site``."""

import sys

from hav_env.cli.errors import report_errors

_COMMANDS = {
    "play": "drive one HAV by keyboard among others",
    "compile": "compile all policies, scenarios and environments ahead of time",
    "site": "say what a file of a site holds, and draw it",
}


def main(arguments: list[str] | None = None) -> int:
    """Run a command, report an error in one line, and return the exit code."""
    return report_errors(_dispatch, arguments)


def _dispatch(arguments: list[str]) -> None:
    if not arguments or arguments[0] in ("-h", "--help"):
        print("usage: python -m hav_env COMMAND [--help]\n")
        for name, meaning in _COMMANDS.items():
            print(f"  {name:8} {meaning}")
        return
    command, rest = arguments[0], arguments[1:]
    if command not in _COMMANDS:
        raise ValueError(f"unknown command {command!r}; known: {', '.join(_COMMANDS)}")
    # only what is run is imported: tyro and the simulator take their time
    from hav_env.cli.options import parse_options  # noqa: PLC0415

    usage = f"python -m hav_env {command}"
    if command == "play":
        from hav_env.cli.play import Play, play  # noqa: PLC0415

        play(parse_options(Play, usage, _COMMANDS[command], rest))
    elif command == "site":
        from hav_env.cli.site import DescribeSite, describe_site  # noqa: PLC0415

        describe_site(parse_options(DescribeSite, usage, _COMMANDS[command], rest))
    else:
        from hav_env.cli.compile import Compile, compile_all  # noqa: PLC0415

        compile_all(parse_options(Compile, usage, _COMMANDS[command], rest))


if __name__ == "__main__":
    sys.exit(main())
