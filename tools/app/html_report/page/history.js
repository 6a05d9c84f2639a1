// Two commits of a history beside each other: what moved, and where the cycles went.

/** Differences of the parts of a stage, the largest first: [name, kcycles of a frame]. */
function partDifferences(a, b) {
  const parts = new Map();
  for (const [side, stage] of [[-1, a], [1, b]])
    for (const [name, cycles] of Object.entries(stage ? stage.parts : {}))
      parts.set(name, (parts.get(name) || 0) + side * cycles);
  return [...parts].filter(([, cycles]) => Math.abs(cycles) >= 0.05)
      .sort((x, y) => Math.abs(y[1]) - Math.abs(x[1]));
}

/** Rows of what differs between the stages of two runs. */
function stageDifferences(history, a, b) {
  const stagesOf = (run) => new Map(
      run.stages.map((at) => history.stages[at]).filter((s) => s).map((s) => [s.name, s]));
  const [before, after] = [stagesOf(a), stagesOf(b)];
  const rows = [];
  for (const name of new Set([...before.keys(), ...after.keys()])) {
    const [x, y] = [before.get(name), after.get(name)];
    if (x === y) continue;
    const total = (y ? y.kcycles : 0) - (x ? x.kcycles : 0);
    const reasons = partDifferences(x, y).slice(0, 3).map(
        ([part, kcycles]) => `${part} ${signed(kcycles)}`);
    rows.push([name, x ? x.kcycles : null, y ? y.kcycles : null, total, reasons.join('; ')]);
  }
  return rows.sort((x, y) => Math.abs(y[3]) - Math.abs(x[3]));
}

function shortText(text, most) {
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

function historyCards(history) {
  const {runs} = history;
  if (runs.length < 2) return [];
  const shown = element('div', {'aria-live': 'polite'});
  const select = (label, value) => {
    const box = element(
        'select', {onchange: show},
        ...runs.map(
            (run, i) => element(
                'option', {value: i, selected: i === value}, `${run.commit} ${shortText(run.subject, 48)}`)));
    return {box, label: element('label', {}, label, box)};
  };
  const before = select('from', history.from);
  const after = select('to', history.to);
  function show() {
    const [a, b] = [runs[Number(before.box.value)], runs[Number(after.box.value)]];
    const rows = stageDifferences(history, a, b);
    shown.replaceChildren(
        rows.length === 0 ?
            element('p', {class: 'soft'}, 'All stages take the same cycles.') :
            sortableTable(
                [
                  {title: 'stage', text: true}, {title: `${a.commit}, kcycles`},
                  {title: `${b.commit}, kcycles`}, {title: 'difference', node: (v) => signed(v)},
                  {title: 'why, kcycles of a frame', text: true, wrap: true}
                ],
                rows, {label: 'Stages that differ'}));
  }
  historyCards.compare = (from, to) => {
    before.box.value = from;
    after.box.value = to;
    show();
  };
  show();
  return [element(
      'div', {class: 'card'}, element('h2', {}, 'Two commits'),
      element(
          'p', {class: 'hint'},
          'Of a mean frame. A click on a point of a chart compares it with the one before.'),
      element('div', {class: 'controls'}, before.label, after.label), shown)];
}
