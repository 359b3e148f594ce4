// ---- colours of hav_env/rendering/colors.py, distinct for any colour vision; amber and red are danger --
const dark = matchMedia("(prefers-color-scheme: dark)");
let theme;

function readTheme() {
  const style = getComputedStyle(document.documentElement);
  theme = {};
  for (const name of ["ground", "grid", "panel", "line", "text", "faint", "accent", "alert"]) {
    theme[name] = style.getPropertyValue(`--${name}`).trim();
  }
  theme.havs = dark.matches ? episode.colors.dark : episode.colors.light;
  theme.ramp = dark.matches
    ? [[0, "#7d8890"], [0.5, "#e8c33c"], [0.8, "#ff8433"], [1, "#ff4f78"]]
    : [[0, "#98a1a8"], [0.5, "#dba800"], [0.8, "#db5a00"], [1, "#b0003a"]];
  theme.joints = dark.matches
    ? [[0, "#c9a6ff"], [0.35, "#5fbdf0"], [0.7, "#4fd6a2"], [1, "#ece56a"]]
    : [[0, "#4b1d7a"], [0.35, "#1f6fa8"], [0.7, "#1c9a72"], [1, "#b0a018"]];
  theme.wheel = dark.matches ? "#05070a" : "#23272b";
  theme.cab = dark.matches ? "#0e1113" : "#ffffff";
}

/** Return the colour at a place of a list of [place, colour]. */
function blend(stops, place) {
  const at = clip(place, 0, 1);
  let k = 1;
  while (k < stops.length - 1 && at > stops[k][0]) k++;
  const [[low, from], [high, to]] = [stops[k - 1], stops[k]];
  const share = (at - low) / (high - low);
  const part = (color, i) => parseInt(color.slice(1 + 2 * i, 3 + 2 * i), 16);
  const mixed = [0, 1, 2].map((i) => Math.round(part(from, i) + share * (part(to, i) - part(from, i))));
  return `rgb(${mixed.join(" ")})`;
}

const colorOf = (hav) => theme.havs[hav % theme.havs.length];
/** Return the pattern of a HAV, one of PATTERNS in hav_env/rendering/colors.py. */
const patternOf = (hav) => episode.patterns[Math.floor(hav / theme.havs.length) % episode.patterns.length];
/** Return the background of a HAV's number in the panel. */
const paintOf = (hav) => {
  const color = colorOf(hav), pattern = patternOf(hav);
  if (pattern === "plain") return color;
  const angle = { stripe: "0deg", dashes: "90deg", dots: "45deg" }[pattern];
  return `repeating-linear-gradient(${angle}, ${color} 0 5px, color-mix(in srgb, ${color}, ${theme.panel} 45%) 5px 7px)`;
};
