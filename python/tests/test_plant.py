"""The plant step by step."""

import time

import numpy as np
import pytest
from conftest import root, sanitized

import hydrapod


def test_rests_where_it_is(heavy):
    plant = hydrapod.Plant(heavy)
    for _ in range(50):
        displacement = plant.step(plant.rest_commands, 1e-3)
    # equilibrium is found to some 1e-9 of the state's magnitude
    assert np.abs(displacement).max() < 1e-7
    assert plant.time == pytest.approx(0.05, rel=1e-12)


def test_linearisation_predicts_small_steps(heavy):
    """A, B of the plant against a small motion of the nonlinear one."""
    plant = hydrapod.Plant(heavy, integrator="adaptive", tolerance=1e-11)
    linear = plant.linearise()
    n = linear.A.shape[0]
    assert linear.B.shape == (n, 12) and linear.C.shape[1] == n and len(linear.states) == n
    push, dt = np.array([31.0, -17.0, 53.0, 7.0, 11.0, -5.0]), 2e-3
    moved = plant.step(None, dt, wrench=push)
    from scipy.linalg import expm

    # ẋ = A x + B u from rest with constant u: the integral of exp(A t) B u
    u = np.concatenate([np.zeros(6), push])
    block = np.zeros((n + 1, n + 1))
    block[:n, :n] = linear.A
    block[:n, n] = linear.B @ u
    x = expm(block * dt)[:n, n]
    center = linear.C[:3] @ x
    # Coulomb friction holds against so small a push for a part of it; displacement is of the frame's origin
    np.testing.assert_allclose((linear.C[:6] @ x)[3:6], moved[3:6], rtol=0.2, atol=1e-9)
    assert np.sign(center[2]) == np.sign(moved[2])


def test_run_is_step_after_step(heavy):
    rng = np.random.default_rng(20)
    commands = 0.02 * rng.standard_normal((120, 6))
    one, other = hydrapod.Plant(heavy), hydrapod.Plant(heavy)
    rows = np.array([one.step(row, 1e-3) for row in commands])
    np.testing.assert_array_equal(rows, other.run(commands, 1e-3))
    np.testing.assert_array_equal(one.state, other.state)
    one.reset()
    np.testing.assert_array_equal(one.run(commands, 1e-3), rows)


def test_fixed_and_adaptive_agree(heavy):
    commands = 0.05 * np.sin(np.linspace(0, 9, 200))[:, None] * np.array([1, -0.7, 0.3, 0.9, -0.2, 0.5])
    fixed = hydrapod.Plant(heavy, fixed_step="0.1 ms").run(commands, 1e-3)
    adaptive = hydrapod.Plant(heavy, integrator="adaptive", tolerance=1e-10).run(commands, 1e-3)
    # measured 3e-10 and 6e-7 of the largest displacement (docs/howto/python.md); ten times that
    np.testing.assert_allclose(fixed, adaptive, atol=1e-8 * np.abs(adaptive).max())
    coarse = hydrapod.Plant(heavy, fixed_step="0.5 ms").run(commands, 1e-3)
    np.testing.assert_allclose(coarse, adaptive, atol=1e-5 * np.abs(adaptive).max())


@pytest.mark.parametrize("name, error", [("heavy-platform", 1e-7), ("zhang-jiang-2021", 2e-5)])
def test_the_default_integrator_keeps_its_tolerance(name, error):
    """Valves moved by sines of 2 Hz to 7 Hz; measured 3e-8 and 5e-6 of the largest displacement (docs/howto/python.md)."""
    machine = hydrapod.read_machine(root / "models" / f"{name}.toml")
    t = np.arange(300) * 1e-3
    commands = 0.05 * np.stack([np.sin(2 * np.pi * (2 + k) * t + k) for k in range(6)], axis=1)
    exact = hydrapod.Plant(machine, integrator="adaptive", tolerance=1e-11).run(commands, 1e-3)
    np.testing.assert_allclose(hydrapod.Plant(machine).run(commands, 1e-3), exact, rtol=0,
                               atol=error * np.abs(exact).max())


def test_fixed_steps_are_for_the_fixed_integrator(heavy):
    commands = np.full((20, 6), 0.05)
    given = hydrapod.Plant(heavy, fixed_step="0.25 ms").run(commands, 1e-3)
    np.testing.assert_array_equal(given, hydrapod.Plant(heavy, integrator="fixed", fixed_step=2.5e-4).run(commands, 1e-3))
    np.testing.assert_array_equal(hydrapod.Plant(heavy, integrator="fixed").run(commands, 1e-3),
                                  hydrapod.Plant(heavy, fixed_step=1e-4).run(commands, 1e-3))
    np.testing.assert_array_equal(hydrapod.Plant(heavy).run(commands, 1e-3),
                                  hydrapod.Plant(heavy, integrator="exponential").run(commands, 1e-3))
    with pytest.raises(ValueError, match="fixed_step: is for integrator"):
        hydrapod.Plant(heavy, integrator="exponential", fixed_step=1e-4)


