// The page's player: time, controls, keys and pointers.

import { from_base64, inflate } from "./bytes.js";
import { Orbit } from "./lens.js";
import { Picture } from "./picture.js";
import { Reel } from "./reel.js";
import { NOTHING, Values } from "./values.js";

const $ = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
const CLOSING = "closing: how fast the points that touch come together, along the normal of the contact";
const APART = 3; // px: from a tick to the next at least
const TICK = 4, // px: a click so near an event's tick is meant for it,
  TAP = 8; // and a finger that goes no farther taps
const TOLD = 200; // ms between two tables while the film plays
const SLOW = 16, // ms: where a whole picture takes longer it is sketched while it moves,
  REST = 150, // and drawn whole when it has stood so long,
  HELD = 600; // or so long under a pointer that is down

class Player {
  /**
   * @param {any} film
   * @param {Reel} reel
   */
  constructor(film, reel) {
    this.film = film;
    this.reel = reel;
    this.values = new Values(film, reel);
    this.picture = new Picture($("picture"), film, reel);
    this.last = reel.frames - 1;
    this.frame = 0; // of the film, not necessarily whole
    this.rate = 1;
    this.playing = false;
    this.again = false;
    /** @type {any} */
    this.pointed = null; // what the pointer is on
    this.due = false;
    this.told = 0;
    /** How long the last two whole pictures took, ms. */
    this.costs = [0, 0];
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.resting = undefined;
    this.sketched = false; // what is on the page
    this.held = false; // whether a pointer is down
    this.by = -1; // the column by which the table of values is sorted
    this.wire();
    this.layout();
  }

  /** Shows a frame; between two frames what moves is between. */
  show(frame) {
    this.frame = Math.min(Math.max(frame, 0), this.last);
    this.refresh();
  }

  /** Shows an instant of the film, s. */
  seek(seconds) {
    this.pause();
    this.show(seconds * this.film.fps);
  }

  /** Goes to a whole frame. */
  step(by) {
    this.pause();
    this.show((by > 0 ? Math.floor(this.frame + NOTHING) : Math.ceil(this.frame - NOTHING)) + by);
  }

  play() {
    if (this.frame >= this.last) this.frame = 0;
    this.playing = true;
    this.before = performance.now();
    document.body.classList.add("playing");
    $("play").title = "Pause (space)";
    requestAnimationFrame((now) => this.tick(now));
  }

  pause() {
    this.playing = false;
    document.body.classList.remove("playing");
    $("play").title = "Play (space)";
  }

  tick(now) {
    if (!this.playing) return;
    this.frame += (Math.min(now - this.before, 250) / 1000) * this.rate * this.film.fps;
    this.before = now;
    if (this.frame > this.last) {
      if (this.again) this.frame %= this.last + 1;
      if (this.frame > this.last) {
        this.frame = this.last;
        if (!this.again) this.pause();
      }
    }
    this.draw(this.slow);
    if (this.playing) requestAnimationFrame((then) => this.tick(then));
    else this.draw();
  }

