// Where estimates were and where they should have been: over each other, in the colour of their
// error, with the start marked.

const kTruthColour = '#7d8794';
/** Of the estimates, which have the colours of their errors. */
const kDashes = [[], [7, 4], [2, 3], [10, 3, 2, 3]];
const kErrorRamp = ['#2f7fc1', '#e0a526', '#d03b2f'];

/** From no error to the greatest. */
function errorColour(share) {
  const at = Math.min(Math.max(share, 0), 1) * (kErrorRamp.length - 1);
  const i = Math.min(Math.floor(at), kErrorRamp.length - 2);
  const mixed = [1, 3, 5].map((digit) => {
    const [from, to] =
        [kErrorRamp[i], kErrorRamp[i + 1]].map((c) => parseInt(c.slice(digit, digit + 2), 16));
    return Math.round(from + (to - from) * (at - i)).toString(16).padStart(2, '0');
  });
  return `#${mixed.join('')}`;
}

/** Limits of both axes, `room` times as far apart, between which metres are as long in x as in y. */
function equalAxes([left, right], [low, high], width, height, room) {
  const plot = {width: Math.max(50, width - 60), height: Math.max(50, height - 50)};
  const perPixel = room * Math.max((right - left) / plot.width, (high - low) / plot.height, 1e-6);
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

/** What the colours mean. */
function errorRamp(most) {
  return element(
      'p', {class: 'ramp hint'}, 'error 0 ',
      element('i', {style: `background:linear-gradient(90deg,${kErrorRamp.join(',')})`}),
      ` ${numberText(most, 3)} m`);
}

/**
 * Upwards is the axis y, or z.
 * @param paths  [{name, errors}]; the truth, where there is one, is that of the longest
 * @param marks  () → datasets that are drawn over them @param onpick  as of chartFigure()
 * @param room  of the axes, as a multiple of what the paths take
 */
function pathFigure(paths, title, up, {marks = () => [], onpick, room = 1.12} = {}) {
  const pointsOf = (errors, name) =>
      errors[`${name}_x_m`].map((x, i) => ({x, y: errors[`${name}_${up}_m`][i], i}));
  const longest = paths.reduce((a, b) => (b.errors.t_s.length > a.errors.t_s.length ? b : a));
  const hasTruth = Boolean(longest.errors.truth_x_m);
  const truth = hasTruth ? pointsOf(longest.errors, 'truth') : [];
  const estimates = paths.map(({name, errors}) => ({name, errors, points: pointsOf(errors, 'estimate')}));
  const all = [...truth, ...estimates.flatMap((e) => e.points)];
  const most = Math.max(0, ...paths.flatMap(({errors}) => errors.position_error_m || []));
  const axes = (width, height) =>
      equalAxes(rangeOf(all.map((p) => p.x)), rangeOf(all.map((p) => p.y)), width, height, room);
  const colourAt = (errors, i) =>
      errorColour(hasTruth ? errors.position_error_m[i] / (most || 1) : 0);
  const line = {showLine: true, borderWidth: 2, pointRadius: 0, pointHitRadius: 8, pointHoverRadius: 4};
  return chartFigure({
    title,
    hint: `${hasTruth ? 'After alignment, ' : ''}x to the right, ${
        up} upwards; metres are as long on both axes. The triangle is the start.`,
    controls: hasTruth ? errorRamp(most) : null,
    onpick,
    height: (width) => Math.min(420, Math.max(260, 0.75 * width)),
    config: (width, height) => ({
      type: 'scatter',
      data: {
        datasets: [
          ...marks(),
          ...estimates.map(({name, errors, points}, k) => ({
                             ...line,
                             label: name,
                             data: points,
                             times: errors.t_s,
                             backgroundColor: style('--ink'),
                             legendLine: ['solid', 'dashed', 'dotted'][Math.min(k, 2)],
                             borderDash: kDashes[k % kDashes.length],
                             pointRadius: ({dataIndex}) => (dataIndex === 0 ? 7 : 0),
                             pointStyle: 'triangle',
                             segment: {borderColor: ({p1DataIndex}) => colourAt(errors, p1DataIndex)}
                           })),
          {
            ...line,
            label: 'truth',
            data: truth,
            times: longest.errors.t_s,
            borderColor: kTruthColour,
            backgroundColor: kTruthColour
          }
        ]
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
                  ` ${item.dataset.label} at ${numberText(item.dataset.times[item.dataIndex], 4)} s: ${
                      numberText(item.raw.x, 3)}, ${numberText(item.raw.y, 3)} m`
            }
          },
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'estimate', text: true},
        ...['t, s', 'estimate x, m', `estimate ${up}, m`, 'truth x, m', `truth ${up}, m`, 'error, m'].map(
            (column) => ({title: column}))
      ],
      rows: estimates.flatMap(
          ({name, errors, points}) => points.map(
              ({x, y}, i) =>
                  [name, errors.t_s[i], x, y,
                   ...['truth_x_m', `truth_${up}_m`, 'position_error_m'].map(
                       (column) => errors[column]?.[i] ?? null)])),
    }),
  });
}

