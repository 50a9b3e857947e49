"""A run as a rerun recording: balls that move in one view, curves beside them. Imports rerun when asked."""

from curriculum.common.files import whole


def write(path, name, t, radius, lanes, curves, colors):
    """Write a recording, whole, in rerun's strict mode. Raises ImportError where rerun is missing.

    name: application id, [a-z0-9_]. t (S,) [s]: becomes the timelines step and sim_time.
    radius (N,) [m]; lanes {label: q (S, 2, N)}: the same N balls, each label over its own piece of
    the line y = 0, side by side in one 2-D view. curves {title: {label: values (S,)}}: a plot a title.
    colors {label: "#rrggbb"}, one fixed colour a label everywhere. rerun's 2-D views have y down and
    no option, so y is negated here and only here. Whole columns are sent, never a value at a time.
    """
    import numpy as np
    import rerun as rr
    import rerun.blueprint as rrb

    colors = {label: int(color[1:] + "ff", 16) for label, color in colors.items()}       # RGBA
    width = max(float(np.ptp(q[0, 0])) for q in lanes.values()) + 12.0 * float(radius.max())
    times = [rr.TimeColumn("step", sequence=np.arange(len(t))),      # whole nanoseconds: no stamp off
             rr.TimeColumn("sim_time", duration=np.round(t * 1e9).astype("timedelta64[ns]"))]
    recording = rr.RecordingStream(name)
    rr.set_strict_mode(True)                            # a wrong call raises instead of warning
    with whole(path) as temporary:
        recording.save(temporary, default_blueprint=layout(rrb, lanes, curves, width, radius))
        for place, (label, q) in enumerate(lanes.items()):
            middle = width * place
            table = [[middle - 0.45 * width, 0.0], [middle + 0.45 * width, 0.0]]
            recording.log(f"world/{label}/table", rr.LineStrips2D(
                [table], colors=[colors[label]], labels=[label], radii=[0.005]), static=True)
            balls = f"world/{label}/balls"
            recording.log(balls, rr.Points2D.from_fields(
                radii=radius, colors=[colors[label]] * len(radius)), static=True)
            spots = np.stack((q[:, 0] + middle, -q[:, 1]), axis=-1).reshape(-1, 2)
            recording.send_columns(balls, times, rr.Points2D.columns(positions=spots).partition(
                [len(radius)] * len(t)))
        for title, lines in curves.items():
            for label, values in lines.items():
                recording.log(f"{title}/{label}", rr.SeriesLines(
                    colors=[colors[label]], names=[label]), static=True)
                recording.send_columns(f"{title}/{label}", times, rr.Scalars.columns(scalars=values))
        recording.disconnect()


def layout(rrb, lanes, curves, width, radius):
    """The blueprint that travels in the file: the balls on top, the plots in a row below, paused at 0."""
    high = max(float(q[0, 1].max()) for q in lanes.values()) + 2.0 * float(radius.max())
    bounds = rrb.VisualBounds2D(x_range=[-0.5 * width, (len(lanes) - 0.5) * width],
                                y_range=[-high, 0.1 * high])
    plots = [rrb.TimeSeriesView(origin=title, name=title) for title in curves]
    return rrb.Blueprint(
        rrb.Vertical(rrb.Spatial2DView(origin="world", name="balls on the table", visual_bounds=bounds),
                     rrb.Horizontal(*plots)),
        rrb.TimePanel(timeline="sim_time", play_state="paused"), collapse_panels=True)
