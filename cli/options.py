"""Options that several commands have in common."""

import click

ROBOTS = "ur3e, ur5e, ur10e, ur16e, or a robot FILE.toml."
robot_option = click.option("--robot", default="ur5e", show_default=True, help=ROBOTS)
