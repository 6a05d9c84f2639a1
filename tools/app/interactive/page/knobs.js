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
  const views = setting.data.knobs.map((knob, i) => knobView(setting, knob, i, changed));
  const switches = setting.data.switches.map((one, i) => switchView(setting, one, i, changed));
  const camera = cameraView(setting, changed);
  return {
    nodes: [...views, camera, ...switches].map((view) => view.node),
    /** @param prices  of lines, by line */
    show(prices) {
      for (const view of [...views, camera, ...switches]) view.show(prices);
    },
    /** What can be asked for each value of each slider, and each switch. */
    questions: () => [...setting.data.knobs.flatMap((knob, i) => knob.values.map(
                          (_, at) => setting.chipLines({knob: [i, at]}))),
                      ...setting.data.switches.map((_, i) => setting.chipLines({switch: i}))],
    answers(refusals) {
      const rest = [...refusals];
      views.forEach((view, i) => view.refuse(rest.splice(0, setting.data.knobs[i].values.length)));
      switches.forEach((view) => view.refuse(rest.splice(0, 1)[0]));
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
    oninput: () => {
      setting.at[i] = Number(slider.value);
      changed();
    }
  });
  function show(prices = {}) {
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
    const price = priceText(prices[`${knob.path}=${text}`]);
    note.replaceChildren(
        knob.help, price ? element('strong', {}, ` ${price}`) : '',
        refusal ? element('span', {class: 'status-bad'}, ` Cannot run: ${refusal}`) : '');
  }
  return {
    show,
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
  function show(prices = {}) {
    box.checked = setting.on[i];
    box.disabled = Boolean(refusal) && !setting.on[i];
    const sum_of = (key) => sum(one.settings.map((line) => (prices[line] || {})[key]));
    const price = priceText({area_mm2: sum_of('area_mm2'), energy_mj: sum_of('energy_mj')});
    note.replaceChildren(
        one.help, price ? element('strong', {}, ` ${price}`) : '',
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

/** Frames come faster or slower; all are delivered and wait. */
function cameraView(setting, changed) {
  const value = element('output', {for: 'knob-camera'});
  const slider = element('input', {
    type: 'range',
    id: 'knob-camera',
    min: 5,
    max: Math.max(120, Math.ceil(2 * setting.recordedRate)),
    step: 1,
    oninput: () => {
      const rate = Number(slider.value);
      setting.rate = rate === Math.round(setting.recordedRate) ? null : rate;
      changed();
    }
  });
  return {
    show() {
      slider.value = setting.rate ?? setting.recordedRate;
      const recorded = numberText(setting.recordedRate);
      value.textContent = setting.rate === null ?
          `${recorded} frames/s` :
          `${setting.rate} frames/s (recorded ${recorded})`;
    },
    node: element(
        'div', {class: 'knob'},
        element('div', {class: 'line'},
                element('label', {for: 'knob-camera'}, element('code', {}, 'camera')), value),
        slider,
        element('p', {class: 'hint'},
                'How often a frame comes: the deadline of each. None is lost, frames wait.'))
  };
}
