"""A run as a rerun recording: balls that move in one view, curves beside them. Imports rerun when asked."""

from curriculum.common.files import whole


def write(path, name, runs, radius, curves, colors):
    """Write a recording, whole, in rerun's strict mode. Raises ImportError where rerun is missing.

    name: application id, [a-z0-9_]. runs {label: run}: run.t (S,) [s] becomes the timelines step and
    sim_time (step alone beyond 9e9 s); run.q (S, 2, N) the balls of `radius` (N,) [m], each label over its own piece of the
    line y = 0, side by side in one 2-D view. curves {title: {label: values (S,)}}: a plot a title,
    its path the title's first word. colors {label: "#rrggbb"}: one fixed colour a label. rerun's 2-D
    views have y down and no option, so y is negated here and only here. Whole columns are sent.
    """
    import numpy as np
    import rerun as rr
    import rerun.blueprint as rrb

    colors = {label: np.array([int(colors[label][1:] + "ff", 16)], np.uint32) for label in runs}
    width = max(float(np.ptp(run.q[0, 0])) for run in runs.values()) + 12.0 * float(radius.max())
    recording = rr.RecordingStream(name)
    rr.set_strict_mode(True)                            # a wrong call raises instead of warning
    with whole(path) as temporary:
        recording.save(temporary, default_blueprint=layout(rrb, runs, curves, width, radius))
        for place, (label, run) in enumerate(runs.items()):
            middle, color, steps = width * place, colors[label], len(run.t)
            times = [rr.TimeColumn("step", sequence=np.arange(steps))]
            if run.t[-1] < 9e9:         # s; 292 years of nanoseconds are all that 64 bits hold
                nanoseconds = np.round(run.t * 1e9).astype("timedelta64[ns]")   # whole: no stamp off
                times.append(rr.TimeColumn("sim_time", duration=nanoseconds))
            table = [[middle - 0.45 * width, 0.0], [middle + 0.45 * width, 0.0]]
            recording.log(f"world/{label}/table", rr.LineStrips2D(
                [table], colors=color, labels=[label], radii=[0.005]), static=True)
            balls = f"world/{label}/balls"
            recording.log(balls, rr.Points2D.from_fields(
                radii=radius, colors=np.repeat(color, len(radius))), static=True)
            spots = np.stack((run.q[:, 0] + middle, -run.q[:, 1]), axis=-1).reshape(-1, 2)
            recording.send_columns(balls, times, rr.Points2D.columns(positions=spots).partition(
                [len(radius)] * steps))
            for title, lines in curves.items():
                curve = f"{title.split()[0]}/{label}"
                recording.log(curve, rr.SeriesLines(colors=color, names=[label]), static=True)
                recording.send_columns(curve, times, rr.Scalars.columns(scalars=lines[label]))
        recording.disconnect()


def layout(rrb, runs, curves, width, radius):
    """The blueprint that travels in the file: the balls on top, the plots in a row below, at t = 0."""
    high = max(float(run.q[0, 1].max()) for run in runs.values()) + 2.0 * float(radius.max())
    bounds = rrb.VisualBounds2D(x_range=[-0.5 * width, (len(runs) - 0.5) * width],
                                y_range=[-high, 0.15 * high])
    plots = [rrb.TimeSeriesView(origin=title.split()[0], name=title,
                                plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop))
             for title in curves]
    return rrb.Blueprint(
        rrb.Vertical(rrb.Spatial2DView(origin="world", name="balls on the table", visual_bounds=bounds),
                     rrb.Horizontal(*plots)),
        rrb.TimePanel(timeline="sim_time", play_state="paused", state="collapsed"),
        collapse_panels=True)
