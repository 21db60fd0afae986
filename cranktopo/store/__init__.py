"""Run directories, manifest and checkpoint."""

from cranktopo.store.cache import private_cache, user_cache
from cranktopo.store.checkpoint import Checkpoint, load_checkpoint, save_checkpoint
from cranktopo.store.destination import check_file, check_folder
from cranktopo.store.files import (
    UnwritableError,
    read_json,
    replacing,
    write_bytes,
    write_json,
    write_npz,
    write_text,
)
from cranktopo.store.folders import moved, unfinished_folder
from cranktopo.store.iterations import load_iteration, save_iteration, saved_iterations
from cranktopo.store.kind import (
    LOOP,
    RESULT_FILES,
    SHAPE,
    SWEEP,
    RunKind,
    kind_of,
    read_result,
    require_kind,
    resume_command,
    shown_results,
)
from cranktopo.store.lock import locked
from cranktopo.store.runs import (
    RUNS,
    RunStore,
    check_destination,
    create_run,
    list_runs,
    open_run,
    remove_run,
    runs_named,
)
from cranktopo.store.work import Json, KeptWork, Work

__all__ = [
    "LOOP",
    "RESULT_FILES",
    "RUNS",
    "SHAPE",
    "SWEEP",
    "Checkpoint",
    "Json",
    "KeptWork",
    "RunKind",
    "RunStore",
    "UnwritableError",
    "Work",
    "check_destination",
    "check_file",
    "check_folder",
    "create_run",
    "kind_of",
    "list_runs",
    "load_checkpoint",
    "load_iteration",
    "locked",
    "moved",
    "open_run",
    "private_cache",
    "read_json",
    "read_result",
    "remove_run",
    "replacing",
    "require_kind",
    "resume_command",
    "runs_named",
    "save_checkpoint",
    "save_iteration",
    "saved_iterations",
    "shown_results",
    "unfinished_folder",
    "user_cache",
    "write_bytes",
    "write_json",
    "write_npz",
    "write_text",
]
