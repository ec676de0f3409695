// The row of behaviours: a moving figure each, its name, how often it was seen, its verdict.

import { element } from "../page/elements.js";
import { Figure } from "./figures.js";

const KINDS = { good: "good", look: "look", "do not use": "bad" };

export function verdictOf(known) {
  if (!known) return ["wait", "being made …"];
  if (known.fault) return ["bad", "no loop"];
  if (!known.verdict) return ["wait", "being judged …"];
  return [KINDS[known.verdict.word], known.verdict.word];
}

export function createCards(box, page, store, session) {
  let cards = [];

  function card(part, place) {
    const input = element("input", { type: "radio", name: "part", value: place });
    input.addEventListener("change", () => store.change({ part: place }));
    const canvas = element("canvas", { ariaHidden: "true" });
    const [name, often, word] = [element("b"), element("span", { className: "muted" }), element("span")];
    const words = element("span", { className: "words" }, name, often, word);
    const box = element("label", { className: "card" }, input, canvas, words);
    box.style.setProperty("--hue", hue(place));
    return { box, input, name, often, word, figure: new Figure(canvas, page.capture.bones, 0.6) };
  }

  function fill() {
    const { work } = session();
    if (cards.length !== work.parts.length) {
      cards = work.parts.map(card);
      box.replaceChildren(...cards.map((one) => one.box));
    }
    work.parts.forEach((part, place) => show(cards[place], part, place));
  }

  function show(one, part, place) {
    const known = session().loop(place);
    const motion = page.motions[place];
    const [kind, word] = verdictOf(known);
    one.name.textContent = part.name;
    one.often.textContent = motion ? `×${motion.repetitions.toFixed(1)}` : "";
    one.word.className = `word ${kind}`;
    one.word.textContent = word;
    one.input.checked = place === store.state.part;
    one.input.setAttribute("aria-label", `${part.name}, ${one.often.textContent} ${word}`);
    one.figure.show(known?.fault ? null : motion);
    one.box.dataset.state = known?.fault ? "none" : known?.verdict ? "judged" : motion ? "plays" : "waits";
  }

  return { fill, figures: () => cards.map((one) => one.figure) };
}

export function hue(place) {
  return (place * 83 + 25) % 360;
}
