// The stages of a run: their cycles on one core and on all, and what the cores did meanwhile.

/**
 * Mechanisms of the account as groups that are called what the printed tables call them: name →
 * keys. What these tables call useful are instructions and the waits of a core for itself.
 */
const kMechanisms = new Map();
for (const {key, group} of kPage.mechanisms) {
  const name = group !== 'useful' ? group :
      key === 'issue'             ? 'instructions' :
                                    'stalls: loads, branches, arithmetic';
  kMechanisms.set(name, [...(kMechanisms.get(name) || []), key]);
}
const mechanismColours = new Colours(kMechanismPalette);
for (const name of kMechanisms.keys()) mechanismColours.of(name);

/** Of a key; what the account does not know keeps its own. */
function mechanismOf(key) {
  return [...kMechanisms].find(([, keys]) => keys.includes(key))?.[0] ?? key.replaceAll('_', ' ');
}

/** Rows of stages.csv as objects with name, calls, and cycles. */
function stageRows(run) {
  const table = run.tables.stages;
  return table.stage.map((name, i) => {
    const cell = (column) => (table[column] ? table[column][i] : null);
    return {
      name,
      key: run.stages[i].key,
      cell,
      calls: cell('calls'),
      unit: cell('call'),
      onController: cell('runs_on') === 'controller',
      single: cell('single_cycles'),
      parallel: cell('parallel_cycles'),
      speedup: cell('speedup')
    };
  });
}

/** Cycles of a mean frame in a group of parts, on one core or on N. */
function groupCycles(run, row, parts, single, frames) {
  const cores = single || row.onController ? 1 : run.facts.cores;
  return sum(parts.map(
             (part) => row.cell(single ? `single_${part}_cycles` : `${part}_core_cycles`))) /
      cores / frames;
}

function breakdownFigure(run, rows) {
  const frames = processedFrames(run);
  const shown = rows.filter((row) => row.calls > 0);
  const bars = shown.flatMap(
      (row) => row.onController ? [{row, single: false, label: `${row.name} (controller)`}] : [
        {row, single: true, label: `${row.name}, 1 core`},
        {row, single: false, label: `${row.name}, ${run.facts.cores} cores`}
      ]);
  const groups = [...kMechanisms].filter(
      ([, parts]) =>
          bars.some((bar) => groupCycles(run, bar.row, parts, bar.single, frames) > 0));
  const valuesOf = (bar) =>
      groups.map(([, parts]) => groupCycles(run, bar.row, parts, bar.single, frames) / 1e3);
  let shares = false;
  const select = element(
      'select', {
        onchange: () => {
          shares = select.value === 'shares';
          figure.redraw();
        }
      },
      element('option', {value: 'cycles'}, 'kilocycles of a mean frame'),
      element('option', {value: 'shares'}, 'shares of the stage'));
  const figure = chartFigure({
    title: 'Where the cycles of each stage go',
    hint:
        'On one core and on all. Cycles of all cores are divided by the cores, so that a bar is as long as the stage takes.',
    controls: element('div', {class: 'controls'}, element('label', {}, 'show', select)),
    height: (width) => 80 + rowsHeight(bars.map((bar) => bar.label), width, 23),
    config: () => ({
      type: 'bar',
      data: {
        labels: bars.map((bar) => bar.label),
        datasets: groups.map(([name], g) => ({
                               label: name,
                               backgroundColor: mechanismColours.of(name),
                               barPercentage: 0.85,
                               categoryPercentage: 0.95,
                               data: bars.map((bar) => {
                                 const values = valuesOf(bar);
                                 return shares ? (100 * values[g]) / (sum(values) || 1) : values[g];
                               })
                             }))
      },
      options: {
        indexAxis: 'y',
        interaction: {mode: 'index', axis: 'y', intersect: false},
        scales: {
          x: {
            stacked: true,
            max: shares ? 100 : undefined,
            title: {display: true, text: shares ? '%' : 'kilocycles'}
          },
          y: stackedRows(),
        },
        plugins: {
          tooltip: {
            filter: (item) => item.raw > 0,
            callbacks: {
              label: (item) =>
                  ` ${item.dataset.label}: ${numberText(item.raw, 3)}${shares ? ' %' : ' kcycles'}`,
              footer: (items) =>
                  (shares || items.length === 0 ?
                       '' :
                       `in all ${numberText(sum(items.map((i) => i.raw)))} kcycles`),
            },
          }
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'stage', text: true}, {title: 'in all, kcycles'},
        ...groups.map(([name]) => ({title: name}))
      ],
      rows: bars.map((bar) => [bar.label, sum(valuesOf(bar)), ...valuesOf(bar)]),
    }),
  });
  return figure;
}

function processedFrames(run) {
  const {frames} = run.tables;
  return (frames.latency_ns ? frames.latency_ns.filter((latency) => latency !== null) :
                              frames.frame)
      .length;
}

function stagesSection(run) {
  if (!run.tables.stages) return null;
  const rows = stageRows(run);
  const ofCluster = sum(rows.map((row) => (row.onController ? 0 : row.parallel)));
  const columns = [
    {title: 'stage', text: true, node: (name) => stageCell(name)}, {title: 'runs on', text: true},
    {title: 'calls'}, {title: 'call is a', text: true}, {title: 'kcycles, 1 core'},
    {title: `kcycles, ${run.facts.cores} cores`}, {title: 'speed-up', digits: 3},
    {title: 'ms per call', digits: 3}, {title: 'share, %', digits: 3}, {title: 'memory, kB'}
  ];
  const table = sortableTable(
      columns,
      rows.map(
          (row) =>
              [row.name, row.cell('runs_on'), row.calls, row.unit,
               row.calls ? row.single / row.calls / 1e3 : null,
               row.calls ? row.parallel / row.calls / 1e3 : null,
               row.onController ? null : row.speedup, row.cell('parallel_ms_per_call'),
               row.onController || !ofCluster ? null : (100 * row.parallel) / ofCluster,
               (row.cell('memory_parallel_bytes') || 0) / 1e3]),
      {whole: true, label: 'Stages, per call'});
  return section(
      'stages', 'Stages',
      element(
          'div', {class: 'card'}, element('h3', {}, 'Stages of the run, per call'), table,
          run.facts.cores > 1 ?
              element(
                  'p', {class: 'hint'},
                  '1 core: the same program on the master alone. ' +
                      'A run with --cores 1 has the program for one core.') :
              null),
      breakdownFigure(run, rows));
}
