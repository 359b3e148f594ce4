// ---- drawing ---------------------------------------------------------------------------------
let density = 1;
const flat = () => ctx.setTransform(density, 0, 0, density, 0, 0);

/** Make the canvas speak metres forward and to the left of a pose. */
function enter(x, y, heading) {
  const [px, py] = onScreen(x, y), k = density * view.scale;
  const cosine = k * Math.cos(heading), sine = k * Math.sin(heading);
  ctx.setTransform(cosine, -sine, -sine, -cosine, density * px, density * py);
}

function draw() {
  [view.width, view.height, density] = fitCanvas(plane, ctx);
  const row = rowAt(state.time), next = Math.min(row + 1, numRows - 1);
  const span = (steps[next] - steps[row]) * dt;
  const share = span > 0 ? clip((state.time - steps[row] * dt) / span, 0, 1) : 0;
  const poses = lengths.map((_, hav) => poseOf(hav, row, share));
  if (state.follow && state.selected !== null) {
    view.x = poses[state.selected].x;
    view.y = poses[state.selected].y;
    view.fitted = false;
  }
  ctx.fillStyle = theme.ground;
  ctx.fillRect(0, 0, view.width, view.height);
  ctx.lineCap = ctx.lineJoin = "round";
  drawGrid();
  const order = poses.map((_, hav) => hav).filter((hav) => !removed[row * numHavs + hav]);
  if (order.includes(state.selected)) {
    order.splice(order.indexOf(state.selected), 1);
    order.push(state.selected);  // on top of the others
  }
  const overlap = findOverlaps(poses, order);
  if (layers.reserved) for (const hav of order) drawReserved(hav, row);
  if (layers.footprints) for (const hav of order) drawFootprint(hav, poses[hav], overlap[hav]);
  if (layers.trails) for (const hav of order) drawTrail(hav, row, poses[hav]);
  for (const hav of order) drawGoal(hav, phases[row * numHavs + hav], poses[hav]);
  state.vehiclesDrawn = 0;
  for (const hav of order) {
    if (!isVisible(poses[hav])) continue;
    drawVehicle(hav, poses[hav], steerings[row * numHavs + hav] / 1e4);
    state.vehiclesDrawn++;
  }
  drawSegments();
  for (const hav of order) drawEvasion(hav, evaded[row * numHavs + hav], poses);
  if (layers.numbers && numHavs > 1) for (const hav of order) drawNumber(hav, poses[hav]);
  flat();
  drawScale();
  if (state.selected !== null) { drawChart(); showFigures(row, poses[state.selected]); }
  current = { row, poses };
}
let current = null;

/** Return the round number (1, 2 or 5 times a power of ten) that is next above a number. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= value * (1 - 1e-9));
}

function drawGrid() {
  const pitch = roundUp(60 / view.scale);
  const [left, high] = onPlane(0, 0), [right, low] = onPlane(view.width, view.height);
  ctx.strokeStyle = theme.grid;
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (let x = Math.ceil(left / pitch) * pitch; x <= right; x += pitch) {
    const px = Math.round(onScreen(x, 0)[0]) + 0.5;
    ctx.moveTo(px, 0); ctx.lineTo(px, view.height);
  }
  for (let y = Math.ceil(low / pitch) * pitch; y <= high; y += pitch) {
    const py = Math.round(onScreen(0, y)[1]) + 0.5;
    ctx.moveTo(0, py); ctx.lineTo(view.width, py);
  }
  ctx.stroke();
}

function drawScale() {
  const length = roundUp(60 / view.scale), width = length * view.scale, y = view.height - 18;
  ctx.strokeStyle = ctx.fillStyle = theme.text;
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  ctx.moveTo(16, y - 5); ctx.lineTo(16, y); ctx.lineTo(16 + width, y); ctx.lineTo(16 + width, y - 5);
  ctx.stroke();
  ctx.font = "12px system-ui, sans-serif";
  ctx.textAlign = "center";
  ctx.textBaseline = "alphabetic";
  outlined(`${length} m`, 16 + width / 2, y - 6, theme.text);
}

function outlined(text, x, y, color) {
  ctx.lineWidth = 3;
  ctx.strokeStyle = theme.ground;
  ctx.strokeText(text, x, y);
  ctx.fillStyle = color;
  ctx.fillText(text, x, y);
}

/** Tell of each HAV whether its footprint overlaps another's now: a potential collision. */
function findOverlaps(poses, present) {
  const overlap = new Array(numHavs).fill(false);
  for (const i of present) {
    for (const k of present) {
      if (k <= i) continue;
      const distance = Math.hypot(poses[i].x - poses[k].x, poses[i].y - poses[k].y);
      if (distance <= footprint[i] + footprint[k]) overlap[i] = overlap[k] = true;
    }
  }
  return overlap;
}

function drawFootprint(hav, pose, overlaps) {
  const [px, py] = onScreen(pose.x, pose.y), radius = footprint[hav] * view.scale;
  flat();
  ctx.beginPath();
  ctx.arc(px, py, radius, 0, 2 * Math.PI);
  const chosen = hav === state.selected;
  const strength = numHavs > 12 && !chosen ? 0.4 : 1;
  ctx.strokeStyle = ctx.fillStyle = colorOf(hav);
  ctx.globalAlpha = strength * (overlaps ? 0.09 : 0.035);
  ctx.fill();
  ctx.globalAlpha = strength * (overlaps ? 0.95 : 0.5);
  ctx.lineWidth = overlaps ? 1.75 : 1;
  ctx.setLineDash(overlaps ? [] : [4, 4]);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.globalAlpha = 1;
}

