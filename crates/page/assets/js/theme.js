// ---- theme.js: the style sheet's colors for the canvases, light and dark.

const theme = {
  listeners: [],
  /** A color of the style sheet, `rgb(...)` or `#...`, as CSS text. */
  css: (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim(),
  dark: () => matchMedia("(prefers-color-scheme: dark)").matches,
};

/** A color of the style sheet as linear light, 0 to 1, for shaders. */
function linearColor(name) {
  const hex = theme.css(name).replace("#", "");
  return [0, 2, 4].map((at) => {
    const c = parseInt(hex.slice(at, at + 2), 16) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  });
}

/** The scale of speeds: from the card's own color to a deep (in the dark: bright) one, evenly lightening. */
const SCALE_LIGHT = ["#f3f1ec", "#d8e8e1", "#a9d4cc", "#70b8b8", "#3f97a3", "#23748a", "#17526b", "#0f334b"];
const SCALE_DARK = ["#1b2026", "#1d3440", "#1f4e5e", "#266d7c", "#3a9093", "#66b3a3", "#a3d4b5", "#e6f1cf"];

/** 256 colors of the scale as [r, g, b] in 255ths. */
function speedScale() {
  const stops = (theme.dark() ? SCALE_DARK : SCALE_LIGHT).map((hex) =>
    [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)),
  );
  return Array.from({ length: 256 }, (_, k) => {
    const place = (k / 255) * (stops.length - 1);
    const low = Math.min(Math.floor(place), stops.length - 2);
    return [0, 1, 2].map((c) => Math.round(mix(stops[low][c], stops[low + 1][c], place - low)));
  });
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => theme.listeners.forEach((f) => f()));

/** Fits a canvas to its place on the page and gives its 2D context in CSS pixels. */
function fitted(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}
