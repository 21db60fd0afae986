"""Torsional vibration as tables and text."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from cranktopo.base.units import number_text, plain_number
from cranktopo.design.misfire import misfire_words
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.performance import pressure_words
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.engine.vibration.disk_error import FEW_THROWS_ERROR, few_throws
from cranktopo.engine.vibration.steady import TELLING_SHARE
from cranktopo.engine.vibration.study import (
    Swing,
    VibrationStudy,
    largest_swing,
    worst_speed,
    worst_swing,
)
from cranktopo.engine.vibration.telling import WEAK, is_near, order_torque_Nm
from cranktopo.report.result_table import Cell, ResultTable, Row, terminal
from cranktopo.tasks.vibration.barred import barred_sentence, passed_sentence

DISKS = (
    "Disks and springs stand for the body, which bends where it twists. Beside one body by finite elements "
    "the first frequency was 10 to 14 % too low for a bare crank of four throws, within 1 % for fours and "
    f"sixes with rods and pistons, and {FEW_THROWS_ERROR} for one to three throws: "
    "too low where the mass of a flywheel holds the end of the shaft against bending, too high where "
    "the shaft bends under the force at its crankpin (a V-twin). "
    "An error bound of the stiffness does not cover that."
)
"""Error of the model itself, as the page of torsional vibration has it."""
JOINED = "Outside the crankshaft, where the worst cylinder does not fire"
"""Title of what a misfire does to coupling, damper and line."""
ORDER_AND_SUM = (
    "Torque amplitudes are the largest of the crankshaft's sections: of this order alone, and of the sum of "
    "all orders over the cycle at that speed, whose stress it is."
)
"""Meaning of the torques of the table of critical speeds."""
NONE_FELT = "No critical speed in this range that is felt and at which the cylinders help one another."
"""Told where the table of critical speeds is empty."""


def modes_table(study: VibrationStudy) -> ResultTable:
    """Natural frequencies with their damping."""
    rows: list[Row] = []
    for number, mode in enumerate(study.modes, start=1):
        where = study.shaft.names[int(abs(mode.shape).argmax())]
        row: dict[str, Cell] = {"mode": str(number), "frequency_Hz": mode.frequency_Hz, "swings_most": where}
        rows.append({**row, "damping_ratio_percent": 100 * mode.damping_ratio})
    columns = {"mode": 0, "frequency_Hz": 1, "damping_ratio_percent": 2, "swings_most": 0}
    return ResultTable(columns, tuple(rows))


def critical_table(study: VibrationStudy) -> ResultTable:
    """Critical speeds at which the cylinders help each other, with the crankshaft's largest torques there.

    Those of the order alone stand beside the sum of all orders over the cycle, to which it may add little.
    """
    response = study.response
    rows: list[Row] = []
    for found in study.critical:
        if found.share < WEAK:
            continue
        near = is_near(response, found, study.varying.rise)
        inside = np.array(study.shaft.in_crankshaft)
        own = float(order_torque_Nm(response, found, study.varying.rise)[inside].max())
        every = float(response.torque_amplitude_Nm[near][:, inside].max())
        row: dict[str, Cell] = {"speed_rpm": found.speed_rpm, "order": found.order, "mode": str(found.mode)}
        row |= {"kind": "major" if found.major else "minor", "cylinders_helping_percent": 100 * found.share}
        row |= {"this_order_alone_Nm": own, "sum_of_all_orders_Nm": every}
        rows.append({**row, "shear_of_sum_MPa": study.shaft.shear_MPa(every)})
    columns = {"speed_rpm": 0, "order": 1, "mode": 0, "kind": 0, "cylinders_helping_percent": 0}
    columns |= {"this_order_alone_Nm": 1, "sum_of_all_orders_Nm": 1, "shear_of_sum_MPa": 1}
    return ResultTable(columns, tuple(rows))


def left_out_sentence(study: VibrationStudy) -> str:
    """Return how many critical speeds are not listed because their order is not felt; empty of none."""
    count = sum(study.left_out)
    if not count:
        return ""
    return (
        f"Not listed: {count} critical speed{'s' * (count > 1)} whose order alone has less than "
        f"{100 * TELLING_SHARE:g} % of the largest torque amplitude in every section."
    )


def cancelled_sentence(study: VibrationStudy) -> str:
    """Return the critical speeds that even firing takes away, mode by mode; empty where none is."""
    weak: dict[int, list[str]] = {}
    for found in study.critical:
        if found.share < WEAK:
            weak.setdefault(found.mode, []).append(f"{found.speed_rpm:.0f} rpm (order {found.order:g})")
    if not weak:
        return ""
    places = "; ".join(f"mode {mode} at {', '.join(met)}" for mode, met in sorted(weak.items()))
    silent = study.response.harmonics.misfire
    return (
        f"Also met, where the cylinders cancel one another to below {WEAK:.0%}: {places}"
        f"{'' if silent else '. A cylinder that misfires excites them there'}."
    )


def misfire_table(study: VibrationStudy) -> ResultTable:
    """Return the largest torque of the crankshaft with one cylinder that does not fire, for each cylinder."""
    rows: tuple[Row, ...] = tuple(
        {
            "cylinder": str(one.cylinder),
            "section": study.shaft.sections[one.crankshaft.section],
            "speed_rpm": one.crankshaft.speed_rpm,
            "torque_amplitude_Nm": one.crankshaft.torque_amplitude_Nm,
            **_largest_order(one.crankshaft),
            "shear_MPa": study.shaft.shear_MPa(one.crankshaft.torque_amplitude_Nm),
        }
        for one in study.misfires
    )
    columns = {"cylinder": 0, "section": 0, "speed_rpm": 0, "torque_amplitude_Nm": 1, **_ORDER_DIGITS}
    return ResultTable({**columns, "shear_MPa": 1}, rows)


_ORDER_DIGITS = {"largest_order": 1, "that_order_alone_Nm": 1}


def _largest_order(swing: Swing) -> dict[str, Cell]:
    return dict(zip(_ORDER_DIGITS, (swing.order, swing.order_Nm), strict=True))


def joined_misfire_table(study: VibrationStudy) -> ResultTable:
    """Return the worst cylinder that does not fire for every section that is no part of the crankshaft."""
    rows: list[Row] = []
    for place, section in enumerate(study.joined_sections):
        cylinder, swing = _worst_of((one.cylinder, one.joined[place]) for one in study.misfires)
        firing = largest_swing(study.response, section)
        row: dict[str, Cell] = {"section": study.shaft.sections[section], "worst_cylinder": str(cylinder)}
        row |= {"speed_rpm": swing.speed_rpm, "torque_amplitude_Nm": swing.torque_amplitude_Nm}
        row |= _largest_order(swing)
        rows.append({**row, "all_fire_Nm": firing.torque_amplitude_Nm})
    columns = {"section": 0, "worst_cylinder": 0, "speed_rpm": 0, "torque_amplitude_Nm": 1}
    columns |= _ORDER_DIGITS
    return ResultTable({**columns, "all_fire_Nm": 1}, tuple(rows))


def joined_misfire_sentence(study: VibrationStudy) -> str:
    """Return what a misfire does outside the crankshaft at the engine's own speed; empty where not known."""
    torques = []
    for place, firing in enumerate(study.joined_own if study.misfires else ()):
        cylinder, swing = _worst_of((one.cylinder, one.joined_own[place]) for one in study.misfires)
        torques.append(
            f"{study.shaft.sections[swing.section]} +-{number_text(swing.torque_amplitude_Nm)} N m without "
            f"cylinder {cylinder}, +-{number_text(firing.torque_amplitude_Nm)} N m where all fire"
        )
    if not torques:
        return ""
    return f"With a misfire at the engine's {engine_of(study.scene).speed_rpm:.0f} rpm: {'; '.join(torques)}."


