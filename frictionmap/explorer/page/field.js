// Fields for numbers, which may be typed with a unit: the server converts them, as it does everywhere else.

/** A text that begins as a number does, and is no number alone. */
export function hasUnit(text) {
  return /^[+-]?\.?\d/.test(text.trim()) && !Number.isFinite(Number(text));
}

/** HTML of a field, and of the place next to it for the refusal of its text. */
export const FIELD = `<input type="text" class="number" inputmode="text" autocomplete="off" spellcheck="false">`;
export const REFUSED = `<p class="refused" role="alert" hidden></p>`;

/** Write a number into a field, unless it is being edited, or what was typed was refused and the number is the same. */
export function writeIn(input, value) {
  const kept = document.activeElement === input ? input.value : input.hasAttribute("aria-invalid") && input.dataset.written === value;
  if (kept) return;
  input.value = input.dataset.written = value;
  if (input.hasAttribute("aria-invalid")) input.dispatchEvent(new Event("input")); // the refusal is outdated
}

/**
 * Listen to a field: a number alone goes to `plain`, one with a unit to the server and then to `ratio`; an empty field is reset.
 * @param {HTMLInputElement} input
 * @param {HTMLElement} refused        where a refusal is shown
 * @param {object} does                callbacks: plain(number), convert(text) a promise of a ratio, ratio(number), reset()
 */
export function listenToField(input, refused, does) {
  const say = (text) => {
    [refused.textContent, refused.hidden] = [text, !text];
    input.toggleAttribute("aria-invalid", Boolean(text));
  };
  input.addEventListener("input", () => say(""));
  input.addEventListener("change", async () => {
    const text = input.value.trim();
    say("");
    if (!text) return does.reset();
    if (Number.isFinite(Number(text))) return does.plain(Number(text));
    try {
      const ratio = await does.convert(text);
      if (input.value.trim() !== text) return; // another text was typed meanwhile
      input.value = ""; // to be written anew: a field that is being edited keeps its text otherwise
      does.ratio(ratio);
    } catch (error) {
      if (input.value.trim() === text) say(error.message);
    }
  });
}
