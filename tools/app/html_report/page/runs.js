// A run from top to bottom, and the choice among several.

/** The names of runs: the last parts of their paths, as many as tell them apart. */
function runNames(runs) {
  const parts = runs.map((run) => run.name.split('/').filter(Boolean));
  const ends = (count) => parts.map((part) => part.slice(-count).join('/'));
  let count = 1;
  while (new Set(ends(count)).size < runs.length && parts.some((part) => part.length > count)) ++count;
  const names = ends(count);
  return names.map((name, i) => (names.indexOf(name) === i ? name : `${name} (${i + 1})`));
}

function runSections(run) {
  return [
    framesSection(run), stagesSection(run), memorySection(run), energySection(run),
    trajectorySection(run),
    section('made', 'How it was made', element('div', {class: 'card'}, factList(run)))
  ].filter(Boolean);
}

function chipText(run) {
  const facts = run.facts;
  const chip = facts.platform ?
      `${[facts.platform, ...facts.overrides].join(', ')}, ${facts.cores} cores at ${
          numberText(facts.cluster_clock / 1e6)} MHz` :
      'the host, natively';
  return `${facts.profile} on ${chip}; ${facts.frames} frames of ${facts.data}`;
}

/** Figures of several runs beside each other. */
function runsTable(runs, names) {
  const titles = [...new Set(runs.flatMap((run) => run.figures.map((figure) => figure.title)))];
  const columns = [{title: 'figure', text: true}, ...names.map((name) => ({title: name}))];
  const abouts = [...new Set(runs.flatMap((run) => run.verdict.list.map((v) => v.about)))];
  const verdict = (run, about) => {
    const found = run.verdict.list.find((v) => v.about === about);
    return found ? `${gradeMark[found.grade]} ${found.word}` : null;
  };
  const cell = (run, title) => {
    const figure = run.figures.find((f) => f.title === title);
    return figure ? `${figure.value} ${figure.unit}` : null;
  };
  return sortableTable(
      columns,
      [
        ...abouts.map(
            (about) => [`Verdict: ${about}`, ...runs.map((run) => verdict(run, about))]),
        ...titles.map((title) => [title, ...runs.map((run) => cell(run, title))])
      ],
      {whole: true, label: 'Runs'});
}

/** What stands beside the errors of the runs: each protocol once. */
function protocols(runs) {
  const texts = [...new Set(runs.map((run) => run.protocol).filter(Boolean))];
  return texts.map((text) => element('p', {class: 'hint'}, `ATE: ${text}`));
}
