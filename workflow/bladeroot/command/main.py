"""`bladeroot`: look at a file, begin a campaign, check it, run it, and read what came out."""

from importlib import import_module

import click

from bladeroot import __version__

# Subcommands by name; each file is loaded when it is called, for the help of one needs no other.
COMMANDS = ("look", "new", "check", "run", "explain", "compare", "export")


class _Commands(click.Group):
    """Subcommands that are loaded late, and errors of one line."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        return import_module(f"bladeroot.command.{name}").command

    def invoke(self, ctx: click.Context):
        try:
            return super().invoke(ctx)
        except (ValueError, OSError) as error:
            for line in str(error).splitlines():
                click.echo(f"bladeroot: {line}", err=True)
            ctx.exit(1)


@click.command(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def main() -> None:
    """From ring-down records to frequency, damping, and what a simulation misses.

    Completion in bash: eval "$(_BLADEROOT_COMPLETE=bash_source bladeroot)".
    """
