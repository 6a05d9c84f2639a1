// Puts the page together from the data.

function main() {
  const data = kPage;
  const content = document.getElementById('content');
  for (const run of data.runs)
    for (const stage of run.stages) stageColours.of(stage.name);

  const heading = element(
      'div', {}, element('h1', {}, data.title),
      data.runs.length === 1 ? element('p', {class: 'hint'}, chipText(data.runs[0])) : null,
      data.truth ? element('p', {class: 'hint'}, data.truth) : null);
  const details = element('div', {style: 'display:contents'});
  const top = element('section', {id: 'verdict', 'aria-label': 'Verdict'}, heading);

  function show(run) {
    for (let i = charts.length - 1; i >= 0; --i)
      if (details.contains(charts[i].figure)) charts.splice(i, 1);
    details.replaceChildren(...runSections(run));
    drawAll();
    fillNavigation();
  }

  function fillNavigation() {
    document.getElementById('nav').replaceChildren(
        ...[...document.querySelectorAll('main section[id]')].map(
            (node) => element('a', {href: `#${node.id}`}, node.getAttribute('aria-label'))));
  }

  content.replaceChildren(top);
  if (data.runs.length === 1) top.append(verdictCard(data.runs[0]), tiles(data.runs[0]));
  if (data.check) content.append(checkSection(data.check));
  if (data.runs.length > 1) {
    const names = runNames(data.runs);
    top.append(
        element('div', {class: 'card'}, runsTable(data.runs, names), ...protocols(data.runs)));
    content.append(...comparisonSections(data.comparisons || []));
    const select = element(
        'select', {onchange: () => show(data.runs[Number(select.value)])},
        ...names.map((name, i) => element('option', {value: i}, name)));
    content.append(element(
        'div', {class: 'card'},
        element('div', {class: 'controls'}, element('label', {}, 'Show the details of', select))));
  }
  if (data.evaluations) content.append(evaluationsSection(data.evaluations));
  if (data.study) content.append(...studySections(data.study, top));
  if (data.history) top.append(...historyCards(data.history));
  content.append(details);
  if (data.runs.length > 0)
    show(data.runs[0]);
  else {
    drawAll();
    fillNavigation();
  }

  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  let width = innerWidth;
  addEventListener('resize', () => {
    if (innerWidth === width) return;
    width = innerWidth;
    drawAll();
  });
  // On paper the page is light, and charts have the width of the paper.
  addEventListener('beforeprint', () => {
    document.documentElement.dataset.theme = 'light';
    drawAll();
  });
  addEventListener('afterprint', () => {
    delete document.documentElement.dataset.theme;
    drawAll();
  });
}

main();
