// Where the vehicle is with the selected frame, on its path from above, with the truth and the map
// points that its last keyframes saw. A click selects the frame that was nearest.

const kShownKeyframes = 10;

/**
 * @param path  {frame, t_s, estimate_x_m, …} and, where there is a truth, that with the error
 * @param film  [{points}], or null
 */
function flightPath(path, film, state, onpick) {
  const mark = (label, data, colour, pointRadius, order) =>
      ({label, data, times: path.t_s, backgroundColor: colour, borderColor: colour, pointRadius,
        pointHoverRadius: pointRadius, order});
  /** The newest pose that is not after the selected frame. */
  const now = () => Math.max(0, path.frame.filter((frame) => frame <= state.frame).length - 1);
  const at = (name) => [{x: path[`${name}_x_m`][now()], y: path[`${name}_y_m`][now()]}];
  function mapPoints() {
    const keyframes =
        film.slice(0, state.frame + 1).filter(({points}) => points.length > 0).slice(-kShownKeyframes);
    return keyframes.flatMap(({points}) => Array.from(
        {length: points.length / 2}, (_, i) => ({x: points[2 * i] / 1e3, y: points[2 * i + 1] / 1e3})));
  }
  function marks() {
    const list = [mark('here', at('estimate'), style('--accent'), 7, -2)];
    if (path.truth_x_m) list.push(mark('here, truth', at('truth'), kTruthColour, 5, -1));
    if (film) list.push(mark('map points', mapPoints(), kSeriesPalette[3], 1.5, 9));
    return list;
  }
  function pick({datasetIndex, index}, chart) {
    const to = chart.data.datasets[datasetIndex].data[index];
    const distances =
        path.frame.map((_, i) => Math.hypot(path.estimate_x_m[i] - to.x, path.estimate_y_m[i] - to.y));
    onpick(path.frame[distances.indexOf(Math.min(...distances))]);
  }
  return pathFigure(
      [{name: 'estimate', errors: path}], 'Trajectory from above', 'y', {marks, onpick: pick, room: film ? 2 : 1.12});
}
