// Questions to the server: plain answers, files that go up, and long work told line by line.

async function refused(answer) {
  const told = await answer.json().catch(() => ({}));
  return Object.assign(new Error(told.error ?? `the studio answered ${answer.status}`), { status: answer.status });
}

export async function ask(path, method = "GET", body = undefined) {
  const answer = await sent(path, { method, body: body === undefined ? undefined : JSON.stringify(body) });
  return answer.json();
}

// Send a file, telling how much of it has gone.
export function sendFile(file, told, signal) {
  return new Promise((resolve, reject) => {
    const question = new XMLHttpRequest();
    question.open("PUT", `api/takes/${encodeURIComponent(file.name)}`);
    question.responseType = "json";
    question.upload.onprogress = (event) => told(event.loaded / Math.max(event.total, 1));
    question.onload = () => {
      if (question.status === 200) resolve(question.response);
      else reject(new Error(question.response?.error ?? `the studio answered ${question.status}`));
    };
    question.onerror = () => reject(new Error("the studio does not answer; is it still running?"));
    question.onabort = () => reject(new DOMException("stopped", "AbortError"));
    signal.addEventListener("abort", () => question.abort());
    question.send(file);
  });
}

// Ask for long work; hear of each event as it comes.
export async function follow(path, body, heard, signal) {
  const answer = await sent(path, { method: "POST", body: JSON.stringify(body), signal });
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let pieces = [];
  for (;;) {
    const { value, done } = await reader.read();
    if (done) break;
    const lines = value.split("\n");
    // A line may be long, and come in many pieces.
    for (const line of lines.slice(0, -1)) {
      pieces.push(line);
      const event = JSON.parse(pieces.join(""));
      pieces = [];
      if (event.error) throw new Error(event.error);
      await heard(event);
    }
    pieces.push(lines.at(-1));
  }
}

async function sent(path, options) {
  let answer;
  try {
    answer = await fetch(path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Error("the studio does not answer; is it still running?");
  }
  if (!answer.ok) throw await refused(answer);
  return answer;
}