function errorFigure(paths, column, time) {
  const [, what, unit] = /^(.*)_error_(.*)$/.exec(column);
  return chartFigure({
    title: `${capital(what)} error over time`,
    height: (width) => Math.min(420, Math.max(260, 0.75 * width)),
    config: () => ({
      type: 'scatter',
      data: {
        datasets: paths.map(({name, errors}, k) => ({
                              label: name,
                              data: errors.t_s.map((x, i) => ({x, y: errors[column][i]})),
                              showLine: true,
                              borderColor: seriesColour(k),
                              backgroundColor: seriesColour(k),
                              borderDash: kDashes[k % kDashes.length],
                              borderWidth: 2,
                              pointRadius: 0,
                              pointHoverRadius: 4
                            }))
      },
      options: {
        interaction: {mode: 'nearest', axis: 'x', intersect: false},
        scales: {
          x: {title: {display: true, text: time}, grid: {display: false}},
          y: {title: {display: true, text: unit}, beginAtZero: true}
        },
        plugins: {
          tooltip: {
            callbacks: {
              label: ({dataset, raw}) =>
                  ` ${dataset.label}: ${numberText(raw.y, 3)} ${unit} at ${numberText(raw.x, 4)}`
            }
          }
        },
      },
    }),
    table: () => ({
      columns: [{title: 'estimate', text: true}, {title: time}, {title: `${what} error, ${unit}`}],
      rows: paths.flatMap(
          ({name, errors}) => errors.t_s.map((t, i) => [name, t, errors[column][i]]))
    }),
  });
}

/** @param paths  [{name, errors}] */
function trajectoryFigures(paths, time = 's since the first pose') {
  return element(
      'div', {class: 'pair'}, pathFigure(paths, 'Trajectory from above', 'y'),
      pathFigure(paths, 'Trajectory from the side', 'z'),
      ...['position_error_m', 'tilt_error_deg', 'heading_error_deg']
          .filter((column) => paths.every(({errors}) => errors[column]))
          .map((column) => errorFigure(paths, column, time)));
}

function trajectorySection(run) {
  const {errors} = run.tables;
  if (!errors || errors.t_s.length === 0)
    return section(
        'trajectory', 'Trajectory',
        element(
            'p', {class: 'card soft'},
            'No positions beside the truth: the data have none, or the run is a replay.'));
  return section(
      'trajectory', 'Trajectory',
      run.protocol ? element('p', {class: 'hint'}, run.protocol) : null,
      trajectoryFigures([{name: 'estimate', errors}]));
}

/** Estimates of one flight beside its truth: what each comes to, and all over each other. */
function evaluationsSection(evaluations) {
  const protocols = [...new Set(evaluations.map(({protocol}) => protocol))];
  return section(
      'trajectory', 'Trajectory',
      ...evaluations.map(
          ({name, sentence}) => element('p', {}, element('strong', {}, `${name} `), sentence)),
      ...protocols.map((text) => element('p', {class: 'hint'}, text)),
      trajectoryFigures(
          evaluations.map(({name, tables}) => ({name, errors: tables.errors})),
          evaluations[0].time));
}
