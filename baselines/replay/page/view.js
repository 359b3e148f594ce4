// ---- what can change -------------------------------------------------------------------------
const state = {
  time: began, playing: false, speed: episode.speed, selected: null, follow: false, vehiclesDrawn: 0,
};
const view = { x: 0, y: 0, scale: 1, width: 0, height: 0, fitted: true };  // scale: pixels per m
const layers = { reserved: true, footprints: true, trails: true, numbers: true };
let stale = true, wanted = false;

function refresh() {
  stale = true;
  if (!wanted) { wanted = true; requestAnimationFrame(frame); }
}

let before = null;
function frame(now) {
  wanted = false;
  if (state.playing) {
    // a page that was hidden must not jump
    const passed = before === null ? 0 : Math.min((now - before) / 1000, 0.1);
    before = now;
    state.time = Math.min(state.time + passed * state.speed, duration);
    if (state.time >= duration) setPlaying(false);
    stale = true;
  }
  if (stale) { stale = false; draw(); showTime(); }
  if (state.playing && !wanted) { wanted = true; requestAnimationFrame(frame); }
}

function setPlaying(playing) {
  if (playing && state.time >= duration) state.time = began;
  state.playing = playing;
  before = null;
  find("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  find("play").querySelector("path").setAttribute(
    "d", playing ? "M1 0 H5 V14 H1 Z M9 0 H13 V14 H9 Z" : "M2 0 L13 7 L2 14 Z");
  refresh();
}

function seek(time) { state.time = clip(time, began, duration); refresh(); }

function select(hav) {
  state.selected = hav;
  if (hav === null) state.follow = find("follow").checked = false;
  find("details").hidden = hav === null;
  chartOf = null;
  buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k === hav)));
  if (hav !== null) {
    find("chip").textContent = hav;
    find("chip").style.background = paintOf(hav);
    find("name").textContent = `HAV ${hav}`;
    const list = find("havs").querySelector("ul"), { offsetTop: top, offsetHeight: height } = buttons[hav].parentElement;
    list.scrollTop = clip(list.scrollTop, top + height - list.clientHeight, top);
    // where a button of the panel was pressed, the panel must not move away
    if (!document.activeElement.closest("aside")) find("details").scrollIntoView({ block: "nearest" });
  }
  refresh();
}

// ---- the view: y up, metres to pixels --------------------------------------------------------
const plane = find("plane"), ctx = plane.getContext("2d");
const onScreen = (x, y) => [
  view.width / 2 + (x - view.x) * view.scale, view.height / 2 - (y - view.y) * view.scale];
const onPlane = (px, py) => [
  view.x + (px - view.width / 2) / view.scale, view.y - (py - view.height / 2) / view.scale];

const NEARBY = 8;  // m
const bounds = (() => {
  const box = [Infinity, -Infinity, Infinity, -Infinity];
  const include = (x, y, margin) => {
    box[0] = Math.min(box[0], x - margin); box[1] = Math.max(box[1], x + margin);
    box[2] = Math.min(box[2], y - margin); box[3] = Math.max(box[3], y + margin);
  };
  for (let hav = 0; hav < numHavs; hav++) {
    const truck = lengths[hav][0];
    for (let row = 0; row < numRows; row++) include(xs[row * numHavs + hav], ys[row * numHavs + hav], truck);
    for (const [x, y] of goals[hav]) include(x, y, truck);
    const { points, corners } = poseOf(hav, 0, 0);
    for (const [x, y] of corners === null ? points : corners.flat()) include(x, y, 1);
  }
  const [left, right, low, high] = box;
  for (let at = 0; at < segments.length; at += 2) {  // ends of obstacles, where they are near
    const x = segments[at], y = segments[at + 1];
    if (x > left - NEARBY && x < right + NEARBY && y > low - NEARBY && y < high + NEARBY) include(x, y, 0);
  }
  return box;
})();

function fit() {
  const [left, right, low, high] = bounds;
  const margin = (size) => clip(0.07 * size, 12, 56);
  // on narrow screens the check boxes are below the buttons, and must cover nothing
  const boxes = find("layers").getBoundingClientRect().bottom - plane.getBoundingClientRect().top;
  const below = margin(view.height), above = Math.max(below, boxes + 6);
  view.scale = Math.min(
    Math.max(view.width - 2 * margin(view.width), 20) / (right - left),
    Math.max(view.height - above - below, 20) / (high - low), 40);
  view.x = (left + right) / 2;
  view.y = (low + high) / 2 + (above - below) / 2 / view.scale;
  view.fitted = true;
  refresh();
}

function zoom(factor, px = view.width / 2, py = view.height / 2) {
  const [x, y] = onPlane(px, py);
  view.scale = clip(view.scale * factor, 1e-3, 400);
  view.x = x - (px - view.width / 2) / view.scale;
  view.y = y + (py - view.height / 2) / view.scale;
  view.fitted = false;
  refresh();
}

function fitCanvas(canvas, context) {
  const { clientWidth: width, clientHeight: height } = canvas, density = devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== columns || canvas.height !== rows) {
    canvas.width = columns;
    canvas.height = rows;
  }
  context.setTransform(density, 0, 0, density, 0, 0);
  return [width, height, density];
}