def _worst_of(swings: Iterable[tuple[int, Swing]]) -> tuple[int, Swing]:
    """Return the cylinder with the largest torque and that torque, of equal ones the first."""
    return max(swings, key=lambda found: round(found[1].torque_amplitude_Nm, 6))


def misfire_sentence(study: VibrationStudy) -> str:
    """Return what misfire of the worst cylinder would do; empty where it was not asked for."""
    found = study.worst_misfire
    if found is None:
        return ""
    worst, amplitude = found.crankshaft, found.crankshaft.torque_amplitude_Nm
    firing = largest_swing(study.response, study.response.worst.section)
    return (
        f"Misfire of cylinder {found.cylinder} is the worst: +-{number_text(amplitude)} N m between "
        f"{ends_of(study, worst)} at {worst.speed_rpm:.0f} rpm, {worst.orders_words}: "
        f"{amplitude / firing.torque_amplitude_Nm:.2f} times the largest of an engine that fires in all "
        f"cylinders, +-{number_text(firing.torque_amplitude_Nm)} N m between {ends_of(study, firing)}."
    )


def ends_of(study: VibrationStudy, swing: Swing) -> str:
    """Return between which disks a section lies, in words."""
    return study.shaft.sections[swing.section].replace(" - ", " and ")


def sections_table(study: VibrationStudy) -> ResultTable:
    """Return every section of the shaft at the speed where it swings most."""
    response, shaft = study.response, study.shaft
    rows: list[Row] = []
    for index, name in enumerate(shaft.sections):
        speed = worst_speed(response, index)
        torque = float(response.torque_amplitude_Nm[speed, index])
        row: dict[str, Cell] = {
            "section": name,
            "stiffness_kNm_per_rad": shaft.chain.stiffness_Nm_per_rad[index] / 1000,
        }
        row |= {"worst_at_rpm": float(response.speeds_rpm[speed]), "torque_amplitude_Nm": torque}
        row["twist_amplitude_deg"] = float(response.twist_amplitude_deg[speed, index])
        row["mean_torque_Nm"] = float(response.mean_torque_Nm[index])
        rows.append({**row, "shear_MPa": shaft.shear_MPa(torque) if shaft.in_crankshaft[index] else None})
    columns = {"section": 0, "stiffness_kNm_per_rad": 2, "worst_at_rpm": 0, "torque_amplitude_Nm": 1}
    columns |= {"twist_amplitude_deg": 3, "mean_torque_Nm": 1, "shear_MPa": 1}
    return ResultTable(columns, tuple(rows))


