// A walk, frame by frame: where its eyes are and look to, with what may be seen from there.

class Walk {
  constructor(table, frames) {
    this.table = table;
    this.frames = frames;
    this.at = 0;
  }

  /** How many cells and objects may be seen from where the eye of a frame is; null outside every cell. */
  counts(frame) {
    const at = this.table.locate(frame.eye);
    if (at.length === 0) return null;
    const visible = this.table.visibleCells(at);
    return { cells: visible.length, objects: this.table.visibleObjects(at).length };
  }
}

function bindWalk(model, goTo) {
  const { walk } = model;
  document.getElementById("walk").hidden = !walk;
  if (!walk) return;
  const [slider, text, play] = ["frame", "frame-text", "play"].map((id) => document.getElementById(id));
  slider.max = walk.frames.length - 1;
  const step = Math.ceil(walk.frames.length / 200);
  const shown = walk.frames.filter((_, k) => k % step === 0).map((frame) => walk.counts(frame)?.objects ?? 0);
  const most = Math.max(...shown, 1);
  const bars = shown.map((n) => {
    const bar = element("span");
    bar.style.height = `${(100 * n) / most}%`;
    return bar;
  });
  document.getElementById("counts").replaceChildren(...bars);
  document.getElementById("counts").setAttribute("aria-label", `Objects that may be seen in each frame, at most ${most}`);
  const show = (k) => {
    walk.at = k;
    slider.value = k;
    const frame = walk.frames[k];
    const n = walk.counts(frame);
    const seen = n ? `${counted(n.cells, "cell")} and ${counted(n.objects, "object")} may be seen from there` : "outside every cell";
    text.textContent = `Frame ${k}: ${seen}.`;
    goTo(frame);
  };
  slider.addEventListener("input", () => show(Number(slider.value)));
  let timer = null;
  play.addEventListener("click", () => {
    const isOn = timer === null;
    play.setAttribute("aria-pressed", String(isOn));
    if (!isOn) {
      clearInterval(timer);
      timer = null;
      return;
    }
    timer = setInterval(() => show((walk.at + 1) % walk.frames.length), 50);
  });
}
