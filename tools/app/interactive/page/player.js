// Plays the flight at the camera's pace: space plays and stops, arrows step. Frames that the page
// has no time to draw are left out.

class Player {
  /** @param setting  {frame, period_ns} @param select  (number) */
  constructor(frames, setting, select) {
    Object.assign(this, {frames, setting, select});
    this.button = element('button', {type: 'button', onclick: () => this.toggle()});
    this.stop();
    addEventListener('keydown', (event) => this.key(event));
  }

  stop() {
    clearTimeout(this.timer);
    this.timer = null;
    this.button.textContent = '▶ Play';
  }
  toggle() {
    if (this.timer) return this.stop();
    this.button.textContent = '❚❚ Stop';
    if (this.setting.frame === this.frames - 1) this.select(0);
    this.began = {at: performance.now(), frame: this.setting.frame};
    this.timer = setTimeout(() => this.tick());
  }
  tick() {
    const passed = (performance.now() - this.began.at) * 1e6 / this.setting.period_ns;
    const due = Math.min(this.frames - 1, this.began.frame + Math.floor(passed));
    if (due !== this.setting.frame) this.select(due);
    if (due === this.frames - 1) return this.stop();
    this.timer = setTimeout(() => this.tick(), 10);
  }
  step(by) {
    this.stop();
    this.select(Math.min(Math.max(this.setting.frame + by, 0), this.frames - 1));
  }

  /** Of the page as a whole: sliders, buttons and charts have keys of their own. */
  key(event) {
    if (event.target !== document.body || event.ctrlKey || event.altKey || event.metaKey) return;
    const act = {
      ' ': () => this.toggle(),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1)
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }
}

/** "frame 12 at 0.6 s, keyframe, pose tracked; map good; …". @param facts  columns of the frames */
function frameSentence(facts, words, i, latency_ns, period_ns) {
  const map = words.health.names[facts.health[i]].replace('_', ' ');
  const why = words.health.reasons.filter((_, bit) => (facts.health_reasons[i] >> bit) & 1);
  const source = words.sources[facts.source[i]] || facts.source[i];
  const time = latency_ns === undefined ? '' :
      `; ${numberText(ms(latency_ns), 3)} of ${numberText(ms(period_ns))} ms, ${
          latency_ns > period_ns ? 'late' : 'in time'}`;
  return `Frame ${i} at ${numberText(facts.t_s[i], 3)} s${facts.keyframe[i] ? ', keyframe' : ''}: pose ${
      source}, ${facts.features[i]} features, ${facts.world_matches[i]} matches with landmarks, ${
      facts.inliers[i]} inliers, ${facts.landmarks[i]} landmarks; map ${map}${
      why.length > 0 ? ` (${why.join(', ')})` : ''}${time}.`;
}