def own_speed_sentence(study: VibrationStudy) -> str:
    """Return the largest torque of the crankshaft at the engine's own speed; empty where it is not solved."""
    response, shaft = study.response, study.shaft
    own = study.own_speed
    if own is None:
        return ""
    swings = np.where(shaft.in_crankshaft, response.torque_amplitude_Nm[own], -1.0)
    amplitude, between = float(swings.max()), shaft.sections[int(swings.argmax())].replace(" - ", " and ")
    outside = "; ".join(
        f"{shaft.sections[one.section]} +-{number_text(one.torque_amplitude_Nm)} N m"
        for one in study.joined_own
    )
    return (
        f"At the engine's {response.speeds_rpm[own]:.0f} rpm it swings most between {between}: "
        f"+-{number_text(amplitude)} N m.{f' Outside the crankshaft: {outside}.' if outside else ''}"
    )


def worst_sentence(study: VibrationStudy) -> str:
    """Return the largest torque of the crankshaft in one sentence."""
    worst = worst_swing(study.response)
    amplitude = worst.torque_amplitude_Nm
    return (
        f"The crankshaft's torque swings most at {worst.speed_rpm:.0f} rpm between "
        f"{ends_of(study, worst)}: +-{number_text(amplitude)} N m, "
        f"+-{study.shaft.shear_MPa(amplitude):.1f} MPa nominal shear stress, {worst.orders_words}."
    )


def pressure_sentence(study: VibrationStudy) -> str:
    """Return what pressure acts over the range of speeds."""
    return pressure_words(study.scene, study.response.speeds_rpm.tolist())


def varying_sentence(study: VibrationStudy) -> str:
    """Tell whether the varying inertia of rod and piston counts, by what estimate, and what it changes."""
    part, threshold = study.varying, 100 * study.scene.effects.threshold
    start = (
        f"The inertia of rod and piston varies over a turn by +-{study.varying_inertia_percent:.1f} % of a "
        f"throw's, +-{part.share_percent:.1f} % of what swings in a natural vibration"
    )
    change = study.varying_change_percent
    if change is not None:
        return (
            f"{start}, above the threshold of {threshold:g} %: included, it changes the largest torque "
            f"amplitude by {change:+z.1f} %."
        )
    if part.share_percent < threshold:
        return f"{start}, below the threshold of {threshold:g} %: they count with their mean inertia."
    return f"{start}: left out without [shaft], they count with their mean inertia."


