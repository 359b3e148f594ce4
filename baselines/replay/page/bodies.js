// ---- bodies with a width: what is drawn is what collides -----------------------------------------
const DRAWBAR = 0.35;  // [m] half of a width up to which a unit is a drawbar

function traceCorners(corners) {
  flat();
  ctx.beginPath();
  for (const corner of corners) ctx.lineTo(...onScreen(...corner));
  ctx.closePath();
}

/** Draw a pair of wheels inside half a width [m] of the unit that was entered. */
function drawWheelsWithin(along, half, angle) {
  const tyre = Math.min(0.16, 0.13 * half), radius = Math.min(0.55, 0.45 * half);
  ctx.fillStyle = theme.wheel;
  for (const side of [-1, 1]) {
    ctx.save();
    ctx.translate(along, side * (half - tyre));
    ctx.rotate(angle);
    ctx.fillRect(-radius, -tyre, 2 * radius, 2 * tyre);
    ctx.restore();
  }
}

/** Draw the rectangles of a HAV from front to rear, drawbars below the others. */
function drawBodies(hav, pose, steering, fine) {
  const color = colorOf(hav), halves = shapes[hav].map(([half]) => half);
  const units = halves.map((_, unit) => unit), isBar = (unit) => unit > 0 && halves[unit] <= DRAWBAR;
  ctx.fillStyle = ctx.strokeStyle = theme.wheel;
  for (const unit of units.filter(isBar)) {
    traceCorners(pose.corners[unit]);
    ctx.fill();
    ctx.lineWidth = 1;
    if (!fine) ctx.stroke();  // it would be too thin to be seen
  }
  for (const unit of units.filter((unit) => !isBar(unit))) {
    traceCorners(pose.corners[unit]);
    ctx.fillStyle = theme.ground;
    ctx.fill();
    ctx.fillStyle = color;
    ctx.globalAlpha = unit === 0 ? 1 : 0.42;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.strokeStyle = unit === 0 ? theme.wheel : color;
    ctx.lineWidth = 1;
    ctx.stroke();
    if (!fine) continue;
    enter(...pose.points[unit + 1], pose.angles[unit]);
    drawWheelsWithin(0, halves[unit], 0);
    if (unit === 0) drawCab(hav, steering);
  }
  if (!fine) return;
  for (const unit of units.filter(isBar)) {  // its wheels are below the body behind it
    enter(...pose.points[unit + 1], pose.angles[unit]);
    drawWheelsWithin(0, Math.max(...halves), 0);
  }
}

/** Draw what shows where the truck that was entered heads: a windscreen and steered wheels. */
function drawCab(hav, steering) {
  const [half, front] = shapes[hav][0], nose = lengths[hav][0] + front, cab = Math.min(2.2, 0.45 * nose);
  drawWheelsWithin(lengths[hav][0], half, steering);
  box(nose - 0.5 * cab, nose - 0.25 * cab, half * 0.8, 0.1);
  ctx.fillStyle = theme.cab;
  ctx.globalAlpha = 0.85;
  ctx.fill();
  ctx.globalAlpha = 1;
}
