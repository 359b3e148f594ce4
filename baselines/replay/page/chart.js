// ---- the chart of the selected HAV -----------------------------------------------------------
const chart = find("chart"), chartContext = chart.getContext("2d");
const plot = { left: 36, right: 10, top: 8, bottom: 22 };
let chartOf = null;  // what the picture below the cursor was drawn for
const picture = document.createElement("canvas"), pictureContext = picture.getContext("2d");

function drawChart() {
  const [width, height, scale] = fitCanvas(chart, chartContext);
  if (width === 0) return;
  const key = [state.selected, width, height, scale, dark.matches].join();
  if (chartOf === null || chartOf.key !== key) chartOf = { key, ...plotChart(width, height, scale) };
  chartContext.setTransform(1, 0, 0, 1, 0, 0);
  chartContext.clearRect(0, 0, chart.width, chart.height);
  chartContext.drawImage(picture, 0, 0);
  chartContext.setTransform(scale, 0, 0, scale, 0, 0);
  const x = chartOf.across(state.time), hav = state.selected;
  const bends = articulations(hav, rowAt(state.time));
  chartContext.strokeStyle = theme.text;
  chartContext.lineWidth = 1.25;
  chartContext.beginPath();
  chartContext.moveTo(x, plot.top); chartContext.lineTo(x, height - plot.bottom);
  chartContext.stroke();
  for (let joint = lengths[hav].length - 1; joint > 0; joint--) {
    chartContext.beginPath();
    chartContext.arc(x, chartOf.up(bends[joint - 1]), 3, 0, 2 * Math.PI);
    chartContext.fillStyle = jointColor(hav, joint);
    chartContext.fill();
    chartContext.strokeStyle = theme.panel;
    chartContext.lineWidth = 1;
    chartContext.stroke();
  }
}

const jointColor = (hav, joint) => blend(theme.joints, (joint - 1) / Math.max(lengths[hav].length - 2, 1));

function plotChart(width, height, scale) {
  const hav = state.selected, joints = lengths[hav].length - 1;
  const limits = [...new Set(articulationMax[hav].slice(1))];
  const bends = Array.from(steps, (_, row) => articulations(hav, row));
  let most = Math.max(...limits);
  for (const row of bends) for (const bend of row) most = Math.max(most, Math.abs(bend));
  most *= 1.12;
  const across = (time) => plot.left + (width - plot.left - plot.right) * (duration > 0 ? time / duration : 0);
  const up = (angle) => plot.top + (height - plot.top - plot.bottom) * (0.5 - angle / (2 * most));
  picture.width = chart.width;
  picture.height = chart.height;
  const pen = pictureContext;
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = "11px system-ui, sans-serif";
  pen.textBaseline = "middle";
  const line = (angle, color, dash) => {
    pen.strokeStyle = color;
    pen.lineWidth = 1;
    pen.setLineDash(dash);
    pen.beginPath();
    pen.moveTo(plot.left, up(angle)); pen.lineTo(width - plot.right, up(angle));
    pen.stroke();
    pen.setLineDash([]);
  };
  pen.textAlign = "right";
  const drawn = limits.flatMap((limit) => [limit, -limit]).map((limit) => [limit, theme.alert, [5, 3]]);
  for (const [angle, color, dash] of [[0, theme.line, []], ...drawn]) {
    line(angle, color, dash);
    pen.fillStyle = angle === 0 ? theme.faint : theme.alert;
    pen.fillText(`${Math.round(angle * DEGREES)}°`.replace("-", "−"), plot.left - 5, up(angle));
  }
  const pitch = roundUp(Math.max(duration, dt) / 5);
  pen.fillStyle = theme.faint;
  for (let time = 0; time <= duration * (1 + 1e-9); time += pitch) {
    // the last label would be cut off at the edge
    pen.textAlign = time === 0 ? "left" : across(time) > width - 24 ? "right" : "center";
    pen.fillText(time === 0 ? "0 s" : `${+time.toPrecision(6)}`, across(time), height - 9);
    if (time > 0) {
      pen.strokeStyle = theme.grid;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(across(time), plot.top); pen.lineTo(across(time), height - plot.bottom);
      pen.stroke();
    }
  }
  for (const { time, havs, color } of events) {
    if (!havs.includes(hav)) continue;
    pen.fillStyle = color();
    pen.fillRect(across(time) - 1, height - plot.bottom - 5, 2, 8);
  }
  pen.lineWidth = 1.25;
  pen.lineJoin = "round";
  for (let joint = joints; joint > 0; joint--) {
    pen.strokeStyle = jointColor(hav, joint);
    pen.beginPath();
    plotJoint(pen, bends.map((row) => row[joint - 1]), across, up);
    pen.stroke();
  }
  const stops = theme.joints.map(([place, color]) => `${color} ${100 * place}%`);
  find("joints").querySelector("i").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  find("lastJoint").textContent = joints > 1 ? joints : "";
  find("joints").querySelector("i").hidden = joints === 1;
  chart.setAttribute("aria-label", `Articulations of HAV ${hav} over time, largest ${Math.round(most / 1.12 * DEGREES)} degrees`);
  return { across, up };
}

/** Trace least and largest articulation in every half pixel; break where it wraps. */
function plotJoint(pen, bends, across, up) {
  let column = null, low, high, last = null;
  const flush = () => {
    if (column === null) return;
    pen.lineTo(column, up(low));
    if (high !== low) { pen.lineTo(column, up(high)); pen.lineTo(column, up(last)); }
  };
  for (let row = 0; row < numRows; row++) {
    const angle = bends[row], place = Math.round(2 * across(steps[row] * dt)) / 2;
    const wraps = last !== null && Math.abs(angle - last) > Math.PI;
    if (wraps || place !== column) {
      flush();
      if (wraps || column === null) pen.moveTo(place, up(angle));
      column = place;
      low = high = angle;
    }
    low = Math.min(low, angle);
    high = Math.max(high, angle);
    last = angle;
  }
  flush();
}
