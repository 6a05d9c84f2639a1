// What differs between two runs, and why: by stage and mechanism, by fork, by block, by energy.

/** B minus A; sums of floating point that differ in their last digits are the same. */
function differenceOf({a, b, difference}) {
  if (difference === null) return null;
  return Math.abs(difference) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b)) ? 0 : difference;
}

function percentOf(quantity) {
  const difference = differenceOf(quantity);
  return quantity.a && difference !== null ? (100 * difference) / Math.abs(quantity.a) : null;
}

function quantityTable(title, quantities, label) {
  const units = new Set(quantities.map((q) => q.unit));
  const unit = (cell) => (units.size === 1 ? [] : [cell]);
  const rows = quantities.map(
      (q) => [q.name, ...unit(q.unit), q.a, q.b, differenceOf(q), percentOf(q)]);
  return element(
      'div', {class: 'card'},
      element('h3', {}, units.size === 1 ? `${title}, ${[...units][0]}` : title),
      sortableTable(
          [
            {title: label, text: true}, ...unit({title: 'unit', text: true}), {title: 'A'},
            {title: 'B'},
            {title: 'B − A', node: (value) => signed(value)},
            {title: '%', node: (value) => (value === null ? '–' : signed(value, 3))}
          ],
          rows, {whole: true, label: title}));
}

function mechanismFigure(comparison) {
  const stages = comparison.stages.filter(
      (stage) => stage.by_mechanism &&
          (stage.by_mechanism.parts || []).some((p) => Math.abs(p.difference) > 0.5));
  if (stages.length === 0) return null;
  const names = [...new Set([
    ...kMechanisms.keys(),
    ...stages.flatMap((stage) => stage.by_mechanism.parts.map((part) => mechanismOf(part.name)))
  ])];
  const partOf = (stage, name, side = 'difference') =>
      sum(stage.by_mechanism.parts.filter((part) => mechanismOf(part.name) === name)
              .map((part) => part[side])) /
      1e3;
  const seen = names.filter((name) => stages.some((stage) => Math.abs(partOf(stage, name)) > 1e-3));
  return chartFigure({
    title: 'Difference of a mean frame, by stage and mechanism',
    hint:
        'Kilocycles that B takes more (to the right) or less (to the left) than A. The parts of a stage add up to its difference.',
    height: (width) => 80 + rowsHeight(stages.map((stage) => stage.name), width, 30),
    config: () => ({
      type: 'bar',
      data: {
        labels: stages.map((stage) => stage.name),
        datasets: seen.map((name) => ({
                             label: name,
                             backgroundColor: mechanismColours.of(name),
                             barPercentage: 0.75,
                             data: stages.map((stage) => partOf(stage, name))
                           }))
      },
      options: {
        indexAxis: 'y',
        interaction: {mode: 'index', axis: 'y', intersect: false},
        scales: {
          x: {stacked: true, title: {display: true, text: 'kilocycles, B − A'}},
          y: stackedRows(),
        },
        plugins: {
          tooltip: {
            filter: (item) => Math.abs(item.raw) > 1e-3,
            callbacks: {
              label: (item) => ` ${item.dataset.label}: ${signed(item.raw)} kcycles`,
              footer: (items) =>
                  (items.length > 0 ?
                       `in all ${
                           signed(
                               stages[items[0].dataIndex].by_mechanism.difference / 1e3)} kcycles` :
                       '')
            }
          }
        },
      },
    }),
    table: () => ({
      columns: [
        {title: 'stage', text: true}, {title: 'mechanism', text: true}, {title: 'A, kcycles'},
        {title: 'B, kcycles'}, {title: 'B − A'}
      ],
      rows: stages.flatMap(
          (stage) => seen.map(
              (name) =>
                  [stage.name, name, partOf(stage, name, 'a'), partOf(stage, name, 'b'),
                   partOf(stage, name)])),
    }),
  });
}

