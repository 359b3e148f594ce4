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
const removed = decode(episode.removed, Uint8Array);
const { dt, lengths, axleUnit, footprint, articulationMax, goals, first, hitStep } = episode;
const numRows = steps.length, numHavs = lengths.length, numGoals = goals[0].length;
const duration = steps[numRows - 1] * dt;
const unitsBefore = [0];
for (const units of lengths) unitsBefore.push(unitsBefore[unitsBefore.length - 1] + units.length);
const rowUnits = unitsBefore[numHavs];
const kinds = episode.events.map((kind, row) => ({ ...kind, row }));  // of events, see EVENTS
const NEVER = -1, DEGREES = 180 / Math.PI;
const WIDTH = 2.4;  // of a vehicle [m]; the simulator's have none

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

/** Return where units head that reach from each of some points to the next [rad]. */
const headingsOf = (points) => points.slice(1).map(
  ([x, y], unit) => Math.atan2(points[unit][1] - y, points[unit][0] - x));

/** Return where the axles of a HAV are and where its units head, between two rows. */
function poseOf(hav, row, share) {
  const next = Math.min(row + 1, numRows - 1);
  const between = (values) => {
    const from = values[row * numHavs + hav];
    return from + share * (values[next * numHavs + hav] - from);
  };
  const x = between(xs), y = between(ys), offsets = offsetsOf(hav, row, share);
  const points = offsets.map(([dx, dy]) => [x + dx, y + dy]);
  return { x, y, angles: headingsOf(offsets), points };
}

/** Return all articulations of a HAV [rad], that of joint k at k - 1. */
function articulations(hav, row) {
  const angles = headingsOf(offsetsOf(hav, row));
  return angles.slice(1).map((angle, k) => wrap(angle - angles[k]));
}

const hasHad = (hav, kind) => happened(first[hav][kind.row][0]);
const harmsOf = (hav) => kinds.filter((kind) => kind.harm && hasHad(hav, kind));
const isWaiting = (hav, phase) => happened(hitStep[hav][phase]);
