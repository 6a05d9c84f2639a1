// What comes out: verdicts and figures beside the recorded ones, and a sentence of what changed and
// why.

const kGradeOrder = ['good', 'unknown', 'doubtful', 'bad'];

function verdictsOf(outcome) {
  const list = outcome.verdicts.map((v) => ({...v, reason: v.reasons.join(', ')}));
  const grade = kGradeOrder[Math.max(0, ...list.map((v) => kGradeOrder.indexOf(v.grade)))];
  return verdictCard({verdict: {grade, list, why: null}});
}

const ms = (ns) => ns / 1e6;

/** "as recorded 10.4 (−3 %)" */
function against(now, recorded) {
  if (recorded === null || recorded === undefined) return '';
  const change = recorded === 0 ? null : 100 * (now / recorded - 1);
  const text = `as recorded ${numberText(recorded, 4)}`;
  return change === null || Math.abs(change) < 0.05 ? text : `${text} (${signed(change, 2)} %)`;
}

/** Frames whose time from the camera to the pose is longer than the camera's period. */
function lateFrames(latencies, period_ns) {
  return latencies.filter((latency) => latency > period_ns).length;
}

function answerTiles(now, recorded, area, recordedArea) {
  const tile = (title, of, unit, scale = 1) => {
    const [value, before] = [of(now), of(recorded)].map((v) => (v === null ? null : v * scale));
    return {title, value: numberText(value, 4), unit, share: null, note: against(value, before)};
  };
  const statistic = (name) => (outcome) => outcome.statistics[name] ?? null;
  return tiles({
    figures: [
      tile('Mean frame', statistic('frame.time.mean'), 'ms', 1e-6),
      tile('99 of 100 frames', statistic('frame.time.p99'), 'ms', 1e-6),
      tile('Worst frame', statistic('frame.time.worst'), 'ms', 1e-6),
      tile('Late, with waiting', (outcome) => outcome.late, `of ${now.frames}`),
      tile('Energy a frame', statistic('energy.frame'), 'mJ'), {
        title: 'Area',
        value: numberText(area, 4),
        unit: 'mm²',
        share: null,
        note: against(area, recordedArea)
      }
    ]
  });
}

/** Time of a stage in ms, by mechanism. */
function stageTimes(outcome) {
  return outcome.stages.map((stage) => {
    const scale = 1e3 / (stage.controller ? outcome.controller_hz : outcome.cluster_hz);
    return {
      name: stage.name,
      controller: stage.controller,
      ms: stage.cycles * scale,
      parts: Object.fromEntries(
          Object.entries(stage.parts).map(([key, cycles]) => [key, cycles * scale]))
    };
  });
}

/** [{stage, mechanism, ms}] of the front end, what changed most first. */
function changesOf(now, recorded) {
  const before = new Map(stageTimes(recorded).map((stage) => [stage.name, stage.parts]));
  const changes = new Map();
  for (const stage of stageTimes(now)) {
    if (stage.controller) continue;
    const old = before.get(stage.name) || {};
    for (const key of new Set([...Object.keys(stage.parts), ...Object.keys(old)])) {
      const change = changes.get(key) || {mechanism: key, ms: 0, stage: '', most: 0};
      const by = (stage.parts[key] || 0) - (old[key] || 0);
      change.ms += by;
      if (Math.abs(by) > Math.abs(change.most)) Object.assign(change, {stage: stage.name, most: by});
      changes.set(key, change);
    }
  }
  return [...changes.values()].sort((a, b) => Math.abs(b.ms) - Math.abs(a.ms));
}

/** @param mechanisms  key → {meaning} */
function sentence(setting, now, recorded, mechanisms) {
  if (setting.isRecorded) return 'The chip and the camera are as recorded: move a slider.';
  const [time, before] = [now, recorded].map((o) => ms(o.statistics['frame.time.mean']));
  const by = time - before;
  const names = setting.names();
  const what = names.length > 3 ? `${names.length} settings` : names.join(', ');
  if (Math.abs(by) < 5e-4)
    return `With ${what}, frame ${setting.frame} takes as long as recorded, ${numberText(time)} ms.`;
  const why = changesOf(now, recorded)
                  .filter((change) => Math.abs(change.ms) > 0.1 * Math.abs(by))
                  .slice(0, 2)
                  .map((change) => `${(mechanisms[change.mechanism] || {}).meaning || change.mechanism} ${
                           signed(change.ms, 2)} ms, most in ${change.stage}`);
  return `With ${what}, frame ${setting.frame} takes ${numberText(time)} ms instead of ${
      numberText(before)}${why.length > 0 ? `: ${why.join('; ')}` : ''}.`;
}