function forkTable(comparison) {
  const rows = comparison.stages.filter((stage) => stage.by_fork)
                   .flatMap(
                       (stage) => (stage.by_fork.parts || [])
                                      .filter((part) => Math.abs(part.difference) > 0.5)
                                      .map(
                                          (part) =>
                                              [stage.name, part.name, part.a / 1e3, part.b / 1e3,
                                               part.difference / 1e3]));
  if (rows.length === 0) return null;
  rows.sort((a, b) => Math.abs(b[4]) - Math.abs(a[4]));
  return element(
      'div', {class: 'card'}, element('h3', {}, 'By fork, the largest difference first'),
      sortableTable(
          [
            {title: 'stage', text: true}, {title: 'fork', text: true},
            {title: 'A, kcycles per frame'}, {title: 'B, kcycles per frame'},
            {title: 'B − A', node: (value) => signed(value)}
          ],
          rows, {label: 'By fork'}));
}

function causesTable(comparison) {
  const rows =
      comparison.stages.filter((stage) => stage.causes)
          .map(
              (stage) =>
                  [stage.name, stage.same_work ? 'the same' : 'another',
                   ...['work', 'cost', 'contention'].map((cause) => stage.causes[cause] / 1e3)]);
  if (rows.length === 0) return null;
  return element(
      'div', {class: 'card'}, element('h3', {}, 'Work, cost or contention'),
      element(
          'p', {class: 'hint'},
          'Kilocycles of a mean frame: from other numbers of operations (work), from another cost of the same operations (cost), from cores that wait for shared units, for each other or for the DMA (contention).'),
      sortableTable(
          [
            {title: 'stage', text: true}, {title: 'its work is', text: true},
            ...['work', 'cost', 'contention'].map(
                (title) => ({title, node: (value) => signed(value)}))
          ],
          rows, {whole: true, label: 'Work, cost or contention'}));
}

/** What a mean frame takes, or the first figure that both have, and why, in a sentence each. */
function differenceCard(comparison, notes) {
  const first = comparison.figures.find(({a, b}) => a !== null && b !== null);
  const value = (x) => (x === null ? '–' : `${numberText(x)} ${first.unit}`);
  const percent = first ? percentOf(first) : null;
  const text = !first ? 'No figure is in both.' :
                        `${capital(first.name)}: ${value(first.b)} in place of ${value(first.a)}${
                            percent === null ? '' : `, ${signed(percent)} %`}.`;
  const why = (comparison.why || []).map(({text}) => element('li', {}, text));
  return element(
      'div', {class: 'card verdict'}, element('p', {class: 'sentence'}, text),
      why.length > 0 ? element('ul', {}, ...why) : null,
      element(
          'p', {class: 'soft'}, element('strong', {}, 'A '), comparison.a.name, ' · ',
          element('strong', {}, 'B '), comparison.b.name, '. ',
          comparison.same_work ? 'Both did the same work.' : 'The work itself differs.'),
      notes);
}

function comparisonSections(comparisons) {
  return comparisons.map((comparison, i) => {
    const changed = (quantity) => quantity.parts || [quantity];
    const notes = comparison.notes.length > 0 ?
        element('ul', {class: 'hint'}, ...comparison.notes.map((note) => element('li', {}, note))) :
        null;
    return section(
        `difference${i + 1}`, comparisons.length > 1 ? `Difference ${i + 1}` : 'Difference',
        differenceCard(comparison, notes),
        mechanismFigure(comparison), forkTable(comparison), causesTable(comparison),
        quantityTable('The run as a whole', comparison.figures, 'figure'),
        comparison.blocks.length > 0 ?
            quantityTable(
                'Blocks at the peaks of memory that appeared, went or changed', comparison.blocks,
                'block') :
            null,
        (comparison.energy_by_stage.parts || []).length === 0 ?
            null :
            element(
                'div', {class: 'pair'},
                quantityTable(
                    'Energy of a frame by stage', changed(comparison.energy_by_stage), 'stage'),
                quantityTable(
                    'Energy of a frame by domain', changed(comparison.energy_by_domain),
                    'domain')));
  });
}
