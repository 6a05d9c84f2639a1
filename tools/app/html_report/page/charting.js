// Charts by Chart.js in the colours of the page: with a legend of buttons, values at the pointer
// and by the arrow keys, and the data as a table below.

const charts = [];

function themeDefaults() {
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.font.size = 11.5;
  Chart.defaults.color = style('--soft');
  Chart.defaults.borderColor = style('--line');
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.devicePixelRatio = Math.max(2, window.devicePixelRatio);
  Chart.defaults.plugins.legend.display = false;
  Object.assign(Chart.defaults.plugins.tooltip, {
    backgroundColor: style('--ink'),
    titleColor: style('--card'),
    bodyColor: style('--card'),
    footerColor: style('--card'),
    padding: 9,
    cornerRadius: 6,
    boxPadding: 4,
    boxWidth: 9,
    boxHeight: 9,
  });
}

/** Lines at values of an axis: [{axis: "x"|"y", value, label}]. */
const limitLines = {
  id: 'limitLines',
  /** Room for labels above the bars. */
  beforeUpdate(chart, _, options) {
    if ((options.lines || []).some(({axis}) => axis === 'x')) chart.options.layout = {padding: {top: 16}};
  },
  afterDatasetsDraw(chart, _, options) {
    const {ctx, chartArea: area, scales} = chart;
    for (const line of options.lines || []) {
      const scale = scales[line.axis];
      if (!scale || line.value < scale.min || line.value > scale.max) continue;
      const at = scale.getPixelForValue(line.value);
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = style('--bad');
      ctx.setLineDash([5, 4]);
      ctx.lineWidth = 1.5;
      ctx.beginPath();
      if (line.axis === 'y') {
        ctx.moveTo(area.left, at);
        ctx.lineTo(area.right, at);
      } else {
        ctx.moveTo(at, area.top);
        ctx.lineTo(at, area.bottom);
      }
      ctx.stroke();
      ctx.font = `600 11px ${Chart.defaults.font.family}`;
      const width = ctx.measureText(line.label).width;
      const [x, y] = line.axis === 'y' ?
          [area.right - width - 4, at - 5] :
          [Math.max(area.left, Math.min(at - width / 2, area.right - width)), area.top - 5];
      ctx.setLineDash([]);
      ctx.lineWidth = 4;
      ctx.strokeStyle = style('--card');
      ctx.strokeText(line.label, x, y);
      ctx.fillText(line.label, x, y);
      ctx.restore();
    }
  },
};

/** Bands of horizontal bars: [{index, low, high}], as whiskers. */
const whiskers = {
  id: 'whiskers',
  afterDatasetsDraw(chart, _, options) {
    const {ctx, scales} = chart;
    ctx.save();
    ctx.strokeStyle = style('--ink');
    ctx.lineWidth = 1.2;
    for (const {index, low, high} of options.bands || []) {
      const y = scales.y.getPixelForValue(index);
      const [left, right] = [scales.x.getPixelForValue(low), scales.x.getPixelForValue(high)];
      ctx.beginPath();
      ctx.moveTo(left, y);
      ctx.lineTo(right, y);
      for (const end of [left, right]) {
        ctx.moveTo(end, y - 4);
        ctx.lineTo(end, y + 4);
      }
      ctx.stroke();
    }
    ctx.restore();
  },
};

/** Names of datasets in those of their bars that have room. */
const barNames = {
  id: 'barNames',
  afterDatasetsDraw(chart, _, options) {
    if (!options.show) return;
    const {ctx} = chart;
    ctx.save();
    ctx.font = `10.5px ${Chart.defaults.font.family}`;
    ctx.fillStyle = '#10161d';
    ctx.textBaseline = 'middle';
    chart.data.datasets.forEach((dataset, i) => {
      if (!chart.isDatasetVisible(i)) return;
      chart.getDatasetMeta(i).data.forEach((bar, index) => {
        if (!dataset.data[index]) return;
        const {x, base, y, height} = bar.getProps(['x', 'base', 'y', 'height'], true);
        if (x - base > ctx.measureText(dataset.label).width + 10 && height > 12)
          ctx.fillText(dataset.label, base + 5, y);
      });
    });
    ctx.restore();
  },
};

/** A text at the end of each horizontal bar, or behind its begin where it has no room: [text]. */
const barTexts = {
  id: 'barTexts',
  afterDatasetsDraw(chart, _, options) {
    const {ctx} = chart;
    ctx.save();
    ctx.font = `11px ${Chart.defaults.font.family}`;
    ctx.fillStyle = style('--ink');
    ctx.textBaseline = 'middle';
    chart.getDatasetMeta(0).data.forEach((bar, index) => {
      const text = (options.texts || [])[index];
      if (!text) return;
      const {x, base, y} = bar.getProps(['x', 'base', 'y'], true);
      const {left, right} = chart.chartArea;
      const width = ctx.measureText(text).width + 6;
      const fitsLeft = x < base && x - width >= left;
      const from = fitsLeft ? x : Math.min(Math.max(x, base), right - width);
      ctx.textAlign = fitsLeft ? 'right' : 'left';
      ctx.fillText(text, from + (fitsLeft ? -6 : 6), y);
    });
    ctx.restore();
  },
};

Chart.register(limitLines, whiskers, barNames, barTexts);

function drawAll() {
  themeDefaults();
  for (const entry of charts) entry.draw();
}

/** A label in lines that take a good third of a narrow chart; paths break behind their signs. */
function labelLines(text, width) {
  const most = Math.max(12, Math.floor((width * 0.36) / 6));
  if (text.length <= most) return [text];
  const lines = [''];
  for (const word of text.match(/[^ .,=_/]*[ .,=_/]|[^ .,=_/]+$/g) || [text])
    if (lines[lines.length - 1] === '' || (lines[lines.length - 1] + word).trimEnd().length <= most)
      lines[lines.length - 1] += word;
    else
      lines.push(word);
  return lines.map((line) => line.trimEnd());
}

