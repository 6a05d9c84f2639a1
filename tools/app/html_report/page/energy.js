// Energy and power of a run by stage and domain, with their bands.

const domainColours = new Colours(kDomainPalette);
for (const domain of ['cores', 'fpu', 'l1', 'dma', 'cluster', 'controller', 'l2', 'soc'])
  domainColours.of(domain);

/** As other charts and pages name it. */
function domainName(domain) {
  return {fpu: 'FPU', l1: 'L1', dma: 'DMA', l2: 'L2', soc: 'SoC'}[domain] || domain;
}

/** stage → domain → {value, low, high} of a quantity. */
function energyOf(run, quantity) {
  const table = run.tables.energy;
  const stages = new Map();
  table.stage.forEach((stage, i) => {
    if (table.quantity[i] !== quantity) return;
    if (!stages.has(stage)) stages.set(stage, {__proto__: null});
    stages.get(
        stage)[table.domain[i]] = {value: table.value[i], low: table.low[i], high: table.high[i]};
  });
  return stages;
}

function domainFigure(title, hint, unit, entries) {
  const domains = [...new Set(entries.flatMap(([, parts]) => Object.keys(parts)))].filter(
      (domain) => domain !== 'total');
  return chartFigure({
    title,
    hint,
    height: (width) => 75 + rowsHeight(entries.map(([name]) => name), width, 27),
    config: () => ({
      type: 'bar',
      data: {
        labels: entries.map(([name]) => name),
        datasets: domains.map(
            (domain) => ({
              label: domainName(domain),
              backgroundColor: domainColours.of(domain),
              barPercentage: 0.75,
              data: entries.map(([, parts]) => (parts[domain] ? parts[domain].value : null))
            }))
      },
      options: {
        indexAxis: 'y',
        interaction: {mode: 'index', axis: 'y', intersect: false},
        scales: {
          x: {
            stacked: true,
            title: {display: true, text: unit},
            suggestedMax: 1.03 * Math.max(...entries.map(([, parts]) => parts.total.high))
          },
          y: stackedRows(),
        },
        plugins: {
          whiskers: {
            bands: entries.map(
                ([, parts], index) => ({index, low: parts.total.low, high: parts.total.high}))
          },
          tooltip: {
            filter: (item) => item.raw > 0,
            callbacks: {
              label: (item) => ` ${item.dataset.label}: ${numberText(item.raw, 3)} ${unit}`,
              footer: ([item]) => {
                if (!item) return '';
                const {value, low, high} = entries[item.dataIndex][1].total;
                return `in all ${numberText(value, 3)} ${unit}, between ${numberText(low, 3)} and ${
                    numberText(high, 3)}`;
              },
            },
          },
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'stage', text: true}, {title: 'domain', text: true}, {title: unit}, {title: 'low'},
        {title: 'high'}
      ],
      rows: entries.flatMap(
          ([name, parts]) => Object.entries(parts).map(
              ([domain, {value, low, high}]) => [name, domainName(domain), value, low, high])),
    }),
  });
}

function energySection(run) {
  if (!run.tables.energy) return null;
  const frames = processedFrames(run);
  const perFrame =
      [...energyOf(run, 'energy')]
          .filter(([name]) => name !== 'all')
          .map(
              ([name, parts]) =>
                  [name,
                   Object.fromEntries(Object.entries(parts).map(
                       ([domain, {value, low, high}]) =>
                           [domain,
                            {value: value / frames, low: low / frames, high: high / frames}]))]);
  const power = [...energyOf(run, 'power')].map(
      ([name, parts]) => [name === 'all' ? 'mean of the run' : name, parts]);
  if (perFrame.length === 0 || power.length === 0) return null;
  return section(
      'energy', 'Energy and power',
      element(
          'div', {class: 'pair'},
          domainFigure(
              'Energy of a mean frame, by stage and domain',
              'Whiskers are the band of the sum: figures of the chip are known within bounds.',
              'mJ', perFrame),
          domainFigure(
              'Power while a stage runs',
              'The controller\'s rows are what it adds. Whiskers are bands.', 'mW', power)));
}
