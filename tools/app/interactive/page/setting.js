// What the sliders and switches say, as lines for the engine, as a command, and in the address of
// the page, which keeps it.

const kCamera = 'fps=';

class Setting {
  /** @param data  of the page: knobs, switches, run, period_ns */
  constructor(data) {
    this.data = data;
    this.frame = 0;
    this.reset();
  }

  reset() {
    this.at = this.data.knobs.map((knob) => knob.recorded);
    this.on = this.data.switches.map(() => false);
  }

  /** Between two frames, as the slider of the camera has it. */
  get period_ns() {
    const line = this.lines().find((text) => text.startsWith(kCamera));
    return line ? 1e9 / Number(line.slice(kCamera.length)) : this.data.period_ns;
  }
  get isRecorded() {
    return this.lines().length === 0;
  }

  /** @param i  of the sliders, and behind them the switches */
  isMoved(i) {
    const knob = this.data.knobs[i];
    return knob ? this.at[i] !== knob.recorded : this.on[i - this.data.knobs.length];
  }
  /** Of the sliders that are not as recorded. */
  knobLines(other = {}) {
    return this.data.knobs.flatMap((knob, i) => {
      const at = other.knob && other.knob[0] === i ? other.knob[1] : this.at[i];
      return at === knob.recorded ? [] : [`${knob.path}=${knob.values[at]}`];
    });
  }

  /** For people: a switch by its name, whatever it sets. */
  names() {
    const on = this.data.switches.filter((_, i) => this.on[i]).map((one) => `units of ${one.name}`);
    return [...this.knobLines(), ...on];
  }

  /** As -p takes them. @param other  {knob: [index, value], switch: [index, on]} in their place */
  lines(other = {}) {
    const lines = this.knobLines(other);
    this.data.switches.forEach((one, i) => {
      if (other.switch && other.switch[0] === i ? other.switch[1] : this.on[i])
        lines.push(...one.settings);
    });
    return lines;
  }

  command() {
    const chip = this.lines().filter((line) => !line.startsWith(kCamera));
    return ['leviosim whatif', this.data.run, ...(chip.length > 0 ? [chip.join(',')] : [])].join(
        ' ');
  }

  fragment() {
    const parts = new URLSearchParams();
    this.data.knobs.forEach((knob, i) => {
      if (this.at[i] !== knob.recorded) parts.set(knob.path, knob.values[this.at[i]]);
    });
    this.data.switches.forEach((one, i) => {
      if (this.on[i]) parts.set(one.name, 'on');
    });
    parts.set('frame', this.frame);
    return parts.toString();
  }

  /** What an address does not say, or says wrongly, stays as recorded. */
  read(fragment) {
    const parts = new URLSearchParams(fragment);
    this.reset();
    this.data.knobs.forEach((knob, i) => {
      const at = knob.values.indexOf(parts.get(knob.path));
      if (at >= 0) this.at[i] = at;
    });
    this.on = this.data.switches.map((one) => parts.get(one.name) === 'on');
    const frame = Number(parts.get('frame') ?? NaN);
    if (Number.isInteger(frame) && frame >= 0 && frame < this.data.frames) this.frame = frame;
  }
}
