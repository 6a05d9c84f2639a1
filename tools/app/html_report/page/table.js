// Tables whose columns sort at a click.

/**
 * @param columns  [{title, text: whether cells are words, digits, wrap, node: cell → element}]
 * @param rows     arrays of cells: numbers, texts or null
 */
function sortableTable(columns, rows, {whole = false, label = ''} = {}) {
  const body = element('tbody');
  const heads = columns.map(
      (column, index) => element(
          'th', {scope: 'col', class: column.text ? 'text' : null},
          element('button', {type: 'button', onclick: () => sortBy(index)}, column.title)));

  function fill(sorted) {
    body.replaceChildren(...sorted.map(
        (row) => element('tr', {}, ...row.map((cell, i) => {
          const column = columns[i];
          const kind = [column.text ? 'text' : '', column.wrap ? 'wrap' : ''].join(' ').trim();
          const content = column.node ? column.node(cell, row) :
              column.text ? (cell === null || cell === undefined ? '–' : String(cell)) :
                            numberText(cell, column.digits);
          return element('td', {class: kind || null}, content);
        }))));
  }

  function sortBy(index) {
    const ascending = heads[index].getAttribute('aria-sort') !== 'ascending';
    heads.forEach((head) => head.removeAttribute('aria-sort'));
    heads[index].setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
    const sign = ascending ? 1 : -1;
    const missing = (value) => value === null || value === undefined;
    fill([...rows].sort((a, b) => {
      if (missing(a[index]) || missing(b[index])) return missing(a[index]) - missing(b[index]);
      if (typeof a[index] === 'number' && typeof b[index] === 'number')
        return sign * (a[index] - b[index]);
      return sign * String(a[index]).localeCompare(String(b[index]), 'en', {numeric: true});
    }));
  }

  fill(rows);
  return element(
      'div', {
        class: whole ? 'scroll whole' : 'scroll',
        tabindex: '0',
        role: 'region',
        'aria-label': label || 'Table'
      },
      element('table', {}, element('thead', {}, element('tr', {}, ...heads)), body));
}

/** The data of a chart, made when it is opened. */
function dataDetails(table, label) {
  const details = element('details', {}, element('summary', {}, 'Data as a table'));
  details.addEventListener('toggle', () => {
    if (details.open && details.childElementCount === 1) {
      const {columns, rows} = table();
      details.append(sortableTable(columns, rows, {label}));
    }
  });
  return details;
}

/** Name and colour of a stage. */
function stageCell(name) {
  return element(
      'span', {}, element('i', {class: 'swatch', style: `background:${stageColour(name)}`}), name);
}
