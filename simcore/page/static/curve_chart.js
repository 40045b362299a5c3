// A chart of a sieve curve whose points are moved by mouse, finger or keyboard.
const CurveChart = (() => {
  const { element } = Drawings;
  const { general } = Numbers;
  const [WIDTH, HEIGHT, LEFT, TOP] = [404, 220, 52, 12];
  const AROUND = 1.5; // room on each side of the sieves, as a ratio of sizes
  const STEPS = { ArrowUp: 0.01, ArrowDown: -0.01, PageUp: 0.1, PageDown: -0.1, Home: -1, End: 1 };
  const NUDGES = { ArrowLeft: 1 / 1.02, ArrowRight: 1.02 };
  const CLOSEST = 1.02; // smallest ratio of two neighbouring sieves
  const STILL = 8; // a drag that is narrower leaves the opening as it is

  // Returns {show(points), hide()}. points: ascending [{size [mm], passing}]. write(number, digits): a number as text.
  // change(points): called after an edit. isOpen(): whether the coarsest sieve may retain grains.
  function create(container, { change, isOpen, write }) {
    let points = [];
    let range = null;
    let drag = null;
    let handles = [];
    let line = null;

    const x = (size) => LEFT + (WIDTH * Math.log(size / range[0])) / Math.log(range[1] / range[0]);
    const y = (passing) => TOP + HEIGHT * (1 - passing);
    const sizeAt = (px) => range[0] * (range[1] / range[0]) ** ((px - LEFT) / WIDTH);

    function show(given) {
      const edited = drag !== null || container.contains(document.activeElement);
      const rebuild = given.length !== points.length || !range;
      points = given.map((point) => ({ ...point }));
      const wide = [points[0].size / AROUND, points.at(-1).size * AROUND];
      const outside = range && (points[0].size < range[0] || points.at(-1).size > range[1]);
      if (!range || outside || !edited) {
        const same = range && wide.every((size, i) => Math.abs(size / range[i] - 1) < 1e-9);
        if (!same) {
          range = wide;
          return draw();
        }
      }
      return rebuild ? draw() : place();
    }

    function hide() {
      points = [];
      range = null;
      container.replaceChildren();
    }

    function draw() {
      const focused = handles.indexOf(document.activeElement);
      const label = "Share of the mass that passes each sieve; its points can be moved";
      const drawing = element("svg", {
        viewBox: `0 0 ${LEFT + WIDTH + 12} ${TOP + HEIGHT + 46}`, role: "group", "aria-label": label,
      });
      const rule = (x1, y1, x2, y2) => drawing.append(element("line", { x1, y1, x2, y2, class: "grid" }));
      for (const share of [0, 0.25, 0.5, 0.75, 1]) {
        rule(LEFT, y(share), LEFT + WIDTH, y(share));
        drawing.append(element("text", { x: LEFT - 7, y: y(share) + 4, class: "end" }, write(100 * share, 3)));
      }
      for (const size of ticks(range)) {
        rule(x(size), TOP, x(size), TOP + HEIGHT);
        drawing.append(element("text", { x: x(size), y: TOP + HEIGHT + 17, class: "middle" }, write(size, 3)));
      }
      drawing.append(element("rect", { x: LEFT, y: TOP, width: WIDTH, height: HEIGHT, class: "frame field" }));
      drawing.append(
        element("text", { x: LEFT + WIDTH / 2, y: TOP + HEIGHT + 38, class: "middle" }, "sieve opening (mm)"),
        element("text", { transform: `translate(14 ${y(0.5)}) rotate(-90)`, class: "middle" }, "passing (%)")
      );
      line = element("polyline", { class: "curve" });
      handles = points.map((_, i) => element("circle", { r: 7, class: "handle", tabindex: 0, role: "slider", "data-point": i }));
      drawing.append(line, ...handles);
      container.replaceChildren(drawing);
      place();
      if (focused >= 0) handles[Math.min(focused, handles.length - 1)].focus();
    }

    function place() {
      line.setAttribute("points", points.map(({ size, passing }) => `${x(size)},${y(passing)}`).join(" "));
      handles.forEach((handle, i) => {
        const { size, passing } = points[i];
        const [low, high] = limits(i);
        const attributes = {
          cx: x(size), cy: y(passing), "aria-label": `sieve ${write(size, 4)} mm`, "aria-orientation": "vertical",
          "aria-valuemin": round(100 * low), "aria-valuemax": round(100 * high), "aria-valuenow": round(100 * passing),
          "aria-valuetext": `${write(100 * passing, 4)} % pass ${write(size, 4)} mm`,
        };
        Object.entries(attributes).forEach(([key, value]) => handle.setAttribute(key, value));
      });
    }

    // Returns the lowest and the highest share that may pass sieve i.
    function limits(i) {
      if (i === points.length - 1 && !isOpen()) return [1, 1];
      return [i ? points[i - 1].passing : 0, points[i + 1]?.passing ?? 1];
    }

    function move(i, passing, size) {
      const [low, high] = limits(i);
      const [finer, coarser] = [points[i - 1]?.size ?? 1e-3, points[i + 1]?.size ?? 1e4];
      points[i].passing = Math.min(Math.max(passing, low), high);
      if (size !== points[i].size) {
        points[i].size = Math.min(Math.max(Number(general(size, 3)), finer * CLOSEST), coarser / CLOSEST);
      }
      changed();
    }

    function add(size, passing) {
      const position = points.findIndex((point) => point.size > size);
      const i = position < 0 ? points.length : position;
      const [finer, coarser] = [points[i - 1], points[i]];
      if ((finer && size < finer.size * CLOSEST) || (coarser && size > coarser.size / CLOSEST)) return;
      const high = coarser?.passing ?? 1;
      const share = coarser ? Math.min(Math.max(passing, finer?.passing ?? 0), high) : 1;
      points.splice(i, 0, { size: Number(general(size, 3)), passing: share });
      draw();
      handles[i].focus();
      changed();
    }

    function remove(i) {
      if (points.length <= 2) return;
      points.splice(i, 1);
      if (!isOpen()) points.at(-1).passing = 1;
      handles[i].focus();
      draw();
      changed();
    }

    function changed() {
      place();
      change(points);
    }

    function onKey(event) {
      const i = handles.indexOf(event.target);
      if (i < 0 || event.ctrlKey || event.altKey || event.metaKey) return;
      const { size, passing } = points[i];
      if (event.key in STEPS) move(i, round(passing + STEPS[event.key], 4), size);
      else if (event.key in NUDGES) move(i, passing, nudged(size, NUDGES[event.key]));
      else if (event.key === "+" || event.key === "Insert") {
        const other = points[i + 1] ?? points[i - 1];
        add(Math.sqrt(size * other.size), round((passing + other.passing) / 2, 2));
      } else if (event.key === "Delete" || event.key === "Backspace") remove(i);
      else return;
      event.preventDefault();
    }

    function at(event) {
      const drawing = container.firstElementChild;
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(drawing.getScreenCTM().inverse());
      return [place.x, place.y];
    }

    const shareAt = (py) => round(1 - (py - TOP) / HEIGHT, 2);

    container.addEventListener("keydown", onKey);
    container.addEventListener("pointerdown", (event) => {
      const i = handles.indexOf(event.target);
      if (i < 0 || event.button) return;
      event.preventDefault();
      handles[i].focus();
      container.setPointerCapture(event.pointerId);
      drag = { i, from: at(event)[0], size: points[i].size };
    });
    container.addEventListener("pointermove", (event) => {
      if (!drag) return;
      const [px, py] = at(event);
      move(drag.i, shareAt(py), Math.abs(px - drag.from) < STILL ? drag.size : sizeAt(px));
    });
    const end = () => {
      drag = null;
    };
    container.addEventListener("pointerup", end);
    container.addEventListener("pointercancel", end);
    container.addEventListener("click", (event) => {
      if (!event.target.classList?.contains("field")) return;
      const [px, py] = at(event);
      add(sizeAt(px), shareAt(py));
    });

    return { show, hide };
  }

  const nudged = (size, factor) => {
    const next = Number(general(size * factor, 3));
    return next === size ? size * factor : next;
  };
  const round = (value, digits = 1) => Number(value.toFixed(digits));

  // Returns sizes 1, 2 and 5 times powers of ten inside a range.
  function ticks([low, high]) {
    const decades = Math.log10(high / low);
    const steps = decades > 2.5 ? [1] : [1, 2, 5];
    const first = Math.floor(Math.log10(low));
    const powers = [...Array(Math.ceil(decades) + 2).keys()].map((i) => first + i);
    const sizes = powers.flatMap((power) => steps.map((step) => Number((step * 10 ** power).toPrecision(3))));
    return sizes.filter((size) => size >= low && size <= high);
  }

  return { create };
})();
