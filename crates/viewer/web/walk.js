// A walk from `sightlines walk --json`, frame by frame.

class Walk {
  constructor(frames) {
    this.frames = frames;
    this.at = 0;
  }
}

function bindWalk(model, goTo) {
  const { walk } = model;
  document.getElementById("walk").hidden = !walk;
  if (!walk) return;
  const [slider, text, play] = ["frame", "frame-text", "play"].map((id) => document.getElementById(id));
  slider.max = walk.frames.length - 1;
  const most = Math.max(...walk.frames.map((frame) => frame.objects), 1);
  const step = Math.ceil(walk.frames.length / 200);
  const bars = walk.frames.filter((_, k) => k % step === 0).map((frame) => {
    const bar = element("span");
    bar.style.height = `${(100 * frame.objects) / most}%`;
    return bar;
  });
  document.getElementById("counts").replaceChildren(...bars);
  document.getElementById("counts").setAttribute("aria-label", `Objects seen in each frame, at most ${most}`);
  const show = (k) => {
    walk.at = k;
    slider.value = k;
    const frame = walk.frames[k];
    text.textContent = `Frame ${k}: ${frame.cells} cells and ${frame.objects} objects are seen in the view.`;
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
