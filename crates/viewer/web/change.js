// Two bakes of one scene: which pairs became visible, and which hidden.

class Change {
  /** Compares two tables with the same cells. */
  constructor(now, before) {
    this.gained = [];
    this.lost = [];
    for (let a = 0; a < now.cells.length; a++) {
      for (let b = 0; b < a; b++) {
        const [is, was] = [now.sees(a, b), before.sees(a, b)];
        if (is !== was) (is ? this.gained : this.lost).push([b, a]);
      }
    }
    this.states = new Map();
    this.gained.forEach(([a, b]) => this.mark(a, b, 1));
    this.lost.forEach(([a, b]) => this.mark(a, b, -1));
  }

  mark(a, b, state) {
    this.states.set(`${a},${b}`, state);
    this.states.set(`${b},${a}`, state);
  }

  /** 1 if one of these cells sees the other only now, -1 if it saw it only before, else 0. */
  stateOf(from, cell) {
    return from.map((at) => this.states.get(`${at},${cell}`) ?? 0).find((state) => state !== 0) ?? 0;
  }
}
