"""What datasets say of their records: where they come from, and bases that still move at the end."""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.motions.origins import end_velocity
from frictionmap.motions.record import Record

FREE = fm.System(contact="fixed-wall", excitation="base", damping_ratios=0.05)
CARRIED = fm.System(
    contact="joined-base-wall", excitation="base", damping_ratios=0.05, damping_reference="base"
)


def test_the_velocity_at_the_end():
    """A half sine of acceleration leaves 2 A T/pi, its largest; one cycle leaves none."""
    assert end_velocity(Record.pulse("half-sine", 3.0, 0.7)) == pytest.approx(1.0, rel=1e-9)
    t = np.linspace(0.0, 1.0, 401)
    assert abs(end_velocity(Record(np.sin(2 * math.pi * t), 1 / 400))) < 1e-12
    assert end_velocity(Record([0.0, 2.0, -1.0], 0.1, quantity="velocity")) == -0.5
    assert end_velocity(Record([0.0, 2.0, -1.0], 0.1, quantity="displacement")) == 0.0
    assert end_velocity(Record([0.0, 2.0, -1.0], 0.1, quantity="force")) == 0.0


@pytest.mark.parametrize(("system", "said"), [(FREE, True), (CARRIED, False)])
def test_a_base_that_drifts_is_named_where_its_place_acts(system, said):
    """A wall at rest moves against the base; one that the base carries does not."""
    drifting = Record([0.0, 1.0, 0.0], 1.0, name="step")
    still = Record([0.0, 1.0, 0.0, -1.0, 0.0], 1.0, name="back")
    ds = fm.history(system, [drifting, still], beta=0.5, after=0.0, samples="none")
    if said:
        assert "the base of step ends with up to 100% of its largest velocity" in ds.attrs["remark"]
        assert "back" not in ds.attrs["remark"]
    else:
        assert "remark" not in ds.attrs


def test_datasets_name_the_files_of_their_records(tmp_path):
    (tmp_path / "shake.csv").write_text("time,acceleration\n0,1\n1,3\n2,-1\n")
    record = Record.read(tmp_path / "shake.csv", baseline="mean")
    ds = fm.history(CARRIED, record, beta=0.5, after=0.0, samples="none")
    assert ds.attrs["records"].startswith("shake: shake.csv (crc32 ")
    assert ds.attrs["records"].endswith("; the mean, 1, is taken off")