  /** Draws when the browser next does: where a whole picture takes long, a sketch of it until nothing moves. */
  refresh() {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      if (this.due) this.draw(this.slow);
    });
  }

  /** Whether pictures of space take long here. */
  get slow() {
    return Math.min(...this.costs) > SLOW;
  }

  /** @param {boolean} [sketched] */
  draw(sketched = false) {
    this.due = false;
    clearTimeout(this.resting);
    this.sketched = sketched;
    if (sketched && !this.playing) this.resting = setTimeout(() => this.draw(), this.held ? HELD : REST);
    const began = performance.now();
    // at full speed the frames of the film, slower also what is between them
    const frame = this.playing && this.rate >= 1 ? Math.floor(this.frame + NOTHING) : this.frame;
    this.picture.draw(frame, sketched);
    if (!sketched && this.picture.spaces.length) this.costs = [this.costs[1], performance.now() - began];
    const seconds = frame / this.film.fps,
      run = this.values.time(frame);
    const scrub = $("scrub");
    if (Math.abs(Number(scrub.value) - frame) > NOTHING) scrub.value = String(frame);
    scrub.setAttribute("aria-valuetext", `${this.values.clock(run)} of the run`);
    $("clock").textContent = this.slowed
      ? `${this.values.clock(run)} (${seconds.toFixed(2)} s)`
      : `${run.toFixed(2)} / ${this.ends.toFixed(2)} s`;
    const said = this.film.captions
      .filter((/** @type {any} */ c) => c.from <= seconds && seconds < c.to)
      .map((/** @type {any} */ c) => c.text)
      .join(" ");
    if ($("caption").textContent !== said) $("caption").textContent = said;
    this.tell();
    const now = performance.now();
    if (!this.playing || now - this.told > TOLD) {
      this.told = now;
      this.list();
    }
    this.mark_event(frame);
  }

  /** How long the film is, s. */
  get ends() {
    return (this.last + 1) / this.film.fps;
  }

  /** Whether the film's time is not the run's. */
  get slowed() {
    return Math.abs(this.values.time(this.last) - this.last / this.film.fps) > 0.01;
  }

  layout() {
    const full = document.fullscreenElement === $("film"),
      embedded = document.body.classList.contains("embedded");
    const wide = document.documentElement.clientWidth,
      bar = $("controls").offsetHeight || 48;
    const high = window.innerHeight - bar - (full || embedded ? 0 : 8);
    const most = Math.min(wide, full ? 1e9 : 1920);
    const width = Math.max(160, Math.min(most, Math.max(high, 160) * this.film.aspect)),
      height = width / this.film.aspect;
    const canvas = $("picture"),
      pixel = window.devicePixelRatio || 1;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    this.picture.size(Math.round(width * pixel), Math.round(height * pixel));
    // the first picture of space is there at once
    this.draw(this.picture.spaces.length > 0 && this.costs[1] === 0);
    this.draw_ticks();
  }

  /** Page units of a pointer. */
  place(event) {
    const box = $("picture").getBoundingClientRect(),
      k = 1080 / box.height;
    return [(event.clientX - box.left) * k, (event.clientY - box.top) * k];
  }

  // events

  /** The frame at which an event's picture is first there. */
  frame_of(event) {
    return Math.min(Math.max(event.film * this.film.fps, 0), this.last);
  }

  /** The frame of the next event, or of the one before; none: there is no more. */
  event_beside(way) {
    const frames = this.film.events.map((/** @type {any} */ e) => this.frame_of(e));
    return way > 0
      ? frames.find((/** @type {number} */ f) => f > this.frame + 1e-3)
      : frames.reverse().find((/** @type {number} */ f) => f < this.frame - 1e-3);
  }

  to_event(way) {
    const found = this.event_beside(way);
    if (found === undefined) return;
    this.pause();
    this.show(found);
  }

  list_events() {
    const { events } = this.film;
    if (events.length === 0) {
      $("before").hidden = $("next").hidden = true;
      return;
    }
    $("events").hidden = false;
    const list = $("events").querySelector("ol");
    for (const event of events) {
      const item = document.createElement("li"),
        button = document.createElement("button");
      button.type = "button";
      button.textContent = `${this.values.clock(event.time, 3)}  ${event.text}`;
      if (event.text.includes("closing")) button.title = CLOSING;
      button.addEventListener("click", () => {
        this.pause();
        this.show(this.frame_of(event));
        // what happens there is to be seen
        $("film").scrollIntoView({ block: "nearest" });
      });
      item.append(button);
      list.append(item);
    }
  }

  mark_event(frame) {
    const items = $("events").querySelectorAll("li");
    let now = -1;
    this.film.events.forEach((/** @type {any} */ e, /** @type {number} */ i) => {
      if (this.frame_of(e) <= frame + 1e-3) now = i;
    });
    for (const [id, way] of /** @type {[string, number][]} */ ([
      ["before", -1],
      ["next", 1],
    ]))
      $(id).setAttribute("aria-disabled", String(this.event_beside(way) === undefined));
    if (now === this.event) return;
    // all that happen together
    const together = (/** @type {number} */ i) =>
      now >= 0 && Math.abs(this.frame_of(this.film.events[i]) - this.frame_of(this.film.events[now])) < 1e-3;
    items.forEach((each, i) => each.classList.toggle("now", together(i)));
    this.event = now;
  }

  draw_ticks() {
    const canvas = $("ticks"),
      pixel = window.devicePixelRatio || 1;
    const width = canvas.clientWidth,
      height = canvas.clientHeight;
    if (width === 0) return;
    canvas.width = Math.round(width * pixel);
    canvas.height = Math.round(height * pixel);
    const c = canvas.getContext("2d"),
      style = getComputedStyle(document.body);
    c.scale(pixel, pixel);
    const x = (/** @type {number} */ frame) => this.track_place(frame, width);
    c.fillStyle = style.getPropertyValue("--line");
    c.fillRect(x(0), height / 2 - 2, x(this.last) - x(0), 4);
    c.fillStyle = style.getPropertyValue("--quiet");
    // those that would run into each other are a comb, not a bar
    let free = -Infinity;
    for (const event of this.film.events) {
      const at = x(this.frame_of(event));
      if (at < free) continue;
      c.fillRect(at - 0.75, height / 2 + 5, 1.5, 5);
      free = at + APART;
    }
  }

  /** Where a frame is on the track, px of its width. */
  track_place(frame, width) {
    const inset = 7;
    return inset + ((width - 2 * inset) * frame) / Math.max(this.last, 1);
  }

  /** The frame of the event whose tick a click on the track is meant for. */
  event_at(x, width) {
    let best = null,
      least = TICK;
    for (const event of this.film.events) {
      const frame = this.frame_of(event),
        off = Math.abs(this.track_place(frame, width) - x);
      if (off < least) {
        least = off;
        best = frame;
      }
    }
    return best;
  }

  // what bodies do

  /** The words beside the pointer. */
  tell() {
    const tip = $("tip"),
      it = this.pointed;
    this.picture.charts.cursor = it?.chart ? it : null;
    if (!it) {
      tip.hidden = true;
      return;
    }
    tip.textContent = "";
    if (it.chart) {
      tip.textContent = this.picture.charts.words(it.chart, it.frame).join("\n");
    } else {
      const body = this.values.body(it.part, it.index);
      if (!body) {
        tip.hidden = true;
        return;
      }
      const name = document.createElement("b");
      name.textContent = body.run === undefined ? body.name : `${body.name}, ${body.run}`;
      tip.append(
        name,
        this.values
          .rows(body, this.picture.frame)
          .map(([what, value]) => `\n${what}  ${value}`)
          .join(""),
      );
    }
    tip.hidden = false;
    const stage = $("stage").getBoundingClientRect(),
      left = it.x - stage.left,
      top = it.y - stage.top;
    const x = left + 16 + tip.offsetWidth > stage.width ? left - 16 - tip.offsetWidth : left + 16;
    tip.style.left = `${Math.max(0, x)}px`;
    tip.style.top = `${Math.max(0, Math.min(top + 14, stage.height - tip.offsetHeight))}px`;
  }

  /** The table of all bodies, where it is open. */
  list() {
    const panel = $("values");
    if (!panel.open) {
      $("when").textContent = "";
      return;
    }
    const { head, rows } = this.values.table(this.picture.frame, this.by),
      { time, before } = this.values.instant(this.picture.frame);
    $("when").textContent = `at ${this.values.clock(time, 3)}${before ? ", just before" : ""}`;
    panel.classList.toggle("runs", head[1] === "run");
    const body = panel.querySelector("tbody"),
      it = this.pointed;
    while (body.rows.length > rows.length) body.deleteRow(-1);
    while (body.rows.length < rows.length) this.row(body.insertRow(), head.length);
    rows.forEach((/** @type {any} */ each, /** @type {number} */ i) => {
      const line = body.rows[i],
        { part, index, name } = each.body;
      Object.assign(line.dataset, { part, index });
      [name, ...each.words].forEach((text, k) => {
        if (line.cells[k].textContent !== text) line.cells[k].textContent = text;
      });
      line.classList.toggle("now", Boolean(it && !it.chart && it.part === part && it.index === index));
    });
    const heads = panel.querySelector("thead");
    if (!heads.firstChild) heads.append(this.heads(head));
    heads.querySelectorAll("th").forEach((/** @type {HTMLElement} */ each, /** @type {number} */ i) => {
      if (i === this.by) each.setAttribute("aria-sort", i === 0 || head[i] === "run" ? "ascending" : "descending");
      else each.removeAttribute("aria-sort");
    });
  }

  /** A row of the table, of so many columns: pointed at, it names its body. */
  row(line, columns) {
    for (let k = 0; k < columns; ++k) line.insertCell();
    line.addEventListener("pointerenter", () => this.name([Number(line.dataset.part), Number(line.dataset.index)]));
    line.addEventListener("pointerleave", () => this.name(null));
  }

  /** The head of the table: a column is sorted where it is clicked, and again as in the scene. */
  heads(names) {
    const line = document.createElement("tr");
    names.forEach((/** @type {string} */ name, /** @type {number} */ i) => {
      const button = line.appendChild(document.createElement("th")).appendChild(document.createElement("button"));
      button.type = "button";
      button.textContent = name;
      button.title = "Sort";
      button.addEventListener("click", () => {
        this.by = this.by === i ? -1 : i;
        this.list();
      });
    });
    return line;
  }

  /** Puts a ring around a body, or takes it away. */
  name(body) {
    this.picture.named = body;
    if (!this.playing) this.refresh();
  }

  point(event) {
    const [x, y] = this.place(event),
      canvas = $("picture");
    const chart = this.picture.charts.at(x, y);
    if (chart) {
      this.pointed = { chart, frame: this.picture.charts.frame_at(chart, x), x: event.clientX, y: event.clientY };
    } else {
      const body = this.picture.body_at(x, y);
      this.pointed = body && { part: body[0], index: body[1], x: event.clientX, y: event.clientY };
    }
    canvas.classList.toggle("seek", Boolean(chart));
    canvas.classList.toggle("body", Boolean(this.pointed && !chart));
    if (!this.playing) this.refresh();
  }

  // keys, pointers

  wire() {
    const { film } = this;
    $("scrub").max = String(this.last);
    $("stage").style.background = `rgb(${film.ground.join(",")})`;
    $("scrub").addEventListener("input", () => {
      this.pause();
      this.show(Number($("scrub").value));
    });
    // a click on a tick goes to its event, not only near it
    let from = 0;
    $("scrub").addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => (from = event.clientX));
    $("scrub").addEventListener("click", (/** @type {MouseEvent} */ event) => {
      const box = $("scrub").getBoundingClientRect(),
        found = Math.abs(event.clientX - from) < TICK ? this.event_at(event.clientX - box.left, box.width) : null;
      if (found !== null) this.show(found);
    });
    const press = (/** @type {string} */ id, /** @type {() => void} */ what) => $(id).addEventListener("click", what);
    press("play", () => this.toggle());
    press("back", () => this.step(-1));
    press("on", () => this.step(1));
    press("before", () => this.to_event(-1));
    press("next", () => this.to_event(1));
    press("loop", () => this.loop());
    press("home", () => this.home());
    press("above", () => this.above());
    $("above").hidden = !film.spaces;
    press("full", () => this.full());
    press("help", () => this.help());
    $("speed").addEventListener("change", () => this.speed(Number($("speed").value)));
    // chosen with the pointer, the list does not keep the arrow keys
    let by_pointer = false;
    $("speed").addEventListener("pointerdown", () => (by_pointer = true));
    $("speed").addEventListener("change", () => {
      if (by_pointer) $("speed").blur();
      by_pointer = false;
    });
    $("values").addEventListener("toggle", () => this.list());
    for (const id of ["story", "events", "values"])
      $(id).addEventListener("toggle", () => {
        if ($(id).open) $(id).scrollIntoView({ block: "nearest" });
        else if (id === "values") this.name(null);
      });
    document.addEventListener("keydown", (event) => this.key(event));
    for (const kind of ["pointerdown", "pointerup", "pointercancel"])
      document.addEventListener(kind, () => {
        this.held = kind === "pointerdown";
        // let go, it stands
        if (!this.held && this.sketched && !this.playing) this.refresh();
      });
    window.addEventListener("resize", () => this.layout());
    document.addEventListener("fullscreenchange", () => this.layout());
    document.body.classList.toggle("space", film.dimension === 3);
    // printed, what happens and the events are there, open or not
    /** @type {any[]} */
    let closed = [];
    window.addEventListener("beforeprint", () => {
      closed = ["story", "events"].map($).filter((each) => !each.open);
      for (const each of closed) each.open = true;
    });
    window.addEventListener("afterprint", () => {
      for (const each of closed) each.open = false;
      closed = [];
    });
    this.list_events();
    this.wire_pointers();
    $("controls").hidden = false;
  }

  wire_pointers() {
    const stage = $("stage"),
      canvas = $("picture");
    /** @type {Map<number, number[]>} */
    const held = new Map();
    let moved = false,
      seeking = false,
      was = 0,
      gone = 0; // px: how far the pointer has gone
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, this.place(event));
      moved = false;
      gone = 0;
      const [x, y] = this.place(event),
        chart = this.picture.charts.at(x, y);
      seeking = Boolean(chart) && held.size === 1;
      if (seeking) this.seek_chart(event);
      was = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId),
        now = this.place(event);
      if (!before) return this.point(event);
      if (seeking) return this.seek_chart(event);
      held.set(event.pointerId, now);
      const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
      gone += Math.hypot(event.movementX, event.movementY);
      moved ||= gone > (event.pointerType === "touch" ? TAP : 2);
      canvas.classList.add("held");
      if (held.size === 2) {
        const [a, b] = [...held.values()],
          apart = Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (was > 0) this.picture.nearer(apart / was, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
        was = apart;
        this.picture.view.shift(dx / 2, dy / 2);
      } else if (event.shiftKey || event.buttons === 4) {
        this.picture.view.shift(dx, dy);
      } else {
        this.picture.view.move(dx, dy);
      }
      this.pointed = null;
      this.refresh();
    });
    const release = (/** @type {PointerEvent} */ event) => {
      held.delete(event.pointerId);
      was = 0;
      seeking = false;
      canvas.classList.remove("held");
      if (event.type === "pointerup" && !moved) this.point(event);
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    stage.addEventListener("pointerleave", (event) => {
      // a finger that is lifted still points
      if (event.pointerType === "touch") return;
      this.pointed = null;
      this.refresh();
    });
    stage.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const [x, y] = this.place(event);
        this.picture.nearer(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), x, y);
        this.pointed = null;
        this.refresh();
      },
      { passive: false },
    );
    canvas.addEventListener("dblclick", () => this.home());
  }

  seek_chart(event) {
    const [x, y] = this.place(event),
      chart = this.picture.charts.at(x, y) ?? this.pointed?.chart;
    if (!chart) return;
    const frame = this.picture.charts.frame_at(chart, x);
    this.pointed = { chart, frame, x: event.clientX, y: event.clientY };
    this.pause();
    this.show(frame);
  }

  toggle() {
    if (this.playing) {
      this.pause();
      this.refresh();
    } else {
      this.play();
    }
  }

  loop() {
    this.again = !this.again;
    $("loop").setAttribute("aria-pressed", String(this.again));
  }

  home() {
    this.picture.view.home();
    this.refresh();
  }

  above() {
    if (!(this.picture.view instanceof Orbit)) return;
    this.picture.view.above();
    this.refresh();
  }

  full() {
    if (document.fullscreenElement) document.exitFullscreen();
    else
      $("film")
        .requestFullscreen?.()
        // a phone lays a wide picture along its longer side, where it may
        .then(() => /** @type {any} */ (screen.orientation).lock?.(this.film.aspect > 1 ? "landscape" : "portrait"))
        .catch(() => undefined);
  }

  help() {
    const keys = $("keys");
    keys.hidden = !keys.hidden;
    $("help").setAttribute("aria-expanded", String(!keys.hidden));
  }

  speed(rate) {
    this.rate = rate;
    $("speed").value = String(rate);
  }

  faster(by) {
    const speeds = [...$("speed").options].map((each) => Number(each.value));
    const at = speeds.indexOf(this.rate);
    this.speed(speeds[Math.min(Math.max(at + by, 0), speeds.length - 1)]);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey) return;
    const on = /** @type {HTMLElement} */ (event.target),
      kind = on.tagName;
    if (kind === "SELECT" || (kind === "INPUT" && /^(Arrow|Home|End|Page)/.test(event.key))) return;
    if ((kind === "BUTTON" || kind === "SUMMARY") && (event.key === " " || event.key === "Enter")) return;
    const view = this.picture.view,
      middle = [this.picture.width / 2, 540];
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[/** @type {keyof typeof arrows} */ (event.key)];
    const does = () => {
      if (arrow && event.altKey) return (view.move(-40 * arrow[0], -40 * arrow[1]), this.refresh());
      if (event.altKey) return false;
      if (arrow) return arrow[0] !== 0 && this.step(arrow[0] * (event.shiftKey ? Math.round(this.film.fps) : 1));
      switch (event.key) {
        case " ":
        case "k":
          return this.toggle();
        case ",":
          return this.step(-1);
        case ".":
          return this.step(1);
        case "p":
        case "P":
          return this.to_event(-1);
        case "n":
        case "N":
          return this.to_event(1);
        case "Home":
          return (this.pause(), this.show(0));
        case "End":
          return (this.pause(), this.show(this.last));
        case "[":
          return this.faster(-1);
        case "]":
          return this.faster(1);
        case "l":
        case "L":
          return this.loop();
        case "f":
        case "F":
          return this.full();
        case "+":
        case "=":
          return (this.picture.nearer(1.25, ...middle), this.refresh());
        case "-":
        case "−":
          return (this.picture.nearer(0.8, ...middle), this.refresh());
        case "0":
          return this.home();
        case "t":
        case "T":
          return this.above();
        case "v":
        case "V":
          $("values").open = !$("values").open;
          return undefined;
        case "?":
          return this.help();
        case "Escape":
          return $("keys").hidden ? false : this.help();
        default:
          return false;
      }
    };
    if (does() !== false) event.preventDefault();
  }
}

