// When the stages of the selected frame run, on the chip as recorded and as it is now, one above the
// other. Left out: waiting for the frame before, which the latency of each frame shows.

/** @param state  {now, recorded: outcomes of the frame} @param setting  {period_ns} */
function frameGantt(state, setting) {
  const chips = () => [['recorded', state.recorded], ['now', state.now]];
  const spans = () => [false, true].flatMap((controller) => chips().flatMap(
      ([chip, outcome]) => outcome.spans.filter((span) => span.controller === controller)
          .map(({stage, begin_ns, end_ns}) => ({
            row: `${controller ? 'controller' : 'cluster'}, ${chip}`,
            stage,
            begin: ms(begin_ns),
            end: ms(end_ns)
          }))));
  return chartFigure({
    title: 'The selected frame in time',
    hint: 'From when it begins, with the optimisation that begins with it.',
    height: () => 60 + 38 * new Set(spans().map((span) => span.row)).size,
    table: () => ({
      columns: [{title: 'where', text: true}, {title: 'stage', text: true},
                {title: 'begins, ms', digits: 5}, {title: 'ends, ms', digits: 5}],
      rows: spans().map(({row, stage, begin, end}) => [row, stage, begin, end])
    }),
    config: (width) => {
      const all = spans();
      const deadline = ms(setting.period_ns);
      return {
        type: 'bar',
        data: {
          labels: [...new Set(all.map((span) => span.row))],
          datasets: [...new Set(all.map((span) => span.stage))].map((name) => ({
            label: name,
            grouped: false,
            backgroundColor: stageColour(name),
            barPercentage: 0.9,
            data: all.filter((span) => span.stage === name)
                .map(({row, begin, end}) => ({x: [begin, end], y: row}))
          }))
        },
        options: {
          indexAxis: 'y',
          interaction: {mode: 'nearest', intersect: true},
          scales: {
            x: {min: 0, suggestedMax: 1.05 * deadline, title: {display: true, text: 'ms'}},
            y: {...stackedRows(), stacked: false}
          },
          plugins: {
            barNames: {show: width > 600},
            limitLines: {lines: [{axis: 'x', value: deadline, label: 'deadline'}]},
            tooltip: {
              callbacks: {
                label: ({dataset, raw: {x: [begin, end]}}) => ` ${dataset.label}: ${
                    numberText(end - begin)} ms, from ${numberText(begin)} to ${numberText(end)} ms`
              }
            }
          }
        }
      };
    }
  });
}
