"""Plots: what they show is what results say, and they refuse what they cannot show."""

import numpy as np
import pytest

import hydrapod

pytest.importorskip("matplotlib")


def drawn(figure, path):
    figure.savefig(path)
    assert path.stat().st_size > 5000
    return figure.axes


def test_modes(heavy, tmp_path):
    modes = hydrapod.modes(heavy)
    left, right = drawn(hydrapod.plot_modes(modes), tmp_path / "modes.png")
    felt = np.array(modes.frequency_hz)[np.array(modes.moves_platform)]
    shown = next(line for line in left.lines if line.get_label() == "flexible legs")
    np.testing.assert_allclose(shown.get_xdata(), felt, rtol=1e-12)
    lengths = np.array([[bar.get_width() for bar in part] for part in right.containers])
    np.testing.assert_allclose(lengths.sum(axis=0), 100.0, rtol=1e-9)
    assert len(hydrapod.plot_modes(modes, platform_only=False).axes[0].get_yticks()) == len(modes.frequency_hz)


def test_bode(heavy, tmp_path):
    bode = hydrapod.bode(heavy, points=50)
    axes = drawn(hydrapod.plot_bode(bode, [("x", "x"), ("ry", "x")]), tmp_path / "bode.png")
    level = [a for a in axes if a.get_title() == "ry from x"][0].lines[0]
    np.testing.assert_allclose(level.get_ydata(), 20 * np.log10(np.abs(bode.H[:, 4, 0])), rtol=1e-12)
    assert len(hydrapod.plot_bode(bode).axes) == 12
    drawn(hydrapod.plot_bode(hydrapod.bode(heavy, input="command", points=50)), tmp_path / "command.png")
    for wrong in ([("x", "up")], ["x"]):
        with pytest.raises(ValueError):
            hydrapod.plot_bode(bode, wrong)


def test_fit_and_stabilisation(strong_run, tmp_path):
    identified = hydrapod.identify(strong_run)
    axes = drawn(hydrapod.plot_fit(identified), tmp_path / "fit.png")
    assert axes[0].get_title()
    # the modes explain the measured responses near their peaks
    k = np.abs(identified.H[:, 0, 0]).argmax()
    assert abs(identified.H_modes[k, 0, 0] / identified.H[k, 0, 0] - 1) < 0.5
    assert identified.deviation.shape == identified.H.shape and identified.radius_95 > 1.0
    with pytest.raises(ValueError):
        hydrapod.plot_fit(identified, [("no such", "x")])
    axes = drawn(hydrapod.plot_stabilisation(identified), tmp_path / "stabilisation.png")
    poles = identified.to_dict()["stabilisation"]
    count = sum(pole["stable"] for order in poles for pole in order["poles"])
    labels = {"new", "frequency agrees", "and damping", "and shape"}
    assert sum(len(line.get_xdata()) for line in axes[0].lines if line.get_label() in labels) == count


def test_a_fit_without_modes():
    """Independent noise has no modes: nothing is drawn for them."""
    noise = np.random.default_rng(2).standard_normal((20000, 2))
    record = hydrapod.Record(noise, 100.0, ["u", "a"], units=["N", "m/s^2"], roles=["excitation", "response"])
    identified = hydrapod.identify(record)
    assert len(identified.frequency_hz) == 0
    assert np.isnan(identified.H_modes).all() and identified.H_modes.shape == identified.H.shape
    assert hydrapod.plot_fit(identified).axes and hydrapod.plot_stabilisation(identified).axes


def test_map(heavy, tmp_path):
    study = hydrapod.workspace_map(heavy, {"x": "-50:50:5 mm", "z": "-100:0:4 mm"})
    axes = drawn(hydrapod.plot_map(study), tmp_path / "map.png")
    np.testing.assert_allclose(axes[0].collections[0].get_array().ravel().filled(np.nan), study["lowest"])
    line = hydrapod.sweep(heavy, {"platform.mass": [13e3, 14e3, 15e3]}, outputs={"own": lambda m: m["platform.mass"]})
    assert list(hydrapod.plot_map(line, "own").axes[0].lines[0].get_ydata()) == [13e3, 14e3, 15e3]
    with pytest.raises(KeyError):
        hydrapod.plot_map(line, "no such")
    with pytest.raises(ValueError, match="grid"):
        hydrapod.plot_map(hydrapod.montecarlo(heavy, {"platform.mass": "uniform ± 1 %"}, samples=5))


