"""Indicator diagrams: what is accepted, and one clear line for what is not."""

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.engine import Gas
from cranktopo.design.loading import load_scene
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.indicator import read_indicator

ANGLE = np.arange(0.0, 720.0, 2.0)
BAR = 1.0 + 50.0 * np.exp(-(((ANGLE - 12.0 + 360) % 720 - 360) ** 2) / 800.0)
COARSE = (ANGLE < 100) | (ANGLE > 220) | ((ANGLE - 100) % 6 == 0)


def write(path, angle=ANGLE, values=BAR, header="crank_angle_deg,pressure_bar", sep=","):
    rows = [f"{a:g}{sep}{p:.9g}" for a, p in zip(angle, values, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


@pytest.fixture
def file(tmp_path):
    return tmp_path / "p.csv"


def read(file, cycle=720.0):
    return read_indicator(file, cycle, 0.1)


def test_bar_is_converted(file):
    angle, pressure = read(write(file))
    assert angle == pytest.approx(ANGLE)
    assert pressure == pytest.approx(BAR / 10)


@pytest.mark.parametrize(
    ("header", "sep"),
    [
        ("Crank angle [deg];p [MPa]", ";"),
        ("angle deg\tpressure (MPa)", "\t"),
        ("# test bed 3\nCA_deg,p_MPa", ","),
    ],
)
def test_headers_and_separators(file, header, sep):
    write(file, values=BAR / 10, header=header, sep=sep)
    assert read(file)[1] == pytest.approx(BAR / 10)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "latin-1"])
@pytest.mark.parametrize(
    ("header", "sep", "per_bar"),
    [
        ("Kurbelwinkel [°KW];Zylinderdruck [bar]", ";", 1.0),
        ("CA [deg];p [MPa]", ";", 0.1),
        ("Crank Angle (degCA),PCYL1 (bar)", ",", 1.0),
        ("Winkel in Grad\tDruck, Zyl. 1 in kPa", "\t", 100.0),
        ("Winkel, gemessen [° KW];Druck, Zyl. 1, indiziert (mbar)", ";", 1000.0),
        ("°KW;hPa", ";", 1000.0),
        ("CAD,Cylinder pressure [Pa]", ",", 1e5),
        ("Crank angle [º];p bar(a)", ";", 1.0),
        ("Winkel;Druck\nGrad;bar", ";", 1.0),
        ("Winkel;Druck\n[°KW];[kPa]", ";", 100.0),
        ("deg CA,pa_bar", ",", 1.0),
    ],
)
def test_headers_of_indicating_systems(file, header, sep, per_bar, encoding):
    """Numbers are the same in every encoding, and in every unit within the digits that are written."""
    body = write(file, values=BAR * per_bar, header="", sep=sep).read_text()
    file.write_bytes(f"{header}{body}".encode(encoding))
    angle, pressure = read(file)
    assert angle == pytest.approx(ANGLE)
    assert pressure == pytest.approx(BAR / 10, rel=1e-8)


def many(file, header):
    """One row a point: angle, cylinder pressure, and beside it things that are no cylinder pressure."""
    rows = [f"{a:g};{a / 7:g};{p:.9g};1.05;0.3" for a, p in zip(ANGLE, BAR, strict=True)]
    file.write_bytes("\n".join([header, *rows]).encode("cp1252"))
    return file


@pytest.mark.parametrize(
    "header",
    [
        "°KW;Zündwinkel [°];Zylinderdruck [bar];Saugrohrdruck [bar];dp/dphi [bar/°KW]",
        "crank [deg];oil [degC];PCYL1 [bar];p_oil [bar];dQ [J/deg]",
        "CA [deg];t [° C];pressure_bar;PCYL2 [bar];ROHR [kJ/deg]",
        "crank_angle_deg;crank, gas exchange [deg];pressure_bar;Druck [bar];MFB [%]",
    ],
)
def test_the_cylinder_pressure_among_other_columns(file, header):
    angle, pressure = read(many(file, header))
    assert angle == pytest.approx(ANGLE)
    assert pressure == pytest.approx(BAR / 10, rel=1e-8)


