// ---- the panel -------------------------------------------------------------------------------
const events = listEvents();
const buttons = [];

/** Return what happened, in order; a pair's collision is one event. */
function listEvents() {
  const list = [];
  const colors = { alert: () => theme.alert, warning: () => theme.ramp[1][1] };
  for (let hav = 0; hav < numHavs; hav++) {
    hitStep[hav].forEach((step, goal) => {
      if (step === NEVER) return;
      list.push({ time: step * dt, havs: [hav], sign: "✓", color: () => theme.accent, text: `HAV ${hav} ${goal === numGoals - 1 ? "arrived at" : "hits"} goal ${goal + 1}` });
    });
    for (const kind of kinds) {
      const { row, sign, happens } = kind, [step, where] = first[hav][row];
      if (step === NEVER) continue;
      const event = { time: step * dt, havs: [hav], sign, color: colors[kind.color] };
      if (kind.place === "joint") {
        list.push({ ...event, text: `HAV ${hav} ${happens} at joint ${where}` });
        continue;
      }
      if (kind.place === "segment") {
        list.push({ ...event, text: `HAV ${hav}: ${happens}` });
        continue;
      }
      const [theirs, partner] = first[where][row], mutual = theirs === step && partner === hav;
      if (mutual && where < hav) continue;
      const pair = mutual ? `HAVs ${hav}, ${where}` : `HAV ${hav} with HAV ${where}`;
      list.push({ ...event, havs: [hav, where], text: `${pair}: ${happens}` });
    }
  }
  if (timeWasUp) list.push({ time: duration, havs: [], sign: "■", color: () => theme.text, text: "time was up" });
  return list.sort((one, two) => one.time - two.time);
}

/** Return how long a HAV is that stands straight [m]. */
function overallLength(hav) {
  const last = lengths[hav].length - 1;
  const behind = (unit) => lengths[hav][unit] + (unit < last ? hitchOffsets[hav][unit] : 0);
  const chain = lengths[hav].reduce((sum, _, unit) => sum + behind(unit), 0);
  return shapes === null ? chain : chain + shapes[hav][0][1] + shapes[hav][last][2];
}

