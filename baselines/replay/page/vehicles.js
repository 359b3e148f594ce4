// ---- drawing HAVs, and what they do -----------------------------------------------------------
function isVisible(pose) {
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const point of pose.corners === null ? pose.points : pose.corners.flat()) {
    const [px, py] = onScreen(...point);
    left = Math.min(left, px); right = Math.max(right, px);
    top = Math.min(top, py); bottom = Math.max(bottom, py);
  }
  const margin = 4 + 2 * view.scale;
  return right > -margin && left < view.width + margin && bottom > -margin && top < view.height + margin;
}

function box(from, to, half, round) {
  ctx.beginPath();
  ctx.roundRect(from, -half, to - from, 2 * half, round);
}

function drawWheels(along, half, angle) {
  ctx.fillStyle = theme.wheel;
  for (const side of [-1, 1]) {
    ctx.save();
    ctx.translate(along, side * half * 0.92);
    ctx.rotate(angle);
    ctx.fillRect(-0.55, -0.19, 1.1, 0.38);
    ctx.restore();
  }
}

/** Draw the pattern of a HAV of half a width [m] along its axles, over its bodies. */
function drawPattern(hav, pose, half) {
  const pattern = patternOf(hav), width = Math.max(1, 0.6 * half * view.scale);
  if (pattern === "plain") return;
  flat();
  ctx.beginPath();
  for (const point of lineOf(hav, pose)) ctx.lineTo(...onScreen(...point));
  ctx.strokeStyle = theme.ground;
  ctx.lineWidth = width;
  const gap = Math.max(2.5 * width, 5);
  ctx.lineCap = pattern === "dots" ? "round" : "butt";
  ctx.setLineDash({ stripe: [], dashes: [gap, gap], dots: [0.1, gap] }[pattern]);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.lineCap = "round";
}

function drawVehicle(hav, pose, steering) {
  const pixel = 1 / view.scale, color = colorOf(hav), units = lengths[hav].length;
  const fine = view.scale > 3.2;  // wheels can be seen
  const half = Math.max(widthOf(hav), 4.5 * pixel) / 2;
  if (hav === state.selected) {
    flat();
    ctx.beginPath();
    for (const point of lineOf(hav, pose)) ctx.lineTo(...onScreen(...point));
    ctx.strokeStyle = color;
    ctx.globalAlpha = 0.28;
    ctx.lineWidth = 2 * half * view.scale + 14;
    ctx.stroke();
    ctx.globalAlpha = 1;
  }
  if (shapes !== null && 2 * half === widthOf(hav)) {  // rectangles are wide enough to be seen
    drawBodies(hav, pose, steering, fine);
    drawPattern(hav, pose, half);
    drawJoints(hav, pose, fine);
    flat();
    return;
  }
  for (let unit = units - 1; unit > 0; unit--) {
    const length = lengths[hav][unit], gap = Math.min(1.1, 0.28 * length);
    enter(...pose.points[unit + 1], pose.angles[unit]);  // its axle; the hitch is ahead
    ctx.strokeStyle = theme.wheel;
    ctx.lineWidth = Math.max(0.3, pixel);
    ctx.beginPath();
    ctx.moveTo(length, 0); ctx.lineTo(length - gap, 0);
    ctx.stroke();
    if (hitchOffsets[hav][unit - 1] !== 0) {  // from the axle ahead to the hitch
      flat();
      ctx.lineWidth = Math.max(0.3 * view.scale, 1);
      ctx.beginPath();
      ctx.moveTo(...onScreen(...pose.points[unit])); ctx.lineTo(...onScreen(...pose.fronts[unit]));
      ctx.stroke();
      enter(...pose.points[unit + 1], pose.angles[unit]);
    }
    if (fine) drawWheels(0, half, 0);
    box(-0.45, length - gap, half * 0.9, 0.25);
    ctx.fillStyle = theme.ground;
    ctx.fill();
    ctx.fillStyle = ctx.strokeStyle = color;
    ctx.globalAlpha = 0.42;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.lineWidth = pixel * (fine ? 1.25 : 0.75);
    ctx.stroke();
  }
  const truck = lengths[hav][0];
  enter(...pose.points[1], pose.angles[0]);
  if (fine) { drawWheels(0, half, 0); drawWheels(truck, half, steering); }
  const nose = truck + Math.min(1, 0.25 * truck), cab = Math.min(2.3, 0.45 * truck);
  box(-0.6, nose, half * 0.9, [0.2, 0.7, 0.7, 0.2]);
  ctx.fillStyle = color;
  ctx.fill();
  ctx.lineWidth = pixel;
  ctx.strokeStyle = theme.wheel;
  ctx.stroke();
  if (fine) {  // the windscreen shows where it heads
    box(nose - 0.85 * cab, nose - 0.4 * cab, half * 0.72, 0.15);
    ctx.fillStyle = theme.cab;
    ctx.globalAlpha = 0.85;
    ctx.fill();
    ctx.globalAlpha = 1;
  } else {
    const tip = Math.max(nose, 9 * pixel);
    ctx.beginPath();
    ctx.moveTo(tip + 4 * pixel, 0); ctx.lineTo(tip - 5 * pixel, half * 1.7); ctx.lineTo(tip - 5 * pixel, -half * 1.7);
    ctx.closePath();
    ctx.fillStyle = color;
    ctx.fill();
    ctx.stroke();
  }
  drawPattern(hav, pose, half);
  drawJoints(hav, pose, fine);
  flat();
}

