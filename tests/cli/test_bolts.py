"""The command `bolts` as a user runs it."""

import json

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder

PLAIN = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
JOINT = '\n[[bolted_joint]]\nname = "counterweight"\nthread = "M10"\ngrip_mm = 30.0\nmax_force_N = 9000.0\n'


def run(capsys, *args):
    code = main(["bolts", *args])
    out = capsys.readouterr()
    return code, out.out, out.err


def test_a_joint_is_told_and_written(capsys, tmp_path):
    design = tmp_path / "bolted.toml"
    design.write_text(PLAIN + JOINT)
    code, text, _ = run(capsys, str(design))
    assert code == 0
    assert "counterweight  M10 10.9" in text
    code, out, _ = run(capsys, str(design), "--json")
    (joint,) = json.loads(out)["joints"]
    assert joint["vdi_2230"]["torque_Nm"] > 60
    safeties = [joint["vdi_2230"][f"{name}_safety"] for name in ("clamp", "yield", "fatigue", "thread")]
    assert joint["smallest_safety"] == min(*safeties, joint["vdi_2230"]["head_pressure_safety"])


def test_a_design_without_joints_and_a_thread_that_is_none(capsys, tmp_path):
    code, _, err = run(capsys, "mikron-iiic-plain")
    assert code == 3
    assert "[[bolted_joint]]" in err
    design = tmp_path / "bolted.toml"
    design.write_text(PLAIN + JOINT.replace("M10", "M11"))
    code, _, err = run(capsys, str(design))
    assert code == 3
    assert "ISO 261" in err
