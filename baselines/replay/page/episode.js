// ---- the episode: T states of N HAVs, as baselines/replay/web_page.py packs them ----------------------
const find = (id) => document.getElementById(id);
const episode = JSON.parse(find("episode").textContent);

function decode(text, kind) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = characters.charCodeAt(k);
  return new kind(bytes.buffer);
}

const steps = decode(episode.step, Int32Array);
const phases = decode(episode.phase, Int16Array);
const xs = decode(episode.x, Float32Array), ys = decode(episode.y, Float32Array);
// all axles of all HAVs in a row but the trucks' rear ones, from which the others are seen
const axles = decode(episode.axles, Int16Array);
const driving = decode(episode.driving, Float32Array);
const steerings = decode(episode.steering, Int16Array);
const evaded = decode(episode.evaded, Int16Array);
// x and y of one end, x and y of the other, of every obstacle
const segments = decode(episode.segments, Float32Array);
// the outline that each HAV has reserved in each state, or NEVER; empty if none ever does
const reserved = decode(episode.reserved, Int32Array), outlines = decode(episode.outlines, Int16Array);
const removed = decode(episode.removed, Uint8Array);
const OUTLINE_SIDES = 24;
const { dt, lengths, hitchOffsets, shapes, axleUnit, footprint, articulationMax, goals, first, hitStep } = episode;
const numRows = steps.length, numHavs = lengths.length, numGoals = goals[0].length;
const began = steps[0] * dt, duration = steps[numRows - 1] * dt;  // first and last time shown [s]
const unitsBefore = [0];
for (const units of lengths) unitsBefore.push(unitsBefore[unitsBefore.length - 1] + units.length);
const rowUnits = unitsBefore[numHavs];
const kinds = episode.events.map((kind, row) => ({ ...kind, row }));  // of events, see EVENTS
const NEVER = -1, DEGREES = 180 / Math.PI;
const LINE_WIDTH = 2.4;  // of a vehicle whose bodies are lines [m], as it is drawn
/** Return how wide a HAV is drawn [m]. */
const widthOf = (hav) => (shapes === null ? LINE_WIDTH : 2 * Math.max(...shapes[hav].map(([half]) => half)));

const happened = (step) => step !== NEVER && step * dt <= state.time + 1e-9;
const seconds = (time) => `${time.toFixed(1)} s`;
const clip = (value, low, high) => Math.min(Math.max(value, low), high);
const wrap = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

/** Return the last row whose state is not later than a time [s]. */
function rowAt(time) {
  let low = 0, high = numRows - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (steps[middle] * dt <= time + 1e-9) low = middle; else high = middle - 1;
  }
  return low;
}

/** Return where a HAV's axles are, seen from its truck's rear axle, between two rows. */
function offsetsOf(hav, row, share = 0) {
  const next = Math.min(row + 1, numRows - 1), width = 2 * rowUnits;
  const between = (at) => {
    const from = axles[row * width + at];
    return axleUnit[hav] * (from + share * (axles[next * width + at] - from));
  };
  const points = lengths[hav].map((_, k) => {
    const at = 2 * (unitsBefore[hav] + k);
    return [between(at), between(at + 1)];
  });
  points.splice(1, 0, [0, 0]);  // from front to rear
  return points;
}

/** Return where the front ends of a HAV's units are, and where these head [rad], given its axles. */
function unitsOf(hav, points) {
  const fronts = [points[0]], angles = [];
  points.slice(1).forEach(([x, y], unit) => {
    const [fx, fy] = fronts[unit], angle = Math.atan2(fy - y, fx - x), offset = hitchOffsets[hav][unit];
    angles.push(angle);
    fronts.push(offset === 0 ? [x, y] : [x - offset * Math.cos(angle), y - offset * Math.sin(angle)]);
  });
  fronts.pop();  // nothing is hitched to the last one
  return { fronts, angles };
}

/** Return where axles and hitches of a HAV are and where its units head, between two rows. */
function poseOf(hav, row, share) {
  const next = Math.min(row + 1, numRows - 1);
  const between = (values) => {
    const from = values[row * numHavs + hav];
    return from + share * (values[next * numHavs + hav] - from);
  };
  const x = between(xs), y = between(ys), offsets = offsetsOf(hav, row, share);
  const { fronts, angles } = unitsOf(hav, offsets), move = ([dx, dy]) => [x + dx, y + dy];
  const pose = { x, y, angles, points: offsets.map(move), fronts: fronts.map(move) };
  return { ...pose, corners: shapes === null ? null : cornersOf(hav, pose) };
}

/** Return the line through axles and hitches of a HAV, from front to rear. */
const lineOf = (hav, { points, fronts }) => points.flatMap((point, k) => (
  k > 0 && k < fronts.length && hitchOffsets[hav][k - 1] !== 0 ? [point, fronts[k]] : [point]));

/** Return the corners of a HAV's bodies, each unit's from its rear right one on. */
function cornersOf(hav, pose) {
  return pose.angles.map((angle, unit) => {
    const [half, front, rear] = shapes[hav][unit], [x, y] = pose.fronts[unit];
    const [cosine, sine] = [Math.cos(angle), Math.sin(angle)], behind = -lengths[hav][unit] - rear;
    const corners = [[behind, -half], [front, -half], [front, half], [behind, half]];
    return corners.map(([along, left]) => [x + along * cosine - left * sine, y + along * sine + left * cosine]);
  });
}

/** Return all articulations of a HAV [rad], that of joint k at k - 1. */
function articulations(hav, row) {
  const { angles } = unitsOf(hav, offsetsOf(hav, row));
  return angles.slice(1).map((angle, k) => wrap(angle - angles[k]));
}

const hasHad = (hav, kind) => happened(first[hav][kind.row][0]);
const harmsOf = (hav) => kinds.filter((kind) => kind.harm && hasHad(hav, kind));
const isWaiting = (hav, phase) => happened(hitStep[hav][phase]);
const hasArrived = (hav) => isWaiting(hav, numGoals - 1);
/** Tell whether the episode ended because its time was up: not all HAVs had arrived. */
const timeWasUp = steps[numRows - 1] >= episode.maxSteps
  && hitStep.some((own, hav) => own[numGoals - 1] === NEVER && !removed[(numRows - 1) * numHavs + hav]);
