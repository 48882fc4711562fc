// A table whose rows can be chosen: of the chosen one its figures, plots and tables stand below.

class Choices {
  constructor(root, number, links) {
    const data = dataOf(root);
    this.choices = data.choices;
    this.details = root.querySelector('.chosen');
    this.said = element('p', {className: 'spoken', role: 'status', 'aria-live': 'polite'});
    const rows = [...root.querySelectorAll('tbody tr')];
    this.radios = rows.map((row, i) => this.addRadio(row, i, number));
    this.rows = rows;
    this.heading = element('h3');
    this.figures = element('div', {className: 'key'});
    this.notes = element('div');
    this.plotsBox = element('div');
    this.rest = element('div');
    this.details.append(this.said, this.heading, this.figures, this.notes, this.plotsBox, this.rest);
    this.figure = new LiveFigure(this.plotsBox, this.choices[data.chosen].plots, number, links);
    this.choose(data.chosen, false);
  }

  addRadio(row, i, number) {
    const radio = element('input', {type: 'radio', name: `choice-${number}`, 'aria-label': this.choices[i].name});
    radio.addEventListener('change', () => this.choose(i));
    row.cells[0].prepend(radio, ' ');
    row.addEventListener('click', () => this.choose(i));
    return radio;
  }

  /** Shows choice i; the part of the axes that the reader has zoomed to stays. */
  choose(i, tell = true) {
    if (i === this.chosen) return;
    const choice = this.choices[i];
    if (this.chosen !== undefined) this.figure.setData(choice.plots);
    this.chosen = i;
    this.radios[i].checked = true;
    this.rows.forEach((row, k) => row.classList.toggle('picked', k === i));
    this.heading.textContent = choice.name;
    const card = ([value, meaning]) =>
        element('div', {}, element('b', {textContent: value}), element('span', {textContent: meaning}));
    this.figures.replaceChildren(...choice.figures.map(card));
    this.notes.replaceChildren(...choice.notes.map(text => element('p', {className: 'warning', textContent: text})));
    this.rest.replaceChildren(...choice.tables.map(plainTable));
    if (tell) this.said.textContent = `${choice.name} is shown below.`;
  }
}

function plainTable({caption, head, rows, marked}) {
  const heading = text => element('th', {scope: 'col', textContent: text});
  const row = (cells, i) => element(
      'tr', {className: marked.includes(i) ? 'marked' : ''}, ...cells.map(text => element('td', {textContent: text})));
  return element(
      'div', {className: 'wide'},
      element(
          'table', {}, element('caption', {textContent: caption}),
          element('thead', {}, element('tr', {}, ...head.map(heading))), element('tbody', {}, ...rows.map(row))));
}
