// What occupies L1 and L2 at their peaks, block by block.

/** A block has one colour in all bars, but shares it with others: its name stands in it. */
const blockColours = new Colours(kBlockPalette);

/** [{owner, bytes, blocks: [{name, bytes, copies}]}] of a memory. */
function peaksOf(run, memory) {
  const table = run.tables.memory;
  const peaks = [];
  table.memory.forEach((name, i) => {
    if (name !== memory) return;
    const row = {
      owner: table.owner[i],
      what: table.what[i],
      name: table.block[i],
      bytes: table.bytes[i],
      copies: table.copies[i]
    };
    if (row.what.startsWith('peak') && row.what !== 'peak on one core')
      peaks.push({owner: row.owner, bytes: row.bytes, blocks: []});
    else if (row.what === 'block')
      peaks[peaks.length - 1].blocks.push(row);
  });
  return peaks;
}

function memoryFigure(title, hint, peaks, size) {
  const names = [...new Set(peaks.flatMap((peak) => peak.blocks.map((block) => block.name)))];
  const bytesOf = (peak, name) =>
      sum(peak.blocks.filter((block) => block.name === name).map((block) => block.bytes));
  const isOne = peaks.length === 1;
  return chartFigure({
    title,
    hint,
    height: (width) => 70 + rowsHeight(peaks.map((peak) => peak.owner), width, isOne ? 46 : 30),
    config: () => ({
      type: 'bar',
      data: {
        labels: peaks.map((peak) => peak.owner),
        datasets: names.map((name) => ({
                              label: name,
                              silent: true,
                              backgroundColor: blockColours.of(name),
                              borderColor: style('--card'),
                              borderWidth: {right: 1},
                              barPercentage: 0.85,
                              categoryPercentage: 0.95,
                              data: peaks.map((peak) => bytesOf(peak, name) / 1e3 || null)
                            }))
      },
      options: {
        indexAxis: 'y',
        interaction: {mode: 'nearest', intersect: true},
        scales: {
          x: {
            stacked: true,
            max: size / 1e3 * 1.02,
            ticks: {includeBounds: false},
            title: {display: true, text: 'kB'}
          },
          y: stackedRows(),
        },
        plugins: {
          barNames: {show: true},
          limitLines: {
            lines:
                [{axis: 'x', value: size / 1e3, label: `capacity ${numberText(size / 1e3, 5)} kB`}]
          },
          tooltip:
              {callbacks: {label: (item) => ` ${item.dataset.label}: ${numberText(item.raw)} kB`}},
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'peak of', text: true}, {title: 'block', text: true}, {title: 'copies'},
        {title: 'bytes'}, {title: '% of the memory', digits: 3}
      ],
      rows: peaks.flatMap(
          (peak) => peak.blocks.map(
              (block) =>
                  [peak.owner, block.name, block.copies, block.bytes, (100 * block.bytes) / size])),
    }),
  });
}

function memorySection(run) {
  if (!run.tables.memory) return null;
  const l1 = peaksOf(run, 'L1').filter((peak) => peak.bytes > 0);
  const l2 = peaksOf(run, 'L2');
  return section(
      'memory', 'Memory',
      memoryFigure(
          'L1 at the peak of each stage',
          `On ${run.facts.cores} cores, by block. Hover shows small blocks.`, l1,
          run.facts.l1_size),
      l2.length === 0 ?
          null :
          memoryFigure(
              'L2, by part', 'The parts are there at the same time: together they are the peak.',
              l2, run.facts.l2_size));
}
