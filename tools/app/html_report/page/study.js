// Many points: curves over a parameter, and a scatter of any two figures with its Pareto front,
// where a point shows its set-up.

/** The number that a cell begins with: of 240, "240MHz". */
function leadingNumber(cell) {
  if (typeof cell === 'number') return cell;
  const number = parseFloat(cell);
  return Number.isNaN(number) ? null : number;
}

/** Points that no other beats: less is better unless the column says more. */
function paretoFront(points, moreX, moreY) {
  const [x, y] = [(p) => (moreX ? -p.x : p.x), (p) => (moreY ? -p.y : p.y)];
  let best = Infinity;
  return [...points].sort((a, b) => x(a) - x(b) || y(a) - y(b)).filter((point) => {
    if (y(point) >= best) return false;
    best = y(point);
    return true;
  });
}

function medianOf(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length / 2;
  return sorted.length % 2 ? sorted[Math.floor(middle)] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** With its unit, unless the title has it. */
function axisTitle({title, unit}) {
  return unit && !title.endsWith(`[${unit}]`) ? `${title}, ${unit}` : title;
}

/** Ticks between whole numbers say nothing of cores, units and commits. */
function ticksOf(values) {
  return values.every(Number.isInteger) ? {precision: 0} : {};
}

/** Logarithmic for positive values over more than two orders of magnitude. */
function axisType(values) {
  const [least, greatest] = [Math.min(...values), Math.max(...values)];
  return least > 0 && greatest > 100 * least ? 'logarithmic' : 'linear';
}

/** A word as the first of a sentence; a path and the name before a colon stay as they are. */
function capital(text) {
  return /^\w+[.=/:]/.test(text) ? text : text.charAt(0).toUpperCase() + text.slice(1);
}

function curveFigure(study, yName) {
  const {x: xName, series: seriesName} = study.curves;
  const cells = (name) => study.table[name];
  const column = (name) => study.columns.find((c) => c.name === name);
  const seriesOf = seriesName ? cells(seriesName) : cells(xName).map(() => '');
  const values = [...new Set(seriesOf)];
  const names = study.curves.names ? cells(study.curves.names) : null;
  const marks = new Set((study.curves.marks || {})[yName]);
  const colourOf = (i) => ({raw}) =>
      raw && marks.has(raw.x) ? style('--bad') : seriesColour(i);
  const lines = values.map((value) => {
    const at = new Map();
    seriesOf.forEach((v, i) => {
      const [x, y] = [leadingNumber(cells(xName)[i]), cells(yName)[i]];
      if (v !== value || x === null || typeof y !== 'number') return;
      if (!at.has(x)) at.set(x, []);
      at.get(x).push(y);
    });
    return {
      value,
      points:
          [...at]
              .sort((a, b) => a[0] - b[0])
              .map(([x, ys]) => ({x, y: medianOf(ys), low: Math.min(...ys), high: Math.max(...ys)}))
    };
  });
  const limit = (study.limits || {})[yName];
  return chartFigure({
    onpick: (item, chart) => {
      const point = chart.data.datasets[item.datasetIndex].data[item.index];
      if (point && historyCards.compare) historyCards.compare(Math.max(0, point.x - 1), point.x);
    },
    title: `${capital(column(yName).title)} over ${column(xName).title}`,
    hint: study.curves.hint ||
        'Medians of what else varies, such as seeds; a point shows the least and the greatest.',
    config: () => ({
      type: 'scatter',
      data: {
        datasets: lines.map(
            ({value, points}, i) => ({
              label: seriesName ? `${numberText(value)} ${column(seriesName).unit}`.trim() :
                                  axisTitle(column(yName)),
              data: points,
              showLine: true,
              borderWidth: 2,
              pointRadius: ({raw}) => (raw && marks.has(raw.x) ? 6 : 3),
              borderColor: seriesColour(i),
              backgroundColor: seriesColour(i),
              pointBackgroundColor: colourOf(i),
              pointBorderColor: colourOf(i)
            }))
      },
      options: {
        interaction: {mode: 'nearest', intersect: false},
        scales: {
          x: {
            title: {display: true, text: axisTitle(column(xName))},
            grid: {display: false},
            ticks: names ? {precision: 0, callback: (value) => names[value] || ''} :
                           ticksOf(lines.flatMap(({points}) => points.map((p) => p.x)))
          },
          y: {
            title: {display: true, text: axisTitle(column(yName))},
            beginAtZero: study.curves.fromZero
          }
        },
        plugins: {
          limitLines: {
            lines: limit === undefined ?
                [] :
                [{axis: 'y', value: limit, label: `limit ${numberText(limit)}`}]
          },
          tooltip: {
            callbacks: {
              label: ({dataset, raw}) => names ? ` ${names[raw.x]}: ${numberText(raw.y)}` :
                                                 ` ${dataset.label}, ${numberText(raw.x)}: ${
                  numberText(raw.y)} (${numberText(raw.low)} to ${numberText(raw.high)})`
            }
          },
        },
      },
    }),
    table: () => ({
      columns: [
        {title: seriesName ? axisTitle(column(seriesName)) : 'curve', text: true},
        {title: axisTitle(column(xName))}, {title: 'median'}, {title: 'least'}, {title: 'greatest'}
      ],
      rows: lines.flatMap(({value, points}) => points.map((p) => [value, p.x, p.y, p.low, p.high])),
    }),
  });
}

/** Of many rows only those whose figure changes by so much [%]. */
const kFewBars = 12;
const kLeastChange = 1;

/**
 * Changes of rows in per cent, the largest first where there are many: those beside the first row,
 * since differences would not show in whole bars, or what the columns hold.
 * @param series  [{label, changes: [% of each row], texts: [], colour: change → colour}]
 */
function changesFigure(title, hint, of, labels, series) {
  const largest = (i) => Math.max(...series.map(({changes}) => Math.abs(changes[i] ?? 0)));
  const rows = [...labels.keys()];
  const shown = rows.length <= kFewBars ?
      rows :
      rows.filter((i) => largest(i) >= kLeastChange || series.some(({isBase}) => isBase && i === 0))
          .sort((a, b) => largest(b) - largest(a));
  const others = rows.length - shown.length;
  return chartFigure({
    title,
    hint: others > 0 ?
        `${hint} ${others} others change it by less than ${kLeastChange} %, or cannot run: see the table.` :
        hint,
    height: (width) => 60 + rowsHeight(shown.map((i) => labels[i]), width, 23),
    config: (width) => ({
      type: 'bar',
      data: {
        labels: shown.map((i) => labels[i]),
        datasets: series.map(({label, changes, colour}) => ({
                               label,
                               data: shown.map((i) => changes[i]),
                               backgroundColor: shown.map((i) => colour(changes[i])),
                               legendColor: colour(1),
                               grouped: false,
                               barPercentage: 0.85,
                               categoryPercentage: 0.95
                             }))
      },
      options: {
        indexAxis: 'y',
        scales: {
          x: {title: {display: true, text: 'change, %'}, grace: width < 600 ? '70%' : '30%', suggestedMin: -1, suggestedMax: 1},
          y: {...stackedRows(), stacked: false}
        },
        plugins: {
          barTexts: {
            texts: shown.map(
                (i) => (series[0].texts || [])[i]?.slice(0, width < 600 ? 1 : 2).join(', '))
          }
        }
      },
    }),
    table: () => ({
      columns: [
        {title: of, text: true},
        ...series.flatMap(
            ({label, values}) => [...(values ? [{title: label}] : []), {title: `change of ${label}, %`}])
      ],
      rows: rows.map(
          (i) =>
              [labels[i],
               ...series.flatMap(
                   ({values, changes}) => [...(values ? [values[i]] : []), changes[i]])])
    }),
  });
}

/** By how much each row differs from the first. */
function barFigure(study, name) {
  const column = study.columns.find((c) => c.name === name);
  const labels = study.table[study.bars.of];
  const cells = study.table[name];
  const values = cells.map((cell) => (typeof cell === 'number' ? cell : null));
  const [base] = values;
  const changes = values.map((value) => (value === null || !base ? null : 100 * (value / base - 1)));
  const better = (change) => (column.more ? change > 0 : change < 0);
  const unit = column.unit ? ` ${column.unit}` : '';
  const texts = values.map((value, i) => {
    const whole = `${numberText(value)}${unit}`;
    return value === null ? [cells[i]].filter((cell) => cell !== null) : i === 0 ? [whole] : [`${signed(changes[i], 2)} %`, whole];
  });
  return changesFigure(
      capital(column.title),
      `Change beside ${labels[0]}. A row without a bar and a value cannot run, or has no such figure.`,
      study.bars.of, labels, [{
        label: axisTitle(column),
        values,
        changes,
        texts,
        isBase: true,
        colour: (c) => style(better(c) ? '--good' : '--bad')
      }]);
}

/** Columns that are changes, in one chart. */
function swingFigure(study) {
  const {of, figures} = study.bars;
  const column = (name) => study.columns.find((c) => c.name === name);
  return changesFigure(
      study.bars.title, '', of, study.table[of],
      figures.filter(column).map((name, i) => ({
                                   label: column(name).title,
                                   changes: study.table[name],
                                   colour: () => seriesColour(i)
                                 })));
}

function scatterFigure(study) {
  const {columns, table} = study;
  const count = table[columns[0].name].length;
  const isSetup = (column) => column.kind === 'setup';
  let [xName, yName] = study.axes;
  let colourName = study.colour || '';
  const column = (name) => columns.find((c) => c.name === name);
  const setupText = (i) => columns.filter(isSetup).map(
      (c) => `${c.title} ${table[c.name][i] ?? '–'}${
          typeof table[c.name][i] === 'number' && c.unit ? ` ${c.unit}` : ''}`);
  const points =
      () => [...Array(count).keys()]
                .map(
                    (i) =>
                        ({i, x: leadingNumber(table[xName][i]), y: leadingNumber(table[yName][i])}))
                .filter((p) => p.x !== null && p.y !== null);
  const axisOf = (name, values) => ({
    type: axisType(values),
    ticks: ticksOf(values),
    title: {display: true, text: axisTitle(column(name))}
  });
  const panel = element(
      'div', {class: 'card', 'aria-live': 'polite'},
      element('p', {class: 'hint'}, 'A click on a point, or Enter, shows its set-up here.'));

  function showPoint(i) {
    panel.replaceChildren(
        element('h3', {}, 'The point'),
        element(
            'dl', {class: 'facts'},
            ...columns.flatMap(
                (c) =>
                    [element('dt', {}, axisTitle(c)),
                     element('dd', {}, numberText(table[c.name][i], 5))])));
  }
  const axisSelect = (label, value, choices, set) => {
    const select = element(
        'select', {
          onchange: () => {
            set(select.value);
            figure.redraw();
          }
        },
        ...choices.map(
            (c) => element('option', {value: c.name, selected: c.name === value}, axisTitle(c))));
    return element('label', {}, label, select);
  };
  const controls = element(
      'div', {class: 'controls'},
      axisSelect(
          'x', xName, columns,
          (name) => {
            xName = name;
          }),
      axisSelect(
          'y', yName, columns,
          (name) => {
            yName = name;
          }),
      axisSelect(
          'colour by', colourName,
          [{name: '', title: 'nothing', unit: ''}, ...columns.filter(isSetup)], (name) => {
            colourName = name;
          }));

  const figure = chartFigure({
    title: 'All points',
    hint: 'The line joins the points that no other beats in both figures, where both are figures.',
    controls,
    height: (width) => Math.min(480, Math.max(300, 0.55 * width)),
    onpick: (item, chart) => {
      const point = chart.data.datasets[item.datasetIndex].data[item.index];
      if (point) showPoint(point.i);
    },
    config: () => {
      const all = points();
      // Of an input of the study neither less nor more is better.
      const front = isSetup(column(xName)) || isSetup(column(yName)) ?
          [] :
          paretoFront(all, column(xName).more, column(yName).more);
      const groups =
          colourName ? [...new Set(all.map((p) => table[colourName][p.i]))].slice(0, 12) : [null];
      return {
        type: 'scatter',
        data: {
          datasets: [
            ...groups.map(
                (value, g) => ({
                  label: value === null ? 'points' :
                                          `${column(colourName).title} ${numberText(value)}`,
                  data: all.filter((p) => value === null || table[colourName][p.i] === value),
                  backgroundColor: `${seriesColour(g)}cc`,
                  legendColor: seriesColour(g),
                  pointRadius: all.length > 400 ? 3 : 5,
                  pointHoverRadius: 7
                })),
            ...(front.length === 0 ? [] : [{
              label: 'not beaten',
              data: front,
              showLine: true,
              borderColor: style('--soft'),
              backgroundColor: 'transparent',
              legendColor: style('--soft'),
              borderWidth: 1.5,
              borderDash: [4, 3],
              pointRadius: 7,
              pointHoverRadius: 8,
              pointBorderColor: style('--soft')
            }]),
          ]
        },
        options: {
          interaction: {mode: 'nearest', intersect: true},
          scales: {
            x: axisOf(xName, all.map((p) => p.x)),
            y: axisOf(yName, all.map((p) => p.y))
          },
          plugins: {
            tooltip: {
              filter: (item, index) => index === 0,
              callbacks: {
                label: ({raw}) => ` ${column(xName).title} ${numberText(raw.x)}, ${
                    column(yName).title} ${numberText(raw.y)}`,
                afterBody: ([item]) => (item ? setupText(item.raw.i) : [])
              }
            }
          },
        },
      };
    },
    table: () => ({
      columns: columns.map((c) => ({
                             title: axisTitle(c),
                             text: table[c.name].some((v) => v !== null) &&
                                 table[c.name].every((v) => v === null || typeof v === 'string')
                           })),
      rows: [...Array(count).keys()].map((i) => columns.map((c) => table[c.name][i])),
    }),
  });
  return [figure, panel];
}

function studyBox({good, mark, sentence, lines}) {
  const [kind, sign] = good === null ? ['', ''] : good ? ['fits', '✓ '] : ['fails', '✗ '];
  return element(
      'div', {class: `card verdict ${kind}`}, element('span', {class: 'mark'}, sign + mark),
      element('p', {class: 'sentence'}, capital(sentence)),
      ...lines.map((line) => element('p', {class: 'soft'}, line)));
}

/** A table of what was found, without columns of nothing. Cells that are numbers stand as such. */
function foundTable({title, titles, rows}) {
  const cell = (text) => (text !== '' && Number.isFinite(Number(text)) ? Number(text) : text);
  const shown = titles.map((_, i) => i).filter((i) => rows.some((row) => row[i] !== '–'));
  const cells = rows.map((row) => shown.map((i) => cell(row[i])));
  const isText = (i) => cells.some((row) => typeof row[i] !== 'number' && !/^[-–.\d]/.test(row[i]));
  return element(
      'div', {class: 'card'}, element('h2', {}, title),
      sortableTable(
          shown.map((column, i) => ({title: titles[column], text: isText(i)})), cells, {label: title}));
}

function studySections(study, top) {
  const count = study.columns.length > 0 ? study.table[study.columns[0].name].length : 0;
  top.append(...study.boxes.map(studyBox));
  top.append(...study.found.map(foundTable));
  if (study.summary)
    top.append(...study.summary.trim().split('\n').map((line) => element('p', {class: 'hint'}, line)));
  if (count === 0) return [element('p', {class: 'card'}, 'No point is finished.')];
  const sections = [];
  if (study.bars)
    sections.push(section(
        'bars', 'Side by side',
        ...(study.bars.title ? [swingFigure(study)] :
                               study.bars.figures.filter((name) => study.table[name])
                                   .map((name) => barFigure(study, name)))));
  if (study.curves)
    sections.push(section(
        'curves', 'Curves',
        element(
            'div', {class: 'pair'},
            ...study.curves.y
                .filter((name) => study.table[name] && study.table[name].some((v) => typeof v === 'number'))
                .map((name) => curveFigure(study, name)))));
  sections.push(section('points', 'Points', ...scatterFigure(study)));
  return sections;
}
