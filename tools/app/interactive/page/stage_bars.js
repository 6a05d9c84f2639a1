// Stages of the selected frame by what their time is spent on: as they are now, and paler below as
// they were recorded.

/** @param state  {now, recorded: outcomes of the frame} @param mechanisms  key → {column} */
function stageBars(state, mechanisms) {
  const colours = new Colours(kMechanismPalette);
  const columns = [...new Set(Object.values(mechanisms).map((m) => m.column).filter(Boolean))];
  columns.forEach((column) => colours.of(column));
  const sums = (stage, column) => sum(Object.entries(stage ? stage.parts : {})
      .map(([key, value]) => ((mechanisms[key] || {}).column === column ? value : 0)));
  const shown = () => {
    const now = stageTimes(state.now).filter((stage) => !stage.controller);
    const before = new Map(stageTimes(state.recorded).map((stage) => [stage.name, stage]));
    return now.map((stage) => ({stage, before: before.get(stage.name)}))
        .filter(({stage, before: old}) => Math.max(stage.ms, old ? old.ms : 0) > 0.005)
        .sort((a, b) => b.stage.ms - a.stage.ms);
  };
  return chartFigure({
    title: 'Stages of the selected frame',
    hint: 'What the time of all cores goes to, in ms of the cluster; paler: as recorded.',
    height: (width) => 60 + rowsHeight(shown().map(({stage}) => stage.name), width, 30),
    table: () => ({
      columns: [{title: 'stage', text: true}, {title: 'ms', digits: 5},
                {title: 'ms as recorded', digits: 5}],
      rows: shown().map(({stage, before}) => [stage.name, stage.ms, before ? before.ms : null])
    }),
    config: () => {
      const rows = shown();
      const bars = (label, column, stack, colour, silent) => ({
        label,
        stack,
        silent,
        backgroundColor: colour,
        data: rows.map(({stage, before}) => sums(stack === 'now' ? stage : before, column)),
        barPercentage: stack === 'now' ? 1 : 0.6
      });
      const used = columns.filter((column) => rows.some(
          ({stage, before}) => sums(stage, column) + sums(before, column) > 0));
      return {
        type: 'bar',
        data: {
          labels: rows.map(({stage}) => stage.name),
          datasets: [
            ...used.map((column) => bars(column, column, 'now', colours.of(column), false)),
            ...used.map((column) => bars(
                `${column}, as recorded`, column, 'recorded', `${colours.of(column)}66`, true))
          ]
        },
        options: {
          indexAxis: 'y',
          scales: {
            x: {stacked: true, title: {display: true, text: 'ms'}},
            y: stackedRows()
          }
        }
      };
    }
  });
}
