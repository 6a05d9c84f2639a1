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

/** Upwards is the axis y, or z. */
function pathFigure(errors, title, up) {
  const points =
      (name) => errors[`${name}_x_m`].map((x, i) => ({x, y: errors[`${name}_${up}_m`][i]}));
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
    title,
    hint: `The estimate after alignment, x to the right, ${
        up} upwards; metres are as long on both axes.`,
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
            title: {display: true, text: `${up}, m`},
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
      columns: ['t, s', 'estimate x, m', `estimate ${up}, m`, 'truth x, m', `truth ${up}, m`].map(
          (title) => ({title})),
      rows: errors.t_s.map(
          (t, i) => [t, estimate[i].x, estimate[i].y, truth[i].x, truth[i].y]),
    }),
  });
}

function errorFigure(errors, name, time) {
  const colour = '#aa5588';
  const [, what, unit] = /^(.*)_error_(.*)$/.exec(name);
  return chartFigure({
    title: `${capital(what)} error over time`,
    height: (width) => Math.min(420, Math.max(260, 0.75 * width)),
    config: () => ({
      type: 'scatter',
      data: {
        datasets: [{
          label: `${what} error`,
          data: errors.t_s.map((x, i) => ({x, y: errors[name][i]})),
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
          x: {title: {display: true, text: time}, grid: {display: false}},
          y: {title: {display: true, text: unit}, beginAtZero: true}
        },
        plugins: {
          tooltip: {
            callbacks: {label: ({raw}) => ` ${numberText(raw.y, 3)} ${unit} at ${numberText(raw.x, 4)}`}
          }
        },
      },
    }),
    table: () => ({
      columns: [{title: time}, {title: `${what} error, ${unit}`}],
      rows: errors.t_s.map((t, i) => [t, errors[name][i]])
    }),
  });
}

/** Of a run, or of an evaluation, which has a sentence and errors of the attitude. */
function trajectorySection(run, id = 'trajectory', title = 'Trajectory') {
  const {errors} = run.tables;
  if (!errors || errors.t_s.length === 0)
    return section(
        id, title,
        element(
            'p', {class: 'card soft'},
            'No positions beside the truth: the data have none, or the run is a replay.'));
  return section(
      id, title, run.sentence ? element('p', {}, run.sentence) : null,
      run.protocol ? element('p', {class: 'hint'}, run.protocol) : null,
      element(
          'div', {class: 'pair'}, pathFigure(errors, 'Trajectory from above', 'y'),
          pathFigure(errors, 'Trajectory from the side', 'z'),
          ...['position_error_m', 'tilt_error_deg', 'heading_error_deg']
              .filter((name) => errors[name])
              .map((name) => errorFigure(errors, name, run.time || 's since the first pose'))));
}
