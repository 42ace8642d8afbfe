// Colours of the pictures, for light and dark pages. Blue and orange are told apart by colour-blind eyes too.

const LIGHT = {
  paper: "#ffffff", cell: "#e8ecf1", hidden: "#e3e6ea", seen: "#8fc4f5", pale: "#d8e8f8", from: "#f0701a", target: "#8a5cd6",
  wall: "#1c2733", portal: "#12a594", line: "#d6246e", text: "#1c2733", gained: "#1b7f3b", lost: "#b3261e", isovist: "rgba(8, 48, 107, 0.42)",
  heat: [[235, 243, 252], [8, 48, 107]],
};
const DARK = {
  paper: "#12171d", cell: "#252d36", hidden: "#222831", seen: "#2f6ea8", pale: "#24405a", from: "#f0701a", target: "#a583e6",
  wall: "#dde4ec", portal: "#27c4b1", line: "#ff5c9a", text: "#dde4ec", gained: "#4fbf73", lost: "#ff8a80", isovist: "rgba(158, 202, 255, 0.42)",
  heat: [[30, 42, 56], [158, 202, 255]],
};

const darkPage = window.matchMedia("(prefers-color-scheme: dark)");

function theme() {
  return darkPage.matches ? DARK : LIGHT;
}

/** The colour of a share from 0 to 1 in one hue. */
function heatColour(share) {
  const [low, high] = theme().heat;
  const channels = low.map((x, k) => Math.round(x + (high[k] - x) * Math.min(Math.max(share, 0), 1)));
  return `rgb(${channels.join(",")})`;
}

/** A colour such as #12a594 as numbers from 0 to 1. */
function channelsOf(colour) {
  return [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);
}
