// Elements, numbers and colours. Texts enter the page as text only, never as HTML.

/** An element. Attributes that are functions are listeners: {onclick: f}; text and nodes follow. */
function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (typeof value === 'function')
      node.addEventListener(name.slice(2), value);
    else if (value === true)
      node.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined)
      node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** A number for people: so many significant digits, thousands apart. */
function numberText(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (typeof value !== 'number') return String(value);
  if (value !== 0 && Math.abs(value) < 1e-4) return value.toExponential(2);
  return value.toLocaleString(
      'en-US', {maximumSignificantDigits: Math.max(digits, Number.isInteger(value) ? 15 : 1)});
}

/** "+1.2", "−3". */
function signed(value, digits = 3) {
  if (value === null || value === undefined) return '–';
  return (value > 0 ? '+' : value < 0 ? '−' : '±') + numberText(Math.abs(value), digits);
}

function sum(values) {
  return values.reduce((total, value) => total + (value || 0), 0);
}

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** The data of the page. */
const kPage = JSON.parse(document.getElementById('data').textContent);

// A kind of thing has colours of its own, so that a colour means one thing on all charts: people
// with any colour vision tell those of a kind apart (after Paul Tol, Okabe and Ito, Brewer), on
// light and on dark. Blocks of memory have pale ones, since their names stand in them.
const kStagePalette = [
  '#8c99a8', '#4477aa', '#66ccee', '#ee7755', '#44aa88', '#ddaa33', '#aa5588', '#228833', '#b0b8c1',
  '#775599', '#999933', '#cc6677'
];
const kMechanismPalette = [
  '#77aadd', '#b3cfee', '#f4a582', '#eedd88', '#c9b95a', '#ffaabb', '#c297d0', '#e3c6ea', '#8fd0b5',
  '#c4c8cc', '#7fbf7b', '#d9f0d3'
];
const kDomainPalette =
    ['#5e81b5', '#e19c24', '#8fb032', '#eb6235', '#9a73b5', '#c56e1a', '#5d9ec7', '#a0a5ab'];
const kSeriesPalette = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#a6a014'];
const kBlockPalette = ['#bcc8d6', '#d8cfbf', '#bfd3c6', '#d6c3cf', '#a9b7c7', '#c7c1b0'];

function seriesColour(index) {
  return kSeriesPalette[index % kSeriesPalette.length];
}

/** Name → colour, in the order in which names come first: the same everywhere in the page. */
class Colours {
  constructor(palette) {
    this.palette = palette;
    this.names = new Map();
  }
  of(name) {
    if (!this.names.has(name))
      this.names.set(name, this.palette[this.names.size % this.palette.length]);
    return this.names.get(name);
  }
}
const stageColours = new Colours(kStagePalette);
const kWaiting = 'waiting for the front end';
const kOther = 'offload and return';
const kSpecialColours = {
  __proto__: null,
  [kWaiting]: '#c5ccd4',
  [kOther]: '#5f6b7a'
};

function stageColour(name) {
  return kSpecialColours[name] || stageColours.of(name);
}

function section(id, title, ...children) {
  return element('section', {id, 'aria-label': title}, element('h2', {}, title), ...children);
}
