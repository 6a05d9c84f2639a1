// The picture of the selected frame, with what became of its features drawn over it. Left out: frames
// of runs without --film, which have none.

/** By the names that the film has for them, from what is drawn first. */
const kFeatureKinds = {
  detected: {label: 'only detected', backgroundColor: '#b4bcc6'},
  matched: {label: 'matched with the last keyframe', backgroundColor: kSeriesPalette[4]},
  agrees: {label: 'landmark, agrees with the pose', backgroundColor: '#3ddc97'},
  new: {label: 'new landmark', backgroundColor: '#ffd23f'},
  rejected: {label: 'landmark, rejected', backgroundColor: '#ff6b4a'}
};

/** [[x, y, x before, y before]], as shares of the image. */
function featuresOf(frame, kind) {
  const bytes = Uint8Array.from(atob(frame.features[kind]), (c) => c.charCodeAt(0));
  const each = kind === 'detected' ? 2 : 4;
  return Array.from({length: bytes.length / each},
                    (_, i) => [...bytes.subarray(each * i, each * (i + 1))].map((b) => b / 256));
}

/** @param film  [{image, features}] of all frames @param state  {frame} */
function filmFigure(film, state) {
  const hidden = new Set();
  const canvas = element('canvas', {role: 'img'});
  const legend = element('div');
  const figure = element(
      'figure', {class: 'card film'},
      element('figcaption', {}, element('h3', {}, 'What the camera saw')), legend, canvas);
  const picture = new Image();

  function draw() {
    const frame = film[state.frame];
    const width = canvas.width = 2 * canvas.clientWidth;
    const height = canvas.height = Math.round(width * picture.naturalHeight / picture.naturalWidth);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0, width, height);
    context.lineWidth = width / 400;
    const counts = [];
    for (const [kind, {label, backgroundColor}] of Object.entries(kFeatureKinds)) {
      const features = featuresOf(frame, kind);
      counts.push(`${features.length} ${label}`);
      if (hidden.has(label)) continue;
      context.strokeStyle = context.fillStyle = backgroundColor;
      context.beginPath();
      for (const [x, y, xBefore = x, yBefore = y] of features) {
        context.rect(width * x - 3, height * y - 3, 6, 6);
        context.moveTo(width * x, height * y);
        context.lineTo(width * xBefore, height * yBefore);
      }
      context.stroke();
    }
    canvas.setAttribute('aria-label', `Frame ${state.frame}: ${counts.join(', ')}`);
  }
  async function redraw() {
    picture.src = `data:image/jpeg;base64,${film[state.frame].image}`;
    try {
      await picture.decode();
      draw();
    } catch {
      // another frame was selected meanwhile
    }
  }
  function toggle() {
    legend.replaceChildren(legendFor(null, Object.values(kFeatureKinds), hidden, toggle));
    redraw();
  }
  charts.push({figure, draw: () => figure.isConnected && toggle()});
  return Object.assign(figure, {redraw});
}
