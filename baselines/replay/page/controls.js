// ---- what the user does ----------------------------------------------------------------------
find("play").onclick = () => setPlaying(!state.playing);
find("scrub").oninput = () => seek(+find("scrub").value);
find("speed").onchange = () => { state.speed = +find("speed").value; };
find("fit").onclick = () => { state.follow = find("follow").checked = false; fit(); };
find("closer").onclick = () => zoom(1.4);
find("farther").onclick = () => zoom(1 / 1.4);
find("deselect").onclick = () => { select(null); plane.focus(); };
find("follow").onchange = () => { state.follow = find("follow").checked; refresh(); };
for (const layer of Object.keys(layers)) {
  find(layer).onchange = () => { layers[layer] = find(layer).checked; refresh(); };
}

plane.addEventListener("wheel", (event) => {
  event.preventDefault();
  const pixels = event.deltaY * (event.deltaMode === 1 ? 20 : 1);
  zoom(Math.exp(-0.0016 * pixels), event.offsetX, event.offsetY);
}, { passive: false });

const fingers = new Map();  // pointers that are down, and where
let moved = 0;
plane.addEventListener("pointerdown", (event) => {
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  plane.setPointerCapture(event.pointerId);
  if (fingers.size === 1) moved = 0;
});
plane.addEventListener("pointermove", (event) => {
  if (!fingers.has(event.pointerId)) return;
  const [px, py] = fingers.get(event.pointerId), [nx, ny] = [event.offsetX, event.offsetY];
  fingers.set(event.pointerId, [nx, ny]);
  moved += Math.hypot(nx - px, ny - py);
  if (moved < 4) return;  // a click that trembles
  plane.classList.add("dragging");
  if (fingers.size === 2) {
    const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    const [was, is] = [Math.hypot(px - other[0], py - other[1]), Math.hypot(nx - other[0], ny - other[1])];
    if (was > 0 && is > 0) zoom(is / was, (nx + other[0]) / 2, (ny + other[1]) / 2);
  }
  view.x -= (nx - px) / view.scale / fingers.size;
  view.y += (ny - py) / view.scale / fingers.size;
  view.fitted = false;
  state.follow = find("follow").checked = false;
  refresh();
});
for (const end of ["pointerup", "pointercancel"]) {
  plane.addEventListener(end, (event) => {
    const clicked = fingers.delete(event.pointerId) && fingers.size === 0 && moved < 4;
    plane.classList.remove("dragging");
    if (clicked && end === "pointerup") select(havNear(event.offsetX, event.offsetY));
  });
}

/** Return the HAV whose chain passes near a place on the screen, null for none. */
function havNear(px, py) {
  let nearest = null, least = Infinity;
  current.poses.forEach((pose, hav) => {
    if (removed[current.row * numHavs + hav]) return;
    const line = lineOf(hav, pose), most = Math.max(14, 0.5 * widthOf(hav) * view.scale + 4);
    for (let k = 1; k < line.length; k++) {
      const [ax, ay] = onScreen(...line[k - 1]), [bx, by] = onScreen(...line[k]);
      const square = (bx - ax) ** 2 + (by - ay) ** 2;
      const along = square ? clip(((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / square, 0, 1) : 0;
      const gap = Math.hypot(px - ax - along * (bx - ax), py - ay - along * (by - ay));
      if (gap < Math.min(least, most)) { least = gap; nearest = hav; }
    }
  });
  return nearest;
}

const seekOnChart = (event) => {
  const { clientWidth: width } = chart;
  seek(duration * (event.offsetX - plot.left) / (width - plot.left - plot.right));
};
chart.addEventListener("pointerdown", (event) => { chart.setPointerCapture(event.pointerId); seekOnChart(event); });
chart.addEventListener("pointermove", (event) => { if (event.buttons) seekOnChart(event); });

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const { tagName: tag, type } = event.target, stride = event.shiftKey ? 10 : 1;
  const typed = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const next = (by) => {
    const from = state.selected === null ? (by > 0 ? -1 : 0) : state.selected;
    select((from + by + numHavs) % numHavs);
  };
  const actions = {
    " ": () => setPlaying(!state.playing),
    ArrowLeft: () => seek(state.time - stride),
    ArrowRight: () => seek(state.time + stride),
    Home: () => seek(0),
    End: () => seek(duration),
    Escape: () => select(null),
    "+": () => zoom(1.4), "=": () => zoom(1.4), "-": () => zoom(1 / 1.4), "−": () => zoom(1 / 1.4),
    f: () => find("fit").click(),
    c: () => { if (state.selected !== null) find("follow").click(); },
    "[": () => next(-1), "]": () => next(1),
  };
  // what has the focus keeps the keys that it understands
  const own = (tag === "SELECT" && typed !== "Escape")
    || (typed === " " && (tag === "BUTTON" || type === "checkbox"));
  if (own || !(typed in actions)) return;
  event.preventDefault();
  actions[typed]();
});

new ResizeObserver(() => {
  [view.width, view.height] = [plane.clientWidth, plane.clientHeight];
  if (view.fitted) fit(); else refresh();
}).observe(plane);
new ResizeObserver(refresh).observe(chart);
dark.addEventListener("change", () => { readTheme(); paintPanel(); refresh(); });

readTheme();
buildPanel();
paintPanel();
[view.width, view.height] = [plane.clientWidth, plane.clientHeight];
fit();

/** For tests and the console: what is shown, where a HAV is on the page, and its bodies and hitches. */
window.replay = {
  get time() { return state.time; },
  get duration() { return duration; },
  get playing() { return state.playing; },
  get speed() { return state.speed; },
  get numHavs() { return numHavs; },
  get vehiclesDrawn() { return state.vehiclesDrawn; },
  get selected() { return state.selected; },
  get events() { return events.map(({ time, text }) => ({ time, text })); },
  positionOf(hav) {
    const { x, y } = current.poses[hav], { left, top } = plane.getBoundingClientRect();
    const [px, py] = onScreen(x, y);
    return [left + px, top + py];
  },
  cornersOf(hav) { return current.poses[hav].corners; },
  frontsOf(hav) { return current.poses[hav].fronts; },
};
