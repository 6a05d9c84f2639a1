// The frames of a run: how long each took and with what, and single frames stage by stage.

// Of the sources of poses, in the order in which a run lists them.
const sourceColours = new Colours(
    ['#dfe3e8', '#f2b705', '#6c4fb3', '#3d4f6b', '#e0729f', '#1fa187', '#9fd4f0', '#7a5230']);

/** How a frame got its pose, or that it got none: name → {words, colour}. */
function kindsOf(run) {
  const kinds = new Map(run.pose_sources.map(
      ({name, words}) => [name, {words, colour: sourceColours.of(name)}]));
  return kinds.set('dropped', {words: 'dropped', colour: '#b3261e'});
}

/** Of grades of the map that the estimator does not trust. */
const kMapColours = {
  unreliable: '--warn',
  lost: '--bad'
};

/**
 * What the estimator does not trust its map for: {name, reasons}; null if it does, or does not
 * judge it.
 */
function mapOf(run, health, bits) {
  const name = health === null ? null : run.health.names[health];
  if (!kMapColours[name]) return null;
  return {name, reasons: run.health.reasons.filter((_, i) => (bits >> i) & 1)};
}

/**
 * Frames with parts in ms that add up to the latency.
 * @returns null without times; {frames: [{number, kind, map, keyframe, latency, parts}], names,
 *     wordsOf}
 */
function framesOf(run) {
  const table = run.tables.frames;
  if (!table.latency_ns) return null;
  const kinds = kindsOf(run);
  const perMs = run.facts.cluster_clock / 1e3;
  const stages = run.stages.filter((stage) => table[`cycles_${stage.key}`]);
  const names = [kWaiting, ...stages.map((s) => s.name), kOther];
  const frames = table.frame.map((number, i) => {
    if (table.latency_ns[i] === null)
      return {
        number,
        kind: 'dropped',
        map: null,
        keyframe: false,
        latency: null,
        parts: names.map(() => null)
      };
    const latency = table.latency_ns[i] / 1e6;
    const waiting = (table.start_ns[i] - table.arrival_ns[i]) / 1e6;
    const cycles = stages.map((stage) => (table[`cycles_${stage.key}`][i] || 0) / perMs);
    const rest = latency - waiting - sum(cycles);
    return {
      number,
      kind: table.source[i],
      map: mapOf(run, table.health[i], table.health_reasons[i]),
      keyframe: table.keyframe[i] === 1,
      latency,
      parts: [waiting, ...cycles, rest]
    };
  });
  return {frames, names, kinds, wordsOf: ({kind}) => kinds.get(kind)?.words ?? kind};
}

function partColour(name) {
  return name === 'front end' ? stageColours.of('front end') : stageColour(name);
}

function latencyFigure(run, data, onpick) {
  const {frames, names} = data;
  const labels = frames.map((frame) => frame.number);
  const deadline = run.facts.deadline_ns / 1e6;
  const kinds = [...data.kinds].filter(([kind]) => frames.some((frame) => frame.kind === kind));
  const grades =
      Object.keys(kMapColours).filter((name) => frames.some(({map}) => map?.name === name));
  const bar = {
    barPercentage: 1,
    inflateAmount: 0.5,
    categoryPercentage: frames.length > 120 ? 1 : 0.9
  };
  const strip = {
    stacked: true,
    stack: 's',
    stackWeight: 1,
    min: 0,
    max: 1,
    ticks: {display: false},
    grid: {display: false, drawBorder: false}
  };
  const seen = names.filter((_, i) => frames.some((frame) => frame.parts[i] > 1e-6));
  return chartFigure({
    title: 'Latency of every frame, by stage',
    hint: 'From the camera\'s frame to its pose. The strip below says where the pose came from' +
        (grades.length > 0 ? ', that under it where the estimator does not trust its map' : '') +
        '. A click shows the frame below, stage by stage.',
    height: (width) => (width < 500 ? 300 : 340),
    onpick: (item) => onpick(item.index),
    config: () => ({
      type: 'bar',
      data: {
        labels,
        datasets: [
          ...seen.map((name) => ({
                        ...bar,
                        label: name,
                        stack: 'time',
                        grouped: false,
                        backgroundColor: partColour(name),
                        data: frames.map((frame) => frame.parts[names.indexOf(name)])
                      })),
          ...kinds.map(([kind, {words, colour}]) => ({
                         ...bar,
                         label: `pose: ${words}`,
                         stack: 'kind',
                         grouped: false,
                         yAxisID: 'kind',
                         categoryPercentage: 1,
                         backgroundColor: colour,
                         data: frames.map((frame) => (frame.kind === kind ? 1 : null))
                       })),
          ...grades.map((name) => ({
                          ...bar,
                          label: `map: ${name}`,
                          stack: 'map',
                          grouped: false,
                          yAxisID: 'map',
                          categoryPercentage: 1,
                          backgroundColor: style(kMapColours[name]),
                          data: frames.map(({map}) => (map?.name === name ? 1 : null))
                        })),
        ]
      },
      options: {
        interaction: {mode: 'index', intersect: false},
        scales: {
          x: {
            stacked: true,
            grid: {display: false},
            ticks: {maxRotation: 0, autoSkipPadding: 24},
            title: {display: true, text: 'frame'}
          },
          ...(grades.length > 0 ? {map: strip} : {}),
          kind: strip,
          y: {
            stacked: true,
            stack: 's',
            stackWeight: 14,
            title: {display: true, text: 'ms'},
            suggestedMax: 1.08 * deadline,
            border: {display: false}
          },
        },
        plugins: {
          limitLines:
              {lines: [{axis: 'y', value: deadline, label: `deadline ${numberText(deadline)} ms`}]},
          tooltip: {
            filter: (item) => item.raw > 1e-6,
            callbacks: {
              title: ([item]) => item ?
                  `frame ${item.label}${frames[item.dataIndex].keyframe ? ', keyframe' : ''}` :
                  '',
              label: (item) => item.dataset.yAxisID === 'map' ?
                  [item.dataset.label, ...frames[item.dataIndex].map.reasons].map((s) => ` ${s}`) :
                  item.dataset.yAxisID === 'kind' ?
                  ` ${item.dataset.label}` :
                  ` ${item.dataset.label}: ${numberText(item.raw, 3)} ms`,
              footer: ([item]) => item && frames[item.dataIndex].latency !== null ?
                  `latency ${numberText(frames[item.dataIndex].latency)} ms` :
                  '',
            },
          },
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'frame'}, {title: 'pose', text: true}, {title: 'map', text: true},
        {title: 'keyframe', text: true}, {title: 'latency, ms'},
        ...names.map((name) => ({title: `${name}, ms`}))
      ],
      rows: frames.map(
          (frame) =>
              [frame.number, data.wordsOf(frame),
               frame.map ? [frame.map.name, frame.map.reasons.join('; ')].join(': ') : '',
               frame.keyframe ? 'yes' : '', frame.latency, ...frame.parts]),
    }),
  });
}

