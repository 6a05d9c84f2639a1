// Where the estimate was and where it should have been.

const kTruthColour = '#8c99a8';
const kEstimateColour = '#4477aa';

/** Limits of both axes between which metres are as long in x as in y. */
function equalAxes([left, right], [low, high], width, height) {
  const plot = {width: Math.max(50, width - 60), height: Math.max(50, height - 50)};
  const perPixel = 1.12 * Math.max((right - left) / plot.width, (high - low) / plot.height, 1e-6);
  const around = (from, to, pixels) => ({
    min: (from + to - perPixel * pixels) / 2,
    max: (from + to + perPixel * pixels) / 2,
  });
  return {x: around(left, right, plot.width), y: around(low, high, plot.height)};
}

function rangeOf(values) {
  return values.reduce(
      ([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}

function pathFigure(errors) {
  const points = (name) => errors[`${name}_x_m`].map((x, i) => ({x, y: errors[`${name}_y_m`][i]}));
  const [truth, estimate] = [points('truth'), points('estimate')];
  const all = [...truth, ...estimate];
  const axes = (width, height) =>
      equalAxes(rangeOf(all.map((p) => p.x)), rangeOf(all.map((p) => p.y)), width, height);
  const line = (label, data, colour, width) => ({
    label,
    data,
    showLine: true,
    borderColor: colour,
    backgroundColor: colour,
    borderWidth: width,
    pointRadius: 0,
    pointHitRadius: 8,
    pointHoverRadius: 4
  });
  return chartFigure({
    title: 'Trajectory from above',
    hint:
        'The estimate after alignment, x to the right, y upwards; metres are as long on both axes.',
    height: (width) => Math.min(420, Math.max(260, 0.75 * width)),
    config: (width, height) => ({
      type: 'scatter',
      data: {
        datasets:
            [line('estimate', estimate, kEstimateColour, 2), line('truth', truth, kTruthColour, 2)]
      },
      options: {
        interaction: {mode: 'nearest', intersect: false},
        scales: {
          x: {
            ...axes(width, height).x,
            title: {display: true, text: 'x, m'},
            ticks: {callback: (v) => numberText(v, 3), includeBounds: false}
          },
          y: {
            ...axes(width, height).y,
            title: {display: true, text: 'y, m'},
            ticks: {callback: (v) => numberText(v, 3), includeBounds: false}
          }
        },
        plugins: {
          tooltip: {
            callbacks: {
              label: (item) =>
                  ` ${item.dataset.label} at ${numberText(errors.t_s[item.dataIndex], 4)} s: ${
                      numberText(item.raw.x, 3)}, ${numberText(item.raw.y, 3)} m`
            }
          },
        },
      },
    }),
    table: () => ({
      columns: ['t, s', 'estimate x, m', 'estimate y, m', 'truth x, m', 'truth y, m'].map(
          (title) => ({title})),
      rows: errors.t_s.map(
          (t, i) =>
              [t, errors.estimate_x_m[i], errors.estimate_y_m[i], errors.truth_x_m[i],
               errors.truth_y_m[i]]),
    }),
  });
}

function errorFigure(errors) {
  const colour = '#aa5588';
  return chartFigure({
    title: 'Position error over time',
    height: (width) => Math.min(420, Math.max(260, 0.75 * width)),
    config: () => ({
      type: 'scatter',
      data: {
        datasets: [{
          label: 'position error',
          data: errors.t_s.map((x, i) => ({x, y: errors.position_error_m[i]})),
          showLine: true,
          borderColor: colour,
          backgroundColor: colour,
          borderWidth: 2,
          pointRadius: 0,
          pointHoverRadius: 4
        }]
      },
      options: {
        interaction: {mode: 'nearest', axis: 'x', intersect: false},
        scales: {
          x: {title: {display: true, text: 's since the first pose'}, grid: {display: false}},
          y: {title: {display: true, text: 'm'}, beginAtZero: true}
        },
        plugins: {
          tooltip: {
            callbacks: {label: ({raw}) => ` ${numberText(raw.y, 3)} m at ${numberText(raw.x, 4)} s`}
          }
        },
      },
    }),
    table: () => ({
      columns: [{title: 't, s'}, {title: 'position error, m'}],
      rows: errors.t_s.map((t, i) => [t, errors.position_error_m[i]])
    }),
  });
}

function trajectorySection(run) {
  const {errors} = run.tables;
  if (!errors || errors.t_s.length === 0)
    return section(
        'trajectory', 'Trajectory',
        element(
            'p', {class: 'card soft'},
            'No positions beside the truth: the data have none, the run is a replay, or an older leviosim wrote it.'));
  return section(
      'trajectory', 'Trajectory', run.protocol ? element('p', {class: 'hint'}, run.protocol) : null,
      element('div', {class: 'pair'}, pathFigure(errors), errorFigure(errors)));
}