/** Mark each joint, the nearer to the limit the stronger; beyond it with a cross. */
function drawJoints(hav, pose, fine) {
  for (let unit = 1; unit < lengths[hav].length; unit++) {
    const bend = wrap(pose.angles[unit] - pose.angles[unit - 1]);
    const near = Math.abs(bend) / articulationMax[hav][unit], color = blend(theme.ramp, near);
    const [px, py] = onScreen(...pose.fronts[unit]);
    flat();
    ctx.fillStyle = color;
    if (fine && near > 0.1) {
      const radius = Math.min(3.2, 0.5 * lengths[hav][unit]) * view.scale;
      const straight = -(pose.angles[unit - 1] + Math.PI), bent = straight - bend;
      ctx.globalAlpha = 0.75;
      ctx.beginPath();
      ctx.moveTo(px, py);
      ctx.arc(px, py, radius, straight, bent, bend > 0);
      ctx.closePath();
      ctx.fill();
      ctx.globalAlpha = 1;
    }
    const radius = Math.max(fine ? 2.5 : 1.1, 0.16 * view.scale) + clip(near, 0, 1) * (fine ? 3 : 2.4);
    ctx.beginPath();
    ctx.arc(px, py, radius, 0, 2 * Math.PI);
    ctx.fill();
    ctx.strokeStyle = theme.ground;
    ctx.lineWidth = fine ? 1.25 : 0.75;
    ctx.stroke();
    if (near > 1) {
      const arm = radius + 6;
      ctx.strokeStyle = color;
      ctx.lineWidth = 2;
      ctx.beginPath();
      ctx.arc(px, py, arm, 0, 2 * Math.PI);
      for (const [dx, dy] of [[1, 1], [1, -1]]) {
        ctx.moveTo(px - arm * dx, py - arm * dy);
        ctx.lineTo(px + arm * dx, py + arm * dy);
      }
      ctx.stroke();
    }
  }
}

/** Draw an arrow away from the HAV that is evaded, and a dotted line to it. */
function drawEvasion(hav, other, poses) {
  if (other === NEVER || !isVisible(poses[hav])) return;
  const [px, py] = onScreen(poses[hav].x, poses[hav].y);
  const [qx, qy] = onScreen(poses[other].x, poses[other].y);
  const distance = Math.hypot(px - qx, py - qy) || 1;
  const [ux, uy] = [(px - qx) / distance, (py - qy) / distance];
  const from = 8, to = Math.max(34, 1.6 * lengths[hav][0] * view.scale), few = numHavs <= 12;
  flat();
  if (few || hav === state.selected) {
    ctx.strokeStyle = theme.text;
    ctx.globalAlpha = 0.45;
    ctx.lineWidth = 1;
    ctx.setLineDash([1, 4]);
    ctx.beginPath();
    ctx.moveTo(px, py); ctx.lineTo(qx, qy);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }
  for (const [color, width] of [[theme.ground, 6], [theme.text, 2.5]]) {
    const [hx, hy] = [px + ux * to, py + uy * to], head = few ? 9 : 7;
    ctx.strokeStyle = ctx.fillStyle = color;
    ctx.lineWidth = few ? width : 0.7 * width;
    ctx.beginPath();
    ctx.moveTo(px + ux * from, py + uy * from);
    ctx.lineTo(hx - ux * head * 0.6, hy - uy * head * 0.6);
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(hx, hy);
    ctx.lineTo(hx - ux * head - uy * head * 0.55, hy - uy * head + ux * head * 0.55);
    ctx.lineTo(hx - ux * head + uy * head * 0.55, hy - uy * head - ux * head * 0.55);
    ctx.closePath();
    if (width > 3) { ctx.lineWidth = 3; ctx.stroke(); }
    ctx.fill();
  }
}

function drawNumber(hav, pose) {
  if (!isVisible(pose)) return;
  const heading = pose.angles[0], [fx, fy] = pose.points[0];
  const ahead = shapes === null ? Math.min(1, 0.25 * lengths[hav][0]) : shapes[hav][0][1];
  const away = 17 + ahead * view.scale;
  const [sx, sy] = onScreen(fx, fy);
  const [px, py] = [sx + away * Math.cos(heading), sy - away * Math.sin(heading)];
  flat();
  ctx.font = `600 ${numHavs > 12 ? 10 : 12}px system-ui, sans-serif`;
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  const width = Math.max(ctx.measureText(hav).width + 9, 17), height = numHavs > 12 ? 14 : 17;
  ctx.beginPath();
  ctx.roundRect(px - width / 2, py - height / 2, width, height, height / 2);
  ctx.fillStyle = colorOf(hav);
  ctx.fill();
  // what went wrong stays to be seen
  const bad = harmsOf(hav).length > 0;
  ctx.strokeStyle = bad ? theme.alert : theme.ground;
  ctx.lineWidth = bad ? 2.5 : 1.5;
  ctx.stroke();
  ctx.fillStyle = theme.panel;
  ctx.fillText(hav, px, py + 0.5);
}
