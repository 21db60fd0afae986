"""In which case every option of every command acts, or is refused: one entry per option."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Acts:
    """The words behind the command give something else with the option than without it."""

    words: str
    option: str


@dataclass(frozen=True)
class Refused:
    """The command with these words ends as wrong use, with a line that says why."""

    words: str
    line: str


@dataclass(frozen=True)
class Shown:
    """Another test, of a file below tests/, shows what the option does: that takes a run or a solve."""

    test: str


Case = Acts | Refused | Shown
MIKRON = "mikron-iiic-plain"
QUIET = Shown("cli/test_command_line.py::test_every_command_that_tells_notes_can_be_quiet_or_verbose")
_ACCESS = "unit/bench/test_access.py"
_GOAL = {
    "--minimise": Acts(MIKRON, "--minimise mass"),
    "--maximise": Acts(MIKRON, "--maximise torsion"),
    "--limit": Acts(f"{MIKRON} --minimise mass", "--limit 'torsion >= 90 %'"),
}
_NO_GOAL = "test_a_volume_fraction_beside_the_goal_of_a_design_names_its_key_and_the_way_out"
_RULES = {
    "--min-wall-mm": Acts(MIKRON, "--min-wall-mm 4"),
    "--min-radius-mm": Acts(MIKRON, "--min-radius-mm 7"),
    "--draft-deg": Acts(MIKRON, "--draft-deg 6"),
    "--cell-mm": Acts(MIKRON, "--cell-mm 2"),
}
_WEB = {"--web": Refused(f"{MIKRON} --web first", "both halves of the throw are alike")}
_THROW = {"--throw": Refused(f"{MIKRON} --throw 2", "all throws of the crank are alike")}
_BODY = {
    "--design": Refused(f"{MIKRON} --design {MIKRON}", "--design is for bodies from CAD"),
    "--align": Refused(f"{MIKRON} --align", "--align is for bodies from CAD"),
}
_MESH = {
    "--element-size-mm": Acts(MIKRON, "--element-size-mm 9"),
    "--accuracy": Acts(MIKRON, "--accuracy 2%"),
    "--budget": Acts(MIKRON, "--budget 9s"),
}
_OUT = {"--out": Acts(MIKRON, "--out here"), "--resume": Refused(f"{MIKRON} --resume run", "leave out")}
_PAIR = f"{MIKRON} pair.toml"
_COMPARE = f"opposed-piston --baseline {MIKRON}"
TABLE: dict[str, dict[str, Case]] = {
    "optimise": {
        **_WEB,
        **_THROW,
        **_GOAL,
        **_OUT,
        "--no-goal": Shown(f"cli/test_goal_options.py::{_NO_GOAL}"),
        "--volume-fraction": Acts(MIKRON, "--volume-fraction 0.25"),
        "--resolution-mm": Acts(MIKRON, "--resolution-mm 3"),
        "--process": Acts(MIKRON, "--process free"),
        "--draft-deg": Refused(f"{MIKRON} --process free --draft-deg 4", "process 'free' has no draft"),
        "--min-member-mm": Acts(MIKRON, "--min-member-mm 6"),
        "--min-gap-mm": Acts(MIKRON, "--min-gap-mm 6"),
        "--accuracy": Acts(MIKRON, "--accuracy 9%"),
        "--budget": Acts(MIKRON, "--budget 5min"),
        "--no-evaluation": Acts(f"{MIKRON} --minimise mass", "--no-evaluation"),
        "--no-bound": Acts(MIKRON, "--no-bound"),
        "--max-iterations": Acts(MIKRON, "--max-iterations 4"),
        "--json": Shown("cli/test_accuracy.py::test_an_accuracy_chooses_the_cells_of_a_run"),
    },
    "plan": {**_THROW, **_GOAL, "--json": Acts("", "--json")},
    "loads": {
        **_THROW,
        "--speed": Acts("", "--speed 1000"),
        "--csv": Acts("", "--csv c.csv"),
        "--plot": Acts("", "--plot p.png"),
        "--json": Acts("", "--json"),
    },
    "film": {
        **_THROW,
        **dict.fromkeys(("--speed", "--plot", "--json"), Shown("unit/film/test_film.py::test_command")),
    },
    "bolts": {"--json": Acts("", "--json")},
    "rod": {
        "--method": Acts("", "--method fkm"),
        "--lighter": Shown("cli/test_rod.py::test_a_lighter_rod_is_found_and_written"),
        "--drawing": Shown("cli/test_rod.py::test_the_drawing_is_written"),
        "--fea": Shown("cli/test_rod.py::test_elements_are_told_beside_the_closed_form"),
        "--element-size-mm": Refused("--element-size-mm 3", "--element-size-mm: only with --fea"),
        "--contact": Refused("--contact", "--contact: only with --fea"),
        "--out": Refused("--out here", "--out: only with --fea"),
        "--json": Acts("", "--json"),
    },
    "balancer": {
        "--redesign": Shown("cli/test_balancer.py::test_a_redesign_is_written_into_the_text_of_the_design"),
        "--drawing": Shown("cli/test_balancer.py::test_the_drawing_of_the_shaft"),
        "--json": Acts("", "--json"),
    },
    "balance": {
        "--report": Acts("", "--report b.md"),
        "--propose": Acts("single.toml", "--propose 50%"),
        "--json": Acts("", "--json"),
    },
    "import": {
        "--solid": Shown("physics/crank_import/test_crank_import.py::test_a_solid_of_an_assembly"),
        "--name": Shown("physics/crank_import/test_crank_import.py::test_the_design_has_the_name_asked_for"),
        "--out": Shown("physics/crank_import/test_crank_import.py::test_a_folder_with_files_is_left_alone"),
        "--end-journals": Shown(
            "physics/crank_import/test_crank_import.py::test_end_journals_are_what_the_user_says"
        ),
        "--unit": Shown(
            "physics/crank_import/test_mesh_import.py::test_the_unit_is_asked_where_none_is_told"
        ),
        "--material": Shown(
            "physics/crank_import/test_crank_import.py::test_the_design_has_the_name_asked_for"
        ),
        "--json": Shown("physics/crank_import/test_crank_import.py::test_the_design_has_the_name_asked_for"),
    },
    "evaluate": {
        **_BODY,
        **_THROW,
        **_MESH,
        "--sensitivities": Refused(f"{MIKRON} --sensitivities", "its web is not parametric"),
        "--web": Refused(f"{MIKRON} --web first", "--web names the web of --sensitivities"),
        "--json": Shown("cli/test_sensitivities.py::test_the_table_and_its_json"),
    },
    "compare": {
        "--throw": Refused(f"{_COMPARE} --throw 2", "all throws of the crank are alike"),
        **_BODY,
        "--design": Refused(f"{_COMPARE} --design {MIKRON}", "--design is for bodies from CAD"),
        "--align": Refused(f"{_COMPARE} --align", "--align is for bodies from CAD"),
        **{name: Acts(_COMPARE, case.option) for name, case in _MESH.items()},
        "--baseline": Shown("cli/test_comparison_report.py::test_estimates_beside_the_values"),
        "--format": Shown("cli/test_comparison_report.py::test_estimates_beside_the_values"),
        "--json": Refused(f"{_COMPARE} --json --format csv", "--json excludes --format csv"),
        "--plot": Shown("cli/test_comparison_report.py::test_plot_in_capitals"),
        "--report": Shown("cli/test_comparison_report.py::test_html"),
        "--stress": Refused(f"{_COMPARE} --stress", "--stress colours the 3D view of --report"),
        "--fatigue": Shown("cli/test_comparison_report.py::test_safety_beside_stiffness"),
        "--loads": Refused(f"{_COMPARE} --loads cycle", "--loads is of the fatigue safety"),
        "--fillet-fraction": Refused(
            f"{_COMPARE} --fillet-fraction 0.3", "--fillet-fraction is of the fatigue safety"
        ),
        "--no-bound": Shown("cli/test_comparison_report.py::test_no_bound_without_a_page_changes_nothing"),
    },
    "accuracy": {
        **_THROW,
        "--design": _BODY["--design"],
        "--budget": Acts(MIKRON, "--budget 9s"),
        "--out": Acts(MIKRON, "--out here"),
        "--json": Shown("cli/test_accuracy.py::test_a_budget_buys_levels_a_table_a_plot_and_a_stored_study"),
    },
    "report": {
        "--out": Acts("run", "--out here.html"),
        "--stress": Acts("run", "--stress"),
        "--markdown": Acts("run", "--markdown"),
    },
    "fatigue": {
        **_BODY,
        **_THROW,
        "--method": Acts(MIKRON, "--method fkm"),
        "--loads": Acts(MIKRON, "--loads cycle"),
        "--baseline": Acts(MIKRON, "--baseline opposed-piston"),
        "--fillet-fraction": Acts(MIKRON, "--fillet-fraction 0.3"),
        "--out": Refused(f"{MIKRON} --method m53 --out here", "two numbers per throw and no field"),
        "--report": Refused(f"{MIKRON} --report r.md", "--report: is the dossier of the rule"),
        "--json": Shown("cli/test_fatigue.py::test_result_and_files"),
    },
    "shaft": {
        **_BODY,
        "--bearings": Acts(MIKRON, "--bearings free"),
        "--element-size-mm": Acts(MIKRON, "--element-size-mm 14"),
        "--speeds": Refused(f"{MIKRON} --bearings free --speeds 900:2100:3", "bearings that are not free"),
        "--method": Acts(MIKRON, "--method fkm"),
        "--fillet-fraction": Refused(f"{MIKRON} --fillet-fraction 0.3", "without --method no stress"),
        "--report": Acts(MIKRON, "--report shaft.html"),
        "--csv": Acts(MIKRON, "--csv shaft.csv"),
        "--misfire": Acts(MIKRON, "--misfire 2"),
        "--dynamic": Acts(MIKRON, "--dynamic"),
        "--json": Shown("cli/test_cad_bodies.py::test_the_shaft_of_a_body_is_that_of_its_design"),
    },
    "modes": {
        **_BODY,
        "--bearings": Acts(MIKRON, "--bearings free"),
        "--element-size-mm": Acts(MIKRON, "--element-size-mm 14"),
        "--speeds": Acts(MIKRON, "--speeds 900:2100:3"),
        "--report": Acts(MIKRON, "--report modes.html"),
        "--json": Shown("cli/test_modes.py::test_the_json_is_that_of_the_model"),
    },
    "vibration": {
        **_BODY,
        "--bearings": Refused("given.toml --bearings spring", "--bearings: shaft.throw_stiffness_Nm_per_rad"),
        "--element-size-mm": Refused("given.toml --element-size-mm 9", "--element-size-mm: shaft.throw_stif"),
        "--report": Acts("given.toml", "--report v.md"),
        "--csv": Acts("given.toml", "--csv v.csv"),
        "--run-up": Acts("given.toml", "--run-up 2s"),
        "--misfire": Acts("given.toml", "--misfire 2"),
        "--json": Acts("given.toml", "--json"),
    },
    "extract": {
        "--iteration": Shown("cli/test_extract.py::test_every_design_has_a_surface"),
        "--format": Shown("cli/test_extract.py::test_formats"),
        "--out": Shown("cli/test_extract.py::test_formats"),
        "--force": Refused("run --force", "--force is about --out"),
        "--json": Shown("cli/test_extract.py::test_formats"),
    },
    "remodel": {
        **{name: Acts("run", case.option) for name, case in _RULES.items()},
        "--out": Acts("run", "--out here"),
        "--no-evaluation": Acts("run", "--no-evaluation"),
        "--no-judge": Acts("run", "--no-judge"),
        "--json": Shown("cli/test_remodel.py::test_whole_command_on_a_coarse_run"),
    },
    "shape": {
        **_WEB,
        **_THROW,
        **_GOAL,
        **_RULES,
        **_OUT,
        "--minimise": Acts(MIKRON, "--minimise inertia"),
        "--loads": Acts(MIKRON, "--loads cycle"),
        "--no-bound": Acts(MIKRON, "--no-bound"),
        "--each-web": Acts(MIKRON, "--each-web"),
        "--json": Shown("cli/test_shape.py::test_the_design_evaluates_as_it_says"),
    },
    "bound": {
        **_WEB,
        **_THROW,
        **_GOAL,
        "--minimise": Acts(MIKRON, "--minimise inertia"),
        "--resolution-mm": Acts(MIKRON, "--resolution-mm 4"),
        "--json": Shown("cli/test_bound.py::test_the_bound_as_json"),
    },
    "iterate": {
        **_WEB,
        **_THROW,
        **_RULES,
        **_OUT,
        "--steps": Acts(MIKRON, "--steps 3"),
        "--volume-fraction": Acts(MIKRON, "--volume-fraction 0.25"),
        "--resolution-mm": Acts(MIKRON, "--resolution-mm 3"),
        "--process": Acts(MIKRON, "--process cast"),
        "--least-transition-mm": Acts(MIKRON, "--least-transition-mm 9"),
        "--no-shape": Acts(MIKRON, "--no-shape"),
        "--no-bound": Acts(MIKRON, "--no-bound"),
        "--element-size-mm": Acts(MIKRON, "--element-size-mm 9"),
        "--json": Shown("cli/test_iterate.py::test_the_loop_ends_when_the_web_is_thin"),
    },
    "sweep": {},
    "export": {
        "--throw": Refused(f"{MIKRON} throw.step --throw 2", "all throws of the crank are alike"),
        "--part": Acts(f"{MIKRON} shaft.npz", "--part reduced"),
        "--facet-mm": Refused(f"{MIKRON} web.step --facet-mm 2", "--facet-mm is the size of STL facets"),
        "--force": Acts(f"{MIKRON} taken.svg", "--force"),
    },
    "drawing": {"--force": Shown("cli/test_crank_drawing.py::test_it_replaces_a_file_by_force_alone")},
    "designs list": {"--json": Acts("", "--json")},
    "designs copy": {"--force": Acts(f"{MIKRON} given.toml", "--force")},
    "designs new": {
        "--name": Acts("new.toml", "--name other"),
        "--layout": Acts("new.toml --cylinders 4", "--layout boxer"),
        "--cylinders": Acts("new.toml", "--cylinders 6"),
        "--bore-mm": Acts("new.toml", "--bore-mm 100"),
        "--stroke-mm": Acts("new.toml", "--stroke-mm 70"),
        "--speed-rpm": Acts("new.toml --bore-mm 100", "--speed-rpm 2000"),
        "--rod-length-mm": Acts("new.toml --bore-mm 100", "--rod-length-mm 190"),
        "--peak-pressure-MPa": Acts("new.toml --bore-mm 100", "--peak-pressure-MPa 9"),
        "--compression-ratio": Acts("new.toml --bore-mm 100", "--compression-ratio 12.5"),
        "--bank-angle-deg": Acts("new.toml --layout V", "--bank-angle-deg 60"),
        "--power-kW": Acts("new.toml --bore-mm 100", "--power-kW 20"),
        "--material": Acts("new.toml --bore-mm 100", "--material 34CrNiMo6"),
        "--force": Acts("given.toml", "--force"),
    },
    "designs sketch": {
        "--force": Shown("cli/test_sketches.py::test_a_sketch_replaces_a_file_only_by_force"),
    },
    "designs pair": {
        "--first": Acts(f"{_PAIR} --second thinner.toml", "--first thinner.toml"),
        "--second": Acts(f"{_PAIR} --first {MIKRON}", "--second thinner.toml"),
        "--force": Acts(f"{MIKRON} given.toml --first {MIKRON}", "--force"),
    },
    "runs list": {"--root": Acts("", "--root ."), "--json": Acts("", "--json")},
    "runs show": {"--root": Acts("ru", "--root ."), "--json": Acts("run", "--json")},
    "runs clean": {
        "--root": Acts("--status interrupted", "--root ."),
        "--status": Acts("--root .", "--status interrupted"),
        "--yes": Acts("--root . --status interrupted", "--yes"),
    },
    "doctor": {"--json": Acts("", "--json")},
    "completion": {},
    "bench": {
        "--port": Refused("--port 80", "80 is not in the range"),
        "--no-browser": Shown("browser/test_bench.py::test_a_drag_moves_numbers_and_picture"),
        "--host": Shown(
            f"{_ACCESS}::test_an_address_that_others_reach_needs_that_it_is_known_and_a_password"
        ),
        "--i-know": Refused("--i-know", "--i-know is about --host"),
    },
}
_SWEEP = f"{MIKRON} --vary web.thickness_mm=18,20"
_RANGE = f"{MIKRON} --vary web.thickness_mm=18:20"
TABLE["sweep"] = {
    "--vary": Acts(_SWEEP, "--vary web.width_mm=48,50"),
    "--stage": Acts(_SWEEP, "--stage fatigue"),
    "--minimise": Refused(f"{_SWEEP} --minimise mass", "stage evaluate has no goal"),
    "--maximise": Acts(f"{_SWEEP} --stage shape", "--maximise torsion"),
    "--limit": Acts(f"{_SWEEP} --stage shape --minimise mass", "--limit 'bending >= 90 %'"),
    "--sampling": Acts(f"{_RANGE} --samples 3 --sampling latin", "--sampling sobol"),
    "--samples": Refused(f"{_SWEEP} --samples 3", "samples are of a Latin hypercube"),
    "--element-size-mm": Acts(_SWEEP, "--element-size-mm 9"),
    "--accuracy": Acts(_SWEEP, "--accuracy 2%"),
    "--keep": Acts(_SWEEP, "--keep pitch"),
    "--refine": Acts(_SWEEP, "--refine front"),
    "--budget": Refused(f"{_SWEEP} --budget 9s", "time for what a first look does not rule out"),
    "--workers": Acts(_SWEEP, "--workers 3"),
    "--scheduler": Acts(_SWEEP, "--scheduler tcp://127.0.0.1:1"),
    "--out": Acts(_SWEEP, "--out here"),
    "--resume": Refused(f"{MIKRON} --resume run", "leave out"),
    "--json": Shown("cli/test_sweep.py::test_a_sweep_of_evaluations"),
}
