// How blocks look: a theme of Blockly from the colours of the page, for light and for dark.

const HUES = {
  start: ["#46566e", "#53657f"], control: ["#7a4b00", "#8a5a10"], conditions: ["#1c5f8a", "#256d9b"], values: ["#3f5f2a", "#4a6e33"],
  variables: ["#8a2f6b", "#9c3f7c"], movement: ["#1a56b0", "#2a64bd"], sensing: ["#0b6b52", "#14795f"], knowledge: ["#6a3fb0", "#7850bd"],
  unknown: ["#9d2f35", "#a8393f"],
};
const PARTS = {
  workspaceBackgroundColour: "back", toolboxBackgroundColour: "surface", toolboxForegroundColour: "text", flyoutBackgroundColour: "raised",
  flyoutForegroundColour: "text", scrollbarColour: "line-strong", insertionMarkerColour: "text", cursorColour: "ring", selectedGlowColour: "ring",
};

/** Return the theme for the current colours of the page. */
export function theme(Blockly) {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const chosen = document.documentElement.dataset.theme ?? (dark ? "dark" : "light");
  const shade = chosen === "dark" ? 1 : 0;
  const styles = Object.fromEntries(Object.entries(HUES).map(([name, hues]) => [name, { colourPrimary: hues[shade], hat: name === "start" ? "cap" : "" }]));
  return Blockly.Theme.defineTheme(`kg-${chosen}`, {
    name: `kg-${chosen}`,
    base: Blockly.Themes.Zelos ?? Blockly.Themes.Classic,
    blockStyles: styles,
    categoryStyles: Object.fromEntries(Object.entries(HUES).map(([name, hues]) => [name, { colour: hues[shade] }])),
    componentStyles: Object.fromEntries(Object.entries(PARTS).map(([part, name]) => [part, colour(name)])),
    fontStyle: { family: "system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif", weight: "500", size: 11 },
  });
}

function colour(name) {
  const probe = document.createElement("span");
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

/** Call back when the page becomes light or dark. */
export function whenChanged(call) {
  document.addEventListener("kg:theme", call);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", call);
}
