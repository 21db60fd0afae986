"""Entry point: commands loaded late, errors shown in one place, documented exit codes."""

from __future__ import annotations

import json
import sys
from typing import Any

import click

from cranktopo.cli.group import LazyGroup
from cranktopo.cli.streams import discard, finish_stdout, prepare_streams
from cranktopo.cli.verbosity import coloured
from cranktopo.errors import CranktopoError, ExitCode, shown

# Command -> module that holds a click command of the same name. Modules load only when called for, so
# that `--help` stays fast.
COMMANDS = {
    "optimise": "Optimise the web's density under bending and torsion; write a run with STL.",
    "plan": "Which effects a design calls for, why, and what each would cost.",
    "loads": "Forces over the working cycle, their extremes, and the load cases.",
    "balance": "Balance of the whole engine: free forces and moments, counterweights, balancer shafts.",
    "evaluate": "Evaluate designs, runs or STL files: mass, torsional and bending stiffness on tet10 solids.",
    "compare": "Compare targets against a baseline: table, Markdown, CSV, JSON or a scatter plot.",
    "accuracy": "What accuracy costs in time: error against seconds for evaluation and optimiser.",
    "report": "Write the page of a run: verdict, 3D view, curves, tables; HTML or Markdown with PNGs.",
    "fatigue": "Fatigue safety of designs with true fillets: local stress analysis, FKM, IACS UR M53.",
    "shaft": "Assemble the throws of a crankshaft: torsional stiffness, natural frequencies, openTorsion.",
    "vibration": "Torsional vibration of the whole shaft: critical speeds, torque and stress by order.",
    "extract": "Surface of a run, or of any iteration of it, as STL, 3MF or GLB.",
    "remodel": "Fit a parametric web that can be made to a run: scene, STEP, STL, drawing, shape error.",
    "shape": "The best dimensions of a web that can be made, for a goal and limits: scene, STEP, drawing.",
    "bound": "What no web of the envelope can beat, whatever its topology: proven, for a goal and limits.",
    "iterate": "The whole loop: remove a little, extract, re-model, evaluate, again inside the new solid.",
    "sweep": "Many points of a design space on all cores or a cluster: table, Pareto front and page.",
    "export": "Write the exact solid of a design as STEP or STL: throw, half, web or crankshaft.",
    "designs": "List the built-in designs, copy one to edit, or begin a new one with every key.",
    "runs": "List, show or clean up runs.",
    "doctor": "Check this machine: Python, JAX, gmsh, memory, optional tools, and how to install them.",
    "completion": "Print the line that makes a shell complete commands, options and designs.",
}

_EPILOG = (
    "Exit codes: 0 done; 1 internal error; 2 wrong use; 3 invalid design or input; 4 solver failure; "
    "5 not converged, best result saved; 6 a requested criterion not met; 7 a package, a library or a device "
    "is missing: see 'cranktopo doctor'; 130 interrupted, checkpoint saved."
)


@click.group(
    cls=LazyGroup,
    entries=COMMANDS,
    package="cranktopo.cli",
    epilog=_EPILOG,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(package_name="cranktopo")
def cli() -> None:
    """Topology and shape optimisation of crankshaft webs.

    A DESIGN is a TOML file or the name of a built-in design; without one, mikron-iiic is used.

    Example: cranktopo optimise mikron-iiic --volume-fraction 0.3
    """


def main(args: list[str] | None = None) -> int:
    """Run the command line and return its exit code (also the console script).

    Args:
        args: arguments without the program name; the process's own by default.
    """
    if args is not None:
        return _run(args)
    prepare_streams()
    code = _run(sys.argv[1:])
    unwritten = finish_stdout()
    if unwritten is not None and not isinstance(unwritten, BrokenPipeError) and code == ExitCode.DONE:
        code = _report(_system_error(unwritten), [])
    sys.exit(code)


def _run(arguments: list[str]) -> int:
    try:
        _check_words(arguments)
        result: Any = cli.main(arguments, prog_name="cranktopo", standalone_mode=False)
        return int(result) if isinstance(result, int) else ExitCode.DONE
    except CranktopoError as error:
        return _report(error, arguments)
    except click.UsageError as error:
        where = error.ctx.command_path if error.ctx else "cranktopo"
        hint = f"See '{where} --help'."
        message = f"{error.format_message().removesuffix('.')}."
        return _report(CranktopoError(message, hint=hint, code=ExitCode.USAGE), arguments)
    except click.ClickException as error:
        return _report(CranktopoError(error.format_message(), code=ExitCode.USAGE), arguments)
    except (click.Abort, KeyboardInterrupt):
        return _report(CranktopoError("interrupted.", code=ExitCode.INTERRUPTED), arguments)
    except (BrokenPipeError, SystemExit):  # click turns the first into the second
        return ExitCode.DONE
    except OSError as error:  # a file or stream that the system refuses in the middle of the work
        return _report(_system_error(error), arguments)
    except MemoryError:
        hint = "Take larger cells or elements."
        return _report(CranktopoError("not enough memory.", hint=hint, code=ExitCode.SOLVER), arguments)
    except Exception as error:
        return _internal(error, arguments)


def _check_words(arguments: list[str]) -> None:
    """No word of a command line may be empty: it comes from a variable that was never set."""
    for before, word in zip(["", *arguments], arguments, strict=False):
        option, equals, value = word.partition("=")
        if not word.strip() or (equals and option.startswith("--") and not value.strip()):
            name = option if equals else before
            where = f"{name} is empty" if name.startswith("-") else "an argument is empty"
            raise click.UsageError(f"{where}.")
        if "\0" in word:
            raise click.UsageError(f"{shown(word)} holds a NUL character.")


def _system_error(error: OSError) -> CranktopoError:
    where = f"'{error.filename}'" if error.filename else "output"
    return CranktopoError(
        f"{where}: cannot be used: {error.strerror or error}.",
        hint="Check its folder, rights and free space.",
    )


def _report(error: CranktopoError, arguments: list[str]) -> int:
    if "--json" in arguments:
        try:
            click.echo(json.dumps(error.as_json()))
        except OSError:
            discard(1)
    click.echo(f"{coloured('error:', 'red', err=True)} {error}", err=True)
    return int(error.code)


def _internal(error: Exception, arguments: list[str]) -> int:
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile("w", prefix="cranktopo-crash-", suffix=".log", delete=False) as log:
        traceback.print_exception(error, file=log)
    message = f"internal error: {type(error).__name__}: {error}."
    hint = f"This is a defect of cranktopo; the details are in {log.name}."
    return _report(CranktopoError(message, hint=hint, code=ExitCode.INTERNAL), arguments)
