// The one state of the page: read it, change it, hear of changes.

export function createStore(initial) {
  const state = { ...initial };
  const listeners = [];
  return {
    state,
    change(patch) {
      const changed = Object.keys(patch).filter((key) => state[key] !== patch[key]);
      if (changed.length === 0) return;
      Object.assign(state, patch);
      for (const listener of listeners) listener(new Set(changed));
    },
    onChange(listener) {
      listeners.push(listener);
    },
  };
}
