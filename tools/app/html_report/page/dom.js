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

// Colours that people with any colour vision tell apart (after Paul Tol), on light and on dark.
const kPalette = [
  '#8c99a8', '#4477aa', '#66ccee', '#ee7755', '#44aa88', '#ddaa33', '#aa5588', '#228833', '#b0b8c1',
  '#775599', '#999933', '#cc6677'
];

function paletteColour(index) {
  return kPalette[index % kPalette.length];
}

/** A colour that is mixed with white, or with black if `by` is negative. */
function shade(colour, by) {
  const to = by < 0 ? 0 : 255;
  const mixed = [1, 3, 5].map((at) => {
    const from = parseInt(colour.slice(at, at + 2), 16);
    return Math.round(from + (to - from) * Math.abs(by)).toString(16).padStart(2, '0');
  });
  return `#${mixed.join('')}`;
}

/** Name → colour, in the order in which names come first: the same everywhere in the page. */
class Colours {
  constructor() {
    this.names = new Map();
  }
  of(name) {
    if (!this.names.has(name)) this.names.set(name, paletteColour(this.names.size));
    return this.names.get(name);
  }
}
const stageColours = new Colours();
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
