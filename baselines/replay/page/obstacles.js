// ---- obstacles: the segments that collide ----------------------------------------------------------
const WALL = 2;  // pixels, breadth of obstacles at any scale: no gap that can be seen closes
const obstacleKinds = kinds.filter((kind) => kind.place === "segment");

/** Add the segments of some numbers to the path, those of which something may be in sight. */
function traceSegments(numbers) {
  const [left, high] = onPlane(-WALL, -WALL), [right, low] = onPlane(view.width + WALL, view.height + WALL);
  ctx.beginPath();
  for (const number of numbers) {
    const at = 4 * number, x = segments[at], y = segments[at + 1], toX = segments[at + 2], toY = segments[at + 3];
    if (Math.max(x, toX) < left || Math.min(x, toX) > right || Math.max(y, toY) < low || Math.min(y, toY) > high) continue;
    ctx.moveTo(...onScreen(x, y));
    ctx.lineTo(...onScreen(toX, toY));
  }
}

/** Draw the obstacles; those that HAVs hit first have the colour of danger from then on. */
function drawSegments() {
  if (segments.length === 0) return;
  flat();
  ctx.lineWidth = WALL;
  ctx.strokeStyle = theme.text;
  traceSegments(Array.from({ length: segments.length / 4 }, (_, number) => number));
  ctx.stroke();
  const struck = obstacleKinds.flatMap((kind) => first
    .map((own) => own[kind.row]).filter(([step]) => happened(step)).map(([, where]) => where));
  ctx.lineWidth = 1.5 * WALL;
  ctx.strokeStyle = theme.alert;
  traceSegments(struck);
  ctx.stroke();
}
