// Puts the interactive page together: a move of a slider times the selected frame at once, and the
// flight when the slider rests.

/** Of a slider, before a flight begins. [ms] */
const kRest = 200;

class InteractivePage {
  /** @param film  of all frames, or null */
  constructor(data, engine, flights, film) {
    this.data = data;
    this.film = film;
    this.engine = engine;
    this.flights = flights;
    this.setting = new Setting(data);
    this.setting.read(location.hash.slice(1));
    this.state = {latencies: [], recorded: [], period_ns: data.period_ns, frame: this.setting.frame};
    this.bars = {};
    this.knobs = knobCards(this.setting, () => this.moved());
    this.parts = {
      verdict: element('div'),
      tiles: element('div'),
      sentence: element('p', {class: 'sentence', 'aria-live': 'polite'}),
      failure: element('p', {class: 'status-bad', role: 'alert'}),
      status: element('p', {class: 'hint'}),
      command: element('code'),
      seen: element('p'),
      frame: element('input', {
        type: 'number',
        min: 0,
        max: data.frames - 1,
        onchange: () => this.select(Number(this.parts.frame.value))
      })
    };
    this.player = new Player(data.frames, this.setting, (number) => this.select(number));
    this.updates = [];  // times that the selected frame took, in ms
  }

  /** The recorded flight comes first: all others are set against it. */
  begin() {
    const asked = this.setting.frame;
    this.recordedArea = this.area = this.engine.set([]).area_mm2;
    this.flights.start([], [], {
      frames: (frames) => this.arrived(this.state.recorded, frames),
      outcome: (outcome) => {
        this.recorded = this.counted(outcome, this.state.recorded, this.data.period_ns);
        this.now = this.recorded;
        this.state.latencies = this.state.recorded;
        if (!location.hash.includes('frame='))
          this.setting.frame = this.state.recorded.indexOf(Math.max(...this.state.recorded));
        else
          this.setting.frame = asked;
        this.draw();
        this.showAnswer();
        this.changed();
        this.showChanged();
      },
      refusals: () => {},
      failure: (text) => this.fail(text)
    });
  }

  arrived(latencies, frames) {
    for (const [number, latency] of frames) latencies[number] = latency;
    this.parts.status.textContent = `${latencies.length} of ${this.data.frames} frames timed …`;
  }
  counted(outcome, latencies, period_ns) {
    return {...outcome, late: lateFrames(latencies, period_ns)};
  }
  fail(text) {
    this.parts.failure.textContent = text ? `Cannot run: ${text}` : '';
    document.getElementById('content').classList.toggle('stale', Boolean(text));
  }

  tellFrame() {
    const {facts, words} = this.data.flight;
    const {latencies, period_ns, frame} = this.state;
    this.parts.seen.textContent = frameSentence(facts, words, frame, latencies[frame], period_ns);
  }
  /** Of the flight that was timed last. */
  showAnswer() {
    this.tellFrame();
    this.parts.verdict.replaceChildren(verdictsOf(this.now));
    this.parts.tiles.replaceChildren(
        answerTiles(this.now, this.recorded, this.area, this.recordedArea));
  }

  draw() {
    const {verdict, tiles: tileBox, sentence: words, failure, status, command, frame} = this.parts;
    const button = (text, onclick) => element('button', {type: 'button', onclick}, text);
    this.timeFrame();
    this.latency = latencyFigure(this.state, (number) => this.select(number));
    this.stages = stageBars(this.bars, this.data.mechanisms);
    this.gantt = frameGantt(this.bars, this.setting);
    const select = (number) => this.select(number);
    const {path} = this.data.flight;
    this.views = [
      this.film && filmFigure(this.film, this.state),
      path && flightPath(path, this.film, this.state, select)
    ].filter(Boolean);
    document.getElementById('content').replaceChildren(
        element(
            'section', {id: 'verdict', 'aria-label': 'Verdict'},
            element('h1', {}, `What if: ${this.data.profile} on ${this.data.platform}`),
            element('p', {class: 'hint'}, `${this.data.frames} frames of ${this.data.data}. The page holds the recorded work and times it anew.`)),
        element(
            'div', {class: 'workbench'},
            element(
                'section', {'aria-label': 'Chip', class: 'card knobs'}, element('h2', {}, 'Chip'),
                ...this.knobs.nodes),
            element(
                'section', {'aria-label': 'Answer', class: 'answer'}, verdict, tileBox,
                element(
                    'div', {class: 'card'}, words, failure, status,
                    element('div', {class: 'controls'}, element('label', {}, 'frame', frame),
                            button('Worst frame', () => this.selectWorst()),
                            button('As recorded', () => this.back()),
                            button('Smallest that is never late', () => findSmallest(this)),
                            button('Copy as command', (event) => this.copy(event.target))),
                    command),
                this.latency,
                element(
                    'div', {class: 'card'},
                    element('div', {class: 'controls'}, this.player.button,
                            element('span', {class: 'hint'}, 'Space plays, arrows step.')),
                    this.parts.seen),
                element('div', {class: 'pair'}, ...this.views), this.gantt, this.stages)));
    drawAll();
  }
  /** An address may have moved a slider that is out of sight. */
  showChanged() {
    const node = this.knobs.nodes.find((_, i) => this.setting.isMoved(i));
    if (node) node.parentNode.scrollTop = node.offsetTop - 12;
  }

