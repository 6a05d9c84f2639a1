// Latency of every frame beside the recorded one, with the deadline. A click, or the arrow keys and
// Enter, select a frame.

/** @param state  {latencies, recorded: [ns], period_ns, frame} @param onpick  (number) */
function latencyFigure(state, onpick) {
  return chartFigure({
    title: 'Latency of each frame',
    hint: 'From the camera to the pose. Click a frame to select it.',
    height: 230,
    onpick: (picked) => onpick(picked.index),
    table: () => ({
      columns: [{title: 'frame'}, {title: 'ms', digits: 5}, {title: 'ms as recorded', digits: 5}],
      rows: state.recorded.map((before, i) => [i, state.latencies[i] === undefined ?
        null : ms(state.latencies[i]), ms(before)])
    }),
    config: () => ({
      type: 'line',
      data: {
        labels: state.recorded.map((_, i) => i),
        datasets: [
          {
            label: 'now',
            data: state.recorded.map((_, i) =>
                (state.latencies[i] === undefined ? null : ms(state.latencies[i]))),
            borderColor: style('--accent'),
            backgroundColor: style('--accent'),
            borderWidth: 1.5,
            pointRadius: state.recorded.map((_, i) => (i === state.frame ? 5 : 0)),
            pointHitRadius: 6
          },
          {
            label: 'as recorded',
            data: state.recorded.map(ms),
            borderColor: style('--soft'),
            backgroundColor: style('--soft'),
            borderWidth: 1,
            pointRadius: 0
          }
        ]
      },
      options: {
        interaction: {mode: 'index', intersect: false},
        scales: {
          x: {title: {display: true, text: 'frame'}, ticks: {maxTicksLimit: 12}},
          y: {title: {display: true, text: 'ms'}, beginAtZero: true,
              suggestedMax: 1.1 * ms(state.period_ns)}
        },
        plugins: {
          limitLines: {lines: [{axis: 'y', value: ms(state.period_ns),
                                label: `deadline ${numberText(ms(state.period_ns))} ms`}]}
        }
      }
    })
  });
}