/** Of rows of bars with such labels, in px. */
function rowsHeight(labels, width, least) {
  const lines = Math.max(1, ...labels.map((label) => labelLines(label, width).length));
  return labels.length * Math.max(least, 8 + 14 * lines);
}

/** The vertical axis of stacked bars, each of which has a name. */
function stackedRows() {
  return {
    stacked: true,
    grid: {display: false},
    ticks: {
      autoSkip: false,
      callback(value) {
        return labelLines(this.getLabelForValue(value), this.chart.width);
      }
    }
  };
}

/** One button per name; several datasets may share one. */
function legendFor(chart, datasets, hidden, redraw) {
  const names =
      [...new Map(datasets.filter((d) => d.label && !d.silent).map((d) => [d.label, d])).values()];
  if (names.length < 2) return null;
  return element(
      'ul', {class: 'legend', 'aria-label': 'Legend: shows and hides'},
      ...names.map(
          (dataset) => element(
              'li', {},
              element(
                  'button', {
                    type: 'button',
                    'aria-pressed': String(!hidden.has(dataset.label)),
                    onclick: () => {
                      if (!hidden.delete(dataset.label)) hidden.add(dataset.label);
                      redraw(dataset.label);
                    },
                  },
                  element('i', {
                    style: dataset.legendLine ?
                        `height:0;border-top:3px ${dataset.legendLine} currentcolor` :
                        `background:${dataset.legendColor || dataset.backgroundColor}`
                  }),
                  dataset.label))));
}

/** Moves the tooltip to the next element, so that charts can be read without a pointer. */
function onChartKey(event, chart, state) {
  const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
  if (!step) return;
  event.preventDefault();
  const shown = chart.data.datasets.map((d, i) => i).filter((i) => chart.isDatasetVisible(i));
  const byIndex = chart.options.interaction.mode === 'index';
  const stops = byIndex ?
      [...Array(Math.max(0, ...shown.map((i) => chart.data.datasets[i].data.length))).keys()].map(
          (index) => shown.filter((i) => index < chart.data.datasets[i].data.length)
                         .map((datasetIndex) => ({datasetIndex, index}))) :
      shown
          .flatMap(
              (datasetIndex) => chart.data.datasets[datasetIndex].data.map(
                  (value, index) =>
                      (value === null || value === 0 ? null : [{datasetIndex, index}])))
          .filter(Boolean);
  if (stops.length === 0) return;
  state.stop =
      (((state.stop ?? (step > 0 ? -1 : 0)) + step) % stops.length + stops.length) % stops.length;
  const active = stops[state.stop];
  const {x, y} =
      chart.getDatasetMeta(active[0].datasetIndex).data[active[0].index].getCenterPoint();
  chart.setActiveElements(active);
  chart.tooltip.setActiveElements(active, {x, y});
  chart.update('none');
  const {title, body} = chart.tooltip;
  document.getElementById('live').textContent =
      [...(title || []), ...(body || []).flatMap((part) => part.lines)].join(', ');
}

/**
 * A chart as a figure.
 * @param config  (width, height) → configuration of Chart.js, anew whenever the page is redrawn
 * @param table   () → {columns, rows}
 * @param height  of the canvas in px, or a function of its width
 * @returns the figure; figure.redraw() after what config reads has changed
 */
function chartFigure({title, hint, controls, config, table, height = 280, onpick}) {
  const canvas = element('canvas', {
    tabindex: '0',
    role: 'img',
    'aria-label': `${title}. Arrow keys step through the values; the data follow as a table.`
  });
  const box = element('div', {class: 'canvas'}, canvas);
  const legend = element('div');
  const caption = element(
      'figcaption', {}, element('h3', {}, title),
      hint ? element('p', {class: 'hint'}, hint) : null);
  const details = dataDetails(table, title);
  const figure =
      element('figure', {class: 'card'}, caption, controls || null, legend, box, details);
  const hidden = new Set();
  const state = {};
  let chart = null;

  /** @param anew  else in place, which takes half the time */
  function draw(anew = true) {
    const focused = document.activeElement && legend.contains(document.activeElement) ?
        document.activeElement.textContent :
        null;
    const pixels = typeof height === 'function' ? height(box.clientWidth) : height;
    box.style.height = `${pixels}px`;
    const wanted = config(box.clientWidth, pixels);
    for (const dataset of wanted.data.datasets) dataset.hidden = hidden.has(dataset.label);
    if (onpick)
      wanted.options.onClick = (event, elements) =>
          elements.length > 0 && onpick(elements[0], chart);
    if (anew || !chart) {
      if (chart) chart.destroy();
      chart = new Chart(canvas, wanted);
    } else {
      Object.assign(chart, {data: wanted.data, options: wanted.options});
      chart.update('none');
    }
    const buttons = legendFor(chart, wanted.data.datasets, hidden, draw);
    legend.replaceChildren(...(buttons ? [buttons] : []));
    if (focused)
      [...legend.querySelectorAll('button')]
          .find((button) => button.textContent === focused)
          ?.focus();
  }

  canvas.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && onpick) {
      const active = chart.getActiveElements();
      if (active.length > 0) onpick(active[0], chart);
    }
    onChartKey(event, chart, state);
  });
  figure.redraw = () => {
    draw(false);
    const open = details.open;
    details.open = false;
    while (details.childElementCount > 1) details.lastElementChild.remove();
    details.open = open;
  };
  charts.push({
    figure,
    draw: () => {
      if (figure.isConnected) draw();
    }
  });
  return figure;
}