def test_state_can_be_put_back(heavy):
    plant = hydrapod.Plant(heavy, fixed_step="0.1 ms")
    plant.step(np.full(6, 0.1), 0.01)
    state = plant.state
    after = plant.step(np.full(6, 0.1), 0.01)
    plant.state = state
    # the clock goes on, so that the step differs by rounding
    np.testing.assert_allclose(plant.step(np.full(6, 0.1), 0.01), after, atol=1e-12)
    assert len(plant.state_names) == len(plant.state_units) == len(state)
    assert plant.outputs()["cap_pressure"].shape == (6,)


@pytest.mark.parametrize("commands", [[1, 2], np.zeros((6, 1)), [np.nan] * 6, "x" * 6, None.__class__,
                                      np.zeros(6, complex) + 1j])
def test_wrong_commands(heavy, commands):
    plant = hydrapod.Plant(heavy)
    with pytest.raises((ValueError, TypeError)):
        plant.step(commands, 1e-3)


@pytest.mark.parametrize("dt", [0.0, -1e-3, np.nan, np.inf, 1e9])
def test_wrong_steps(heavy, dt):
    with pytest.raises(ValueError):
        hydrapod.Plant(heavy).step(None, dt)


def test_ends_where_the_model_ends(heavy):
    plant = hydrapod.Plant(heavy)
    with pytest.raises((hydrapod.ComputationError, ValueError)):
        plant.state = np.full(plant.state.shape, np.nan)
    with pytest.raises(ValueError):
        plant.state = plant.state[:-1]


@pytest.mark.skipif(sanitized, reason="sanitizers take time")
def test_speed(heavy, capsys):
    """Steps of 1 ms per second of processor time, the platform in motion; the bound is a third of what an idle processor
    does, for busy ones. bench/python.py has the figures."""
    plant = hydrapod.Plant(heavy)
    t = np.arange(500) * 1e-3
    commands = 0.05 * np.stack([np.sin(2 * np.pi * (2 + k) * t + k) for k in range(6)], axis=1)
    rates = []
    for _ in range(8):
        plant.reset()
        began = time.thread_time()
        for row in commands:
            plant.step(row, 1e-3)
        rates.append(len(t) / (time.thread_time() - began))
    with capsys.disabled():
        print(f"\n{max(rates):.0f} steps of 1 ms per second")
    assert max(rates) > 30_000


def test_classes_that_derive_have_their_own_step(heavy):
    """As environments for reinforcement learning are written."""
    class Environment(hydrapod.Plant):
        def step(self, action):
            return super().step(0.01 * np.asarray(action), 1e-3)

    action = np.linspace(-1, 1, 6)
    np.testing.assert_array_equal(Environment(heavy).step(action), hydrapod.Plant(heavy).step(0.01 * action, 1e-3))
    assert "wrench" in hydrapod.Plant.step.__doc__ and "Heavy" in repr(hydrapod.Plant(heavy))


def test_plants_are_not_copied(heavy):
    """A copy would step with the plant it was made of."""
    import copy
    import pickle

    plant = hydrapod.Plant(heavy)
    for attempt in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="make another"):
            attempt(plant)


def test_time_steps_may_have_a_unit(heavy):
    by_number, by_text = hydrapod.Plant(heavy), hydrapod.Plant(heavy)
    commands = np.full((3, 6), 0.01)
    np.testing.assert_array_equal(by_number.step(commands[0], 1e-3), by_text.step(commands[0], "1 ms"))
    np.testing.assert_array_equal(by_number.run(commands, 1e-3), by_text.run(commands, "1 ms"))
    plants = (plant for plant in (by_number, by_text))
    motions, _ = hydrapod.Plant.run_many(plants, commands, "1 ms")
    np.testing.assert_array_equal(motions[0], motions[1])
    for wrong in ("1 mm", "soon", None, True, [1e-3]):
        with pytest.raises((ValueError, TypeError), match="dt"):
            by_number.step(None, wrong)


@pytest.mark.parametrize("wrong", [["0.1"] * 6, [True] * 6, np.full(6, 0.1, object), [0.1j] * 6])
def test_commands_are_real_numbers(heavy, wrong):
    with pytest.raises(TypeError, match="six real numbers"):
        hydrapod.Plant(heavy).step(wrong, 1e-3)