def run_up_sentence(study: VibrationStudy) -> str:
    """Return the largest torque of a passage through the range of speeds; empty when none was asked for."""
    worst, passage = study.run_up_worst(), study.run_up
    if worst is None or passage is None:
        return ""
    speed, section, torque = worst
    steady = float(study.mean_response.torque_amplitude_Nm[:, section].max())
    inertia = ", with mean inertia," if study.varying.included else ""
    return (
        f"In a run-up of {passage.seconds:g} s{inertia} it swings most at {speed:.0f} rpm between "
        f"{study.shaft.sections[section].replace(' - ', ' and ')}: +-{number_text(torque)} N m, "
        f"{100 * torque / steady:.0f} % of the largest steady vibration there."
    )


def _stiffness_sentence(study: VibrationStudy) -> str:
    """Return what load cases take instead, where that is not what was given."""
    scene, found = study.scene, [plain_number(one) for one in study.shaft.throws_Nm_per_rad]
    if scene.shaft is None or scene.shaft.gives_stiffness:
        return ""
    estimated = number_text(throw_stiffness_Nm_per_rad(scene))
    key, value = "throw_stiffness_Nm_per_rad", found[0]
    if len(set(found)) > 1:
        key, value = "throw_stiffnesses_Nm_per_rad", f"[{', '.join(found)}]"
    return (
        f"Load cases take {estimated} N m/rad for a throw, in closed form; to have them take "
        f"that of this run write shaft.{key} = {value}."
    )


def disks_sentence(study: VibrationStudy) -> str:
    """Return the error of the model, and what has the body where the shaft is so short that it counts."""
    return " ".join(filter(None, (DISKS, short_shaft_sentence(study))))


def short_shaft_sentence(study: VibrationStudy) -> str:
    """Return what tells the frequencies of a shaft of few throws with its bending; empty of a longer one."""
    if not few_throws(study.scene):
        return ""
    count = len(study.scene.shaft_angles_deg)
    return (
        f"This shaft has {count} throw{'s' * (count > 1)}: `cranktopo modes` gives frequencies and critical "
        "speeds of its body."
    )


def vibration_text(study: VibrationStudy) -> str:
    """For the terminal."""
    low, high = study.response.speeds_rpm[[0, -1]]
    parts = [
        f"{study.scene.name}: steady torsional vibration, {low:.0f} to {high:.0f} rpm, "
        f"{len(study.response.orders)} orders\nstiffness of the throws: {study.stiffness_source}"
        f"\n{misfire_words(study.scene)}".rstrip(),
        terminal(modes_table(study)),
    ]
    critical = critical_table(study)
    parts.append(f"{terminal(critical)}\n{ORDER_AND_SUM}" if critical.rows else NONE_FELT)
    parts[-1] += f"\n{left_out_sentence(study)}".rstrip()
    cancelled = cancelled_sentence(study)
    parts += [cancelled] if cancelled else []
    sentences = (
        worst_sentence(study),
        passed_sentence(study),
        own_speed_sentence(study),
        pressure_sentence(study),
        run_up_sentence(study),
    )
    parts += [terminal(sections_table(study)), "\n".join(filter(None, sentences))]
    if study.misfires:
        parts[-1:-1] = ["One cylinder that does not fire:", terminal(misfire_table(study))]
        if study.joined_sections:
            parts[-1:-1] = [f"{JOINED}:", terminal(joined_misfire_table(study))]
        parts[-1] += f"\n{misfire_sentence(study)}\n{joined_misfire_sentence(study)}".rstrip()
    parts[-1] += f"\n{barred_sentence(study)}\n{varying_sentence(study)}"
    parts[-1] += f"\n{_stiffness_sentence(study)}".rstrip()
    parts[-1] += f"\n{DISKS}\n{short_shaft_sentence(study)}".rstrip()
    return "\n\n".join(parts)
