// Makes the page live. `bodesmith` is for a reader's console and for tests.

function start() {
  const links = new Links();
  const repaint = () => {
    readColours();
    for (const figure of bodesmith.figures)
      for (const plot of figure.plots) plot.u.redraw();
  };
  const tools = document.querySelector('.tools');
  const bodesmith = {figures: [], links, csvText, tableOf, valueText, numberText, columnName};
  tools.append(themeSwitch(repaint));
  readColours();
  document.documentElement.classList.add('scripted');
  document.querySelectorAll('figure.plots')
      .forEach((root, i) => bodesmith.figures.push(new LiveFigure(root, i, links)));
  if (bodesmith.figures.length > 1) {
    const link = element('input', {type: 'checkbox', checked: true});
    link.addEventListener('change', () => links.frequencies = link.checked);
    tools.append(element(
        'label', {title: 'Zooming one frequency axis zooms those of other figures too'}, link, ' Link frequency axes'));
  }
  tools.hidden = false;
  globalThis.bodesmith = bodesmith;
}

start();
