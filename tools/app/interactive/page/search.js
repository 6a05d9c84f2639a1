// The smallest chip that is never late, round by round. A round times each change of the present
// setting alone on the slowest frames, takes the effects of changes to add up, and flies the least
// area that should be in time. The next round begins from there, until nothing new comes.
//
// Left out: the camera, which is asked for, and accelerators whose area is not known.

const kFramesTried = 3;
const kMostRounds = 6;

/**
 * The least area among sums of one choice each that take no more time; undefined if there is none.
 * @param choices  a list for each slider: [{area, ns, …}], differences
 */
function smallestSum(choices, ns) {
  let front = [{area: 0, ns: 0, picks: []}];  // more area, less time
  for (const list of choices) {
    const sums = front.flatMap((sum) => list.map((choice) => ({
      area: sum.area + choice.area,
      ns: sum.ns + choice.ns,
      picks: [...sum.picks, choice]
    })));
    let least = Infinity;
    front = sums.sort((a, b) => a.area - b.area || a.ns - b.ns).filter((sum) => {
      const better = sum.ns < least;
      least = Math.min(least, sum.ns);
      return better;
    });
  }
  return front.find((sum) => sum.ns <= ns);
}

/** What single changes of the present setting do to its slowest frames. */
class SingleChanges {
  /** @param latencies  of the flight with the setting, in ns */
  constructor(setting, engine, latencies) {
    this.setting = setting;
    this.engine = engine;
    this.frames = latencies.map((_, number) => number)
                      .sort((a, b) => latencies[b] - latencies[a])
                      .slice(0, kFramesTried);
    this.base = this.measured(setting.lines());
  }

  /** {area, ns} of the slowest frame; null of what cannot run. */
  measured(lines) {
    try {
      const area = this.engine.set(lines).area_mm2;
      const times = this.frames.map(
          (number) => this.engine.frame(number).statistics['frame.time.worst']);
      return {area, ns: Math.max(...times)};
    } catch {
      return null;
    }
  }
  /** Differences that each of some changes makes, and none. @param changes  as Setting::lines() takes them */
  differences(changes) {
    const measured = changes.map((change) => ({change, to: this.measured(this.setting.lines(change))}));
    return [{area: 0, ns: 0}, ...measured.filter(({to}) => to).map(
        ({change, to}) => ({area: to.area - this.base.area, ns: to.ns - this.base.ns, change}))];
  }
}

/** Moves the sliders of a page, and says what it found. Ends when somebody else moves one. */
async function findSmallest(page) {
  const {setting} = page;
  const {knobs, switches} = setting.data;
  const isMine = page.startSearch();
  const stateOf = () => ({at: [...setting.at], on: [...setting.on]});
  const start = stateOf();
  let best = page.now.late === 0 ? {...start, area: page.area} : null;
  const seen = new Set([String(setting.lines())]);
  const apart = new Set();  // values that do not go with others
  for (let round = 1; round <= kMostRounds; ++round) {
    const singles = new SingleChanges(setting, page.engine, page.state.latencies);
    const changes = [
      ...knobs.map((knob, i) => `${knob.path}=` === kCamera ? [] : knob.values.map((_, at) => ({knob: [i, at]}))
          .filter(({knob: [, at]}) => at !== setting.at[i] && page.knobs.can(i, at) && !apart.has(`${i} ${at}`))),
      ...switches.map((_, i) => [{switch: [i, !setting.on[i]]}])
    ];
    const choices = [];
    for (const [i, list] of changes.entries()) {
      page.say(`Round ${round}: trying ${(knobs[i] || {}).path || 'accelerators'} …`);
      await new Promise((done) => setTimeout(done));
      if (!isMine()) return;
      const differences = singles.differences(list);
      const isFree = i >= knobs.length && differences.every(({area}) => area === 0);
      choices.push(isFree ? differences.slice(0, 1) : differences);
    }
    const found = smallestSum(choices, setting.period_ns - singles.base.ns);
    if (!found) break;
    const before = stateOf();
    const picks = found.picks.map(({change}) => change).filter(Boolean);
    for (const {knob, switch: one} of picks) {
      if (knob) setting.at[knob[0]] = knob[1];
      if (one) setting.on[one[0]] = one[1];
    }
    if (seen.has(String(setting.lines()))) break;
    seen.add(String(setting.lines()));
    const outcome = await page.timed();
    if (!isMine()) return;
    if (outcome.failure) {  // names the sliders that do not go together
      const named = picks.filter(({knob}) => knob && outcome.failure.includes(knobs[knob[0]].path));
      if (named.length === 0) break;
      named.forEach(({knob}) => apart.add(knob.join(' ')));
      Object.assign(setting, before);
    } else if (outcome.late === 0 && !(best && best.area <= page.area)) {
      best = {...stateOf(), area: page.area};
    }
  }
  Object.assign(setting, best ? {at: best.at, on: best.on} : start);
  await page.timed();
  if (!isMine()) return;
  page.say(best ? `The smallest chip found that is never late: ${numberText(best.area)} mm².` :
                  'No chip was found that is never late.');
}
