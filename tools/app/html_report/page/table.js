// Tables whose columns sort at a click.

const kMostEmptyRows = 3;

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

  const missing = (value) => value === null || value === undefined;
  const rowOf = (row) => element('tr', {}, ...row.map((cell, i) => {
    const column = columns[i];
    const kind = [column.text ? 'text' : '', column.wrap ? 'wrap' : ''].join(' ').trim();
    const content = column.node ? column.node(cell, row) :
        column.text ? (missing(cell) ? '–' : String(cell)) :
                      numberText(cell, column.digits);
    return element('td', {class: kind || null}, content);
  }));

  /** Rows without any figure are one line, which shows them. */
  function fill(sorted) {
    const figures = columns.map((column, i) => (column.text ? -1 : i)).filter((i) => i >= 0);
    const isEmpty = (row) => figures.length > 0 && figures.every((i) => missing(row[i]));
    const empty = sorted.filter(isEmpty);
    if (empty.length <= kMostEmptyRows) return body.replaceChildren(...sorted.map(rowOf));
    const more = element(
        'button', {
          type: 'button',
          onclick: () => body.replaceChildren(...sorted.map(rowOf))
        },
        `${empty.length} rows without a figure`);
    body.replaceChildren(
        ...sorted.filter((row) => !isEmpty(row)).map(rowOf),
        element('tr', {}, element('td', {class: 'text', colspan: columns.length}, more)));
  }

  function sortBy(index) {
    const ascending = heads[index].getAttribute('aria-sort') !== 'ascending';
    heads.forEach((head) => head.removeAttribute('aria-sort'));
    heads[index].setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
    const sign = ascending ? 1 : -1;
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