/** Return the number of the outline that a HAV has reserved in a row, NEVER for none. */
const outlineAt = (hav, row) => (reserved.length === 0 ? NEVER : reserved[row * numHavs + hav]);

/** Draw the area that a HAV has reserved. */
function drawReserved(hav, row) {
  const number = outlineAt(hav, row), chosen = hav === state.selected;
  if (number === NEVER) return;
  flat();
  ctx.beginPath();
  for (let corner = number * OUTLINE_SIDES; corner < (number + 1) * OUTLINE_SIDES; corner++) {
    const [x, y] = [outlines[2 * corner], outlines[2 * corner + 1]];
    ctx.lineTo(...onScreen(episode.outlineUnit * x, episode.outlineUnit * y));
  }
  ctx.closePath();
  ctx.fillStyle = ctx.strokeStyle = colorOf(hav);
  ctx.globalAlpha = chosen ? 0.2 : 0.11;
  ctx.fill();
  ctx.globalAlpha = chosen ? 1 : 0.65;
  ctx.lineWidth = chosen ? 2 : 1.25;
  ctx.stroke();
  ctx.globalAlpha = 1;
}

function tracePath(hav, from, to, most) {
  // the same rows again in the next frame: a path that grows must not flicker
  const stride = 2 ** Math.ceil(Math.log2(Math.max(1, (to - from) / most)));
  ctx.beginPath();
  for (let row = Math.ceil(from / stride) * stride; row <= to; row += stride) {
    ctx.lineTo(...onScreen(xs[row * numHavs + hav], ys[row * numHavs + hav]));
  }
}

/** Draw where the truck's rear axle went: the last two minutes strongly, before that faintly. */
function drawTrail(hav, row, pose) {
  flat();
  ctx.strokeStyle = colorOf(hav);
  const chosen = hav === state.selected;
  const few = numHavs <= 12;
  if (few || chosen) {
    tracePath(hav, 0, row, 3000);
    ctx.lineTo(...onScreen(pose.x, pose.y));
    ctx.lineWidth = 1;
    ctx.globalAlpha = chosen ? 0.55 : 0.3;
    ctx.stroke();
  }
  const pieces = 5, seconds = few || chosen ? 120 : 60;
  for (let piece = 0; piece < pieces; piece++) {
    const from = rowAt(state.time - seconds * (1 - piece / pieces));
    const to = Math.min(rowAt(state.time - seconds * (1 - (piece + 1) / pieces)), row);
    if (to <= from && piece < pieces - 1) continue;
    tracePath(hav, from, to, 300);
    if (piece === pieces - 1) ctx.lineTo(...onScreen(pose.x, pose.y));
    ctx.lineWidth = chosen ? 2.5 : 2;
    ctx.globalAlpha = 0.12 + 0.09 * piece;
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

/** Trace a truck that points ahead; with a rectangle for its body, that, and the point inside. */
function traceGoal(hav, length, half) {
  const [rear, shoulder, nose] = shapes === null ? [-0.12 * length, 0.72 * length, 1.12 * length]
    : [-shapes[hav][0][2], length + shapes[hav][0][1] - half, length + shapes[hav][0][1]];
  ctx.beginPath();
  if (shapes !== null) ctx.rect(rear, -half, nose - rear, 2 * half);
  ctx.moveTo(rear, -half);
  ctx.lineTo(shoulder, -half);
  ctx.lineTo(nose, 0);
  ctx.lineTo(shoulder, half);
  ctx.lineTo(rear, half);
  ctx.closePath();
}

/** Draw a goal as the truck that should stand there, its rear axle on the cross. */
function drawGoal(hav, phase, pose) {
  const [x, y, heading] = goals[hav][phase], chosen = hav === state.selected;
  const pixel = 1 / view.scale, reached = isWaiting(hav, phase);
  const length = Math.max(lengths[hav][0], 15 * pixel), half = Math.max(widthOf(hav), 7 * pixel) / 2;
  if (chosen && !reached) {
    flat();
    ctx.beginPath();
    ctx.moveTo(...onScreen(pose.x, pose.y));
    ctx.lineTo(...onScreen(x, y));
    ctx.strokeStyle = colorOf(hav);
    ctx.globalAlpha = 0.6;
    ctx.lineWidth = 1;
    ctx.setLineDash([2, 5]);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }
  enter(x, y, heading);
  ctx.strokeStyle = ctx.fillStyle = colorOf(hav);
  ctx.lineWidth = (chosen ? 2.5 : 1.75) * pixel;
  traceGoal(hav, length, half);
  ctx.globalAlpha = reached ? 0.3 : 0.08;
  ctx.fill();
  ctx.globalAlpha = 1;
  ctx.stroke();
  const arm = 0.7 * half;
  ctx.beginPath();
  ctx.moveTo(-arm, 0); ctx.lineTo(arm, 0); ctx.moveTo(0, -arm); ctx.lineTo(0, arm);
  ctx.lineWidth = 1.25 * pixel;
  ctx.stroke();
  flat();
  if (layers.numbers && numHavs > 1) {
    const away = 13 + half * view.scale, [px, py] = onScreen(x, y);
    ctx.font = "600 11px system-ui, sans-serif";
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    outlined(hav, px + away * Math.sin(heading), py + away * Math.cos(heading), colorOf(hav));
  }
}
