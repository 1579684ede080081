"""The application that commands join, and how it ends: one line for a user's mistake, an exit code for every outcome."""

import signal
import sys
import warnings
from typing import Annotated

import typer

from anisogran import __version__
from anisogran.outcome import InputError, Interrupted, NotConverged, RunFailed

OK, BAD_INPUT, RUN_FAILED, NOT_CONVERGED, NOT_TRUSTWORTHY, INTERRUPTED = 0, 2, 3, 4, 5, 130

app = typer.Typer(
    help="From particle simulations to continuum theory for granular matter.", add_completion=False,
    pretty_exceptions_enable=False, rich_markup_mode=None,
)  # fmt: skip


@app.callback(invoke_without_command=True)
def anisogran(version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False):
    """From particle simulations to continuum theory for granular matter."""
    if version:
        print(f"anisogran {__version__}")
        raise typer.Exit


def main(arguments=None):
    """Runs the command line and leaves with its exit code; a user's mistake is one line on stderr, never a traceback."""
    arguments = sys.argv[1:] if arguments is None else arguments
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ended politely is interrupted: workers are stopped, folders left clean
    warnings.showwarning = one_line
    try:
        code = app(args=arguments or ["--help"], prog_name="anisogran", standalone_mode=False)
        if code == INTERRUPTED:  # typer gives an interrupt an exit code, but no word
            complain("interrupted", code)
    except typer.Exit as end:
        code = end.exit_code
    except InputError as error:
        code = complain(error, BAD_INPUT)
    except RunFailed as error:
        code = complain(error, RUN_FAILED)
    except NotConverged as error:
        code = complain(error, NOT_CONVERGED)
    except (KeyboardInterrupt, Interrupted) as error:
        code = complain(str(error) or "interrupted", INTERRUPTED)
    except Exception as error:
        if not hasattr(error, "format_message"):  # typer's own errors: a wrong option, a value of the wrong type
            raise
        code = complain(error.format_message(), BAD_INPUT)
    sys.exit(code or OK)


def one_line(message, category, filename, lineno, file=None, line=None):
    """Shows a warning as the user's concern that it is, without the line of our sources at which it arose."""
    complain(f"warning: {message}", OK)


def complain(error, code):
    """One line on stderr; returns the exit code."""
    print(f"anisogran: {' '.join(str(error).split())}", file=sys.stderr)
    return code
