// The first screen: the verdict, and the figures that are asked for first.

/** A class of the page for each grade of a verdict. */
const gradeClass = {good: 'fits', unknown: '', doubtful: 'doubtful', bad: 'fails'};
const gradeMark = {good: '✓', unknown: '?', doubtful: '!', bad: '✗'};

function verdictCard(run) {
  const {grade, list, why} = run.verdict;
  const line = (verdict) => element(
      'p', {class: `sentence verdict-line ${gradeClass[verdict.grade]}`},
      element(
          'span', {class: 'mark'},
          `${gradeMark[verdict.grade]} ${verdict.about} ${verdict.word}`),
      verdict.reason ? ` ${verdict.reason}` : '');
  return element(
      'div', {class: `card verdict ${gradeClass[grade] || ''}`},
      ...(list.length > 0 ? list.map(line) : [element('p', {class: 'sentence'}, 'No frames')]),
      why ? element('p', {class: 'soft'}, why) : null);
}

function meter(share) {
  if (share === null) return null;
  return element(
      'div', {
        class: share > 1 ? 'meter over' : 'meter',
        role: 'img',
        'aria-label': `${numberText(100 * share, 3)} %`
      },
      element('i', {style: `width:${Math.min(100, 100 * share).toFixed(1)}%`}));
}

function tiles(run) {
  return element(
      'div', {class: 'tiles'},
      ...run.figures.map(
          (figure) => element(
              'div', {class: figure.note.length > 90 ? 'card tile wide' : 'card tile'},
              element('span', {class: 'title'}, figure.title),
              element(
                  'span', {class: 'value'}, figure.value,
                  element('span', {class: 'unit'}, figure.unit)),
              meter(figure.share), element('span', {class: 'note'}, figure.note))));
}

function factList(run) {
  const facts = run.facts;
  const mhz = (hertz) => `${numberText(hertz / 1e6)} MHz`;
  const list = [
    ['program', `leviosim ${facts.program}`],
    ['command', `leviosim ${facts.command_line.join(' ')}`],
    ['data', `${facts.data}, ${facts.frames} frames from number ${facts.first_frame}`],
    ['profile', [facts.profile, ...(facts.workload || [])].join(', ')],
    ['image', `${facts.image[0]}×${facts.image[1]} px`],
    ['seed', facts.seed],
  ];
  if (facts.platform) {
    list.push(['chip', [facts.platform, ...facts.overrides].join(', ')], [
      'cores',
      `${facts.cores} at ${mhz(facts.cluster_clock)}, controller at ${mhz(facts.controller_clock)}`
    ]);
    if (facts.voltage !== null) list.push(['supply', `${numberText(facts.voltage)} V`]);
  }
  if (facts.camera) list.push(['camera', facts.camera]);
  if (run.protocol) list.push(['accuracy', run.protocol]);
  return element(
      'dl', {class: 'facts'},
      ...list.flatMap(
          ([name, value]) => [element('dt', {}, name), element('dd', {}, String(value))]));
}
