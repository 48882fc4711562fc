// Elements of the page, made without any HTML text: nothing that stands in the data can become markup.

/** An element with properties (`aria-…` and `role` as attributes) and children (elements or texts). */
function element(name, properties = {}, ...children) {
  const out = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes('-') || key === 'role')
      out.setAttribute(key, value);
    else
      out[key] = value;
  }
  out.append(...children);
  return out;
}

function button(text, title, press) {
  const out = element('button', {type: 'button', textContent: text, title});
  out.addEventListener('click', press);
  return out;
}

/** A button that is on or off; `press` gets the new state. */
function toggle(text, title, on, press) {
  const out = button(text, title, () => {
    const now = out.getAttribute('aria-pressed') !== 'true';
    out.setAttribute('aria-pressed', now);
    press(now);
  });
  out.setAttribute('aria-pressed', on);
  return out;
}