def test_several_cylinder_pressures_are_named_and_one_is_chosen_by_its_header(file):
    header = "CA [deg];t;PCYL1 (bar);PCYL2 (bar);x"
    with pytest.raises(CranktopoError) as told:
        read(many(file, header))
    assert "several columns fit as pressure" in told.value.message
    assert "'PCYL1 (bar)', 'PCYL2 (bar)'" in told.value.message
    assert "\n" not in str(told.value)
    assert "Rename the header of the one to be read to pressure_bar" in told.value.hint
    assert read(many(file, header.replace("PCYL1 (bar)", "pressure_bar")))[1] == pytest.approx(BAR / 10)
    with pytest.raises(
        CranktopoError, match=r"several columns fit as crank angle.*'CA \[deg\]', 'CA2 \[deg\]'"
    ):
        read(many(file, header.replace(";t;", ";CA2 [deg];")))


def test_firing_dead_centre_may_be_anywhere_in_the_trace(file):
    for firing in (360.0, 90.5, -359.0, 540.0):
        late = np.interp(ANGLE, ANGLE + firing, BAR, period=720)
        angle, pressure = read_indicator(write(file, values=late), 720.0, 0.1, firing)
        assert np.interp(30.0, angle, pressure) == pytest.approx(np.interp(30.0, ANGLE, BAR) / 10, rel=5e-3)
        assert 0 <= angle.min() < angle.max() < 720


def test_columns_in_other_order_and_extra(file):
    rows = [f"{p:.9g},1,{a:g}" for a, p in zip(ANGLE, BAR, strict=True)]
    file.write_text("\n".join(["pressure_bar,cycle,angle_deg", *rows]))
    assert read(file)[1] == pytest.approx(BAR / 10)


def test_any_start_and_a_closing_point(file):
    """-360 .. 360 with both ends: the same curve as 0 .. 720."""
    shifted = np.arange(-360.0, 361.0, 2.0)
    write(file, shifted, np.interp(shifted, ANGLE, BAR, period=720))
    angle, pressure = read(file)
    assert angle == pytest.approx(ANGLE)
    assert pressure == pytest.approx(BAR / 10)


def test_step_may_be_finer_around_the_peak(file):
    angle = np.concatenate([np.arange(0, 60, 0.5), np.arange(60, 720, 3.0)])
    write(file, angle, np.interp(angle, ANGLE, BAR, period=720))
    assert len(read(file)[0]) == len(angle)


def test_interpolation_keeps_points_and_never_overshoots(file):
    write(file)
    scene = load_scene("mikron-iiic-plain")
    gas = Gas(indicator_csv=str(file))
    curve = pressure_curve(scene.model_copy(update={"engine": scene.engine.model_copy(update={"gas": gas})}))
    assert curve.pressure_MPa[::8] == pytest.approx(BAR / 10)
    # Between the last point and the first one of the next cycle the curve goes on smoothly.
    join = curve.pressure_MPa[-8:]
    assert (np.diff(join) > 0).all()
    assert join[0] == pytest.approx(BAR[-1] / 10)
    assert join[-1] < BAR[0] / 10
    assert curve.pressure_MPa[[-4]] == pytest.approx((BAR[-1] + BAR[0]) / 20, rel=2e-3)
    assert curve.pressure_MPa.max() == pytest.approx(BAR.max() / 10)
    assert curve.pressure_MPa.min() == pytest.approx(BAR.min() / 10)


