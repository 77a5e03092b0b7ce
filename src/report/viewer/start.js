// Puts the live picture in place of the still one; where that fails the still one stays, with a word on why.
const root = document.getElementById("viewer");
const sorry = (why) => root.append(element("p", { class: "note", role: "status" }, "The live view is not available here (" + why + "); the pictures and tables of this page say the same."));
try {
  const exhibits = JSON.parse(document.getElementById("viewer-data").textContent).exhibits.map(exhibitOf);
  const canvas = element("canvas", { tabindex: 0, role: "img", "aria-label": "The parts in 3D" });
  const made = stage(canvas);
  if (!made) sorry("the browser has no WebGL 2");
  else {
    const live = element("div", { class: "live" });
    const shown = show(exhibits, made, canvas);
    root.append(live);
    root.classList.add("alive");
    const hands = controls(live, shown, canvas, exhibits);
    // For tests and for the curious: where the plan stands, where a part is, what is seen, how long a picture takes.
    const frame = (moving) => {
      shown.state.moving = moving;
      const from = performance.now();
      shown.draw();
      shown.finish();
      shown.state.moving = false;
      return performance.now() - from;
    };
    window.weavelock = {
      go: (done) => hands.jump(done, "apart"), done: () => shown.state.done, steps: () => shown.steps().length,
      pose: shown.pose, camera: shown.camera, shares: shown.shares, frame, state: shown.state, draw: shown.draw,
      parts: () => shown.exhibit().ids, triangles: () => shown.exhibit().triangles, refresh: hands.refreshLegend,
    };
  }
} catch (e) {
  root.classList.remove("alive");
  console.error(e);
  sorry(String(e.message || e));
}
