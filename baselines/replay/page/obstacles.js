// ---- obstacles: the segments that collide ----------------------------------------------------------
const WALL = 2;  // pixels, breadth of obstacles at any scale: no gap that can be seen closes
const STROKED = 64;  // segments that are stroked at once: long paths take more time than short ones
const obstacleKinds = kinds.filter((kind) => kind.place === "segment");
const allSegments = Array.from({ length: segments.length / 4 }, (_, number) => number);
const walls = document.createElement("canvas"), wallContext = walls.getContext("2d");
let wallsOf = null;  // the view that they were drawn for

/** Draw those segments of which something may be in sight. */
function strokeSegments(pen, numbers, color, width) {
  const [left, high] = onPlane(-width, -width), [right, low] = onPlane(view.width + width, view.height + width);
  const seen = numbers.filter((number) => {
    const at = 4 * number, x = segments[at], y = segments[at + 1], toX = segments[at + 2], toY = segments[at + 3];
    return !((x < left && toX < left) || (x > right && toX > right) || (y < low && toY < low) || (y > high && toY > high));
  });
  pen.lineWidth = width;
  pen.lineCap = "butt";
  pen.strokeStyle = color;
  for (let from = 0; from < seen.length; from += STROKED) {
    pen.beginPath();
    for (const number of seen.slice(from, from + STROKED)) {
      const at = 4 * number;
      pen.moveTo(...onScreen(segments[at], segments[at + 1]));
      pen.lineTo(...onScreen(segments[at + 2], segments[at + 3]));
    }
    pen.stroke();
  }
}

/** Draw the obstacles; those that HAVs hit first have the colour of danger from then on. */
function drawSegments() {
  if (segments.length === 0) return;
  const now = [view.x, view.y, view.scale, view.width, view.height, density, dark.matches].join();
  if (wallsOf !== now) {
    wallsOf = now;
    [walls.width, walls.height] = [plane.width, plane.height];  // this clears it
    wallContext.setTransform(density, 0, 0, density, 0, 0);
    strokeSegments(wallContext, allSegments, theme.text, WALL);
  }
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.drawImage(walls, 0, 0);
  flat();
  const struck = obstacleKinds.flatMap((kind) => first
    .map((own) => own[kind.row]).filter(([step]) => happened(step)).map(([, where]) => where));
  strokeSegments(ctx, struck, theme.alert, 1.5 * WALL);
  ctx.lineCap = "round";
}
