// What a budget says of the run: each limit, and of those that are not met where and why.

function checkSection(check) {
  const words = ['not met', 'warning', 'met'];  // the worst first
  const signs = {
    'not met': ['status-bad', '✗ '],
    'warning': ['status-warn', '! '],
    'met': ['status-good', '✓ ']
  };
  const wordOf = (finding) => finding.met ? 'met' :
      finding.level === 'warn'            ? 'warning' :
                                            'not met';
  const status = (word, text = word) =>
      element('span', {class: signs[word][0]}, signs[word][1] + text);
  const margin = (finding) => {
    if (finding.value === null || !finding.bound) return null;
    const atMost = !finding.limit.includes('>=');
    return (100 * (atMost ? finding.bound - finding.value : finding.value - finding.bound)) /
        Math.abs(finding.bound);
  };
  const columns = [
    {title: 'result', text: true, node: (word) => status(word)}, {title: 'limit', text: true, wrap: true},
    {title: 'stage', text: true}, {title: 'margin, %', node: (value) => signed(value)},
    {title: 'found'}, {title: 'bound'}, {title: 'statistic', text: true}
  ];
  const rows = check.findings.map(
      (f) =>
          [wordOf(f), f.limit, f.stage || '', margin(f), f.shown.value, f.shown.bound,
           f.statistic]);
  rows.sort((a, b) => words.indexOf(a[0]) - words.indexOf(b[0]));
  const kind = check.not_met > 0 ? 'fails' : check.warnings > 0 ? 'doubtful' : 'fits';
  const missed = check.findings.filter((finding) => !finding.met);
  return section(
      'budget', 'Budget',
      element(
          'div', {class: `card verdict ${kind}`},
          element(
              'p', {class: 'sentence'},
              check.not_met > 0 ?
                  `${check.not_met} of ${check.limits} limits ${
                      check.not_met === 1 ? 'is' : 'are'} not met.` :
                  `All ${check.limits} limits are met${
                      check.warnings > 0 ? `, but ${check.warnings} with a warning` : ''}.`),
          check.better > 0 ?
              element(
                  'p', {},
                  `${check.better} better than the baseline, by more than the limit ` +
                      'allows it to worsen.') :
              null,
          element(
              'p', {class: 'hint'},
              `${check.budget}${
                  check.baseline ? `, against the baseline ${check.baseline}` : ''}`)),
      ...missed.map(
          (finding) => element(
              'div', {class: 'card'},
              element(
                  'h3', {}, status(wordOf(finding), ''),
                  `${finding.stage ? `${finding.stage}: ` : ''}${finding.limit}`),
              element('p', {}, finding.excess),
              element(
                  'dl', {class: 'facts'},
                  ...[['where', finding.where], ['why', (finding.why || []).join('; ')],
                      ['reason', finding.reason], ['owner', finding.owner],
                      ['line', finding.line > 0 ? `${check.budget}:${finding.line}` : '']]
                      .filter(([, value]) => value)
                      .flatMap(([name,
                                 value]) => [element('dt', {}, name), element('dd', {}, value)])))),
      element('div', {class: 'card'}, sortableTable(columns, rows, {label: 'Limits'})));
}