/** The page that `obscura watch` serves: anew when its scene is saved, at the same instant and view. */
function watch(player) {
  const key = "obscura";
  try {
    const was = JSON.parse(sessionStorage.getItem(key) ?? "null");
    if (was && was.title === player.film.title) {
      Object.assign(player.picture.view, was.view);
      player.again = was.again;
      $("loop").setAttribute("aria-pressed", String(was.again));
      player.speed(was.rate);
      player.show(was.seconds * player.film.fps);
      if (was.playing) player.play();
    }
  } catch {
    // what was kept is of another version
  }
  new EventSource("changes").addEventListener("message", (event) => {
    if (event.data === document.body.dataset.watched) return;
    const { view } = player.picture,
      { zoom, dx, dy, turn, tilt, flat } = /** @type {any} */ (view);
    sessionStorage.setItem(
      key,
      JSON.stringify({
        title: player.film.title,
        seconds: player.frame / player.film.fps,
        playing: player.playing,
        rate: player.rate,
        again: player.again,
        view: { zoom, dx, dy, turn, tilt, flat },
      }),
    );
    location.reload();
  });
}

async function open() {
  const bytes = await inflate(from_base64($("reel").textContent));
  const size = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + size)));
  const player = new Player(json.film, new Reel(json.reel, bytes.subarray(4 + size)));
  $("exact").textContent = json.film.exact;
  $("reel").remove();
  if (document.body.hasAttribute("data-watched")) watch(player);
  return player;
}

// the page's scroll bar is there from the start: the picture is as wide as it leaves
if (window.parent !== window || /[?#&]embed\b/.test(location.href))
  for (const each of [document.documentElement, document.body]) each.classList.add("embedded");
// a page around this one, and tests, may turn it: obscura.then((player) => player.seek(1.5))
/** @type {any} */ (window).obscura = open();
