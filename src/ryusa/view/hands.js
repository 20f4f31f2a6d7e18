// The hands on the viewers of a page: mouse and keys. What the mouse does, keys do too.

const TURN = 0.1, STEP = 0.2;  // of a key: radians; share of half the height that is seen
const HELP = [
  ["space", "play, pause"], ["\u2190 \u2192", "one frame back, on"], ["Home End", "first, last frame"], ["\u2191 \u2193", "faster, slower"],
  ["drag, shift + \u2190 \u2192 \u2191 \u2193", "turn"], ["shift + drag, right button, i j k l", "shift"], ["wheel, + \u2212", "zoom"], ["1 2 3", "oblique view, from the side, from above"],
  ["o", "perspective on, off"], ["c", "next colouring"], ["click a grain", "choose it, show its track"], ["g G", "choose the next grain, the one before"], ["f", "follow it"], ["Esc", "let it go"],
  ["b", "fixed grains on, off"], ["w", "walls and water on, off"], ["a", "arrows of the water on, off"], ["p", "save a picture (PNG)"], ["h ?", "this list"],
];

function hands(viewer) {
  const { canvas, holder } = viewer;
  const place = (event) => { const box = canvas.getBoundingClientRect(); return [2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height]; };
  let last = null, moved = 0;
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); last = [event.clientX, event.clientY]; moved = 0; holder.focus({ preventScroll: true }); });
  canvas.addEventListener("pointermove", (event) => {
    if (!last) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]], metre = 2 * viewer.camera.half / canvas.clientHeight;
    last = [event.clientX, event.clientY]; moved += Math.abs(dx) + Math.abs(dy);
    if (moved < 4) return;
    if (event.shiftKey || event.buttons === 2) viewer.shift(-dx * metre, dy * metre);
    else viewer.turn(-0.006 * dx, 0.006 * dy);
  });
  canvas.addEventListener("pointerup", (event) => { last = null; if (moved < 4 && event.button === 0) viewer.pick(...place(event)); });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); viewer.zoom(Math.exp(0.0015 * event.deltaY), ...place(event)); }, { passive: false });
  const step = () => STEP * viewer.camera.half;
  const keys = {
    " ": () => viewer.toggle(), ArrowLeft: () => viewer.step(-1), ArrowRight: () => viewer.step(1), Home: () => viewer.seek(0), End: () => viewer.seek(viewer.frames - 1),
    ArrowUp: () => viewer.faster(1), ArrowDown: () => viewer.faster(-1), "+": () => viewer.zoom(0.8), "=": () => viewer.zoom(0.8), "-": () => viewer.zoom(1.25),
    "shift ArrowLeft": () => viewer.turn(TURN, 0), "shift ArrowRight": () => viewer.turn(-TURN, 0), "shift ArrowUp": () => viewer.turn(0, -TURN), "shift ArrowDown": () => viewer.turn(0, TURN),
    j: () => viewer.shift(-step(), 0), l: () => viewer.shift(step(), 0), i: () => viewer.shift(0, step()), k: () => viewer.shift(0, -step()),
    1: () => viewer.look("oblique"), 2: () => viewer.look("side"), 3: () => viewer.look("top"), o: () => { viewer.camera.flat = !viewer.camera.flat; },
    c: () => viewer.colourBy(viewer.data.colourings[(viewer.colouring + 1) % viewer.data.colourings.length].word), f: () => { viewer.following = !viewer.following && viewer.picked >= 0; },
    g: () => viewer.choose(1), G: () => viewer.choose(-1), Escape: () => { viewer.picked = -1; viewer.following = false; viewer.showHelp(false); },
    b: () => { viewer.fixedShown = !viewer.fixedShown; }, w: () => { viewer.wallsShown = !viewer.wallsShown; }, a: () => { viewer.arrowsShown = !viewer.arrowsShown; },
    p: () => viewer.save(), h: () => viewer.showHelp(viewer.help.hidden), "?": () => viewer.showHelp(viewer.help.hidden),
  };
  holder.addEventListener("keydown", (event) => {
    const key = event.shiftKey && event.key.startsWith("Arrow") ? `shift ${event.key}` : event.key, { tagName } = event.target;
    if (!(key in keys) || event.ctrlKey || event.metaKey || event.altKey || !viewer.arrays) return;
    if (tagName === "SELECT" || (tagName === "BUTTON" && key === " ")) return;  // a choice has keys of its own, and a button is pressed
    if (event.target === viewer.help && /^(Arrow| |Home|End)/.test(key)) return;  // a list longer than the window is scrolled
    event.preventDefault();
    keys[key]();
    viewer.changed();
  });
}

const viewers = [];
for (const holder of document.querySelectorAll("[data-run]")) {
  const run = holder.dataset.run, text = (kind) => document.getElementById(`ryusa-${kind}-${run}`).textContent;
  try {
    const viewer = new Viewer(holder, JSON.parse(text("data")), text("arrays"));
    viewer.ready.catch((error) => { element("p", holder, { className: "fault", role: "alert" }, `The run cannot be shown: ${error.message}`); throw error; });
    viewers.push(viewer);
  } catch (error) {
    element("p", holder, { className: "fault", role: "alert" }, error.message);
  }
}
document.querySelector("main[data-run]")?.focus({ preventScroll: true });  // a report is read, and scrolled by keys
window.ryusaViewers = viewers;