def test_map_has_the_end_of_the_stroke(heavy, tmp_path):
    def dashed(axes):
        return [one for one in axes.collections if any(style[1] for style in one.get_linestyle())]

    beyond = hydrapod.workspace_map(heavy, {"z": "-300:600:10 mm", "x": "-40:40:5 mm"})
    assert (beyond["stroke"] < 0.0).any() and (beyond["stroke"] > 0.0).any()
    lines = dashed(drawn(hydrapod.plot_map(beyond, "condition"), tmp_path / "beyond.png")[0])
    assert lines
    z = np.concatenate([path.vertices[:, 0] for line in lines for path in line.get_paths()])
    rows = np.flatnonzero(beyond["stroke"] < 0.0)
    assert z.max() <= 600.0 and np.abs(z - 1e3 * beyond["pose.z"][rows].min()).min() < 100.0
    inside = hydrapod.workspace_map(heavy, {"z": "-20:20:3 mm", "x": "-20:20:3 mm"})
    assert not dashed(hydrapod.plot_map(inside).axes[0])


def test_diagnosis(heavy, tmp_path):
    table = tmp_path / "modes.csv"
    rows = [f"neutral,{f:.3f} Hz" for f in hydrapod.modes(heavy).frequency_hz[:6]]
    table.write_text("pose,frequency\n" + "\n".join(rows) + "\n")
    stiff = heavy.with_({"legs.guide_sleeve.stiffness": "20 kN/mm"})
    diagnosed = hydrapod.diagnose(stiff, table, model_error="0.3 %")
    axes = drawn(hydrapod.plot_diagnosis(diagnosed), tmp_path / "diagnosis.png")
    assert len(axes[1].patches) == min(14, len(diagnosed.hypotheses))
    with pytest.raises(ValueError):
        hydrapod.plot_diagnosis(hydrapod.diagnose(heavy, want="x=3 %"))


def test_plots_say_what_they_cannot_draw(heavy, strong_run):
    bode, identified = hydrapod.bode(heavy, points=5), hydrapod.identify(strong_run)
    for plot, result in ((hydrapod.plot_bode, bode), (hydrapod.plot_fit, identified)):
        for entries in ([], [3], [("x",)]):
            with pytest.raises(ValueError, match="entries"):
                plot(result, entries)
    with pytest.raises(TypeError, match="Figure"):
        hydrapod.plot_bode(bode, figure=hydrapod.plot_bode(bode).axes[0])
    part = hydrapod.sweep(heavy, {"platform.mass": np.linspace(12e3, 14e3, 20000)}, threads=1,
                          progress=lambda share: share > 0.1)
    assert not part.complete
    with pytest.raises(ValueError, match="interrupted"):
        hydrapod.plot_map(part)


def test_refuse_other_results(heavy):
    checked = hydrapod.sensitivity(heavy, "platform.mass")
    for plot in (hydrapod.plot_modes, hydrapod.plot_bode, hydrapod.plot_fit, hydrapod.plot_stabilisation,
                 hydrapod.plot_map, hydrapod.plot_diagnosis):
        with pytest.raises(TypeError, match="expected"):
            plot(checked)


def test_a_figure_of_ones_own(heavy):
    from matplotlib.figure import Figure

    figure = Figure()
    assert hydrapod.plot_modes(hydrapod.modes(heavy), figure=figure) is figure


@pytest.mark.parametrize("band, entries", [((0.01, 1000), [("x", "x"), ("y", "ry")]), ((0.2, 30), [("x", "x")]),
                                           ((0.001, 0.02), None)])
def test_ticks_are_the_frequencies_where_they_are(heavy, band, entries):
    """Those below 1 Hz were 0."""
    figure = hydrapod.plot_bode(hydrapod.bode(heavy, from_=band[0], to=band[1], points=60), entries)
    figure.draw_without_rendering()
    for axes in figure.axes:
        if axes.get_xlabel():
            labels = [label.get_text() for label in axes.get_xticklabels()]
            assert len(labels) > 2 and [float(label) for label in labels] == pytest.approx(list(axes.get_xticks()))


def overlap(figure, one, other):
    renderer = figure.canvas.get_renderer()
    a, b = one.get_window_extent(renderer), other.get_window_extent(renderer)
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


def test_legends_leave_titles_free(heavy, strong_run):
    """Also of one response, whose figure is narrow."""
    identified, bode = hydrapod.identify(strong_run), hydrapod.bode(heavy, points=50)
    one = [(identified.outputs[0], identified.inputs[0])]
    for figure in (hydrapod.plot_bode(bode, [("x", "x")]), hydrapod.plot_bode(bode), hydrapod.plot_fit(identified, one),
                   hydrapod.plot_bode(hydrapod.bode(heavy, input="command", points=50), [("x", "x")]),
                   hydrapod.plot_fit(identified), hydrapod.plot_stabilisation(identified)):
        figure.draw_without_rendering()
        (legend,) = figure.legends
        assert not overlap(figure, legend, figure._suptitle)
        assert not any(overlap(figure, legend, axes) or overlap(figure, legend, axes.xaxis.label)
                       for axes in figure.axes)


def test_most_is_at_least_one(heavy, strong_run):
    with pytest.raises(ValueError, match="most"):
        hydrapod.plot_fit(hydrapod.identify(strong_run), most=0)
