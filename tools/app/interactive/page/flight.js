// Whole flights, timed in a worker so that the page stays quick. One flight at a time: a new one ends
// the one before with its worker.

/** The worker's side. */
function serveFlights() {
  let engine = null;
  let frames = [];
  let sent = 0;
  function send() {
    if (frames.length > 0) postMessage({frames});
    frames = [];
    sent = performance.now();
  }
  onmessage = ({data}) => {
    if (data.module) {
      engine = new ReplayEngine(data.module, (number, latency) => {
        frames.push([number, latency]);
        if (performance.now() - sent > 50) send();
      });
      engine.load(data.trace, data.chip);
      return;
    }
    try {
      if (data.lines) {
        const started = performance.now();
        engine.set(data.lines);
        const outcome = engine.flight();
        send();
        postMessage({outcome, ms: performance.now() - started});
      }
      postMessage({refusals: data.questions.map((lines) => engine.refusal(lines))});
    } catch (error) {
      postMessage({failure: error.message});
    }
  };
}

class Flights {
  constructor(module, trace, chip) {
    this.load = {module, trace, chip};
    const source = `${ReplayEngine}\n(${serveFlights})();`;
    this.url = URL.createObjectURL(new Blob([source], {type: 'text/javascript'}));
    this.busy = false;
    this.worker = null;
  }

  /**
   * @param lines  the setting; null for questions alone
   * @param questions  settings of which it is asked whether they can run, once a flight is over
   * @param on  {frames: ([[number, latency]]), outcome: (outcome, ms), refusals, failure}
   */
  start(lines, questions, on) {
    if (this.busy || !this.worker) {
      if (this.worker) this.worker.terminate();
      this.worker = new Worker(this.url);
      this.worker.postMessage(this.load);
    }
    this.busy = true;
    this.worker.onmessage = ({data}) => {
      if (data.refusals || data.failure) this.busy = false;
      if (data.frames) on.frames(data.frames);
      if (data.outcome) on.outcome(data.outcome, data.ms);
      if (data.refusals) on.refusals(data.refusals);
      if (data.failure) on.failure(data.failure);
    };
    this.worker.onerror = (event) => on.failure(event.message);
    this.worker.postMessage({lines, questions});
  }
}
