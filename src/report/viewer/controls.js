// Buttons, sliders, lists, keys and fingers; each control has a label, each step is said in a live region.
function element(tag, attributes = {}, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) e.addEventListener(name.slice(2), value);
    else if (value !== false && value !== null) e.setAttribute(name, value === true ? "" : value);
  }
  e.append(...children);
  return e;
}

// Seconds that a step takes while playing; long plans go faster, so that the whole takes about a minute at most.
const secondsFor = (count) => clamp(60 / Math.max(count, 1), 0.12, 1.4);
// Milliseconds without a change after which the picture is drawn in full.
const QUIET = 160;

function controls(root, shown, canvas, exhibits) {
  const { state } = shown;
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  let waiting = 0, rest = 0, playing = 0, last = 0, way = "apart", told = "";

  const paint = () => {
    waiting = 0;
    if (playing) advance();
    shown.draw();
    say();
    if (playing) waiting = requestAnimationFrame(paint);
  };
  const ask = () => {
    if (!waiting) waiting = requestAnimationFrame(paint);
  };
  // A change that others will follow at once: coarse until they stop.
  const change = () => {
    state.moving = true;
    clearTimeout(rest);
    rest = setTimeout(() => {
      state.moving = playing !== 0;
      ask();
    }, QUIET);
    ask();
  };

  // Steps.
  const total = () => shown.steps().length;
  const advance = () => {
    const now = performance.now(), share = (now - last) / 1000 / secondsFor(total());
    last = now;
    goTo(state.done + playing * (still ? Math.round(share) : share));
    if ((playing > 0 && state.done >= total()) || (playing < 0 && state.done <= 0)) pause();
  };
  const goTo = (done) => {
    state.done = clamp(done, 0, total());
    slider.value = state.done;
  };
  const pause = () => {
    playing = 0;
    label();
    change();
  };
  const start = (direction) => {
    if (playing === direction) return pause();
    way = direction > 0 ? "apart" : "together";
    if (direction > 0 && state.done >= total()) goTo(0);
    if (direction < 0 && state.done <= 0) goTo(total());
    playing = direction;
    last = performance.now();
    state.moving = true;
    label();
    ask();
  };
  const jump = (done, direction) => {
    way = direction;
    if (playing) pause();
    goTo(done);
    change();
  };
  const next = () => jump(Math.floor(state.done + 1e-9) + 1, "apart");
  const previous = () => jump(Math.ceil(state.done - 1e-9) - 1, "together");

  // What is seen, in words; told once for each step.
  const say = () => {
    const plan = shown.exhibit().plans[state.plan], at = shown.step(), count = total();
    let words;
    if (!plan) words = "No plan was made.";
    else if (!count) words = plan.says;
    else if (at < 0) words = (shown.exhibit().plans.length > 1 ? plan.name + ". " : "") + plan.says + " All parts in place.";
    else if (way === "apart") words = "Taking apart, step " + (at + 1) + " of " + count + ": " + plan.steps[at].apart + ".";
    else words = "Putting together, step " + (count - at) + " of " + count + ": " + plan.steps[at].together + ".";
    if (words !== told) live.textContent = told = words;
    slider.setAttribute("aria-valuetext", words);
  };

  const button = (words, title, onclick) => element("button", { type: "button", title, "aria-label": title, onclick }, words);
  const play = button("▶ Take apart", "Play: take apart (space)", () => start(1));
  const back = button("◀ Put together", "Play backward: put together", () => start(-1));
  const label = () => {
    play.textContent = playing > 0 ? "❚❚ Pause" : "▶ Take apart";
    back.textContent = playing < 0 ? "❚❚ Pause" : "◀ Put together";
    play.setAttribute("aria-label", playing > 0 ? "Pause" : "Play: take apart (space)");
    back.setAttribute("aria-label", playing < 0 ? "Pause" : "Play backward: put together");
  };
  const slider = element("input", { type: "range", min: 0, step: 0.01, "aria-label": "How far the plan has come, in steps", oninput: () => {
    const to = Number(slider.value);
    jump(to, to >= state.done ? "apart" : "together");
  } });
  const live = element("p", { class: "step", "aria-live": "polite" });
  const buttons = [button("⏮", "All in place (Home)", () => jump(0, "together")), button("‹ Step", "Previous step (p)", previous), back, play, button("Step ›", "Next step (n)", next)];
  const transport = element("div", { class: "transport", role: "group", "aria-label": "The plan, step by step" }, ...buttons, slider);

  // Lists.
  let made = 0;
  const labelled = (words, control) => {
    const id = "viewer-" + ++made;
    control.id = id;
    return element("span", { class: "field" }, element("label", { for: id }, words), control);
  };
  const select = (names, onchange) => {
    const s = element("select", { onchange: () => onchange(s.selectedIndex) });
    const fill = (list) => s.replaceChildren(...list.map((n) => element("option", {}, n)));
    fill(names);
    return Object.assign(s, { fill });
  };
  const which = select(exhibits.map((e) => e.name), (k) => {
    shown.choose(k);
    refresh();
  });
  const plans = select([], (k) => {
    playing = 0;
    label();
    shown.choosePlan(k);
    refreshPlan();
  });
  const colour = select([], (k) => {
    state.scheme = k;
    refreshLegend();
  });
  const directions = select(DIRECTIONS, (k) => {
    state.direction = k;
    refreshLegend();
  });
  directions.selectedIndex = state.direction;
  const direction = labelled("Moving along", directions);
  const parts = select([], (k) => pick(k - 1));
  const pick = (p) => {
    state.picked = p;
    parts.selectedIndex = p + 1;
    refreshLegend();
  };
  const legend = element("ul", { class: "legend", "aria-label": "Colours" });
  const refreshLegend = () => {
    direction.hidden = !shown.blocking();
    colour.selectedIndex = state.scheme;
    const item = ([rgb, words]) => {
      const chip = element("span", { class: "chip", "aria-hidden": true });
      chip.style.background = "rgb(" + rgb.join() + ")";
      return element("li", {}, chip, words);
    };
    const list = shown.legend().map(item);
    if (state.picked >= 0 && !shown.blocking()) list.push(element("li", {}, "chosen: " + shown.exhibit().ids[state.picked]));
    legend.replaceChildren(...list);
    ask();
  };

  // Section, explosion, signs.
  const range = (attributes, oninput) => {
    const r = element("input", { type: "range", ...attributes, oninput: () => {
      oninput(Number(r.value));
      change();
    } });
    return r;
  };
  const axis = select(["no section", "across x", "across y", "across z"], (k) => {
    state.section.axis = k - 1;
    // The half toward the viewer goes.
    if (k) flip.checked = state.section.flip = frame(state.view.azimuth, state.view.elevation).back[k - 1] < 0;
    place.disabled = flip.disabled = !k;
    change();
  });
  const place = range({ min: -1, max: 1, step: 0.005, value: 0, disabled: true, "aria-label": "Section at" }, (v) => (state.section.at = v));
  const check = (onchange, checked = false) => {
    const c = element("input", { type: "checkbox", checked, onchange: () => {
      onchange(c.checked);
      ask();
    } });
    return c;
  };
  const flip = check((on) => (state.section.flip = on));
  flip.disabled = true;
  const explode = range({ min: 0, max: 1.5, step: 0.01, value: 0 }, (v) => (state.explode = v));
  const arrows = check((on) => {
    state.signs = on;
    refreshSigns();
  });
  const arrowsField = labelled("Arrows", arrows);
  const faint = check((on) => (state.left = on ? "faint" : "none"), true);
  const signsSay = element("p", { class: "note" });
  const refreshSigns = () => {
    const signs = shown.exhibit().signs;
    arrowsField.hidden = !signs.length;
    if (signs.length) arrowsField.firstChild.textContent = signs[0].name;
    signsSay.textContent = state.signs && signs.length ? signs[0].says : "";
    arrows.checked = state.signs;
  };
  const home = () => {
    Object.assign(state.view, { azimuth: -62, elevation: 38, zoom: 1, pan: [0, 0] });
    ask();
  };
  const views = element("span", { class: "views", role: "group", "aria-label": "Views" },
    button("Home", "Home: the first view (0)", home),
    ...[["Top", -90, 90], ["Front", -90, 0], ["Side", 0, 0]].map(([name, azimuth, elevation]) => button(name, name + " view", () => {
      Object.assign(state.view, { azimuth, elevation });
      ask();
    })));

  const refreshPlan = () => {
    const count = total();
    slider.max = count;
    slider.value = state.done;
    plans.selectedIndex = state.plan;
    for (const b of [...buttons, slider]) b.disabled = !count;
    told = "";
    change();
  };
  const planField = labelled("Plan", plans);
  const refresh = () => {
    const e = shown.exhibit();
    playing = 0;
    label();
    which.selectedIndex = state.exhibit;
    plans.fill(e.plans.map((p) => p.name));
    planField.hidden = e.plans.length < 2;
    colour.fill([...e.schemes.map((s) => "by " + s.name), ...(e.touch ? ["by who stops whom"] : [])]);
    parts.fill(["none", ...e.ids]);
    axis.selectedIndex = 0;
    explode.value = 0;
    refreshSigns();
    refreshLegend();
    refreshPlan();
  };

  // Fingers and mouse: one turns, two (or the right button, or shift) shift and zoom.
  const turn = (dx, dy) => {
    state.view.azimuth -= dx;
    state.view.elevation = clamp(state.view.elevation + dy, -90, 90);
    change();
  };
  const zoom = (factor) => {
    state.view.zoom = clamp(state.view.zoom * factor, 0.2, 40);
    change();
  };
  const shift = (dx, dy) => {
    const size = 2 / (canvas.clientHeight * state.view.zoom);
    state.view.pan[0] -= dx * size;
    state.view.pan[1] += dy * size;
    change();
  };
  const down = new Map();
  let travelled = 0;
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, [e.clientX, e.clientY]);
    travelled = 0;
  });
  canvas.addEventListener("pointermove", (e) => {
    const was = down.get(e.pointerId);
    if (!was) return;
    const [dx, dy] = [e.clientX - was[0], e.clientY - was[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (down.size === 1) {
      if (e.shiftKey || e.buttons & 2) shift(dx, dy);
      else turn(dx * 0.4, dy * 0.4);
    } else {
      const other = [...down].find(([id]) => id !== e.pointerId)[1];
      const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      zoom(gap([e.clientX, e.clientY]) / gap(was));
      shift(dx / 2, dy / 2);
    }
    down.set(e.pointerId, [e.clientX, e.clientY]);
  });
  const up = (e) => {
    // A finger that hardly moved has pointed at a part.
    if (e.type === "pointerup" && down.size === 1 && travelled < 6 && e.button === 0) {
      const box = canvas.getBoundingClientRect(), fine = canvas.width / box.width;
      pick(shown.partAt((e.clientX - box.left) * fine, (e.clientY - box.top) * fine));
    }
    down.delete(e.pointerId);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  // The wheel scrolls the page unless the picture was chosen first.
  canvas.addEventListener("wheel", (e) => {
    if (document.activeElement !== canvas && !e.ctrlKey) return;
    e.preventDefault();
    zoom(Math.exp(-e.deltaY * 0.0015));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => turn(8, 0), ArrowRight: () => turn(-8, 0), ArrowUp: () => turn(0, 6), ArrowDown: () => turn(0, -6),
    "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), 0: home,
    n: next, p: previous, " ": () => total() && start(1), Home: () => jump(0, "together"), End: () => jump(total(), "apart"),
  };
  canvas.addEventListener("keydown", (e) => {
    const act = !e.ctrlKey && !e.metaKey && !e.altKey && keys[e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });

  const help = element("p", { class: "note", id: "viewer-keys" },
    "Drag, or arrow keys, to turn; pinch, wheel or + and − to zoom; shift and drag to move; click a part to choose it. n and p: next and previous step; space: play; 0: first view.");
  canvas.setAttribute("aria-describedby", "viewer-keys");
  const top = element("div", { class: "bar" }, ...(exhibits.length > 1 ? [labelled("Show", which)] : []), labelled("Colour", colour), direction, labelled("Part", parts), views);
  const more = element("div", { class: "bar" }, labelled("Section", axis), labelled("at", place), labelled("other half", flip), labelled("Explode", explode), arrowsField, labelled("show parts that left", faint));
  root.append(top, element("div", { class: "stage" }, canvas), legend, element("div", { class: "bar" }, planField), transport, live, more, signsSay, help);

  new ResizeObserver(() => {
    const fine = Math.min(devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * fine));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * fine));
    shown.draw();
  }).observe(canvas);
  canvas.addEventListener("webglcontextlost", () => (live.textContent = "The picture was lost; load the page again."));
  refresh();
  return { jump, refreshLegend, ask };
}
