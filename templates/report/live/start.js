// Makes the page live. `bodesmith` is for a reader's console and for tests.

function start() {
  const links = new Links();
  const repaint = () => {
    readColours();
    for (const {plot} of links.plots) plot.u.redraw();
  };
  const tools = document.querySelector('.tools');
  const bodesmith = {figures: [], choices: [], links, csvText, tableOf, valueText, numberText, columnName};
  tools.append(themeSwitch(repaint));
  readColours();
  document.documentElement.classList.add('scripted');
  document.querySelectorAll('figure.plots').forEach((root, i) => {
    bodesmith.figures.push(new LiveFigure(root.querySelector('.live'), dataOf(root), i, links));
  });
  document.querySelectorAll('.choices').forEach((root, i) => {
    bodesmith.choices.push(new Choices(root, bodesmith.figures.length + i, links));
  });
  if (new Set(links.plots.filter(one => one.link === 'Hz').map(one => one.figure)).size > 1) {
    const link = element('input', {type: 'checkbox', checked: true});
    link.addEventListener('change', () => links.frequencies = link.checked);
    tools.append(element(
        'label', {title: 'Zooming one frequency axis zooms those of other figures too'}, link, ' Link frequency axes'));
  }
  tools.hidden = false;
  globalThis.bodesmith = bodesmith;
}

start();