function element(tag, text = "", kind = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function buildPanel() {
  const { policy, scenario, seed, episode: number } = episode;
  document.title = `${policy}, ${scenario}, seed ${seed}, episode ${number}`;
  find("title").textContent = policy;
  find("subtitle").textContent = `${scenario}, seed ${seed}, episode ${number}`;
  const limits = articulationMax.flatMap((own) => own.slice(1)).map((limit) => Math.round(limit * DEGREES));
  find("limit").textContent = limits.every((limit) => limit === limits[0]) ? `limit, ${limits[0]}°` : "limit";
  for (const event of events) {
    const button = element("button");
    event.mark = element("span", event.sign, "sign");
    button.append(element("span", seconds(event.time), "when"), event.mark, element("span", event.text));
    button.onclick = () => { seek(event.time); if (event.havs.length && !event.havs.includes(state.selected)) select(event.havs[0]); };
    event.item = element("li");
    event.item.append(button);
    find("events").querySelector("ul").append(event.item);
    event.tick = element("i");
    event.tick.style.left = `${clip(100 * (event.time - began) / (duration - began || 1), 0, 100)}%`;
    find("ticks").append(event.tick);
  }
  find("events").querySelector("p").hidden = events.length > 0;
  for (let hav = 0; hav < numHavs; hav++) {
    const button = element("button"), trailers = lengths[hav].length - 1;
    const total = overallLength(hav);
    button.append(
      element("span", hav, "chip"),
      element("span", `${trailers} trailer${trailers > 1 ? "s" : ""}, ${total.toFixed(0)} m`),
      element("span", "", "state"));
    button.onclick = () => select(state.selected === hav ? null : hav);
    button.setAttribute("aria-pressed", "false");
    const item = element("li");
    item.append(button);
    find("havs").querySelector("ul").append(item);
    buttons.push(button);
  }
  const speeds = [...new Set([0.5, 1, 2, 5, 10, 20, 50, 100, episode.speed])].sort((a, b) => a - b);
  for (const speed of speeds) {
    const option = element("option", `× ${+speed.toPrecision(3)}`);
    option.value = speed;
    find("speed").append(option);
  }
  find("speed").value = episode.speed;
  find("reserved").parentElement.hidden = outlines.length === 0;
  listSigns();
  Object.assign(find("scrub"), { min: began, max: duration });
}

function paintPanel() {
  for (const event of events) event.mark.style.color = event.tick.style.background = event.color();
  buttons.forEach((button, hav) => { button.querySelector(".chip").style.background = paintOf(hav); });
  if (state.selected !== null) find("chip").style.background = paintOf(state.selected);
  const stops = theme.ramp.map(([place, color]) => `${color} ${100 * place}%`);
  find("ramp").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
}

/** Return what a HAV is up to, as text, with what went wrong in bold. */
function describe(hav, row) {
  const hits = hitStep[hav].filter(happened).length, bad = harmsOf(hav).map((kind) => kind.state);
  const doing = removed[row * numHavs + hav] ? "has left"
    : hasArrived(hav) ? "arrived" : isWaiting(hav, phases[row * numHavs + hav]) ? "waits"
    : evaded[row * numHavs + hav] !== NEVER ? `evades HAV ${evaded[row * numHavs + hav]}` : "";
  const plain = [bad.length > 1 ? "" : doing, `${hits}/${numGoals}`].filter(Boolean).join(" · ");
  return [bad.join(", "), bad.length ? ` · ${plain}` : plain];
}

/** Explain the signs on the plane, each drawn as there. */
function listSigns() {
  const line = '<path d="M2 9 H26" ', none = 'fill="none" stroke="currentColor"';
  const signs = [
    ["goal: the truck's pose there", `<path d="M4 4 H18 L25 9 L18 14 H4 Z M8 9 H14 M11 6 V12" ${none} stroke-width="1.5"/>`],
    ["path of the last two minutes", `${line}${none} stroke-width="2.5" opacity=".5"/>`],
    ["footprint; solid: overlaps another", `<circle cx="9" cy="9" r="7" ${none} stroke-dasharray="3 3"/><circle cx="21" cy="9" r="6" ${none} stroke-width="1.75"/>`],
    ["number; framed: jackknifed or collided", '<rect x="3" y="2" width="22" height="14" rx="7" fill="currentColor" stroke="var(--alert)" stroke-width="2.5"/>'],
    ["bar at the time: an event", '<rect x="12" y="3" width="3" height="12" fill="currentColor"/>'],
  ];
  if (outlines.length) signs.push(["area that a HAV has reserved", '<rect x="3" y="3" width="22" height="12" fill="currentColor" fill-opacity=".15" stroke="currentColor"/>']);
  if (evaded.some((other) => other !== NEVER)) signs.push(["evades the HAV on the dotted line", `<path d="M2 9 H11" ${none} stroke-dasharray="1 3"/><path d="M12 9 H20" ${none} stroke-width="2.5"/><path d="M19 4 L27 9 L19 14 Z" fill="currentColor"/>`]);
  if (segments.length) signs.push(["obstacle; coloured: a HAV hit it", `${line}${none} stroke-width="2"/>`]);
  for (const [text, drawn] of signs) {
    const item = element("li");
    item.innerHTML = `<svg width="28" height="18" viewBox="0 0 28 18" aria-hidden="true">${drawn}</svg>`;
    item.append(element("span", text));
    find("signs").querySelector("ul").append(item);
  }
}

let told = -1;
function showTime() {
  const { row } = current;
  find("clock").innerHTML = `${seconds(state.time)} <span>/ ${seconds(duration)}</span>`;
  if (document.activeElement !== find("scrub") || +find("scrub").value !== state.time) find("scrub").value = state.time;
  find("scrub").setAttribute("aria-valuetext", seconds(state.time));
  if (told === row) return;
  told = row;
  const under = phases.subarray(row * numHavs, (row + 1) * numHavs);
  const least = Math.min(...under) + 1, most = Math.max(...under) + 1;
  const shown = least === most ? least : `${least}-${most}`;
  const arrived = lengths.filter((_, hav) => hasArrived(hav)).length;
  const over = timeWasUp && row === numRows - 1 ? "; time was up" : "";
  find("phase").textContent = `goal ${shown} of ${numGoals}, ${arrived} of ${numHavs} arrived${over}`;
  for (const event of events) event.item.className = event.time > state.time + 1e-9 ? "ahead" : "";
  buttons.forEach((button, hav) => {
    const [bad, plain] = describe(hav, row), place = button.querySelector(".state");
    if (place.dataset.told === bad + plain) return;
    place.dataset.told = bad + plain;
    place.replaceChildren(element("b", bad), plain);
  });
}

let figures = null;
function showFigures(row, pose) {
  const hav = state.selected, trailers = lengths[hav].length - 1;
  const bends = articulations(hav, row), sizes = bends.map(Math.abs);
  const worst = sizes.indexOf(Math.max(...sizes));
  const angle = (radians) => `${(radians * DEGREES).toFixed(0)}°`.replace("-", "−").replace("−0°", "0°");
  const hits = hitStep[hav].map((step) => (step === NEVER ? null : step * dt))
    .filter((time) => time !== null && time <= state.time + 1e-9).map(seconds);
  const moment = (kind) => {
    const [step, where] = first[hav][kind.row], name = kind.place === "partner" ? "HAV" : kind.place;
    return happened(step) ? `at ${seconds(step * dt)}, ${name} ${where}` : "no";
  };
  const toldOf = (chosen) => chosen.map((kind) => [kind.state, moment(kind), kind.harm]);
  const other = evaded[row * numHavs + hav];
  const lines = [
    ["trailers", `${trailers}, of ${lengths[hav].slice(1).map((length) => length.toFixed(1)).join(" ")}\u00a0m`],
    ["truck", `${lengths[hav][0].toFixed(1)} m, drives ${driving[row * numHavs + hav].toFixed(2)} m/s`],
    ["steering", angle(steerings[row * numHavs + hav] / 1e4)],
    ["most bent", `${angle(bends[worst])} at joint ${worst + 1}`],
    ["goals hit", `${hits.length} of ${numGoals}${hits.length ? `, at ${hits.join(", ")}` : ""}`],
    ...toldOf(kinds.filter((kind) => !kind.company)),
  ];
  if (numHavs > 1) {
    lines.push(
      ["evades", other === NEVER ? "nobody" : `HAV ${other}`],
      ...(outlines.length ? [["reserved", outlineAt(hav, row) === NEVER ? "nothing" : "the area in its colour"]] : []),
      ...toldOf(kinds.filter((kind) => kind.company)));
  }
  const now = JSON.stringify(lines);
  if (now === figures && find("figures").childElementCount) return;
  figures = now;
  find("figures").replaceChildren(...lines.flatMap(([name, value, harm]) => {
    const bad = harm && value !== "no";
    const told = element("dd");
    told.append(bad ? element("b", value) : value);
    return [element("dt", name), told];
  }));
}