BAD = {
    "missing angles": (
        np.delete(ANGLE, [50, 51]),
        np.delete(BAR, [50, 51]),
        r"missing between 98 and 104 deg",
    ),
    "missing over the join": (ANGLE[:-1], BAR[:-1], r"missing between 716 and 720 deg"),
    "duplicate": (np.insert(ANGLE, 5, 8.0), np.insert(BAR, 5, 1.0), r"line 7: angle 8 deg repeats"),
    "descending": (np.where(ANGLE == 10, 7, ANGLE), BAR, r"line 7: angle 7 deg falls below .*\(8 deg\)"),
    "half a cycle": (ANGLE[:180], BAR[:180], r"span 358 deg, not one cycle of 720 deg"),
    "NaN": (ANGLE, np.where(ANGLE == 4, np.nan, BAR), r"line 4: 'nan' is not a number"),
    "infinite": (ANGLE, np.where(ANGLE == 4, np.inf, BAR), r"line 4: 'inf' is not a number"),
    "below vacuum": (ANGLE, BAR - 1.2, r"is below vacuum"),
    "MPa called bar": (ANGLE, BAR / 50, r"peak pressure 0\.10.* Check the unit"),
    "bar called MPa": (ANGLE, BAR * 10, r"peak pressure 51 MPa is outside .* Check the unit"),
    "another closing point": (
        np.append(ANGLE, 720.0),
        np.append(BAR, BAR[0] + 0.1 * BAR.max()),
        r"rows at 0 and 720 deg are the same point of the cycle",
    ),
    "coarse": (ANGLE[COARSE], BAR[COARSE], r"missing between 100 and 106 deg"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_curves_are_refused(file, case):
    angle, values, message = BAD[case]
    write(file, angle, values)
    with pytest.raises(CranktopoError, match=message):
        read(file)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("angle_rad,pressure_bar", "no crank angle in deg"),
        ("angle_deg,pressure_psi", "no pressure in bar, kPa, MPa, Pa, hPa or mbar"),
        ("angle_deg,pressure", "no pressure in bar, kPa, MPa, Pa, hPa or mbar"),
        ("angle_deg,dp/dphi [bar/deg]", "no pressure in bar"),
        ("oil [deg C],pressure_bar", "no crank angle in deg"),
        ("Kurbelwinkel [°KW],p [bar Überdruck]", "is a gauge pressure.* add that of the surroundings"),
        ("crank_angle_deg,pressure_barg", "is a gauge pressure.* add that of the surroundings"),
        ("0,1.0", "no crank angle in deg"),
    ],
)
def test_bad_headers_are_refused(file, header, message):
    with pytest.raises(CranktopoError, match=message):
        read(write(file, header=header))


def test_wrong_period_for_a_two_stroke(file):
    with pytest.raises(CranktopoError, match="span 718 deg, not one cycle of 360 deg"):
        read(write(file), cycle=360.0)


def test_missing_cell_empty_file_and_missing_file(file):
    file.write_text("angle_deg,pressure_bar\n0,1\n2\n4,1\n")
    with pytest.raises(CranktopoError, match="line 3: '' is not a number"):
        read(file)
    file.write_text("")
    with pytest.raises(CranktopoError, match="has no rows of numbers"):
        read(file)
    file.write_bytes(b"\xff\xfe\x00angle")
    with pytest.raises(CranktopoError, match="is not text in UTF-8"):
        read(file)
    file.write_bytes("°KW;bar\n0;1\n1;2\n".encode("cp1252") + b"\x81")
    with pytest.raises(CranktopoError, match="is not text in UTF-8: line 1"):
        read(file)
    with pytest.raises(CranktopoError, match="cannot be read"):
        read(file.with_name("nothing.csv"))


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("100,1,5", r"line 52: 3 cells under a header of 2. With a decimal comma, put semicolons"),
        ('"100,1.5', r"line 52: a quote is not closed"),
        ('100,1"5', r"line 52: '1\"5' is not a number"),
        ("1_00,1.5", r"line 52: '1_00' is not a number"),
        ("100,0x10", r"line 52: '0x10' is not a number"),
        ("100,1e300", r"line 52: '1e300' is out of any range"),
        ("100,\u0661", r"line 52: .* is not a number"),
        ("100;1,5", r"line 52: '100;1' is not a number"),
    ],
)
def test_a_row_that_could_be_read_as_something_else(file, cell, message):
    lines = write(file).read_text().splitlines()
    assert lines[51].startswith("100,")
    file.write_text("\n".join([*lines[:51], cell, *lines[52:]]), encoding="utf-8")
    with pytest.raises(CranktopoError, match=message):
        read(file)


def test_decimal_commas_between_semicolons(file):
    """As a German spreadsheet writes it, with a byte-order mark and a closing semicolon."""
    rows = [f"{a:.1f};{p:.6f};".replace(".", ",") for a, p in zip(ANGLE, BAR, strict=True)]
    file.write_text("\n".join(["crank_angle_deg;pressure_bar", *rows]), encoding="utf-8-sig")
    angle, pressure = read(file)
    assert angle == pytest.approx(ANGLE)
    assert pressure == pytest.approx(BAR / 10, rel=1e-5)
    rows[7] = rows[7].replace(",", ".")
    file.write_text("\n".join(["crank_angle_deg;pressure_bar", *rows]))
    with pytest.raises(CranktopoError, match=r"line 9: '14.0' beside decimal commas"):
        read(file)
