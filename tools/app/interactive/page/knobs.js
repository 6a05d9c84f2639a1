// Sliders and switches. Each says its name in the schema, what it is, its value, and what it costs;
// marks below a slider show which values can run.

/** "+0.012 mm²", "−0.1 mJ"; empty for nothing. */
function priceText(price) {
  if (!price) return '';
  const parts = [[price.area_mm2, 'mm²'], [price.energy_mj, 'mJ a frame']];
  return parts.filter(([value]) => Math.abs(value) >= 1e-6)
      .map(([value, unit]) => `${signed(value, 2)} ${unit}`)
      .join(', ');
}

/** @param changed  called after every move */
function knobCards(setting, changed) {
  const {knobs, switches} = setting.data;
  const views = knobs.map((knob, i) => knobView(setting, knob, i, changed));
  const boxes = switches.map((one, i) => switchView(setting, one, i, changed));
  return {
    nodes: [...views, ...boxes].map((view) => view.node),
    /** @param price  (lines without a change) → what the change adds */
    show(price = () => null) {
      views.forEach((view, i) => view.show(
          setting.at[i] === knobs[i].recorded ? null :
                                                price(setting.lines({knob: [i, knobs[i].recorded]}))));
      boxes.forEach((view, i) => view.show(
          setting.on[i] ? price(setting.lines({switch: [i, false]})) : null));
    },
    /** What can be asked for: each value of each slider, and each switch. */
    questions: () => [...knobs.flatMap((knob, i) => knob.values.map(
                          (_, at) => setting.lines({knob: [i, at]}))),
                      ...switches.map((_, i) => setting.lines({switch: [i, true]}))],
    /** Whether a value of a slider can run, as far as is known. */
    can: (i, at) => !views[i].refusals()[at],
    answers(refusals) {
      const rest = [...refusals];
      views.forEach((view, i) => view.refuse(rest.splice(0, knobs[i].values.length)));
      boxes.forEach((view) => view.refuse(rest.splice(0, 1)[0]));
    }
  };
}

function knobView(setting, knob, i, changed) {
  let refusals = [];
  const id = `knob-${i}`;
  const value = element('output', {for: id});
  const marks = knob.values.map((text) => element('i', {title: text}));
  const note = element('p', {class: 'hint'});
  const slider = element('input', {
    type: 'range',
    id,
    min: 0,
    max: knob.values.length - 1,
    step: 1,
    disabled: Boolean(knob.fixed),
    oninput: () => {
      setting.at[i] = Number(slider.value);
      changed();
    }
  });
  const others = knob.values.filter((_, n) => n !== knob.recorded).join(',');
  const fixed = knob.fixed ?
      [`. ${knob.fixed} `, element('code', {}, `leviosim whatif ${setting.data.run} ${knob.path}=${others}`)] :
      [];
  let paid = null;
  function show(price = paid) {
    paid = price;
    const at = setting.at[i];
    const text = knob.values[at];
    const refusal = refusals[at];
    slider.value = at;
    slider.setAttribute('aria-valuetext', refusal ? `${text}, cannot run: ${refusal}` : text);
    value.textContent = at === knob.recorded ? text : `${text} (recorded ${knob.values[knob.recorded]})`;
    marks.forEach((mark, n) => {
      mark.className = [n === at ? 'at' : '', refusals[n] ? 'cannot' : ''].join(' ').trim();
      mark.title = refusals[n] ? `${knob.values[n]}: ${refusals[n]}` : knob.values[n];
    });
    note.replaceChildren(
        knob.help, ...fixed, price ? element('strong', {}, ` ${priceText(price)}`) : '',
        refusal ? element('span', {class: 'status-bad'}, ` Cannot run: ${refusal}`) : '');
  }
  return {
    show,
    refusals: () => refusals,
    refuse: (answers) => {
      refusals = answers;
      show();
    },
    node: element(
        'div', {class: 'knob'},
        element('div', {class: 'line'}, element('label', {for: id}, element('code', {}, knob.path)),
                value),
        slider, element('div', {class: 'marks', 'aria-hidden': 'true'}, ...marks), note)
  };
}

function switchView(setting, one, i, changed) {
  let refusal = null;
  const note = element('span', {class: 'hint'});
  const box = element('input', {
    type: 'checkbox',
    onchange: () => {
      setting.on[i] = box.checked;
      changed();
    }
  });
  let paid = null;
  function show(price = paid) {
    paid = price;
    box.checked = setting.on[i];
    box.disabled = Boolean(refusal) && !setting.on[i];
    note.replaceChildren(
        one.help, price ? element('strong', {}, ` ${priceText(price)}`) : '',
        refusal ? element('span', {class: 'status-bad'}, ` Cannot run: ${refusal}`) : '');
  }
  return {
    show,
    refuse: (answer) => {
      refusal = answer;
      show();
    },
    node: element(
        'div', {class: 'knob'},
        element('label', {}, box, ` units of `, element('code', {}, one.name), ' '), note)
  };
}
