"""Kinematics, statics, signals: against geometry, differences and what the check prints."""

import numpy as np
import pytest
from conftest import command_line

import hydrapod


def rotation(rx, ry, rz):
    """R = Rz Ry Rx"""
    (cx, cy, cz), (sx, sy, sz) = np.cos([rx, ry, rz]), np.sin([rx, ry, rz])
    return (np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
            @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]))


def test_lengths_are_distances_of_joints(heavy):
    """Against joints from the report's document, moved by hand."""
    machine = hydrapod.report(heavy, points=2).to_dict()
    geometry = machine["poses"][0]["geometry"]
    origin = np.array(geometry["platform"]["origin_m"])
    base = np.array([leg["base_joint_m"] for leg in geometry["legs"]])
    platform = np.array([leg["platform_joint_m"] for leg in geometry["legs"]])
    d = np.array([0.02, -0.03, 0.04, 0.05, -0.06, 0.07])
    moved = (platform - origin) @ rotation(*d[3:]).T + origin + d[:3]
    np.testing.assert_allclose(hydrapod.leg_lengths(heavy, d), np.linalg.norm(moved - base, axis=1), atol=1e-12)
    np.testing.assert_allclose(hydrapod.leg_lengths(heavy), np.linalg.norm(platform - base, axis=1), atol=1e-12)


def test_forward_undoes_inverse(heavy):
    rng = np.random.default_rng(5)
    d = rng.uniform(-0.05, 0.05, (200, 6))
    lengths = hydrapod.leg_lengths(heavy, d)
    np.testing.assert_allclose(hydrapod.forward_kinematics(heavy, lengths), d, atol=1e-10)
    np.testing.assert_allclose(hydrapod.forward_kinematics(heavy, lengths[0], start=d[0]), d[0], atol=1e-10)
    assert np.isnan(hydrapod.forward_kinematics(heavy, np.full(6, 0.01))).all()
    assert hydrapod.leg_lengths(heavy, np.zeros((0, 6))).shape == (0, 6)


def test_jacobian_is_the_slope(heavy):
    h = 1e-6
    J = hydrapod.leg_jacobian(heavy)
    steps = h * np.eye(6)
    slope = (hydrapod.leg_lengths(heavy, steps) - hydrapod.leg_lengths(heavy, -steps)).T / (2 * h)
    np.testing.assert_allclose(J, slope, atol=1e-8)
    quality = hydrapod.pose_quality(heavy)
    assert quality.condition == pytest.approx(quality.singular_values[0] / quality.singular_values[-1], rel=1e-12)


def test_statics_are_those_of_the_check(model):
    machine = hydrapod.read_machine(model)
    checked = command_line("check", model, "--pose", "neutral", "--format", "json")["poses"][0]
    forces = [leg["axial_force_N"] for leg in checked["legs"]]
    found = hydrapod.static_equilibrium(machine)
    np.testing.assert_array_equal(0.0 - found.oil_force, forces)
    tilts = [leg["static_tilt_rad"] for leg in checked["legs"]]
    np.testing.assert_allclose(np.hypot(*found.flexible[:, :2].T), tilts, rtol=1e-15)
    buckling = hydrapod.buckling(machine)
    if checked["buckling"]["status"] == "not_sought":
        return
    assert buckling.status == checked["buckling"]["status"]
    payload = checked["buckling"].get("payload_kg")
    assert buckling.payload == payload or (payload is None and np.isnan(buckling.payload))


def test_oil_forces_carry_the_weight(heavy):
    """Σ Jᵀ f of the oil forces alone: the weight of platform and legs, to the share that the seals carry."""
    stiff = heavy.using("rigid")
    found = hydrapod.static_equilibrium(stiff)
    pull = hydrapod.leg_jacobian(stiff).T @ found.oil_force
    assert found.residual < 1e-10
    # pulling legs push the platform down, so that a platform at rest has negative forces
    assert -pull[2] > 9.8 * stiff["platform.mass"]
    assert np.abs(pull[[0, 1, 5]]).max() < 0.05 * abs(pull[2])


def test_signals(heavy):
    found = hydrapod.sample_signals("sine x=3 mm, frequency=2 Hz, fade=0 s", rate="1 kHz", duration="0.5 s")
    np.testing.assert_allclose(found.values[:, 0], 3e-3 * np.sin(4 * np.pi * found.time), atol=1e-15)
    np.testing.assert_allclose(found.rates[:, 0], 3e-3 * 4 * np.pi * np.cos(4 * np.pi * found.time), atol=1e-13)
    multisine = hydrapod.sample_signals("multisine z=1 mm, from=1 Hz, to=5 Hz, period=2 s, fade=0 s", rate=200,
                                        duration=2.0)
    spectrum = np.abs(np.fft.rfft(multisine.values[:, 2]))
    lines = np.flatnonzero(spectrum > 1e-9 * spectrum.max())
    assert list(lines) == list(range(2, 11)) and multisine.period == 400
    np.testing.assert_allclose(np.sqrt(np.mean(multisine.values[:, 2] ** 2)), 1e-3, rtol=1e-12)
    # what a simulation is commanded
    run = hydrapod.simulate(heavy, "step z=1 mm, at=0.01 s, rise=0.02 s", until=0.05)
    step = hydrapod.sample_signals("step z=1 mm, at=0.01 s, rise=0.02 s", rate=1000.0, duration=0.06)
    interpolated = np.interp(run.time, step.time, step.values[:, 2])
    np.testing.assert_allclose(run.command[:, 2], interpolated, atol=1.1e-4)


@pytest.mark.parametrize("wrong", [np.zeros(5), np.zeros((2, 7)), np.full(6, np.nan), np.zeros(6, complex), "x" * 6,
                                   np.zeros((2, 2, 6)), np.array([object()] * 6)])
def test_wrong_displacements(heavy, wrong):
    for call in (hydrapod.leg_lengths, hydrapod.leg_jacobian, hydrapod.forward_kinematics):
        with pytest.raises((ValueError, TypeError)):
            call(heavy, wrong)


def test_wrong_signals():
    for wrong in (dict(signals="sinus x=1 mm"), dict(signals="rest", duration=-1), dict(signals="rest", rate=0),
                  dict(signals="rest", duration=1e9), dict(signals="sine x=1 mm", unit="volt")):
        with pytest.raises(ValueError):
            hydrapod.sample_signals(**wrong)