  /** By somebody, which ends a search. */
  moved() {
    this.searching = null;
    this.changed();
  }
  back() {
    this.setting.reset();
    this.moved();
  }
  /** @returns whether the search that begins here goes on */
  startSearch() {
    const search = this.searching = {};
    return () => this.searching === search;
  }
  say(text) {
    this.parts.status.textContent = text;
  }
  /** The outcome of the flight with the present setting, or {failure: why it cannot run}. */
  timed() {
    return new Promise((done) => {
      this.onTimed = done;
      this.changed();
    });
  }
  select(number) {
    if (!(Number.isInteger(number) && number >= 0 && number < this.data.frames)) return;
    this.setting.frame = number;
    this.changed();
  }
  selectWorst() {
    this.select(this.state.latencies.indexOf(Math.max(...this.state.latencies)));
  }
  async copy(button) {
    try {
      await navigator.clipboard.writeText(this.setting.command());
      button.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(this.parts.command);
      button.textContent = 'Selected: copy it';
    }
    setTimeout(() => (button.textContent = 'Copy as command'), 1500);
  }

  /** Times the selected frame. Whether the setting can run. */
  timeFrame() {
    const began = performance.now();
    const number = this.setting.frame;
    try {
      if (this.bars.number !== number) {
        this.engine.set([]);
        this.bars.now = this.bars.recorded = this.engine.frame(number);
        this.bars.number = number;
      }
      this.area = this.engine.set(this.setting.lines()).area_mm2;
      this.bars.now = this.engine.frame(number);
    } catch (error) {
      this.fail(error.message);
      return false;
    }
    this.updates.push(performance.now() - began);
    this.fail('');
    return true;
  }

  changed() {
    clearTimeout(this.rest);
    this.parts.command.textContent = this.setting.command();
    this.parts.frame.value = this.setting.frame;
    this.state.frame = this.setting.frame;
    const runs = this.timeFrame();
    this.parts.sentence.textContent = runs ?
        sentence(this.setting, this.bars.now, this.bars.recorded, this.data.mechanisms) :
        '';
    for (const figure of [this.stages, this.gantt, ...this.views]) figure.redraw();
    this.tellFrame();
    this.rest = setTimeout(() => this.rested(runs), kRest);
    this.latency.redraw();
    this.knobs.show();
  }

  /** @param runs  whether the setting does; else it is only asked which others do */
  rested(runs) {
    history.replaceState(null, '', `#${this.setting.fragment()}`);  // browsers bear few a second
    if (runs) this.knobs.show((others) => this.engine.price(this.setting.frame, others));
    const period_ns = this.setting.period_ns;
    const latencies = [];
    if (runs) Object.assign(this.state, {latencies, period_ns});
    this.tellFrame();
    this.flights.start(runs ? this.setting.lines() : null, this.knobs.questions(), {
      frames: (frames) => {
        this.arrived(latencies, frames);
        this.latency.redraw();
      },
      outcome: (outcome, took) => {
        this.now = this.counted(outcome, latencies, period_ns);
        this.showAnswer();
        this.parts.status.textContent =
            `The flight was timed in ${numberText(took / 1e3, 2)} s, frame ${
                this.setting.frame} in ${numberText(this.updates.at(-1), 2)} ms.`;
        this.latency.redraw();
      },
      refusals: (refusals) => {
        this.knobs.answers(refusals);
        document.body.dataset.ready = this.setting.fragment();
        this.onTimed?.(runs ? this.now : {failure: this.parts.failure.textContent});
      },
      failure: (text) => {
        this.fail(text);
        this.onTimed?.({failure: text});
      }
    });
  }
}

async function interactiveMain() {
  const data = JSON.parse(document.getElementById('data').textContent).interactive;
  const content = document.getElementById('content');
  content.append(element('p', {class: 'hint', id: 'status'}, 'Timing the recorded flight …'));
  try {
    const module = await WebAssembly.compile(await unpacked('engine'));
    const trace = await unpacked('trace');
    const film = document.getElementById('film') &&
        JSON.parse(new TextDecoder().decode(await unpacked('film')));
    const engine = new ReplayEngine(module);
    engine.load(trace, data.chip);
    window.page = new InteractivePage(data, engine, new Flights(module, trace, data.chip), film);
    window.page.begin();
  } catch (error) {
    content.replaceChildren(element(
        'p', {class: 'status-bad', role: 'alert'},
        `This page needs WebAssembly with tail calls (Chromium 112, Firefox 121 or later): ${error.message}`));
  }
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  addEventListener('resize', drawAll);
}

interactiveMain();
