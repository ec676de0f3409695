// The keyboard. Keys that a focused control needs for itself are left to it.

const VIEWS = { 1: "capture", 2: "loop", 3: "beside", 4: "overlay" };

export function listenToKeys(actions) {
  const plain = {
    " ": actions.playOrPause,
    ArrowLeft: (event) => actions.step(-1, event.shiftKey),
    ArrowRight: (event) => actions.step(1, event.shiftKey),
    Home: () => actions.seek(0),
    End: () => actions.seek(Infinity),
    "[": () => actions.part(-1),
    "]": () => actions.part(1),
    "-": () => actions.speed(-1),
    "+": () => actions.speed(1),
    "=": () => actions.speed(1),
    b: actions.compare,
    c: actions.nextClass,
    o: () => actions.toggle("onion"),
    f: () => actions.toggle("follow"),
    r: actions.reset,
    t: actions.theme,
    "?": actions.help,
  };
  const views = Object.entries(VIEWS).map(([key, view]) => [key, () => actions.view(view)]);
  listenTo({ ...plain, ...Object.fromEntries(views) });
}

// Keys: actions by key, letters in lower case.
export function listenTo(keys) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.defaultPrevented || wantedBy(event.target, event.key)) return;
    const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}

function wantedBy(target, key) {
  if (target.matches("select")) return true;
  if (target.matches("input[type=text], input[type=number]")) return true;
  if (target.matches("input")) return key === " " || key.startsWith("Arrow");
  return target.matches("button, a") && key === " ";
}
