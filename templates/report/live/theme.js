// Light or dark: as the system says, until the reader chooses; the choice is kept where the browser allows it.

const THEMES = ['auto', 'light', 'dark'];
const THEME_KEY = 'bodesmith.theme';

function keptTheme() {
  try {
    const kept = localStorage.getItem(THEME_KEY);
    return THEMES.includes(kept) ? kept : 'auto';
  } catch {
    return 'auto';
  }
}

function setTheme(theme) {
  if (theme === 'auto')
    delete document.documentElement.dataset.theme;
  else
    document.documentElement.dataset.theme = theme;
  try {
    localStorage.setItem(THEME_KEY, theme);
  } catch {
    // Not kept; it holds for this page.
  }
}

/** The control; `changed` is called whenever the page has become light or dark. */
function themeSwitch(changed) {
  setTheme(keptTheme());
  const choice =
      element('select', {id: 'theme'}, ...THEMES.map(theme => element('option', {value: theme, textContent: theme})));
  choice.value = keptTheme();
  choice.addEventListener('change', () => {
    setTheme(choice.value);
    changed();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);
  return element('label', {}, 'Colours ', choice);
}