/** The parts of a frame in their order, as spans of time since the camera's frame. */
function spansOf(data, frame) {
  let at = 0;
  const spans = [];
  frame.parts.forEach((ms, i) => {
    if (ms > 1e-6) spans.push({name: data.names[i], begin: at, end: at + ms});
    at += Math.max(ms, 0);
  });
  return spans;
}

/** A picked frame may change: title and frame are functions. */
function ganttFigure(run, data, titleOf, frameOf, controls) {
  const deadline = run.facts.deadline_ns / 1e6;
  const longest = Math.max(deadline, ...data.frames.map((frame) => frame.latency || 0));
  const figure = chartFigure({
    title: titleOf(),
    controls,
    height: () => 70 + 25 * Math.max(3, spansOf(data, frameOf()).length),
    config: () => {
      const spans = spansOf(data, frameOf());
      return {
        type: 'bar',
        data: {
          labels: spans.map((span) => span.name),
          datasets: [{
            data: spans.map((span) => [span.begin, span.end]),
            backgroundColor: spans.map((span) => partColour(span.name)),
            borderRadius: 2,
            barPercentage: 0.8,
            minBarLength: 2,
          }]
        },
        options: {
          indexAxis: 'y',
          interaction: {mode: 'nearest', axis: 'y', intersect: false},
          scales: {
            x: {
              min: 0,
              max: 1.05 * longest,
              ticks: {includeBounds: false},
              title: {display: true, text: 'ms since the camera\'s frame'}
            },
            y: {grid: {display: false}, ticks: {autoSkip: false}},
          },
          plugins: {
            limitLines: {lines: [{axis: 'x', value: deadline, label: 'deadline'}]},
            tooltip: {
              callbacks: {
                label: ({raw: [begin, end]}) => ` ${numberText(end - begin)} ms, from ${
                    numberText(begin)} to ${numberText(end)} ms`
              }
            },
          },
        },
      };
    },
    table: () => ({
      columns: [
        {title: 'stage', text: true, node: (name) => stageCell(name)}, {title: 'begins, ms'},
        {title: 'ends, ms'}, {title: 'takes, ms'}
      ],
      rows: spansOf(data, frameOf())
                .map((span) => [span.name, span.begin, span.end, span.end - span.begin]),
    }),
  });
  figure.retitle = () => {
    figure.querySelector('h3').textContent = titleOf();
  };
  return figure;
}

function framesSection(run) {
  const data = framesOf(run);
  if (!data) return null;
  const processed = data.frames.filter((frame) => frame.latency !== null)
                        .sort((a, b) => a.latency - b.latency || a.number - b.number);
  if (processed.length === 0)
    return section('frames', 'Frames', element('p', {class: 'card'}, 'No frame was processed.'));
  const describe = (what, frame) => {
    if (frame.latency === null) return `Frame ${frame.number} was dropped`;
    const [waited] = frame.parts;
    return `${what} frame: number ${frame.number}, ${data.wordsOf(frame)}${
        frame.keyframe ? ', keyframe' : ''}, ${numberText(frame.latency - waited)} ms${
        waited > 1e-6 ? ` of its own after ${numberText(waited)} ms of waiting` : ''}`;
  };
  const median = processed[Math.floor((processed.length - 1) / 2)];
  const worst = processed[processed.length - 1];
  let picked = processed[Math.floor((processed.length - 1) * 0.9)];
  const input = element('input', {
    type: 'number',
    min: data.frames[0].number,
    max: data.frames[data.frames.length - 1].number,
    value: picked.number,
    onchange: () => pick(data.frames.findIndex((frame) => frame.number === Number(input.value)))
  });
  const pickedFigure = ganttFigure(
      run, data, () => describe('A', picked), () => picked,
      element('div', {class: 'controls'}, element('label', {}, 'frame', input)));
  function pick(index) {
    if (index < 0) return;
    picked = data.frames[index];
    input.value = picked.number;
    pickedFigure.retitle();
    pickedFigure.redraw();
  }
  return section(
      'frames', 'Frames', latencyFigure(run, data, pick),
      element(
          'div', {class: 'pair'},
          ganttFigure(run, data, () => describe('Median', median), () => median),
          ganttFigure(run, data, () => describe('Slowest', worst), () => worst)),
      pickedFigure);
}
