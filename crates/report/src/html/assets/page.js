// Starts everything: reads the data, draws the plots, minds light and dark and printing.

const pageData = JSON.parse(document.getElementById("data").textContent);
const PLOTS = { chart: drawChart, map: drawMap, polar: drawPolar, flow: drawFlow, scene: drawScene };

for (const figure of document.querySelectorAll("figure[data-plot]")) {
  const data = pageData.plots[Number(figure.dataset.plot)];
  PLOTS[data.plot](figure, data);
}

// Names of measures are long, and a phone is narrow: they may go on in the next line after a dot or an underline.
for (const cell of document.querySelectorAll("td:first-child")) {
  const parts = cell.textContent.split(/(?<=[._])(?=[A-Za-z])/);
  cell.replaceChildren(...parts.flatMap((part, i) => (i === 0 ? [part] : [make("wbr"), part])));
}

// Colours have changed: what is painted, and not styled, has to be painted again.
function repaint() {
  document.dispatchEvent(new Event("repaint"));
}

function useTheme(theme) {
  document.documentElement.dataset.theme = theme;
  button.textContent = theme === "dark" ? "light" : "dark";
  button.setAttribute("aria-label", `show the page ${button.textContent}`);
  repaint();
}

const button = document.getElementById("theme");
const systemDark = matchMedia("(prefers-color-scheme: dark)");
button.hidden = false;
button.addEventListener("click", () => useTheme(button.textContent));
systemDark.addEventListener("change", () => useTheme(systemDark.matches ? "dark" : "light"));
useTheme(systemDark.matches ? "dark" : "light");

// Paper is light; what is folded away stays so.
let themeBefore = "light";
addEventListener("beforeprint", () => {
  themeBefore = document.documentElement.dataset.theme;
  useTheme("light");
});
addEventListener("afterprint", () => useTheme(themeBefore));
